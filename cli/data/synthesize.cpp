// sinew data synthesize: an experiment that never happened.
#include <cstdio>

#include "base/text.h"
#include "cli/binding.h"
#include "cli/data/data_commands.h"
#include "cli/run_command_line.h"
#include "cli/terminal.h"
#include "datasets/io/dataset_file.h"

namespace sinew {
namespace {

struct SynthesizeWords {
  const Program* program = nullptr;
  std::string problem;
  std::string out;
  std::vector<std::string> set;
  std::vector<std::string> effects;
  std::uint64_t seed = 1;
  std::optional<double> noise;
};

// "NAME" or "NAME:PARAM=VALUE,PARAM=VALUE"
Result<std::pair<std::string, std::map<std::string, double>>> ParseEffect(const std::string& text) {
  const auto at = text.find(':');
  std::map<std::string, double> parameters;
  if (at != std::string::npos) {
    for (const auto part : Split(std::string_view(text).substr(at + 1), ',')) {
      SINEW_ASSIGN(const auto assignment, ParseAssignment("--effect", std::string(part)));
      parameters.insert(assignment);
    }
  }
  return std::pair{text.substr(0, at), parameters};
}

Result<int> Synthesize(const SynthesizeWords& words) {
  SINEW_ASSIGN(const ProblemEntry* entry, FindProblem(words.program->problems, words.problem));
  if (entry->synthesize == nullptr)
    return Fail("data synthesize: the problem '{}' has no laboratory of its own", entry->name);
  SINEW_TRY(CheckOutput(words.out, {}));
  SynthesisRequest request;
  request.seed = words.seed;
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
  std::printf("%s: %zu trials, synthetic (%s)\n", words.out.c_str(), data.trials.size(), data.title.c_str());
  return kDone;
}

}  // namespace

void AddSynthesizeCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<SynthesizeWords>();
  words->program = &data.program();
  Command command = data.AddCommand("synthesize", "An experiment that never happened, marked synthetic");
  command.Add("problem", words->problem).Required().Shows("PROBLEM");
  command.Add("--out", words->out, "Data set to write").Required().Shows("F.h5");
  command.Add("--seed", words->seed, "Seed").Between(std::uint64_t{0}, std::uint64_t{1} << 53).ShowsDefault();
  command.Add("--set", words->set, "True parameters and the experiment (`sinew list parameters PROBLEM`)")
      .Shows("NAME=VALUE");
  command.Add("--effect", words->effects, "Something wrong with the measurement").Shows("NAME:PARAM=VALUE");
  command.Add("--noise", words->noise, "Factor on all noise; 0 for none").Shows("X");
  command.Runs(run, [=] { return Synthesize(*words); });
}

}  // namespace sinew
