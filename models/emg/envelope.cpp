#include "models/emg/envelope.h"

#include <algorithm>
#include <cmath>

#include "base/numbers.h"
#include "models/emg/butterworth.h"
#include "models/emg/filter_section.h"

namespace sinew {
namespace {

constexpr int kHighestOrder = 16;
// Shorter means would be one sample's chance.
constexpr std::size_t kMinNeighbours = 8;

// At least a period: a shorter signal has no determined amplitude at this frequency.
Status CheckLength(std::size_t samples, double rate_Hz, const EnvelopeSettings& settings) {
  const double length_s = static_cast<double>(samples) / rate_Hz;
  const double period_s = 1 / std::min(settings.low_pass_Hz, settings.high_pass_Hz);
  if (length_s >= period_s) return {};
  return Fail("{} samples ({} s) are too short for a cut-off of {} Hz, expected at least {} s", samples,
              Readable(length_s), Readable(1 / period_s), Readable(period_s));
}

Status CheckGaps(const std::vector<SampleRun>& gaps, double rate_Hz, const EnvelopeSettings& settings) {
  if (gaps.empty()) return {};
  const SampleRun& longest = LongestRun(gaps);
  const double length_s = static_cast<double>(longest.count) / rate_Hz;
  if (length_s <= settings.longest_gap_s) return {};
  return Fail(
      "a gap of {} samples ({} s) begins {} s after the start, longer than the {} s that are bridged; cut "
      "the "
      "trial around it",
      longest.count, Readable(length_s), Readable(static_cast<double>(longest.first) / rate_Hz, 4),
      Readable(settings.longest_gap_s));
}

void BridgeRaw(const std::vector<SampleRun>& gaps, std::vector<double>& raw) {
  for (const SampleRun& gap : gaps) {
    const std::size_t end = gap.first + gap.count;
    const double right = raw[end < raw.size() ? end : gap.first - 1];
    const double left = gap.first > 0 ? raw[gap.first - 1] : right;
    for (std::size_t k = 0; k < gap.count; ++k) {
      const double share = static_cast<double>(k + 1) / static_cast<double>(gap.count + 1);
      raw[gap.first + k] = left + share * (right - left);
    }
  }
}

void BridgeRectified(const std::vector<SampleRun>& gaps, std::vector<double>& rectified) {
  for (const SampleRun& gap : gaps) {
    const std::size_t reach = std::max(gap.count, kMinNeighbours);
    const std::size_t end = gap.first + gap.count;
    const std::size_t from = gap.first > reach ? gap.first - reach : 0;
    const std::size_t to = std::min(end + reach, rectified.size());
    double sum = 0;
    for (std::size_t k = from; k < gap.first; ++k) sum += rectified[k];
    for (std::size_t k = end; k < to; ++k) sum += rectified[k];
    const double mean = sum / static_cast<double>(gap.first - from + to - end);
    std::fill_n(rectified.begin() + static_cast<std::ptrdiff_t>(gap.first), gap.count, mean);
  }
}

void CutUndershoot(Envelope& envelope) {
  for (std::size_t k = 0; k < envelope.values.size(); ++k) {
    double& value = envelope.values[k];
    if (value < 0) {
      ++envelope.undershoot;
      envelope.deepest = std::min(envelope.deepest, value);
      value = 0;
    }
    if (value > envelope.maximum) {
      envelope.maximum = value;
      envelope.maximum_at = k;
    }
  }
}

}  // namespace

Status CheckEnvelopeSettings(const EnvelopeSettings& settings) {
  if (settings.order < 2 || settings.order > kHighestOrder || settings.order % 2 != 0) {
    return Fail(
        "order {}: expected an even number from 2 to {}; half of it is run forward and half of it backward",
        settings.order, kHighestOrder);
  }
  if (!(settings.longest_gap_s >= 0)) {
    return Fail("longest gap {} s: expected 0 or more", settings.longest_gap_s);
  }
  return {};
}

Result<Envelope> ComputeEnvelope(const std::vector<double>& raw, double rate_Hz,
                                 const EnvelopeSettings& settings) {
  SINEW_TRY(CheckEnvelopeSettings(settings));
  const int one_pass = settings.order / 2;
  SINEW_ASSIGN(const FilterSections high_pass, ButterworthHighPass(one_pass, settings.high_pass_Hz, rate_Hz));
  SINEW_ASSIGN(const FilterSections low_pass, ButterworthLowPass(one_pass, settings.low_pass_Hz, rate_Hz));
  SINEW_TRY(CheckLength(raw.size(), rate_Hz, settings));
  Envelope envelope;
  envelope.faults = FindRawEmgFaults(raw, rate_Hz);
  const RawEmgFaults& faults = envelope.faults;
  if (TotalSamples(faults.gaps) == raw.size()) return Fail("no sample is a number");
  SINEW_TRY(CheckGaps(faults.gaps, rate_Hz, settings));
  // The filters would turn its rounding into a signal.
  if (faults.silent) {
    envelope.values.assign(raw.size(), 0);
    return envelope;
  }

  std::vector<double> whole = raw;
  BridgeRaw(faults.gaps, whole);
  SINEW_ASSIGN(std::vector<double> rectified, FilterZeroLag(high_pass, whole));
  for (double& value : rectified) value = std::abs(value);
  BridgeRectified(faults.gaps, rectified);
  SINEW_ASSIGN(envelope.values, FilterZeroLag(low_pass, rectified));
  CutUndershoot(envelope);
  return envelope;
}

double LowPassAmplitude(const EnvelopeSettings& settings, double frequency_Hz) {
  return 1 / (1 + std::pow(frequency_Hz / settings.low_pass_Hz, settings.order));
}

}  // namespace sinew
