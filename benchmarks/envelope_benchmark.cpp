// Raw EMG to envelope: 60 s of eight muscles at 2048 Hz on one core, with the checks of the recording.
#include <benchmark/benchmark.h>

#include <random>

#include "models/emg/butterworth.h"
#include "models/emg/envelope.h"
#include "models/emg/filter_section.h"
#include "models/emg/raw_emg.h"

namespace sinew {
namespace {

constexpr double kRate = 2048;
constexpr int kMuscles = 8;

std::vector<double> OneMinute() {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1e-4);
  std::vector<double> raw(static_cast<std::size_t>(60 * kRate));
  for (double& value : raw) value = noise(random);
  return raw;
}

void EightEnvelopes(benchmark::State& state) {
  const std::vector<double> raw = OneMinute();
  EnvelopeSettings settings;
  settings.order = static_cast<int>(state.range(0));
  for (auto _ : state) {
    for (int muscle = 0; muscle < kMuscles; ++muscle) {
      auto envelope = ComputeEnvelope(raw, kRate, settings);
      if (!envelope) state.SkipWithError("no envelope");
      benchmark::DoNotOptimize(envelope->values.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * kMuscles * static_cast<long>(raw.size()));
}

void ZeroLag(benchmark::State& state) {
  const std::vector<double> raw = OneMinute();
  const FilterSections sections = *ButterworthLowPass(static_cast<int>(state.range(0)), 6, kRate);
  for (auto _ : state) {
    auto filtered = FilterZeroLag(sections, raw);
    benchmark::DoNotOptimize(filtered->data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(raw.size()));
}

BENCHMARK(EightEnvelopes)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);
BENCHMARK(ZeroLag)->Arg(2)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew
