// sinew mbs: the simulator against mechanisms whose motion is known.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/command_files.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "models/mechanisms/integrator.h"
#include "models/mechanisms/mechanism_error.h"

namespace sinew {
namespace {

struct MbsWords {
  std::string which = "all";
  std::string integrator;
  std::string formulation;
  std::string reference;
  std::string json;
  WorkOptions work;
  std::optional<double> accuracy;
  std::optional<double> longest_seconds;
};

/// One mechanism and what became of it.
struct Outcome {
  Mechanism mechanism;
  MechanismOptions options;
  MechanismReference reference;
  MechanismRun run;
  MechanismError error;
  std::string failure;
};

constexpr double kEnergyKept = 1e-3;  // share of the largest kinetic energy

// What the thesis found with OpenSim, table 8 [%].
double OfThesis(const std::string& mechanism) {
  if (mechanism == "A01") return 3.6e-3;
  if (mechanism == "A02") return 9.8e-4;
  if (mechanism == "A03") return 4.7e-2;
  if (mechanism == "A04") return 6.4e-4;
  return mechanism == "A05" ? 7.3e-5 : std::nan("");
}

Result<std::vector<Mechanism>> Chosen(const MbsWords& words) {
  if (words.which == "all") return MechanismRegistry();
  SINEW_ASSIGN(const Mechanism mechanism, FindMechanism(words.which));
  return std::vector<Mechanism>{mechanism};
}

// What may be read of the folder of --reference.
std::vector<std::string> ReferenceFiles(const MbsWords& words) {
  std::vector<std::string> files;
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator(words.reference, code)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path().string());
  }
  return files;
}

Result<Outcome> Examine(const Mechanism& mechanism, const MbsWords& words) {
  Outcome outcome;
  outcome.mechanism = mechanism;
  outcome.options.integrator =
      words.integrator.empty() ? IntegratorRegistry().front().name : words.integrator;
  outcome.options.formulation =
      words.formulation.empty() ? mechanism.formulations.front().name : words.formulation;
  if (words.accuracy) outcome.options.accuracy = *words.accuracy;
  if (words.longest_seconds) outcome.options.longest_seconds = *words.longest_seconds;
  SINEW_TRY(CheckMechanismOptions(mechanism, outcome.options));
  if (words.reference.empty()) {
    outcome.reference = BuiltInReference(mechanism);
  } else {
    SINEW_ASSIGN(outcome.reference, ReadReference(mechanism, words.reference));
  }
  const std::vector<double> times = TimesOf(outcome.reference);
  auto run = SimulateMechanism(mechanism, outcome.options, times);
  if (!run) {
    outcome.failure = run.error().message;
    return outcome;
  }
  outcome.run = std::move(*run);
  outcome.error = ErrorOf(mechanism, outcome.run, times, outcome.reference);
  return outcome;
}

double SimulatedSeconds(const Outcome& outcome) {
  return TimesOf(outcome.reference).back();
}

std::string Describe(const std::vector<Outcome>& outcomes) {
  std::vector<std::vector<std::string>> rows{{"mechanism", "formulation", "error %", "thesis %", "coordinate",
                                              "RMSE", "peak", "unit", "energy drift J", "constraints",
                                              "CPU s", "of real time"}};
  std::string notes;
  for (const Outcome& o : outcomes) {
    const double thesis = OfThesis(o.mechanism.name);
    if (!o.failure.empty()) {
      notes += fmt::format("{}: {}\n", o.mechanism.name, o.failure);
      continue;
    }
    for (std::size_t j = 0; j < o.mechanism.coordinates.size(); ++j) {
      const bool first = j == 0;
      rows.push_back({first ? o.mechanism.name : "", first ? o.options.formulation : "",
                      first ? Readable(100 * o.error.total) : "",
                      first && std::isfinite(thesis) ? Readable(thesis) : "", o.mechanism.coordinates[j],
                      Readable(o.error.rmse[j]), Readable(o.error.peak[j]), o.mechanism.unit,
                      first ? Readable(o.run.energy_drift) : "",
                      first ? Readable(o.run.position_violation) : "", first ? Readable(o.run.seconds) : "",
                      first ? Readable(o.run.seconds / SimulatedSeconds(o), 2) : ""});
    }
    if (o.run.energy_drift > kEnergyKept * o.run.kinetic_energy) {
      notes += fmt::format(
          "{}  does not conserve energy: {} J of {} J are lost or gained; use a higher accuracy\n",
          o.mechanism.name, Readable(o.run.energy_drift), Readable(o.run.kinetic_energy));
    }
    notes += fmt::format("{}  {}; {} of {}; reference: {}\n", o.mechanism.name, o.mechanism.title,
                         Join(o.mechanism.coordinates, ", "), o.mechanism.point, o.reference.source);
  }
  return Table(rows, 0) + "\n" + notes;
}

nlohmann::ordered_json ToJson(const Outcome& o) {
  nlohmann::ordered_json json{{"mechanism", o.mechanism.name},
                              {"title", o.mechanism.title},
                              {"formulation", o.options.formulation},
                              {"integrator", o.options.integrator},
                              {"accuracy", o.options.accuracy},
                              {"reference", o.reference.source},
                              {"reference_certain_to", o.reference.certain_to},
                              {"failure", nullptr}};
  if (!o.failure.empty()) json["failure"] = o.failure;
  if (!o.failure.empty()) return json;
  json["total_error_percent"] = 100 * o.error.total;
  for (std::size_t j = 0; j < o.mechanism.coordinates.size(); ++j) {
    json["coordinates"].push_back({{"name", o.mechanism.coordinates[j]},
                                   {"unit", o.mechanism.unit},
                                   {"rmse", o.error.rmse[j]},
                                   {"peak", o.error.peak[j]},
                                   {"n", o.reference.curves[j].time.size()}});
  }
  json["energy_drift"] = o.run.energy_drift;
  json["kinetic_energy"] = o.run.kinetic_energy;
  json["position_violation"] = o.run.position_violation;
  json["velocity_violation"] = o.run.velocity_violation;
  json["simulated_seconds"] = SimulatedSeconds(o);
  json["cpu_seconds"] = o.run.seconds;
  json["steps"] = o.run.steps;
  json["evaluations"] = o.run.evaluations;
  return json;
}

Result<int> RunMbs(const Program& program, const MbsWords& words) {
  SINEW_ASSIGN(const auto mechanisms, Chosen(words));
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles({ReferenceFiles(words), {}, words.json}));
  ProgressLine line("mbs", words.work.quiet);
  int done = 0;
  std::vector<Outcome> outcomes;
  for (const Mechanism& mechanism : mechanisms) {
    // The test set's start has its own answer, whatever the folder holds.
    if (words.which == "all" && mechanism.name == "A03-IVP" && !words.reference.empty()) continue;
    line.Show(done++, static_cast<int>(mechanisms.size()));
    SINEW_ASSIGN(Outcome outcome, Examine(mechanism, words));
    outcomes.push_back(std::move(outcome));
  }
  line.Clear();
  if (!words.json.empty()) {
    nlohmann::ordered_json json{{"schema", "sinew.mbs/1"}};
    for (const Outcome& outcome : outcomes) json["runs"].push_back(ToJson(outcome));
    SINEW_TRY(WriteText(words.json, json.dump(2)));
  }
  if (words.json != "-") {
    Print(stdout, fmt::format("{} at accuracy {}\n", outcomes.front().options.integrator,
                              Readable(outcomes.front().options.accuracy)));
    Print(stdout, Describe(outcomes));
  }
  for (const Outcome& outcome : outcomes) {
    if (outcome.failure.empty()) continue;
    return ReportNotUsable(program, outcome.failure);
  }
  return kDone;
}

}  // namespace

void AddMbsCommand(Command app, const RunAction& run) {
  auto words = std::make_shared<MbsWords>();
  Command command = app.AddCommand("mbs", "Test the simulator on five mechanisms with a known motion");
  command.Add("mechanism", words->which, "A01 .. A05, A03-IVP or all").ShowsDefault();
  command.Add("--integrator", words->integrator, "One of 'sinew list integrators'");
  command.Add("--accuracy", words->accuracy, "Relative error per step, 1e-14 .. 0.1; default 1e-9");
  command.Add("--formulation", words->formulation, "Of a mechanism that has several (docs/mbs.md)");
  command.Add("--max-seconds", words->longest_seconds,
              "CPU time after which a mechanism is stopped; default 600");
  command
      .Add("--reference", words->reference,
           "Folder with NAME_reference_COORDINATE.csv instead of what is built in")
      .Shows("DIR");
  AddJsonTo(command, words->json);
  words->work.AddQuietTo(command);
  const Program* program = &command.program();
  command.Runs(run, [=] { return RunMbs(*program, *words); });
}

}  // namespace sinew
