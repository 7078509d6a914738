#include "identify/solvers/pattern_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew::solvers {

namespace {

constexpr double kSameValue = 0.1;  // steps

}  // namespace

PatternSearch::PatternSearch(Vector lower, Vector upper, const Vector& factors, IsBetter is_better,
                             std::function<bool()> stopped)
    : lower_(std::move(lower)),
      upper_(std::move(upper)),
      first_steps_(factors.array().log()),
      is_better_(std::move(is_better)),
      stopped_(std::move(stopped)) {}

Vector PatternSearch::From(Vector values) {
  values_ = std::move(values);
  steps_ = first_steps_;
  tried_.clear();
  IsNew(values_);
  for (int halving = 0; halving <= kHalvings; ++halving) {
    while (!stopped_() && Sweep()) {
    }
    steps_ /= 2;
  }
  return values_;
}

// @return whether any value moved
bool PatternSearch::Sweep() {
  bool moved = false;
  for (Eigen::Index k = 0; k < values_.size(); ++k) {
    for (const double sign : {1.0, -1.0}) {
      bool gained = false;
      while (!stopped_() && Move(k, sign * steps_[k])) gained = true;
      moved = moved || gained;
      if (gained) break;
    }
  }
  return moved;
}

bool PatternSearch::Move(Eigen::Index k, double step) {
  Vector there = values_;
  there[k] = std::clamp(values_[k] * std::exp(step), lower_[k], upper_[k]);
  if (there[k] == values_[k] || !IsNew(there) || !is_better_(there)) return false;
  values_ = std::move(there);
  return true;
}

bool PatternSearch::IsNew(const Vector& values) {
  Vector logarithms = values.array().log();
  const bool known = std::any_of(tried_.begin(), tried_.end(), [&](const Vector& other) {
    return ((logarithms - other).array() / steps_.array()).abs().maxCoeff() < kSameValue;
  });
  if (!known) tried_.push_back(std::move(logarithms));
  return !known;
}

}  // namespace sinew::solvers
