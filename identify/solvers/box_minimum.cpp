#include "identify/solvers/box_minimum.h"

#include <cmath>
#include <utility>

#include "base/symmetric_solver.h"

namespace sinew::solvers {
namespace {

// Of columns of unit length: enough to survive rank loss, too little to move the minimum.
constexpr double kRidge = 1e-10;
constexpr int kMaxSteps = 60;
constexpr int kMaxHalvings = 30;
constexpr int kMostChanges = 20;  // of the sets of variables that are held

}  // namespace

struct BoxMinimum::Decomposition {
  std::vector<int> moving;
  Vector scale;
  SymmetricSolver scaled;
};

BoxMinimum::BoxMinimum(const BoxQuadraticModel& model, const Vector& x, int held, double damping)
    : model_(model), x_(x), held_(held), damping_(damping) {}

BoxMinimum::~BoxMinimum() = default;

Vector BoxMinimum::Curved(const Vector& step) const {
  Vector curved = model_.normal * step;
  if (damping_ > 0) {
    Vector damped = damping_ * model_.normal.diagonal().cwiseProduct(step);
    if (held_ >= 0) damped[held_] = 0;
    curved += damped;
  }
  return curved;
}

double BoxMinimum::Value(const Vector& step, const Vector& curved) const {
  return model_.gradient.dot(step) + 0.5 * step.dot(curved);
}

Vector BoxMinimum::NewtonStep(const std::vector<int>& moving, const Vector& gradient) {
  const auto n = static_cast<Eigen::Index>(moving.size());
  if (last_ == nullptr || last_->moving != moving) {
    Vector scale(n);
    for (Eigen::Index i = 0; i < n; ++i) scale[i] = 1 / std::sqrt(model_.normal(moving[i], moving[i]));
    SymmetricSolver solver(SymmetricView(model_.normal, moving, scale, kRidge + damping_));
    last_ = std::make_unique<Decomposition>(Decomposition{moving, std::move(scale), std::move(solver)});
  }
  Vector pull(n);
  for (Eigen::Index i = 0; i < n; ++i) pull[i] = -gradient[moving[i]] * last_->scale[i];
  const Vector solution = last_->scaled.Solve(pull);
  Vector step = Vector::Zero(x_.size());
  for (Eigen::Index i = 0; i < n; ++i) step[moving[i]] = solution[i] * last_->scale[i];
  return step;
}

// The variables that the model would move beyond their bounds are held there, those that it would move inward
// are released, all at once, and the rest is solved for: a few times as a rule, whatever the number of
// variables.
bool BoxMinimum::FindByActiveSets(Vector& step) {
  enum class At { kInside, kLower, kUpper };
  const auto n = static_cast<std::size_t>(x_.size());
  std::vector<At> at(n, At::kInside);
  Vector next = step;
  Vector gradient = model_.gradient + Curved(next);
  const auto bound = [&](std::size_t v) {
    const auto i = static_cast<Eigen::Index>(v);
    return at[v] == At::kLower ? -x_[i] : 1 - x_[i];
  };
  const auto may_move = [&](std::size_t v) {
    const auto i = static_cast<Eigen::Index>(v);
    return static_cast<int>(v) != held_ && model_.normal(i, i) > 0;
  };
  for (std::size_t v = 0; v < n; ++v) {
    const auto i = static_cast<Eigen::Index>(v);
    if (x_[i] + next[i] <= 0 && gradient[i] >= 0) at[v] = At::kLower;
    if (x_[i] + next[i] >= 1 && gradient[i] <= 0) at[v] = At::kUpper;
  }
  for (int k = 0; k < kMostChanges; ++k) {
    std::vector<int> moving;
    for (std::size_t v = 0; v < n; ++v) {
      if (!may_move(v)) continue;
      if (at[v] == At::kInside)
        moving.push_back(static_cast<int>(v));
      else
        next[static_cast<Eigen::Index>(v)] = bound(v);
    }
    if (moving.empty()) return false;
    gradient = model_.gradient + Curved(next);
    next += NewtonStep(moving, gradient);
    if (!next.allFinite()) return false;
    gradient = model_.gradient + Curved(next);
    bool changed = false;
    for (std::size_t v = 0; v < n; ++v) {
      if (!may_move(v)) continue;
      const auto i = static_cast<Eigen::Index>(v);
      const At before = at[v];
      if (before == At::kInside) {
        if (x_[i] + next[i] < 0) at[v] = At::kLower;
        if (x_[i] + next[i] > 1) at[v] = At::kUpper;
      } else if (before == At::kLower ? gradient[i] < 0 : gradient[i] > 0) {
        at[v] = At::kInside;
      }
      changed = changed || at[v] != before;
    }
    if (changed) continue;
    step = std::move(next);
    return true;
  }
  return false;
}

double BoxMinimum::Find(Vector& step, double tolerance) {
  FindByActiveSets(step);
  Vector curved = Curved(step);
  double value = Value(step, curved);
  for (int k = 0; k < kMaxSteps; ++k) {
    const Vector gradient = model_.gradient + curved;
    std::vector<int> moving;
    for (int v = 0; v < static_cast<int>(x_.size()); ++v) {
      const double at = x_[v] + step[v];
      const bool outward = (at <= 0 && gradient[v] >= 0) || (at >= 1 && gradient[v] <= 0);
      if (v != held_ && !outward && model_.normal(v, v) > 0) moving.push_back(v);
    }
    if (moving.empty()) break;
    const Vector newton = NewtonStep(moving, gradient);
    if (-0.5 * gradient.dot(newton) <= tolerance) break;
    // Back along the projected arc until the model has fallen: always so for a small part of the step.
    double share = 1;
    bool fell = false;
    for (int half = 0; half < kMaxHalvings && !fell; ++half, share *= 0.5) {
      Vector next = step + share * newton;
      for (const int v : moving) {
        if (x_[v] + next[v] <= 0) next[v] = -x_[v];
        if (x_[v] + next[v] >= 1) next[v] = 1 - x_[v];
      }
      Vector curved_there = Curved(next);
      const double after = Value(next, curved_there);
      if (!(after < value)) continue;
      fell = true;
      step = std::move(next);
      curved = std::move(curved_there);
      value = after;
    }
    if (!fell) break;
  }
  if (held_ >= 0) slope_ = model_.gradient[held_] + curved[held_];
  return value;
}

}  // namespace sinew::solvers
