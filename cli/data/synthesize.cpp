// sinew data synthesize: generates a synthetic data set.
#include "cli/binding.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/run_command_line.h"
#include "datasets/io/dataset_file.h"

namespace sinew {
namespace {

struct SynthesizeWords {
  const Program* program = nullptr;
  std::string problem;
  std::string out;
  std::vector<std::string> set;
  std::vector<std::string> effects;
  WorkOptions work;
  std::string json;
  std::optional<double> noise;
};

Result<int> Synthesize(const SynthesizeWords& words) {
  const auto limit = words.work.LimitThreads();
  SINEW_ASSIGN(const ProblemEntry* entry, FindProblem(words.program->problems, words.problem));
  if (entry->synthesize == nullptr)
    return Fail("data synthesize: the problem '{}' has no synthetic experiment", entry->name);
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles({{}, {words.out}, words.json}));
  SynthesisRequest request;
  request.seed = words.work.seed;
  request.noise = words.noise;
  for (const std::string& text : words.set) {
    SINEW_ASSIGN(const auto assignment, ParseAssignment("--set", text));
    request.set.insert(assignment);
  }
  for (const std::string& text : words.effects) {
    SINEW_ASSIGN(auto effect, ParseEffect(text));
    request.effects.push_back(std::move(effect));
  }
  SINEW_ASSIGN(const Dataset data, entry->synthesize(request));
  SINEW_TRY(WriteDataset(words.out, data));
  SINEW_TRY(Report(
      words.json, [&] { return DatasetJson(data); },
      fmt::format("{}: {} trials, synthetic ({})\n", words.out, data.trials.size(), data.title)));
  return kDone;
}

}  // namespace

void AddSynthesizeCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<SynthesizeWords>();
  words->program = &data.program();
  Command command = data.AddCommand("synthesize", "Generate a synthetic data set");
  command.Add("problem", words->problem).Required().Shows("PROBLEM");
  command.Add("--out", words->out, "Data set to write").Required().Shows("F.h5");
  command.Add("--set", words->set, "True parameters and the experiment (`sinew list parameters PROBLEM`)")
      .Shows("NAME=VALUE");
  command.Add("--effect", words->effects, "Something wrong with the measurement").Shows("NAME:PARAM=VALUE");
  command.Add("--noise", words->noise, "Factor on all noise; 0 for none").Shows("X");
  AddJsonTo(command, words->json);
  words->work.AddSeedTo(command);
  words->work.AddThreadsTo(command);
  words->work.AddQuietTo(command);
  command.Runs(run, [=] { return Synthesize(*words); });
}

}  // namespace sinew
