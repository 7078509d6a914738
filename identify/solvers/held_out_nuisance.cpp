#include "identify/solvers/held_out_nuisance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/constants.h"
#include "identify/execution/shared_loop.h"
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/role_view.h"
#include "identify/solvers/improved_start.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/trial_search.h"

namespace sinew::solvers {
namespace {

constexpr std::uint64_t kRedrawSeed = 1;
constexpr long kEvaluations = 200;
// Of a further start, before it is clear that it ends lower.
constexpr long kEvaluationsPerStart = 60;
constexpr LocalFit::Tolerance kToleranceOfStarts{0.1, 1e-4};
// Of the way from one model to another, in equal steps.
constexpr int kSteps = 8;
constexpr long kEvaluationsPerStep = 30;
constexpr LocalFit::Tolerance kToleranceOfSteps{0, 1e-3};
// A model that leaves so little more of a trial than another one does has not ended at a minimum that is far
// worse: half of what a parameter more usually gains.
constexpr double kAsGood = 1;

double Between(const Parameter& parameter, double from, double to, double share) {
  if (parameter.scale == Scale::kLog) return from * std::pow(to / from, share);
  return from + share * (to - from);
}

// One held-out trial as if it alone were fitted, by its own nuisance values.
class TrialFit {
 public:
  TrialFit(const Problem& problem, const Vector& parameters, std::string trial, double tolerance)
      : trial_(std::move(trial)), tolerance_{0, tolerance}, alone_(problem, [this](const Block& block) {
          const bool fitted = block.trial == trial_ && block.role == BlockRole::kValidate;
          return fitted ? BlockRole::kTrain : BlockRole::kPredicted;
        }) {
    setup_.parameters = problem.parameters();
    setup_.rest = parameters;
    for (std::size_t i = 0; i < setup_.parameters.size(); ++i) {
      const Parameter& p = setup_.parameters[i];
      if (p.kind == ParameterKind::kNuisance && p.trial == trial_) setup_.free.push_back(static_cast<int>(i));
    }
    setup_.straight_steps = true;  // a trial's own values alone have no valleys
  }

  // Its values at the best point found, in the order of free(); nothing if no fit succeeds.
  [[nodiscard]] std::optional<std::vector<double>> Search(const HeldOutSearch& search) {
    const LeastSquares fit(alone_, setup_);
    if (search.fitted) {
      best_.x = fit.Start();
      best_.cost = CostOf(setup_.rest);
      if (!std::isfinite(best_.cost)) best_.failure = "no prediction";
    } else {
      best_ = LocalFit(fit).Minimize(fit.Start(), -1, tolerance_, kEvaluations);
    }
    if (setup_.HasNuisancePriors()) {
      SearchMinima(fit, search);
    } else {
      TryImprovedStart(fit);
    }
    if (!best_.failure.empty()) return std::nullopt;
    const Vector found = fit.Parameters(best_.x);
    std::vector<double> values;
    for (const int index : free()) values.push_back(found[index]);
    return values;
  }

  void AddTo(Digest& question) const { LeastSquares(alone_, setup_).AddTo(question); }

  [[nodiscard]] const std::vector<int>& free() const { return setup_.free; }

 private:
  void TryImprovedStart(const LeastSquares& fit) {
    const Vector from = best_.failure.empty() ? fit.Parameters(best_.x) : setup_.rest;
    const auto improved = ImprovedStart(fit, from);
    if (!improved) return;
    auto found = LocalFit(fit).Minimize(fit.Variables(*improved), -1, tolerance_, kEvaluations);
    if (found.failure.empty() && (!best_.failure.empty() || found.cost < best_.cost))
      best_ = std::move(found);
  }

  // Costs are negative logarithms of probabilities here.
  void TryFrom(const LeastSquares& fit, const Vector& start) {
    auto found = LocalFit(fit).Minimize(start, -1, kToleranceOfStarts, kEvaluationsPerStart);
    if (!found.failure.empty()) return;
    if (best_.failure.empty() && !(found.cost < best_.cost - kWorthTaking)) return;
    found = LocalFit(fit).Minimize(found.x, -1, tolerance_, kEvaluations);
    if (found.failure.empty()) best_ = std::move(found);
  }

  void SearchMinima(const LeastSquares& fit, const HeldOutSearch& search) {
    double reference = kInfinity;
    const Vector* closest = nullptr;
    for (const Vector& other : search.earlier) {
      Vector start = setup_.rest;
      for (const int index : free()) start[index] = other[index];
      TryFrom(fit, fit.Variables(start));
      if (const double cost = CostOf(other); cost < reference) {
        reference = cost;
        closest = &other;
      }
    }
    const auto settled = [&] { return best_.failure.empty() && best_.cost <= reference + kAsGood; };
    if (closest != nullptr && !settled()) TryFrom(fit, Follow(*closest));
    if (search.in_windows && best_.failure.empty() && (closest == nullptr || !settled())) {
      LeastSquares alone(alone_, setup_);
      TryFrom(fit, SearchTrial(alone, best_.x, {}, kRedrawSeed, {}).x);
    }
  }

  // Of the trial, with these parameters [P].
  [[nodiscard]] double CostOf(const Vector& parameters) const {
    const FitSetup setup = At(parameters);
    const LeastSquares fit(alone_, setup);
    LeastSquares::Workspace workspace = fit.NewWorkspace();
    const auto cost = fit.Cost(fit.Start(), workspace);
    return cost ? *cost : kInfinity;
  }

  // The minimum at other parameters, followed while they change to the given ones [n].
  [[nodiscard]] Vector Follow(const Vector& other) const {
    Vector x = LeastSquares(alone_, setup_).Variables(other);
    for (int step = 1; step < kSteps; ++step) {
      Vector parameters = other;
      for (Eigen::Index i = 0; i < parameters.size(); ++i) {
        parameters[i] = Between(setup_.parameters[static_cast<std::size_t>(i)], other[i], setup_.rest[i],
                                static_cast<double>(step) / kSteps);
      }
      const FitSetup setup = At(parameters);
      const LeastSquares fit(alone_, setup);
      auto outcome = LocalFit(fit).Minimize(x, -1, kToleranceOfSteps, kEvaluationsPerStep);
      if (outcome.failure.empty()) x = std::move(outcome.x);
    }
    return x;
  }

  [[nodiscard]] FitSetup At(const Vector& parameters) const {
    FitSetup setup = setup_;
    setup.rest = parameters;
    return setup;
  }

  std::string trial_;
  LocalFit::Tolerance tolerance_;
  RoleView alone_;
  FitSetup setup_;
  LocalFit::Outcome best_;
};

// The same from the record, if it holds the answer to this question.
std::optional<std::vector<double>> Answered(TrialFit& fit, FitRecord* record, const HeldOutSearch& search) {
  if (record == nullptr) return fit.Search(search);
  Digest question;
  fit.AddTo(question);
  question.Add("held out").Add(search.in_windows ? 1.0 : 0.0).Add(search.fitted ? 1.0 : 0.0);
  question.Add(search.tolerance);
  for (const Vector& other : search.earlier)
    question.Add(other.data(), static_cast<std::size_t>(other.size()));
  if (const auto known = record->Find(question); known && known->numbers.size() == fit.free().size())
    return known->numbers;
  auto values = fit.Search(search);
  if (!values) return values;
  FitRecord::Answer answer;
  answer.numbers = *values;
  record->Keep(question, std::move(answer));
  return values;
}

}  // namespace

Vector FitHeldOutNuisance(const Problem& problem, const Vector& parameters, FitRecord* record,
                          const HeldOutSearch& search) {
  std::set<std::string> names;
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kValidate) names.insert(block.trial);
  }
  const std::vector<std::string> trials(names.begin(), names.end());
  std::vector<std::vector<std::pair<int, double>>> found(trials.size());
  ForEachShared(record, search.threads, trials.size(), [&](std::size_t i, std::size_t) {
    TrialFit fit(problem, parameters, trials[i], search.tolerance);
    if (fit.free().empty()) return;
    const auto values = Answered(fit, record, search);
    if (!values) return;
    for (std::size_t k = 0; k < values->size(); ++k) found[i].emplace_back(fit.free()[k], (*values)[k]);
  });
  Vector answer = parameters;
  for (const auto& values : found) {
    for (const auto& [index, value] : values) answer[index] = value;
  }
  return answer;
}

}  // namespace sinew::solvers
