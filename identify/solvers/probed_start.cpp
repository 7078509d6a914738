#include "identify/solvers/probed_start.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/constants.h"
#include "identify/probe_grid.h"
#include "identify/solvers/alternating_fit.h"
#include "identify/solvers/box_quadratic_model.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/residual_whitening.h"

namespace sinew::solvers {
namespace {

constexpr double kDampingAtProbe = 1e-3;
constexpr LocalFit::Tolerance kProbedTolerance{0, 1e-6};
constexpr long kProbedEvaluations = 60;
// Minima along the probe values that a fit is tried from.
constexpr std::size_t kTriedProbes = 4;
constexpr long kLongEvaluations = 200;

// The free parameters of an effect, and values of those that have probe values.
struct ProbedEffect {
  std::vector<int> parameters;
  std::vector<ProbeValues> probes;
};

const Parameter& ParameterOf(const FitSetup& setup, int index) {
  return setup.parameters[static_cast<std::size_t>(index)];
}

bool HasStatedStart(const FitSetup& setup, int index) {
  return std::count(setup.stated_starts.begin(), setup.stated_starts.end(), index) > 0;
}

std::vector<ProbeValues> ProbesWithinBounds(const FitSetup& setup, const std::vector<int>& group) {
  std::vector<ProbeValues> probes = ProbeGrid(setup.parameters, group);
  const auto is_outside = [&](const auto& one) {
    const Parameter& p = ParameterOf(setup, one.first);
    return one.second < p.lower || one.second > p.upper;
  };
  probes.erase(std::remove_if(probes.begin(), probes.end(),
                              [&](const ProbeValues& values) {
                                return std::any_of(values.begin(), values.end(), is_outside);
                              }),
               probes.end());
  return probes;
}

std::vector<ProbedEffect> ProbedEffects(const FitSetup& setup, std::size_t least_probes) {
  std::map<std::string, ProbedEffect> by_name;
  for (const int index : setup.free) {
    const Parameter& p = ParameterOf(setup, index);
    if (p.kind == ParameterKind::kEffect) by_name[p.effect].parameters.push_back(index);
  }
  std::vector<ProbedEffect> effects;
  for (auto& [name, effect] : by_name) {
    effect.probes = ProbesWithinBounds(setup, effect.parameters);
    const bool probed =
        !effect.probes.empty() && !effect.probes.front().empty() && effect.probes.size() >= least_probes;
    const bool stated = std::any_of(effect.parameters.begin(), effect.parameters.end(),
                                    [&](int index) { return HasStatedStart(setup, index); });
    if (probed && !stated) effects.push_back(std::move(effect));
  }
  return effects;
}

// The fit with some effects at their null.
FitSetup Without(const std::vector<ProbedEffect>& effects, FitSetup setup) {
  for (const ProbedEffect& effect : effects) {
    for (const int index : effect.parameters) {
      setup.free.erase(std::remove(setup.free.begin(), setup.free.end(), index), setup.free.end());
      setup.rest[index] = ParameterOf(setup, index).null_value;
    }
  }
  return setup;
}

// Costs that a Gauss-Newton step from each probe predicts; infinite where there is no prediction.
struct PredictedCosts {
  std::vector<double> plain;
  std::vector<double> whitened;
};

double AfterStep(const Vector& x, const Vector& residuals, const SparseJacobian& jacobian) {
  BoxQuadraticModel model;
  if (!model.Set(x.size(), residuals, jacobian)) return kInfinity;
  double fall = 0;
  (void)model.BoxStep(x, -1, kDampingAtProbe, fall);
  return 0.5 * residuals.squaredNorm() - fall;
}

PredictedCosts CostsAtProbes(const LeastSquares& fit, const ProbedEffect& effect, const Vector& point,
                             const RowTransform* whitening, const std::function<bool()>& stop) {
  auto workspace = fit.NewWorkspace();
  SparseJacobian jacobian = fit.NewJacobian();
  Vector residuals;
  PredictedCosts costs;
  for (const auto& probe : effect.probes) {
    costs.plain.push_back(kInfinity);
    costs.whitened.push_back(kInfinity);
    if (stop()) continue;
    Vector at = point;
    for (const auto& [index, value] : probe) at[index] = value;
    const Vector x = fit.Variables(at);
    if (!fit.Evaluate(x, workspace, residuals, &jacobian)) continue;
    costs.plain.back() = AfterStep(x, residuals, jacobian);
    if (!whitening) continue;
    for (std::size_t b = 0; b < fit.train_blocks().size(); ++b) {
      SparseJacobian::Piece& piece = jacobian.pieces[b];
      whitening->Apply(static_cast<int>(b), piece.values);
      whitening->Apply(static_cast<int>(b), residuals.segment(piece.first_row, piece.values.rows()));
    }
    costs.whitened.back() = AfterStep(x, residuals, jacobian);
  }
  return costs;
}

// The lowest minima along the probes, lowest first.
std::vector<std::size_t> LowestMinima(const std::vector<double>& costs) {
  std::vector<std::size_t> minima;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const bool below_last = i == 0 || costs[i] < costs[i - 1];
    const bool below_next = i + 1 == costs.size() || costs[i] <= costs[i + 1];
    if (costs[i] < kInfinity && below_last && below_next) minima.push_back(i);
  }
  std::stable_sort(minima.begin(), minima.end(),
                   [&](std::size_t a, std::size_t b) { return costs[a] < costs[b]; });
  if (minima.size() > kTriedProbes) minima.resize(kTriedProbes);
  return minima;
}

double Lowest(const std::vector<double>& costs) {
  return *std::min_element(costs.begin(), costs.end());
}

class Probing {
 public:
  Probing(const LeastSquares& fit, const ProbedSearch& search)
      : fit_(fit), search_(search), left_(ProbedEffects(fit.setup(), search.least_probes)) {}

  [[nodiscard]] bool HasEffects() const { return !left_.empty(); }

  // [P]; nothing if it was stopped, or if nothing can be predicted.
  std::optional<Vector> Run(const Vector& point) {
    const FitSetup without = Without(left_, fit_.setup());
    LeastSquares fit(fit_.problem(), without);
    auto end = Fit(fit, fit.Parameters(fit.Variables(point)), nullptr, kLongEvaluations);
    while (end && !left_.empty()) {
      if (search_.found) search_.found(fit_.Variables(*end));
      end = Release(*end);
    }
    return end;
  }

 private:
  [[nodiscard]] std::optional<Vector> Fit(LeastSquares& fit, const Vector& point,
                                          const RowTransform* transform, long evaluations) {
    if (search_.stop()) return {};
    fit.set_transform(transform);
    const LocalFit::Outcome outcome =
        LocalFit(fit).Minimize(fit.Variables(point), -1, kProbedTolerance, evaluations);
    cost_ = outcome.cost;
    if (!outcome.failure.empty()) return {};
    return fit.Parameters(outcome.x);
  }

  // The fit with the one of the effects left that lowers the cost the most.
  std::optional<Vector> Release(const Vector& point) {
    const auto whitening = ResidualWhitening(fit_, point);
    std::size_t best = 0;
    PredictedCosts costs;
    for (std::size_t i = 0; i < left_.size(); ++i) {
      const FitSetup setup = WithOneMore(i);
      const LeastSquares fit(fit_.problem(), setup);
      PredictedCosts predicted = CostsAtProbes(fit, left_[i], point, whitening.get(), search_.stop);
      if (search_.stop()) return {};
      if (i > 0 && !(Lowest(predicted.plain) < Lowest(costs.plain))) continue;
      best = i;
      costs = std::move(predicted);
    }
    const FitSetup setup = WithOneMore(best);
    LeastSquares fit(fit_.problem(), setup);
    auto plain = BestOf(fit, point, left_[best], LowestMinima(costs.plain), nullptr);
    const double plain_cost = cost_;
    auto whitened = BestOf(fit, point, left_[best], LowestMinima(costs.whitened), whitening.get());
    if (whitened) {
      const LocalFit::Outcome end =
          AlternatingFit(fit, fit.Variables(*whitened), kProbedTolerance, search_.stop);
      cost_ = end.cost;
      whitened = fit.Parameters(end.x);
    }
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(best));
    return whitened && (!plain || cost_ < plain_cost) ? whitened : plain;
  }

  // The lowest end of fits from some probes.
  std::optional<Vector> BestOf(LeastSquares& fit, const Vector& point, const ProbedEffect& effect,
                               const std::vector<std::size_t>& probes, const RowTransform* transform) {
    std::optional<Vector> lowest;
    double lowest_cost = kInfinity;
    for (const std::size_t probe : probes) {
      Vector from = point;
      for (const auto& [index, value] : effect.probes[probe]) from[index] = value;
      auto end = Fit(fit, from, transform, kProbedEvaluations);
      if (!end || !(cost_ < lowest_cost)) continue;
      lowest = std::move(end);
      lowest_cost = cost_;
    }
    cost_ = lowest_cost;
    return lowest;
  }

  [[nodiscard]] FitSetup WithOneMore(std::size_t effect) const {
    std::vector<ProbedEffect> others = left_;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(effect));
    return Without(others, fit_.setup());
  }

  const LeastSquares& fit_;
  const ProbedSearch& search_;
  std::vector<ProbedEffect> left_;
  double cost_ = 0;  // of the last fit
};

}  // namespace

bool HasProbes(const FitSetup& setup, std::size_t least_probes) {
  return !setup.HasNuisancePriors() && !ProbedEffects(setup, least_probes).empty();
}

Vector ProbedStart(const LeastSquares& fit, const Vector& start, const ProbedSearch& search) {
  if (!HasProbes(fit.setup(), search.least_probes)) return start;
  const auto point = Probing(fit, search).Run(fit.Parameters(start));
  return point ? LowerOf(fit, start, fit.Variables(*point)) : start;
}

}  // namespace sinew::solvers
