// The same filters as scipy's, on the same signal: scipy_reference.txt, made by make_scipy_reference.py.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "models/emg/butterworth.h"
#include "models/emg/envelope.h"
#include "models/emg/filter_section.h"

namespace sinew {
namespace {

constexpr double kTolerance = 1e-10;  // of the signal's range; rounding of coefficients allows 1e-12

// As make_scipy_reference.py makes it, to the last bit.
std::vector<double> Signal() {
  std::vector<double> values;
  unsigned long long state = 1;
  for (int k = 0; k < 2000; ++k) {
    state = (1103515245 * state + 12345) % (1ULL << 31U);
    values.push_back(0.3 + (static_cast<double>(state) / 2147483648.0 - 0.5) *
                               (0.1 + std::abs(k % 700 - 350) / 350.0));
  }
  return values;
}

struct Case {
  std::string way;
  std::string kind;
  int order = 0;
  double low_Hz = 0;
  double high_Hz = 0;
  double rate_Hz = 0;
};

Result<std::vector<double>> OnePass(const FilterSections& sections, bool settled,
                                    const std::vector<double>& values) {
  CausalFilter filter(sections);
  if (settled) filter.Settle(values.front());
  std::vector<double> out;
  out.reserve(values.size());
  for (const double value : values) out.push_back(filter.Next(value));
  return out;
}

Result<std::vector<double>> Ours(const Case& c, const std::vector<double>& values) {
  if (c.way == "envelope") {
    EnvelopeSettings settings;
    settings.order = 2 * c.order;
    settings.low_pass_Hz = c.low_Hz;
    settings.high_pass_Hz = c.high_Hz;
    SINEW_ASSIGN(Envelope envelope, ComputeEnvelope(values, c.rate_Hz, settings));
    return std::move(envelope.values);
  }
  const auto made = c.kind == "lowpass"    ? ButterworthLowPass(c.order, c.low_Hz, c.rate_Hz)
                    : c.kind == "highpass" ? ButterworthHighPass(c.order, c.low_Hz, c.rate_Hz)
                                           : ButterworthBandPass(c.order, c.low_Hz, c.high_Hz, c.rate_Hz);
  SINEW_ASSIGN(const FilterSections sections, made);
  if (c.way == "zero_lag") return FilterZeroLag(sections, values);
  return OnePass(sections, c.way == "settled", values);
}

TEST(ScipyReferenceTest, FiltersAreScipysTo1em10) {
  const std::vector<double> signal = Signal();
  const auto [low, high] = std::minmax_element(signal.begin(), signal.end());
  const double range = *high - *low;
  std::ifstream file(SINEW_SOURCE_DIR "/tests/models/emg/scipy_reference.txt");
  ASSERT_TRUE(file);
  std::map<std::string, std::vector<double>> filtered;
  std::map<std::string, double> worst;
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words(line);
    Case c;
    std::size_t sample = 0;
    double expected = 0;
    words >> c.way >> c.kind >> c.order >> c.low_Hz >> c.high_Hz >> c.rate_Hz >> sample >> expected;
    ASSERT_TRUE(words) << line;
    std::ostringstream name;
    name << c.way << " " << c.kind << " " << c.order << " " << c.low_Hz << " " << c.high_Hz << " "
         << c.rate_Hz;
    auto& values = filtered[name.str()];
    if (values.empty()) {
      auto ours = Ours(c, signal);
      ASSERT_TRUE(ours) << name.str() << ": " << ours.error().message;
      values = *std::move(ours);
    }
    ASSERT_LT(sample, values.size());
    double& difference = worst[name.str()];
    difference = std::max(difference, std::abs(values[sample] - expected) / range);
  }
  EXPECT_EQ(worst.size(), 56U);  // all of them were read
  double largest = 0;
  for (const auto& [name, difference] : worst) {
    EXPECT_LE(difference, kTolerance) << name;
    largest = std::max(largest, difference);
  }
  RecordProperty("largest_difference", testing::PrintToString(largest));
}

}  // namespace
}  // namespace sinew
