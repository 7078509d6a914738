// What a person types or writes for the program: words of a command line, pipelines, and its record of steps.
#include <filesystem>

#include "base/text.h"
#include "cli/binding.h"
#include "cli/cohort/pipeline.h"
#include "cli/cohort/step_state.h"
#include "cli/parsed_words.h"
#include "tests/fuzz/targets.h"

namespace sinew::fuzz {
namespace {

const Program& ThisProgram() {
  static const Program kProgram = [] {
    Program program;
    program.name = "sinew";
    program.problems = ProblemRegistry();
    program.mechanisms = true;
    return program;
  }();
  return kProgram;
}

}  // namespace

void Pipeline(std::string_view bytes) {
  const std::string path = Scratch("cohort.yaml", bytes);
  const auto pipeline = cohort::ReadPipeline(path, ThisProgram());
  if (!Holds(pipeline, path)) return;
  Demand(!pipeline->subjects.empty() && !pipeline->steps.empty(), "a pipeline without work");
  for (std::size_t i = 0; i < pipeline->tasks.size(); ++i) {
    Demand(!pipeline->tasks[i].written.empty(), "a task that writes nothing");
    for (const std::size_t before : pipeline->tasks[i].after)
      Demand(before < i, "an order that cannot be kept");
  }
}

void Words(std::string_view bytes) {
  std::vector<std::string> words;
  for (const auto line : Split(bytes, '\n')) words.emplace_back(line);
  const auto parsed = ParseWords(ThisProgram(), words);
  if (Holds(parsed, "")) Demand(!parsed->command.empty(), "no command");
  FitOptions options;
  options.fix = options.bounds = options.start = words;
  Holds(options.Request(), "--");
  for (const std::string& word : words) {
    Holds(ParseAssignment("--set", word), "--set");
    Holds(ParseEffect(word), "--effect");
    options.fix = options.start = {};
    options.bounds = {word};
    Holds(options.Request(), "--bounds");
  }
}

void StepStates(std::string_view bytes) {
  const std::string path = Scratch("steps.json", bytes);
  const auto states = cohort::StepStates::Read(ScratchFolder());
  if (!Holds(states, path)) return;
  auto changed = *states;
  Demand(changed.Set("step", {}).has_value(), "a record cannot be written");
  Demand(cohort::StepStates::Read(ScratchFolder()).has_value(), "a record that was written cannot be read");
}

}  // namespace sinew::fuzz
