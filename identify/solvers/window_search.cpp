#include "identify/solvers/window_search.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/marginal_cost.h"
#include "identify/solvers/time_factors.h"

namespace sinew::solvers {
namespace {

// Of a trial, from where windows grow, as shares of its duration.
constexpr double kOrigins[] = {0, 1, 0.5, 0.25, 0.75};
// Share of a trial's duration in which the factor on residuals falls by e next to a window: about half of and
// one time between instants of a stance.
constexpr double kEdges[] = {0.02, 0.04};
constexpr int kWindows = 30;
constexpr long kEvaluationsPerWindow = 12;
constexpr long kEvaluationsAtEnd = 60;
constexpr double kTolerance = 1e-3;
// Of a window's cost over that of the best whole trial: a search stops before its minimum.
constexpr double kGivenUpAbove = 2;

class Search {
 public:
  Search(LeastSquares& fit, const Vector& start, const std::function<bool()>& stop)
      : fit_(fit), stop_(stop), window_(fit) {
    LeastSquares::Workspace workspace = fit.NewWorkspace();
    const auto cost = fit.Cost(start, workspace);
    best_ = {start, cost ? *cost : kInfinity, MarginalCost(fit, start)};
  }

  WindowEnd Run(const std::vector<Vector>& others) {
    const Vector given = best_.x;
    const Vector means = Means();
    for (const Vector& other : others) End(other);
    for (const Vector& start : {means, given}) {
      for (const double edge : kEdges) {
        for (const double origin : kOrigins) Grow(start, origin, edge);
      }
    }
    return best_;
  }

 private:
  [[nodiscard]] bool Stopped() const { return stop_ && stop_(); }

  [[nodiscard]] Vector Means() const {
    Vector parameters = fit_.setup().rest;
    for (const int index : fit_.setup().free) {
      const Parameter& p = fit_.setup().parameters[static_cast<std::size_t>(index)];
      if (!p.prior) continue;
      const double mean = p.scale == Scale::kLog ? std::exp(p.prior->mean) : p.prior->mean;
      parameters[index] = std::clamp(mean, p.lower, p.upper);
    }
    return fit_.Variables(parameters);
  }

  void Grow(const Vector& start, double origin, double edge) {
    Vector x = start;
    for (int i = 1; i <= kWindows; ++i) {
      if (Stopped()) return;
      const double share = static_cast<double>(i) / kWindows;
      const double from = origin * (1 - share);
      const double to = origin + (1 - origin) * share;
      window_.Set([&](std::size_t, double at) {
        return std::exp(-std::max({0.0, from - at, at - to}) / edge);
      });
      fit_.set_transform(&window_);
      const auto outcome = LocalFit(fit_).Minimize(x, -1, {0, kTolerance}, kEvaluationsPerWindow);
      fit_.set_transform(nullptr);
      if (!outcome.failure.empty() || outcome.cost > best_.cost + kGivenUpAbove) return;
      x = outcome.x;
    }
    End(x);
  }

  void End(const Vector& start) {
    if (Stopped()) return;
    auto outcome = LocalFit(fit_).Minimize(start, -1, {0, kTolerance}, kEvaluationsAtEnd);
    if (!outcome.failure.empty()) return;
    const double marginal = MarginalCost(fit_, outcome.x);
    if (marginal < best_.marginal - kWorthTaking) best_ = {std::move(outcome.x), outcome.cost, marginal};
  }

  LeastSquares& fit_;
  const std::function<bool()>& stop_;
  TimeFactors window_;
  WindowEnd best_;
};

}  // namespace

WindowEnd SearchInWindows(LeastSquares& fit, const Vector& start, const std::vector<Vector>& others,
                          const std::function<bool()>& stop) {
  return Search(fit, start, stop).Run(others);
}

}  // namespace sinew::solvers
