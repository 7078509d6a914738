#include "problems/nms/arm_slopes.h"

#include <algorithm>
#include <cstddef>

#include "base/column_space.h"

namespace sinew {
namespace {

constexpr int kMostDegree = 4;
constexpr double kLeastRange = 0.02;       // [rad] of an angle that its terms need
constexpr double kMostUnexplained = 0.05;  // of the arm's variance
constexpr double kEnough = 1e-6;           // the same, from which a higher degree is not needed
constexpr double kSingular = 1e-4;         // of columns scaled to -1..1

// An angle scaled to -1..1 over all trials.
struct Scaled {
  double middle = 0;
  double half = 0;

  Scaled(const std::vector<std::vector<Vector>>& angles, std::size_t joint) {
    double least = angles.front()[joint][0];
    double most = least;
    for (const auto& trial : angles) {
      least = std::min(least, trial[joint].minCoeff());
      most = std::max(most, trial[joint].maxCoeff());
    }
    middle = (least + most) / 2;
    half = (most - least) / 2;
  }
  [[nodiscard]] double At(double angle) const { return (angle - middle) / half; }
};

// Terms of the polynomial, or their derivatives with respect to the scaled own angle.
class Terms {
 public:
  explicit Terms(const std::vector<std::vector<Vector>>& angles) : angles_(angles) {
    for (std::size_t j = 0; j < angles.front().size(); ++j) {
      scaled_.emplace_back(angles, j);
      if (2 * scaled_[j].half > kLeastRange) used_.push_back(j);
    }
  }

  [[nodiscard]] bool own_angle_varies() const { return !used_.empty() && used_.front() == 0; }
  [[nodiscard]] double half() const { return scaled_[0].half; }

  [[nodiscard]] Matrix Of(std::size_t trial, int degree, bool derivatives) const {
    const auto& angle = angles_[trial];
    const auto others = static_cast<Eigen::Index>(used_.size()) - 1;
    Matrix terms(angle[0].size(), degree + 1 + 2 * others);
    for (Eigen::Index i = 0; i < terms.rows(); ++i) {
      const double s = scaled_[0].At(angle[0][i]);
      double power = 1;  // of one degree less
      terms(i, 0) = derivatives ? 0 : 1;
      for (int n = 1; n <= degree; ++n, power *= s) terms(i, n) = power * (derivatives ? n : s);
      for (Eigen::Index k = 0; k < others; ++k) {
        const std::size_t j = used_[static_cast<std::size_t>(k) + 1];
        const double u = scaled_[j].At(angle[j][i]);
        terms(i, degree + 1 + 2 * k) = derivatives ? 0 : u;
        terms(i, degree + 2 + 2 * k) = derivatives ? u : u * s;
      }
    }
    return terms;
  }

 private:
  const std::vector<std::vector<Vector>>& angles_;
  std::vector<Scaled> scaled_;
  std::vector<std::size_t> used_;  // joints with terms
};

}  // namespace

std::vector<Vector> ArmSlopes(const std::vector<Vector>& arm,
                              const std::vector<std::vector<Vector>>& angles) {
  const Terms terms(angles);
  if (!terms.own_angle_varies()) return {};
  Eigen::Index rows = 0;
  for (const Vector& trial : arm) rows += trial.size();
  Vector values(rows);
  rows = 0;
  for (const Vector& trial : arm) {
    values.segment(rows, trial.size()) = trial;
    rows += trial.size();
  }
  const double variation = (values.array() - values.mean()).matrix().squaredNorm();
  double left = variation;
  int degree = 0;
  Vector coefficients;
  while (degree < kMostDegree && left > kEnough * variation) {
    Matrix all(values.size(), 0);
    rows = 0;
    for (std::size_t t = 0; t < arm.size(); ++t) {
      const Matrix part = terms.Of(t, degree + 1, false);
      if (t == 0) all.resize(values.size(), part.cols());
      all.middleRows(rows, part.rows()) = part;
      rows += part.rows();
    }
    const ColumnSpace space(all, kSingular);
    if (space.rank() < all.cols()) break;  // the angles do not tell such polynomials apart
    ++degree;
    coefficients = space.Solve(values);
    left = (values - all * coefficients).squaredNorm();
  }
  if (degree == 0 || left > kMostUnexplained * variation) return {};
  std::vector<Vector> slopes;
  for (std::size_t t = 0; t < arm.size(); ++t)
    slopes.emplace_back(terms.Of(t, degree, true) * coefficients / terms.half());
  return slopes;
}

}  // namespace sinew
