#include "identify/uncertainty/local_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/decompositions.h"

namespace sinew {
namespace {

// Nearly Gauss-Newton: refits start close to their answer, where full steps are right.
constexpr double kFirstDamping = 1e-8;
constexpr double kLargestDamping = 1e8;
// A violation of a constraint by a share e of its span costs as much as moving the steepest variable by 100
// e.
constexpr double kPenalty = 1e4;

}  // namespace

LocalFit::LocalFit(const LeastSquares& problem, double penalty)
    : problem_(problem),
      workspace_(problem.NewWorkspace()),
      jacobian_(problem.NewJacobian()),
      penalty_(penalty) {}

void LocalFit::AddPenalties(const Vector& x, double& cost, bool derivatives) {
  if (problem_.constraints() == 0) return;
  problem_.Constraints(x, constraint_, &constraint_jacobian_);
  for (Eigen::Index i = 0; i < constraint_.size(); ++i) {
    const double span = constraint_jacobian_.row(i).squaredNorm();
    if (!(constraint_[i] > 0) || !(span > 0)) continue;
    const double weight = penalty_ / span;
    cost += 0.5 * weight * constraint_[i] * constraint_[i];
    if (!derivatives) continue;
    gradient_ += weight * constraint_[i] * constraint_jacobian_.row(i).transpose();
    normal_ += weight * constraint_jacobian_.row(i).transpose() * constraint_jacobian_.row(i);
  }
}

Status LocalFit::Cost(const Vector& x, double& cost) {
  ++evaluations_;
  SINEW_TRY(problem_.Evaluate(x, workspace_, residuals_, nullptr));
  cost = 0.5 * residuals_.squaredNorm();
  AddPenalties(x, cost, false);
  return {};
}

Status LocalFit::CostAndDerivatives(const Vector& x, double& cost) {
  ++evaluations_;
  SINEW_TRY(problem_.Evaluate(x, workspace_, residuals_, &jacobian_));
  cost = 0.5 * residuals_.squaredNorm();
  normal_.setZero(x.size(), x.size());
  gradient_.setZero(x.size());
  for (const SparseJacobian::Piece& piece : jacobian_.pieces) {
    const Matrix products = piece.values.transpose() * piece.values;
    const Vector pull = piece.values.transpose() * residuals_.segment(piece.first_row, piece.values.rows());
    for (std::size_t a = 0; a < piece.variables.size(); ++a) {
      gradient_[piece.variables[a]] += pull[static_cast<Eigen::Index>(a)];
      for (std::size_t b = 0; b < piece.variables.size(); ++b) {
        normal_(piece.variables[a], piece.variables[b]) +=
            products(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
      }
    }
  }
  if (!normal_.allFinite() || !gradient_.allFinite()) return Fail("a derivative is not finite");
  // Fixed at the first point: a search needs one and the same cost throughout.
  if (penalty_ == 0) penalty_ = kPenalty * normal_.diagonal().maxCoeff();
  AddPenalties(x, cost, true);
  return {};
}

Vector LocalFit::Step(const Vector& x, int held, double damping, double& gain) const {
  std::vector<int> moving;
  for (int v = 0; v < static_cast<int>(x.size()); ++v) {
    const bool outward = (x[v] <= 0 && gradient_[v] >= 0) || (x[v] >= 1 && gradient_[v] <= 0);
    if (v != held && !outward && normal_(v, v) > 0) moving.push_back(v);
  }
  const auto n = static_cast<Eigen::Index>(moving.size());
  Vector step = Vector::Zero(x.size());
  gain = 0;
  if (n == 0) return step;
  // Columns of unit length: the damping then has no unit.
  Matrix normal(n, n);
  Vector scale(n);
  Vector pull(n);
  for (Eigen::Index i = 0; i < n; ++i) scale[i] = 1 / std::sqrt(normal_(moving[i], moving[i]));
  for (Eigen::Index i = 0; i < n; ++i) {
    pull[i] = gradient_[moving[i]] * scale[i];
    for (Eigen::Index j = 0; j < n; ++j) normal(i, j) = normal_(moving[i], moving[j]) * scale[i] * scale[j];
    normal(i, i) += damping;
  }
  const Vector solution = normal.ldlt().solve(pull);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int v = moving[static_cast<std::size_t>(i)];
    step[v] = std::clamp(x[v] - solution[i] * scale[i], 0.0, 1.0) - x[v];
  }
  gain = -gradient_.dot(step) - 0.5 * step.dot(normal_ * step);
  return step;
}

LocalFit::Outcome LocalFit::Minimize(const Vector& start, int held, Tolerance tolerance,
                                     long max_evaluations) {
  Outcome outcome;
  outcome.x = start.cwiseMax(0).cwiseMin(1);
  const long last = evaluations_ + max_evaluations;
  const Status status = CostAndDerivatives(outcome.x, outcome.cost);
  if (!status) {
    outcome.failure = status.error().message;
    outcome.cost = std::numeric_limits<double>::infinity();
    return outcome;
  }
  double damping = kFirstDamping;
  while (true) {
    double predicted = 0;
    const Vector step = Step(outcome.x, held, damping, predicted);
    const bool tiny_step = step.cwiseAbs().maxCoeff() <= std::numeric_limits<double>::epsilon();
    const double enough = std::max(tolerance.absolute + tolerance.relative * outcome.cost,
                                   problem_.problem().cost_grain() * outcome.cost);
    if (tiny_step || std::abs(predicted) <= enough) {
      outcome.converged = true;
      return outcome;
    }
    if (evaluations_ >= last || damping > kLargestDamping) return outcome;
    Vector next = (outcome.x + step).cwiseMax(0).cwiseMin(1);
    double cost = 0;
    if (!Cost(next, cost) || !(cost < outcome.cost)) {
      damping = std::max(10 * damping, 1e-4);
      continue;
    }
    const double gained = outcome.cost - cost;
    outcome.x = std::move(next);
    outcome.cost = cost;
    damping = std::max(damping / 10, kFirstDamping);
    if (gained <= enough) {
      outcome.converged = true;
      return outcome;
    }
    if (evaluations_ >= last || !CostAndDerivatives(outcome.x, cost)) return outcome;
  }
}

}  // namespace sinew
