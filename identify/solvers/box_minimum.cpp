#include "identify/solvers/box_minimum.h"

#include <cmath>
#include <utility>

#include "base/decompositions.h"

namespace sinew::solvers {
namespace {

// Of columns of unit length: enough to survive rank loss, too little to move the minimum.
constexpr double kRidge = 1e-10;
constexpr int kMaxSteps = 60;
constexpr int kMaxHalvings = 30;

}  // namespace

struct BoxMinimum::Decomposition {
  std::vector<int> moving;
  Vector scale;
  std::unique_ptr<SparseCholesky> sparse;
  Eigen::LDLT<Matrix> dense;
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

double BoxMinimum::Value(const Vector& step) const {
  return model_.gradient.dot(step) + 0.5 * step.dot(Curved(step));
}

Vector BoxMinimum::NewtonStep(const std::vector<int>& moving, const Vector& gradient) {
  const auto n = static_cast<Eigen::Index>(moving.size());
  if (last_ == nullptr || last_->moving != moving) {
    last_ = std::make_unique<Decomposition>();
    last_->moving = moving;
    last_->scale.resize(n);
    Matrix scaled(n, n);
    for (Eigen::Index i = 0; i < n; ++i) last_->scale[i] = 1 / std::sqrt(model_.normal(moving[i], moving[i]));
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j)
        scaled(i, j) = model_.normal(moving[i], moving[j]) * last_->scale[i] * last_->scale[j];
      scaled(i, i) += kRidge + damping_;
    }
    last_->sparse = std::make_unique<SparseCholesky>(scaled);
    if (!last_->sparse->usable()) last_->dense.compute(scaled);
  }
  Vector pull(n);
  for (Eigen::Index i = 0; i < n; ++i) pull[i] = -gradient[moving[i]] * last_->scale[i];
  const Vector solution =
      last_->sparse->usable() ? last_->sparse->Solve(pull) : Vector(last_->dense.solve(pull));
  Vector step = Vector::Zero(x_.size());
  for (Eigen::Index i = 0; i < n; ++i) step[moving[i]] = solution[i] * last_->scale[i];
  return step;
}

double BoxMinimum::Find(Vector& step, double tolerance) {
  double value = Value(step);
  Vector gradient;
  for (int k = 0; k < kMaxSteps; ++k) {
    gradient = model_.gradient + Curved(step);
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
      const double after = Value(next);
      if (!(after < value)) continue;
      fell = true;
      step = std::move(next);
      value = after;
    }
    if (!fell) break;
  }
  gradient = model_.gradient + Curved(step);
  if (held_ >= 0) slope_ = gradient[held_];
  return value;
}

}  // namespace sinew::solvers
