#include "identify/noise/elimination.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew::noise {
namespace {

constexpr Eigen::Index kAll = 7;
constexpr Eigen::Index kGone = 4;

Matrix Positive(std::uint64_t seed) {
  Random random(seed);
  Matrix rows(20, kAll);
  for (Eigen::Index c = 0; c < kAll; ++c) {
    for (Eigen::Index r = 0; r < rows.rows(); ++r) rows(r, c) = random.Normal();
  }
  return rows.transpose() * rows;
}

Matrix Weights() {
  Random random(9);
  Matrix weights(kAll - kGone, kAll - kGone);
  for (Eigen::Index c = 0; c < weights.cols(); ++c) {
    for (Eigen::Index r = c; r < weights.rows(); ++r) weights(r, c) = weights(c, r) = random.Normal();
  }
  return weights;
}

// Sum of weighted entries of what is left, and log det of what is gone, by dense algebra.
double Function(const Matrix& all, const Matrix& weights) {
  const Matrix gone = all.topLeftCorner(kGone, kGone);
  const Matrix beside = all.bottomLeftCorner(kAll - kGone, kGone);
  const Matrix rest = all.bottomRightCorner(kAll - kGone, kAll - kGone);
  const Matrix left = rest - beside * gone.inverse() * beside.transpose();
  return weights.cwiseProduct(left).sum() + std::log(gone.determinant());
}

TEST(Elimination, LeavesTheSchurComplement) {
  const Matrix all = Positive(1);
  const Matrix beside = all.bottomLeftCorner(kAll - kGone, kGone);
  const Matrix gone = all.topLeftCorner(kGone, kGone);
  Matrix lower = all;
  Elimination elimination;
  ASSERT_TRUE(elimination.Eliminate(lower, kGone));
  const Matrix left =
      all.bottomRightCorner(kAll - kGone, kAll - kGone) - beside * gone.inverse() * beside.transpose();
  for (Eigen::Index c = 0; c < left.cols(); ++c) {
    for (Eigen::Index r = c; r < left.rows(); ++r)
      EXPECT_NEAR(lower(kGone + r, kGone + c), left(r, c), 1e-11);
  }
  EXPECT_NEAR(elimination.log_determinant(), std::log(gone.determinant()), 1e-11);
}

TEST(Elimination, CarriesDerivativesBack) {
  const Matrix all = Positive(2);
  const Matrix weights = Weights();
  Matrix lower = all;
  Elimination elimination;
  ASSERT_TRUE(elimination.Eliminate(lower, kGone));
  Matrix slopes;
  elimination.CarryBack(lower, weights, slopes);
  constexpr double kStep = 1e-5;
  for (Eigen::Index c = 0; c < kAll; ++c) {
    for (Eigen::Index r = c; r < kAll; ++r) {
      Matrix above = all;
      Matrix below = all;
      above(r, c) += kStep;
      below(r, c) -= kStep;
      if (r != c) {
        above(c, r) += kStep;
        below(c, r) -= kStep;
      }
      const double difference = (Function(above, weights) - Function(below, weights)) / (2 * kStep);
      EXPECT_NEAR(r == c ? slopes(r, c) : slopes(r, c) + slopes(c, r), difference, 1e-7) << r << ", " << c;
    }
  }
}

TEST(Elimination, RefusesWhatIsNotPositiveDefinite) {
  Matrix lower = Positive(3);
  lower(2, 2) = -1;
  EXPECT_FALSE(Elimination().Eliminate(lower, kGone));
}

}  // namespace
}  // namespace sinew::noise
