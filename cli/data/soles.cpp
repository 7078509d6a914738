// sinew data soles: settings of a contact problem from stances.
#include <cmath>
#include <cstdio>
#include <optional>

#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/data/soles_text.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"

namespace sinew {
namespace {

constexpr const char* kModel = "model.osim";

struct SolesWords {
  std::string path;
  std::string out;
  std::optional<double> floor_height;
  std::string json;
};

Result<int> Soles(const SolesWords& words) {
  if (words.floor_height && !std::isfinite(*words.floor_height))
    return Fail("--floor-height {}: expected a height in m", *words.floor_height);
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles({{words.path}, {words.out}, words.json}));
  SINEW_ASSIGN(const Dataset data, ReadDataset(words.path));
  const auto proposal = ProposeSoles(data, kModel, words.floor_height.value_or(0));
  if (!proposal) return Fail("{}: {}", words.path, proposal.error().message);
  const std::vector<std::string> notes = SolesNotes(*proposal);
  if (proposal->regions.empty())
    return Fail("{}: no sole can be proposed: {}", words.path, Join(notes, "; "));
  for (const std::string& note : notes) Print(stderr, Wrapped("note: " + note, 0));
  SINEW_TRY(WriteText(words.out, SolesYaml(*proposal, words.path, kModel)));
  SINEW_TRY(Report(
      words.json, [&] { return SolesJson(*proposal); }, words.out + "\n" + SolesText(*proposal)));
  return kDone;
}

}  // namespace

void AddSolesCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<SolesWords>();
  Command command =
      data.AddCommand("soles", "Propose settings of the contact problem from stances (docs/contact.md)");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--out", words->out, "Settings to write").Required().NotEmpty().Shows("contact.yaml");
  command.Add("--floor-height", words->floor_height, "Of the floor along y, in m; default: 0");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return Soles(*words); });
}

}  // namespace sinew
