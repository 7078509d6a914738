#include "identify/solvers/box_quadratic_model.h"

#include <cmath>
#include <vector>

#include "base/symmetric_solver.h"
#include "identify/solvers/box_minimum.h"

namespace sinew::solvers {
namespace {

// Of the gain of the step.
constexpr double kBoxTolerance = 1e-6;
// Twice the acceleration over the step, above which it is not trusted: Transtrum and Sethna (2012).
constexpr double kMostAcceleration = 0.75;

}  // namespace

bool BoxQuadraticModel::Set(Eigen::Index variables, const Vector& residuals, const SparseJacobian& jacobian) {
  normal.setZero(variables, variables);
  gradient.setZero(variables);
  for (const SparseJacobian::Piece& piece : jacobian.pieces) {
    const Matrix products = Gram(piece.values);
    const Vector pull = piece.values.transpose() * residuals.segment(piece.first_row, piece.values.rows());
    for (std::size_t a = 0; a < piece.variables.size(); ++a) {
      gradient[piece.variables[a]] += pull[static_cast<Eigen::Index>(a)];
      auto column = normal.col(piece.variables[a]);
      for (std::size_t b = 0; b < piece.variables.size(); ++b)
        column[piece.variables[b]] += products(static_cast<Eigen::Index>(b), static_cast<Eigen::Index>(a));
    }
  }
  return normal.allFinite() && gradient.allFinite();
}

Vector BoxQuadraticModel::ProjectedStep(const Vector& x, int held, double damping, double& gain) const {
  std::vector<int> moving;
  for (int v = 0; v < static_cast<int>(x.size()); ++v) {
    const bool outward = (x[v] <= 0 && gradient[v] >= 0) || (x[v] >= 1 && gradient[v] <= 0);
    if (v != held && !outward && normal(v, v) > 0) moving.push_back(v);
  }
  Vector step = Vector::Zero(x.size());
  gain = 0;
  Vector scale;
  Vector pull;
  Vector curved = Vector::Zero(x.size());  // by the step of the variables at a bound
  while (!moving.empty()) {
    const auto n = static_cast<Eigen::Index>(moving.size());
    scale.resize(n);
    pull.resize(n);
    // Columns are scaled to unit length, so that the damping has no unit.
    for (Eigen::Index i = 0; i < n; ++i) scale[i] = 1 / std::sqrt(normal(moving[i], moving[i]));
    for (Eigen::Index i = 0; i < n; ++i) pull[i] = -(gradient[moving[i]] + curved[moving[i]]) * scale[i];
    const Vector solution =
        SymmetricSolver(SymmetricView(normal, moving, scale, damping)).Solve(pull).cwiseProduct(scale);
    std::vector<int> inside;
    for (Eigen::Index i = 0; i < n; ++i) {
      const int v = moving[static_cast<std::size_t>(i)];
      if (x[v] + solution[i] < 0)
        step[v] = -x[v];
      else if (x[v] + solution[i] > 1)
        step[v] = 1 - x[v];
      else
        inside.push_back(v);
    }
    if (inside.size() == moving.size()) {
      for (Eigen::Index i = 0; i < n; ++i) step[moving[static_cast<std::size_t>(i)]] = solution[i];
      break;
    }
    moving = std::move(inside);
    curved = normal * step;
  }
  gain = -gradient.dot(step) - 0.5 * step.dot(normal * step);
  return step;
}

Vector BoxQuadraticModel::BoxStep(const Vector& x, int held, double damping, double& gain) const {
  Vector step = ProjectedStep(x, held, damping, gain);
  Vector slope = normal * step;
  slope += gradient + damping * normal.diagonal().cwiseProduct(step);
  for (int v = 0; v < static_cast<int>(x.size()); ++v) {
    const bool inward = (step[v] < 0 && slope[v] < 0) || (step[v] > 0 && slope[v] > 0);
    const bool reached = step[v] != 0 && (x[v] + step[v] <= 0 || x[v] + step[v] >= 1);
    if (!inward || !reached) continue;
    step.setZero();
    BoxMinimum(*this, x, held, damping).Find(step, kBoxTolerance * std::abs(gain));
    gain = -gradient.dot(step) - 0.5 * step.dot(normal * step);
    break;
  }
  return step;
}

std::optional<Vector> BoxQuadraticModel::Acceleration(const Vector& x, const Vector& step, double damping,
                                                      const Vector& pull) const {
  std::vector<int> moving;
  for (int v = 0; v < static_cast<int>(x.size()); ++v) {
    if (step[v] != 0 && x[v] + step[v] > 0 && x[v] + step[v] < 1) moving.push_back(v);
  }
  if (moving.empty()) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(moving.size());
  Vector scale(n);
  Vector right(n);
  Vector moved(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    scale[i] = 1 / std::sqrt(normal(moving[i], moving[i]));
    right[i] = -pull[moving[i]] * scale[i];
    moved[i] = step[moving[i]] / scale[i];
  }
  const Vector acceleration = SymmetricSolver(SymmetricView(normal, moving, scale, damping)).Solve(right);
  if (!(2 * acceleration.norm() <= kMostAcceleration * moved.norm())) return std::nullopt;
  Vector half = Vector::Zero(x.size());
  for (Eigen::Index i = 0; i < n; ++i) half[moving[i]] = 0.5 * acceleration[i] * scale[i];
  return half;
}

}  // namespace sinew::solvers
