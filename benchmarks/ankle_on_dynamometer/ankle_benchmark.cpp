// How long a second of the ankle on the dynamometer takes: one trial of 4 s with four muscles, values alone
// and with derivatives; and one step of a control program at 1 kHz.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "problems/ankle_on_dynamometer/laboratory/synthesis.h"
#include "problems/ankle_on_dynamometer/problem.h"
#include "problems/ankle_on_dynamometer/stepper.h"

namespace sinew {
namespace {

constexpr double kDuration = 4;  // [s]

Dataset Recorded(double rate) {
  SynthesisRequest request;
  request.set = {{"duration", kDuration}, {"speeds", 1}, {"rate", rate}};
  return *SynthesizeAnkle(request);
}

AnkleSettings SettingsOf(const Dataset& data) {
  const auto yaml =
      *YamlReader::Parse(data.files.at("ankle_on_dynamometer.yaml"), "ankle_on_dynamometer.yaml");
  return *ReadAnkleSettings(*yaml.At("ankle_on_dynamometer"));
}

enum class Wanted { kValues, kBase, kAll };

void Simulate(benchmark::State& state, const char* trial, Wanted wanted) {
  const Dataset data = Recorded(200);
  const auto problem = *AnkleProblem::Make(data, SettingsOf(data));
  const auto workspace = problem->NewWorkspace();
  Prediction prediction(problem->layout());
  std::vector<bool> blocks;
  for (const Block& block : problem->layout()) blocks.push_back(block.trial == trial);
  std::vector<bool> differentiate;
  for (const Parameter& p : problem->parameters())
    differentiate.push_back(wanted == Wanted::kAll || p.kind == ParameterKind::kBase);
  // Two points in turn: of one, a workspace keeps the values.
  const Vector point = RestPoint(*problem);
  Vector other = point;
  other[*FindParameter(problem->parameters(), "passive_stiffness")] *= 1.01;
  bool first = false;
  for (auto _ : state) {
    first = !first;
    benchmark::DoNotOptimize(problem->Predict(
        {first ? point : other, blocks, wanted != Wanted::kValues, &differentiate}, *workspace, prediction));
  }
  state.counters["simulated_per_second"] =
      benchmark::Counter(kDuration * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(Simulate, passive_values, "passive_60", Wanted::kValues)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Simulate, passive_fit, "passive_60", Wanted::kBase)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Simulate, active_values, "active_060", Wanted::kValues)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Simulate, active_fit, "active_060", Wanted::kBase)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Simulate, active_score, "active_060", Wanted::kAll)->Unit(benchmark::kMillisecond);

// Steps of a control program; wall clock, since the worst one counts.
// @param paced a step every millisecond; else one after the other
void Step(benchmark::State& state, bool paced) {
  constexpr double kRate = 1000;
  const Dataset data = Recorded(kRate);
  const AnkleSettings settings = SettingsOf(data);
  const Trial& trial = data.trials.at("active_060");
  const auto& angle = trial.Find("machine_angle").channel->values;
  const Grid& emg = trial.grids.at("excitations");
  const auto first = static_cast<std::size_t>(-emg.time.front() * kRate + 0.5);
  std::vector<std::vector<double>> excitations;
  for (std::size_t i = 0; i < angle.size(); ++i) {
    excitations.emplace_back();
    for (const AnkleMuscle& muscle : settings.muscles)
      excitations.back().push_back(emg.channels.at(muscle.excitation).values[first + i]);
  }
  const auto stepper = *AnkleStepper::Make(settings, {}, kRate);
  std::vector<double> took;  // [us]
  took.reserve(1 << 22);
  for (auto _ : state) {
    if (!stepper->Begin(angle[0], excitations[0].data())) return state.SkipWithError("no equilibrium");
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 1; i < angle.size(); ++i) {
      if (paced) std::this_thread::sleep_until(start + std::chrono::milliseconds(i));
      const auto begin = std::chrono::steady_clock::now();
      const auto torque = stepper->Step(angle[i], excitations[i].data());
      const auto end = std::chrono::steady_clock::now();
      if (!torque) return state.SkipWithError(torque.error().message.c_str());
      benchmark::DoNotOptimize(*torque);
      if (took.size() < took.capacity())
        took.push_back(std::chrono::duration<double, std::micro>(end - begin).count());
    }
  }
  std::sort(took.begin(), took.end());
  double sum = 0;
  for (const double t : took) sum += t;
  const auto count = static_cast<double>(took.size());
  state.counters["mean_us"] = sum / count;
  state.counters["median_us"] = took[static_cast<std::size_t>(0.5 * count)];
  state.counters["p99.9_us"] = took[static_cast<std::size_t>(0.999 * count)];
  state.counters["worst_us"] = took.back();
  state.counters["steps"] = count;
}

BENCHMARK_CAPTURE(Step, in_a_row, false)->Unit(benchmark::kMillisecond)->Iterations(100);
BENCHMARK_CAPTURE(Step, every_millisecond, true)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
}  // namespace sinew
