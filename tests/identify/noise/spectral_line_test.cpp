// Detection and false alarms of a line in the spectrum of the residual.
#include "identify/noise/spectral_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <iterator>
#include <string>

#include "base/constants.h"
#include "identify/diagnosis/diagnosis.h"
#include "tests/identify/diagnosis/linear_laws.h"
#include "tests/identify/noise/noise_cases.h"

namespace sinew::noise {
namespace {

constexpr double kStep = 0.01;

/// Trials of which only the times matter.
class Recording final : public Problem {
 public:
  Recording() = default;
  Recording(int trials, int samples) {
    for (int t = 0; t < trials; ++t) Add("force", samples);
  }
  /// @param jitter of every second sample, as a share of the step
  void Add(const std::string& channel, int samples, double jitter = 0, BlockRole role = BlockRole::kTrain) {
    Block block;
    block.trial = "trial_" + std::to_string(layout_.size() + 1);
    block.channel = channel;
    block.unit = "1";
    block.role = role;
    for (int i = 0; i < samples; ++i) {
      block.prediction_time.push_back(3 + kStep * (i + (i % 2) * jitter));
      block.sample.push_back(i);
      block.measured.push_back(0);
    }
    layout_.push_back(std::move(block));
  }
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return ports_; }
  Status Predict(const Query& /*query*/, Workspace& /*workspace*/,
                 Prediction& /*prediction*/) const override {
    return Fail("nothing to predict");
  }

 private:
  std::vector<Parameter> parameters_;
  std::vector<Effect> effects_;
  std::vector<DiscrepancyPort> ports_;
  Layout layout_;
};

/// Noise of its own in every trial.
Vector Draw(const LeastSquares& fit, const NoiseProcess& process, std::uint64_t seed) {
  Random random(seed);
  Vector rows(fit.residuals());
  for (const auto& train : fit.train_blocks()) {
    const int n = fit.problem().layout()[static_cast<std::size_t>(train.block)].samples();
    rows.segment(train.first_row, n) = process.Draw(random, n);
  }
  return rows;
}

Vector Hum(const LeastSquares& fit, double frequency, double amplitude, double phase) {
  Vector rows(fit.residuals());
  for (const auto& train : fit.train_blocks()) {
    const Block& block = fit.problem().layout()[static_cast<std::size_t>(train.block)];
    for (int i = 0; i < block.samples(); ++i)
      rows[train.first_row + i] = amplitude * std::sin(2 * kPi * frequency * kStep * i + phase);
  }
  return rows;
}

/// Detectable amplitude of a line for a test with known frequency, phase and noise (probability 95 % at the
/// level of 5 %).
double JustDetectable(const NoiseProcess& process, double frequency, int samples) {
  std::complex<double> above = 1;
  std::complex<double> below = 1;
  const auto turn = [&](std::size_t lag) {
    return std::polar(1.0, -2 * kPi * frequency * kStep * static_cast<double>(lag));
  };
  for (std::size_t i = 0; i < process.moving_average.size(); ++i)
    above += process.moving_average[i] * turn(i + 1);
  for (std::size_t i = 0; i < process.autoregression.size(); ++i)
    below -= process.autoregression[i] * turn(i + 1);
  return 3.605 * std::sqrt(2 * std::norm(above) / std::norm(below) / samples);
}

const NoiseProcess kProcesses[] = {{{0.5}, {}, 0}, {{0.9}, {}, 0}, {{1.2, -0.5}, {0.6}, 0}};
// Ratio to that amplitude: three or less in most places, but nearly five where the spectrum is steep, because
// the side with more power is the reference.
constexpr double kEasily = 5;
constexpr double kBin = 0.2;  // [Hz] of 250 samples

TEST(SpectralLine, SmoothSpectraHaveNone) {
  constexpr int kCases = 400;
  const Recording recording(4, 250);
  const FitSetup setup;
  const LeastSquares fit(recording, setup);
  for (std::size_t p = 0; p < std::size(kProcesses); ++p) {
    int below_1 = 0;
    int below_10 = 0;
    for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
      const auto line = FindLine(fit, Draw(fit, kProcesses[p], 100 * seed + p));
      ASSERT_TRUE(line);
      below_1 += line->p_value < 0.01 ? 1 : 0;
      below_10 += line->p_value < 0.1 ? 1 : 0;
    }
    std::printf("noise %zu: p < 0.01 in %d, p < 0.1 in %d of %d\n", p, below_1, below_10, kCases);
    // The p-value is a bound: 4 and 40 expected at most, and three deviations more.
    EXPECT_LE(below_1, 10) << p;
    EXPECT_LE(below_10, 58) << p;
  }
}

// A twentieth of the level of 5 % is the share of the line in a diagnosis.
constexpr double kLevel = 0.0025;

TEST(SpectralLine, DetectsALineWellAboveTheDetectableSize) {
  constexpr int kCases = 20;
  const Recording recording(4, 250);
  const FitSetup setup;
  const LeastSquares fit(recording, setup);
  for (const double frequency : {11.0, 24.1, 37.7}) {
    for (std::size_t p = 0; p < std::size(kProcesses); ++p) {
      int found = 0;
      for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
        const double amplitude = kEasily * JustDetectable(kProcesses[p], frequency, 1000);
        const Vector hum = Hum(fit, frequency, amplitude, 0.3 * static_cast<double>(seed));
        const auto line = FindLine(fit, Draw(fit, kProcesses[p], seed) + hum);
        ASSERT_TRUE(line);
        const bool there = std::abs(line->frequency - frequency) <= kBin;
        found += line->p_value < kLevel && there ? 1 : 0;
      }
      std::printf("%g Hz, noise %zu: %d of %d\n", frequency, p, found, kCases);
      EXPECT_GE(found, 17) << frequency << " Hz, noise " << p;
    }
  }
}

TEST(SpectralLine, SumsOverTrialsOfDifferentLengths) {
  Recording recording;
  for (const int samples : {250, 180, 300, 90}) recording.Add("force", samples);
  const FitSetup setup;
  const LeastSquares fit(recording, setup);
  const auto line = FindLine(fit, Draw(fit, {{0.5}, {}, 0}, 3) + Hum(fit, 20, 1.5, 0));
  ASSERT_TRUE(line);
  EXPECT_LT(line->p_value, 1e-4);
  EXPECT_NEAR(line->frequency, 20, kBin);
}

TEST(SpectralLine, UnsuitableBlocksAreLeftOut) {
  const FitSetup setup;
  const auto line_of = [&](const Recording& recording) {
    const LeastSquares fit(recording, setup);
    return FindLine(fit, Hum(fit, 20, 5, 0) + Draw(fit, {}, 1));
  };
  const Recording too_short(3, 63);
  EXPECT_FALSE(line_of(too_short));
  const Recording long_enough(3, 64);
  EXPECT_TRUE(line_of(long_enough));
  Recording uneven;
  for (int t = 0; t < 3; ++t) uneven.Add("force", 250, 0.05);
  EXPECT_FALSE(line_of(uneven));
  Recording nearly_even;
  for (int t = 0; t < 3; ++t) nearly_even.Add("force", 250, 0.01);
  EXPECT_TRUE(line_of(nearly_even));
  Recording held_out;
  for (int t = 0; t < 3; ++t) held_out.Add("force", 250, 0, BlockRole::kValidate);
  EXPECT_FALSE(line_of(held_out));
}

// Two cycles per block are a curve, not a line.
TEST(SpectralLine, LeavesOutFrequenciesOfAFewCyclesPerTrial) {
  const Recording recording(4, 250);
  const FitSetup setup;
  const LeastSquares fit(recording, setup);
  const auto line = FindLine(fit, Draw(fit, {}, 1) + Hum(fit, 0.8, 10, 0));
  ASSERT_TRUE(line);
  EXPECT_GE(line->frequency, 4 / (249 * kStep) - 1e-9);
  EXPECT_GT(line->p_value, 0.01);
}

TEST(SpectralLine, AZeroResidualHasNone) {
  const Recording recording(2, 128);
  const FitSetup setup;
  const LeastSquares fit(recording, setup);
  const auto line = FindLine(fit, Vector::Zero(fit.residuals()));
  EXPECT_TRUE(!line || line->p_value == 1);
}

TEST(SpectralLine, AmplitudesAreThoseOfItsChannel) {
  Recording recording;
  recording.Add("force", 250);
  recording.Add("position", 250);
  recording.Add("force", 200);
  const FitSetup setup;
  const LeastSquares fit(recording, setup);
  const SpectralLine line{"force", 12.3, 0};
  Vector rows = Hum(fit, line.frequency, 2, 0.4);
  rows.segment(250, 250) *= -7;
  const Vector amplitudes = LineAmplitudes(fit, rows, line);
  // a sin(w t + p) = a sin(p) cos(w t) + a cos(p) sin(w t); least squares of 450 rows to rounding.
  EXPECT_NEAR(amplitudes[0], 2 * std::sin(0.4), 1e-12);
  EXPECT_NEAR(amplitudes[1], 2 * std::cos(0.4), 1e-12);
  EXPECT_LT((LineAt(recording.layout()[2], line, amplitudes) - rows.tail(200)).norm(), 1e-11);
}

// An autoregression would describe the hum as coloured noise, and no curve of any signal explains it.
TEST(SpectralLine, DiagnosisNamesItAndMeasuresIt) {
  LinearLaws::Truth truth;
  truth.correlation = 0.5;
  truth.hum = 0.1;
  truth.hum_frequency = 6;
  const LinearLaws problem(truth, 4);
  const auto setup = MakeFitSetup(problem, {});
  ASSERT_TRUE(setup);
  const auto diagnosis = Diagnose(problem, *setup, {});
  ASSERT_TRUE(diagnosis) << diagnosis.error().message;
  EXPECT_EQ(diagnosis->verdict, DiagnosisVerdict::kUnexplained);
  EXPECT_TRUE(diagnosis->causes.empty());
  ASSERT_FALSE(diagnosis->unknown_terms.empty());
  const UnknownFinding& hum = diagnosis->unknown_terms.front();
  EXPECT_EQ(hum.port, "y");
  EXPECT_EQ(hum.signal, "time");
  EXPECT_EQ(hum.kind, UnknownKind::kPeriodic);
  EXPECT_EQ(hum.name, "y(period)");
  const auto score = std::find_if(diagnosis->scores.begin(), diagnosis->scores.end(),
                                  [&](const EffectScore& s) { return s.effect == hum.name; });
  ASSERT_NE(score, diagnosis->scores.end());
  EXPECT_EQ(score->family_p_value, hum.p_value);
  // The traces include it: the fit of training trials improves too.
  double before = 0;
  double after = 0;
  for (const TracePair& trace : diagnosis->traces) {
    for (std::size_t i = 0; i < trace.time.size(); ++i) {
      before += std::pow(trace.before[i] - trace.measured[i], 2);
      after += std::pow(trace.after[i] - trace.measured[i], 2);
    }
  }
  EXPECT_LT(after, 0.8 * before);
  EXPECT_LT(hum.p_value, 0.05);
  EXPECT_NEAR(1 / hum.knots.back(), truth.hum_frequency, 0.06);  // bins of 0.05 Hz
  const auto [least, most] = std::minmax_element(hum.curve.begin(), hum.curve.end());
  // 1000 samples: an amplitude has the deviation 0.1 sqrt(2 / 1000), here 5 % of it; a frequency that is off
  // by half a bin takes up to a tenth.
  EXPECT_NEAR((*most - *least) / 2, truth.hum, 0.025);
  // It is half of the residual's variance: 1 - sqrt(2 / 3) at best.
  EXPECT_GT(hum.held_out_reduction, 0.1);
}

}  // namespace
}  // namespace sinew::noise
