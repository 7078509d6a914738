// Musculotendon steps per second on one core: 10 s of one muscle at 1 kHz, in every tendon mode, with and
// without the derivatives for all of its twelve parameters.
#include <benchmark/benchmark.h>

#include <cmath>

#include "problems/nms/muscle/muscle_force.h"

namespace sinew {
namespace {

MuscleSignals TenSeconds() {
  MuscleSignals signals;
  for (int k = 0; k < 10000; ++k) {
    const double t = 0.001 * k;
    signals.excitation_time.push_back(t);
    signals.excitation.push_back(0.05 + 0.8 * std::pow(std::sin(4 * t), 4));
    signals.time.push_back(t);
    signals.unit_length.push_back(0.3 + 0.01 * std::sin(5 * t));
  }
  return signals;
}

constexpr std::array<double, kMuscleSlots> kSoleus{0.015, 0.1, -1.2,  0.015, 0.05, 0.25,
                                                   3549,  1.1, 0.436, 0.15,  0.1,  10};

template <class T>
void Steps(benchmark::State& state, TendonMode tendon, int lanes = 0) {
  const MuscleCurves curves = MuscleCurves::Default();
  const MuscleSignals signals = TenSeconds();
  std::array<T, kMuscleSlots> parameters;
  for (int i = 0; i < kMuscleSlots; ++i) {
    const double value = kSoleus[static_cast<std::size_t>(i)];
    if constexpr (std::is_same_v<T, double>) {
      parameters[static_cast<std::size_t>(i)] = value;
    } else {
      parameters[static_cast<std::size_t>(i)] = i < lanes ? T::Variable(value, i) : T(value);
    }
  }
  MuscleTrace<T> trace;
  for (auto _ : state) {
    if (!ComputeMuscleForce(curves, {tendon}, parameters, signals, trace)) state.SkipWithError("no force");
    benchmark::DoNotOptimize(trace.tendon_force.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(signals.time.size()));
}

void Plain(benchmark::State& state, TendonMode tendon) {
  Steps<double>(state, tendon);
}
// Four parameters of a muscle, as usual in a calibration; and all parameters of a subject.
void WithFour(benchmark::State& state, TendonMode tendon) {
  Steps<Dual<kFewLanes>>(state, tendon, kFewLanes);
}
void WithTwelve(benchmark::State& state, TendonMode tendon) {
  Steps<Dual<kMuscleSlots>>(state, tendon, kSubjectSlots);
}

BENCHMARK_CAPTURE(Plain, rigid, TendonMode::kRigid)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WithFour, rigid, TendonMode::kRigid)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WithTwelve, rigid, TendonMode::kRigid)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Plain, equilibrium, TendonMode::kEquilibrium)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WithFour, equilibrium, TendonMode::kEquilibrium)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WithTwelve, equilibrium, TendonMode::kEquilibrium)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Plain, elastic, TendonMode::kElastic)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WithFour, elastic, TendonMode::kElastic)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WithTwelve, elastic, TendonMode::kElastic)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew
