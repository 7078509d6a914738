#include "tests/problems/support/jacobian_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/random.h"

namespace sinew {
namespace {

// Differences have a truncation error of step^2 and a rounding error of eps / step: 1e-10 and 2e-11 of the
// values for this step.
constexpr double kStep = 1e-5;
constexpr double kSmallestShare = 1e-3;
// Largest disagreement of one-sided differences, above their truncation and rounding.
constexpr double kKink = 1e-7;
// Share of a column's samples that must be smooth.
constexpr double kSmoothShare = 0.8;

Prediction PredictAt(const Problem& problem, const Vector& parameters, bool derivatives) {
  Prediction prediction(problem.layout());
  const auto workspace = problem.NewWorkspace();
  const std::vector<bool> all(problem.layout().size(), true);
  const Status status = problem.Predict({parameters, all, derivatives, nullptr}, *workspace, prediction);
  EXPECT_TRUE(status) << status.error().message;
  return prediction;
}

}  // namespace

JacobianCheck CheckJacobian(const Problem& problem, const Vector& parameters) {
  JacobianCheck check;
  const Layout& layout = problem.layout();
  const Prediction at = PredictAt(problem, parameters, true);
  for (std::size_t k = 0; k < problem.parameters().size(); ++k) {
    const Parameter& p = problem.parameters()[k];
    if (p.kind == ParameterKind::kPrior) continue;
    const auto index = static_cast<Eigen::Index>(k);
    bool was_compared = false;
    const double width = p.scale == Scale::kLog ? parameters[index] : p.upper - p.lower;
    const auto moved = [&](double steps) {
      Vector q = parameters;
      q[index] += steps * kStep * width;
      return PredictAt(problem, q, false);
    };
    const std::array<Prediction, 4> near{moved(-2), moved(-1), moved(1), moved(2)};
    for (std::size_t b = 0; b < layout.size(); ++b) {
      const int block = static_cast<int>(b);
      const Vector value = at.values(block);
      const Vector central = (near[2].values(block) - near[1].values(block)) / (2 * kStep);
      const auto& columns = layout[b].columns;
      const auto column = std::find(columns.begin(), columns.end(), static_cast<int>(k));
      if (column == columns.end()) {
        EXPECT_EQ(central.norm(), 0) << layout[b].channel << " depends on " << p.name
                                     << ", which it does not declare";
        continue;
      }
      const Vector derivative = width * at.derivatives(block).col(column - columns.begin());
      const double size = std::max({derivative.norm(), kSmallestShare * value.norm(), 1e-300});
      const Vector right = (4 * near[2].values(block) - near[3].values(block) - 3 * value) / (2 * kStep);
      const Vector left = (3 * value - 4 * near[1].values(block) + near[0].values(block)) / (2 * kStep);
      ++check.columns;
      // Third difference: a kink two thirds of a step away is not seen by the other test.
      const Vector third =
          (near[3].values(block) - 3 * near[2].values(block) + 3 * value - near[1].values(block)) / kStep;
      const Vector third_left =
          (near[0].values(block) - 3 * near[1].values(block) + 3 * value - near[2].values(block)) / kStep;
      // One spring that lifts off in one sample says nothing against the others.
      const double most = kKink * size / std::sqrt(static_cast<double>(value.size()));
      double squares = 0;
      Eigen::Index smooth = 0;
      for (Eigen::Index i = 0; i < value.size(); ++i) {
        const double kink =
            std::max({std::abs(right[i] - left[i]), std::abs(third[i]), std::abs(third_left[i])});
        if (!(kink <= most)) continue;
        ++smooth;
        squares += (derivative[i] - central[i]) * (derivative[i] - central[i]);
      }
      if (static_cast<double>(smooth) < kSmoothShare * static_cast<double>(value.size())) continue;
      ++check.compared;
      was_compared = true;
      check.worst = std::max(check.worst, std::sqrt(squares) / size);
    }
    if (!was_compared) check.never.insert(static_cast<int>(k));
  }
  return check;
}

void ExpectJacobianAgrees(const Problem& problem, Random& random, double least_compared) {
  constexpr double kTolerance = 1e-6;  // of differences, see CheckJacobian
  JacobianCheck total;
  for (int round = 0; round < 10; ++round) {
    const JacobianCheck check = CheckJacobian(problem, RandomInside(problem, 0.02, random));
    total.columns += check.columns;
    total.compared += check.compared;
    total.worst = std::max(total.worst, check.worst);
  }
  std::printf("%d of %d columns compared, worst relative difference %.2e\n", total.compared, total.columns,
              total.worst);
  EXPECT_LT(total.worst, kTolerance);
  EXPECT_GE(total.compared, least_compared * total.columns);
}

Vector RandomInside(const Problem& problem, double margin, Random& random) {
  const auto& parameters = problem.parameters();
  Vector point(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const double x = random.Uniform(margin, 1 - margin);
    point[static_cast<Eigen::Index>(i)] =
        p.scale == Scale::kLog ? p.lower * std::pow(p.upper / p.lower, x) : p.lower + x * (p.upper - p.lower);
  }
  return point;
}

}  // namespace sinew
