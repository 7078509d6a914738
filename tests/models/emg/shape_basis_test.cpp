#include "models/emg/shape_basis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

TEST(ShapeBasis, SumsToOneEverywhere) {
  for (const double harmonics : {0.0, 6.0}) {
    const ShapeBasis basis(7, harmonics, harmonics > 0 ? 0.02 : 0);
    for (const double phase : {-1.3, 0.0, 0.1234, 0.5, 0.999, 7.25}) {
      Vector values(7);
      Vector slopes(7);
      basis.At(phase, values.data(), slopes.data());
      EXPECT_NEAR(values.sum(), 1, 1e-8) << harmonics;
      EXPECT_NEAR(slopes.sum(), 0, 1e-6) << harmonics;
    }
  }
}

TEST(ShapeBasis, SlopesAreThoseOfTheValues) {
  const std::vector<double> control{0, 1, 0.2, 0.7, -0.3, 0.4};
  constexpr double kStep = 1e-6;
  for (const double harmonics : {0.0, 5.0}) {
    const ShapeBasis basis(6, harmonics);
    for (const double phase : {0.0, 1.0 / 6, 0.3141, 0.5, 0.77}) {
      const double rise =
          basis.Value(phase + kStep, control.data()) - basis.Value(phase - kStep, control.data());
      EXPECT_NEAR(rise / (2 * kStep), basis.Slope(phase, control.data()), 1e-6) << harmonics;
    }
  }
}

// The filter that is meant: each harmonic of the plain curve, times its amplitude.
TEST(ShapeBasis, FiltersAsTheEnvelopeDoes) {
  const std::vector<double> control{0, 1, 0.2, 0.7, -0.3, 0.4, 0.1, 0.3};
  constexpr double kHarmonics = 4;
  constexpr double kJitter = 0.03;
  constexpr int kSamples = 4096;
  const ShapeBasis plain(8);
  const ShapeBasis filtered(8, kHarmonics, kJitter);
  for (const int n : {0, 1, 3, 6}) {
    double before = 0;
    double after = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double phase = static_cast<double>(i) / kSamples;
      const double wave = std::cos(2 * kPi * n * phase) / kSamples;
      before += wave * plain.Value(phase, control.data());
      after += wave * filtered.Value(phase, control.data());
    }
    const double kept =
        std::exp(-0.5 * std::pow(2 * kPi * n * kJitter, 2)) / (1 + std::pow(n / kHarmonics, 4));
    EXPECT_NEAR(after, kept * before, 1e-8) << n;
  }
}

TEST(ShapeBasis, FitFindsItsOwnControlPoints) {
  const Vector truth = (Vector(8) << 0.1, 0.5, 0.9, 0.3, 0, 0, 0.05, 0.2).finished();
  for (const double harmonics : {0.0, 8.0}) {
    const ShapeBasis basis(8, harmonics);
    std::vector<double> phase;
    std::vector<double> values;
    for (int i = 0; i < 200; ++i) {
      phase.push_back(0.37 * i);
      values.push_back(basis.Value(phase.back(), truth.data()));
    }
    const auto fitted = FitShape(phase, values, basis);
    ASSERT_TRUE(fitted);
    EXPECT_LT((*fitted - truth).norm(), 1e-8) << harmonics;
  }
}

TEST(ShapeBasis, IsSmoothWhereThereAreNoSamples) {
  std::vector<double> phase;
  std::vector<double> values;
  for (int i = 0; i < 60; ++i) {
    phase.push_back(0.6 * i / 60);
    values.push_back(0.5 + 0.1 * std::sin(2 * kPi * phase.back()));
  }
  const ShapeBasis basis(10);
  const auto fitted = FitShape(phase, values, basis);
  ASSERT_TRUE(fitted);
  for (const double at : {0.7, 0.8, 0.9}) EXPECT_NEAR(basis.Value(at, fitted->data()), 0.5, 0.25);
}

TEST(ShapeBasis, RejectsBadInput) {
  const ShapeBasis basis(4);
  EXPECT_EQ(FitShape({0, 0.5}, {1}, basis).error().message, "2 phases and 1 values, expected as many");
  EXPECT_EQ(FitShape({0, 0.5}, {1, 2}, basis).error().message, "2 samples are too few for 4 control points");
  EXPECT_EQ(FitShape({0, 0.2, 0.5, 0.7}, {1, 2, NAN, 1}, basis).error().message, "sample 2 is no number");
}

}  // namespace
}  // namespace sinew
