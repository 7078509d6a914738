// How long one trial of a joint takes: 10 s at 100 Hz, driven by torque, values alone, with the derivatives
// of a base fit (three parameters and the initial state), of a refit with four causes, and of a score (all of
// them).
#include <benchmark/benchmark.h>

#include <set>
#include <string>

#include "problems/drive/laboratory/synthesis.h"
#include "problems/drive/problem.h"

namespace sinew {
namespace {

std::unique_ptr<DriveProblem> OneTrial() {
  SynthesisRequest request;
  request.set = {{"train", 1}, {"validate", 0}};
  const auto data = SynthesizeDrive(request);
  DriveSettings settings;
  settings.step = 0.01;
  return *DriveProblem::Make(*data, settings);
}

enum class Wanted { kValues, kBase, kRefit, kAll };

bool Differentiates(Wanted wanted, const Parameter& p) {
  static const std::set<std::string> causes{"coulomb_torque", "stribeck_torque", "stribeck_velocity",
                                            "motor_load_friction", "imbalance_torque"};
  if (wanted == Wanted::kAll || p.kind != ParameterKind::kEffect) return true;
  return wanted == Wanted::kRefit && causes.count(p.name) > 0;
}

// @param friction [N*m] Coulomb friction: 0 for a smooth motion.
void Evaluate(benchmark::State& state, Wanted wanted, double friction) {
  const auto problem = OneTrial();
  const auto workspace = problem->NewWorkspace();
  Prediction prediction(problem->layout());
  Vector parameters = RestPoint(*problem);
  parameters[*FindParameter(problem->parameters(), "coulomb_torque")] = friction;
  const std::vector<bool> blocks(problem->layout().size(), true);
  std::vector<bool> differentiate;
  int count = 0;
  for (const Parameter& p : problem->parameters()) {
    differentiate.push_back(Differentiates(wanted, p));
    if (differentiate.back()) ++count;
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(problem->Predict({parameters, blocks, wanted != Wanted::kValues, &differentiate},
                                              *workspace, prediction));
  }
  state.counters["derivatives"] = wanted == Wanted::kValues ? 0 : count;
}

BENCHMARK_CAPTURE(Evaluate, values, Wanted::kValues, 0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, base_fit, Wanted::kBase, 0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, base_fit_with_stiction, Wanted::kBase, 0.1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, refit, Wanted::kRefit, 0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, refit_with_stiction, Wanted::kRefit, 0.1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, score, Wanted::kAll, 0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, score_with_stiction, Wanted::kAll, 0.1)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sinew
