#include "models/emg/raw_emg.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew {
namespace {

constexpr double kClipped_s =
    1e-3;  // a muscle's potentials last several ms, but their peaks do not stand still
constexpr std::size_t kClippedSamples = 3;
constexpr double kFrozen_s = 20e-3;  // noise of electrodes alone changes more often
constexpr double kFewSteps = 64;

std::size_t Samples(double seconds, double rate_Hz) {
  return static_cast<std::size_t>(std::ceil(seconds * rate_Hz));
}

// Runs of equal samples, and of samples that are not finite.
template <class Visit>
void VisitRuns(const std::vector<double>& raw, const Visit& visit) {
  const auto same = [](double a, double b) { return a == b || (!std::isfinite(a) && !std::isfinite(b)); };
  for (std::size_t first = 0; first < raw.size();) {
    std::size_t end = first + 1;
    while (end < raw.size() && same(raw[first], raw[end])) ++end;
    visit(SampleRun{first, end - first});
    first = end;
  }
}

}  // namespace

RawEmgFaults FindRawEmgFaults(const std::vector<double>& raw, double rate_Hz) {
  RawEmgFaults faults;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double step = low;  // the smallest difference between neighbours: that of the converter
  double last = std::nan("");
  for (const double value : raw) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
    if (value != last && std::isfinite(last)) step = std::min(step, std::abs(value - last));
    last = value;
  }
  faults.silent = !(high > low);
  const bool fine = high - low >= kFewSteps * step;
  const std::size_t clipped = std::max(kClippedSamples, Samples(kClipped_s, rate_Hz));
  const std::size_t frozen = Samples(kFrozen_s, rate_Hz);
  VisitRuns(raw, [&](const SampleRun& run) {
    const double value = raw[run.first];
    if (!std::isfinite(value)) {
      faults.gaps.push_back(run);
    } else if (faults.silent) {
      return;
    } else if ((value == low || value == high) && run.count >= clipped && fine) {
      faults.clipped.push_back(run);
    } else if (run.count >= frozen) {
      faults.frozen.push_back(run);
    }
  });
  return faults;
}

std::size_t TotalSamples(const std::vector<SampleRun>& runs) {
  std::size_t total = 0;
  for (const SampleRun& run : runs) total += run.count;
  return total;
}

const SampleRun& LongestRun(const std::vector<SampleRun>& runs) {
  return *std::max_element(runs.begin(), runs.end(),
                           [](const SampleRun& a, const SampleRun& b) { return a.count < b.count; });
}

}  // namespace sinew
