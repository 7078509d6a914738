#include "identify/solvers/window_search.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/constants.h"
#include "identify/execution/shared_loop.h"
#include "identify/role_view.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/marginal_cost.h"

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

struct Instants {
  double first = 0;
  double last = 0;
};

// Factors on the residuals: 1 within a window of time, falling on both sides of it.
class Window final : public RowTransform {
 public:
  // @param from, to shares of the duration
  Window(const LeastSquares& fit, const Instants& all, double from, double to, double edge) {
    for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
      const Block& block = fit.problem().layout()[static_cast<std::size_t>(train.block)];
      Vector factor(static_cast<Eigen::Index>(block.sample.size()));
      for (Eigen::Index i = 0; i < factor.size(); ++i) {
        const double time =
            block.prediction_time[static_cast<std::size_t>(block.sample[static_cast<std::size_t>(i)])];
        const double share = (time - all.first) / std::max(all.last - all.first, kSmallestDuration);
        factor[i] = std::exp(-std::max({0.0, from - share, share - to}) / edge);
      }
      factors_.push_back(std::move(factor));
    }
  }

  void Apply(int train_block, Eigen::Ref<Matrix> rows) const override {
    rows.array().colwise() *= factors_[static_cast<std::size_t>(train_block)].array();
  }
  void AddTo(Digest& digest) const override {
    for (const Vector& factor : factors_) digest.Add(factor.data(), static_cast<std::size_t>(factor.size()));
  }

 private:
  static constexpr double kSmallestDuration = 1e-9;  // [s]
  std::vector<Vector> factors_;
};

Instants InstantsOf(const LeastSquares& fit) {
  Instants all{kInfinity, -kInfinity};
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const Block& block = fit.problem().layout()[static_cast<std::size_t>(train.block)];
    if (block.prediction_time.empty()) continue;
    all.first = std::min(all.first, block.prediction_time.front());
    all.last = std::max(all.last, block.prediction_time.back());
  }
  return all;
}

class Search {
 public:
  Search(LeastSquares& fit, const Vector& start, const std::function<bool()>& stop)
      : fit_(fit), stop_(stop), all_(InstantsOf(fit)) {
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
      const Window window(fit_, all_, origin * (1 - share), origin + (1 - origin) * share, edge);
      fit_.set_transform(&window);
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
  Instants all_;
  WindowEnd best_;
};

// The training trials that have nuisance values with priors of their own, and the indices of these values.
struct TrialValues {
  std::string trial;
  std::vector<int> free;
};

std::vector<TrialValues> OwnValues(const LeastSquares& fit) {
  std::vector<TrialValues> trials;
  for (const int index : fit.setup().free) {
    const Parameter& p = fit.setup().parameters[static_cast<std::size_t>(index)];
    if (p.kind != ParameterKind::kNuisance || !p.prior || p.trial.empty()) continue;
    auto found =
        std::find_if(trials.begin(), trials.end(), [&](const TrialValues& t) { return t.trial == p.trial; });
    if (found == trials.end()) found = trials.insert(trials.end(), {p.trial, {}});
    found->free.push_back(index);
  }
  return trials;
}

// The own values of one trial at the best point found, in the order of `own.free`.
std::vector<double> SearchTrial(const LeastSquares& fit, const TrialValues& own, const Vector& parameters,
                                const std::vector<Vector>& others, const std::function<bool()>& stop) {
  const RoleView view(fit.problem(), [&](const Block& block) {
    return block.role == BlockRole::kTrain && block.trial != own.trial ? BlockRole::kPredicted : block.role;
  });
  FitSetup setup = fit.setup();
  setup.record = nullptr;  // the answer as a whole is kept instead
  setup.free = own.free;
  setup.rest = parameters;
  LeastSquares alone(view, setup);
  std::vector<Vector> starts;
  for (const Vector& other : others) {
    Vector start = parameters;
    for (const int index : own.free) start[index] = other[index];
    starts.push_back(alone.Variables(start));
  }
  const Vector found = alone.Parameters(SearchInWindows(alone, alone.Start(), starts, stop).x);
  std::vector<double> values;
  for (const int index : own.free) values.push_back(found[index]);
  return values;
}

}  // namespace

WindowEnd SearchInWindows(LeastSquares& fit, const Vector& start, const std::vector<Vector>& others,
                          const std::function<bool()>& stop) {
  return Search(fit, start, stop).Run(others);
}

Vector SearchTrials(const LeastSquares& fit, const Vector& x, const std::vector<Vector>& others, int threads,
                    const std::function<bool()>& stop) {
  const std::vector<TrialValues> trials = OwnValues(fit);
  const Vector parameters = fit.Parameters(x);
  std::vector<Vector> other_parameters;
  for (const Vector& other : others) other_parameters.push_back(fit.Parameters(other));
  std::vector<std::vector<double>> found(trials.size());
  FitRecord* const record = fit.setup().record;
  ForEachShared(record, threads, trials.size(), [&](std::size_t i, std::size_t) {
    Digest question;
    if (record != nullptr) {
      fit.AddTo(question);
      question.Add("windows").Add(trials[i].trial).Add(x.data(), static_cast<std::size_t>(x.size()));
      for (const Vector& other : others) question.Add(other.data(), static_cast<std::size_t>(other.size()));
      if (const auto known = record->Find(question);
          known && known->numbers.size() == trials[i].free.size()) {
        found[i] = known->numbers;
        return;
      }
    }
    found[i] = SearchTrial(fit, trials[i], parameters, other_parameters, stop);
    if (record == nullptr || (stop && stop())) return;
    FitRecord::Answer answer;
    answer.numbers = found[i];
    record->Keep(question, std::move(answer));
  });
  Vector better = parameters;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    for (std::size_t k = 0; k < found[i].size(); ++k) better[trials[i].free[k]] = found[i][k];
  }
  return better == parameters ? x : fit.Variables(better);
}

}  // namespace sinew::solvers
