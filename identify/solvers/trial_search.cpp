#include "identify/solvers/trial_search.h"

#include <algorithm>
#include <string>

#include "base/constants.h"
#include "base/random.h"
#include "identify/execution/shared_loop.h"
#include "identify/role_view.h"
#include "identify/solvers/marginal_cost.h"
#include "identify/solvers/redrawn_stretches.h"

namespace sinew::solvers {
namespace {

// Redrawn stretches of all trials together that bring nothing: of the worst minimum met, one of fifty found
// the way out.
constexpr int kIdleOfAll = 48;

// The training trials that have curves of their own, and the indices of their values.
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
  trials.erase(
      std::remove_if(trials.begin(), trials.end(),
                     [](const TrialValues& t) { return static_cast<int>(t.free.size()) < kFewestOfCurve; }),
      trials.end());
  return trials;
}

WindowEnd EndAt(const LeastSquares& fit, const Vector& x) {
  LeastSquares::Workspace workspace = fit.NewWorkspace();
  const auto cost = fit.Cost(x, workspace);
  return {x, cost ? *cost : kInfinity, MarginalCost(fit, x)};
}

// The own values of one trial at the best point found, in the order of `own.free`.
// @param others parameters [P] of other ends @param seed of this trial
std::vector<double> ValuesOf(const LeastSquares& fit, const TrialValues& own, const Vector& parameters,
                             const std::vector<Vector>& others, bool in_windows, std::uint64_t seed,
                             const std::function<bool()>& stop) {
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
  const WindowEnd end = in_windows ? SearchTrial(alone, alone.Start(), starts, seed, stop)
                                   : RedrawStretches(alone, EndAt(alone, alone.Start()), {seed}, stop);
  const Vector found = alone.Parameters(end.x);
  std::vector<double> values;
  for (const int index : own.free) values.push_back(found[index]);
  return values;
}

}  // namespace

bool HasCurves(const LeastSquares& fit) {
  return !OwnValues(fit).empty();
}

WindowEnd SearchTrial(LeastSquares& fit, const Vector& start, const std::vector<Vector>& others,
                      std::uint64_t seed, const std::function<bool()>& stop) {
  if (fit.variables() < kFewestOfCurve) return EndAt(fit, start);
  return RedrawStretches(fit, SearchInWindows(fit, start, others, stop), {seed}, stop);
}

Vector SearchTrials(const LeastSquares& fit, const Vector& x, const TrialSearch& search,
                    const std::function<bool()>& stop) {
  const std::vector<TrialValues> trials = OwnValues(fit);
  const Vector parameters = fit.Parameters(x);
  std::vector<Vector> other_parameters;
  for (const Vector& other : search.others) other_parameters.push_back(fit.Parameters(other));
  std::vector<std::vector<double>> found(trials.size());
  FitRecord* const record = fit.setup().record;
  ForEachShared(record, search.threads, trials.size(), [&](std::size_t i, std::size_t) {
    Digest question;
    if (record != nullptr) {
      fit.AddTo(question);
      question.Add("trial").Add(trials[i].trial).Add(search.seed).Add(search.in_windows ? 1.0 : 0.0);
      question.Add(x.data(), static_cast<std::size_t>(x.size()));
      for (const Vector& other : search.others)
        question.Add(other.data(), static_cast<std::size_t>(other.size()));
      if (const auto known = record->Find(question);
          known && known->numbers.size() == trials[i].free.size()) {
        found[i] = known->numbers;
        return;
      }
    }
    found[i] = ValuesOf(fit, trials[i], parameters, other_parameters, search.in_windows,
                        Random::StreamSeed(search.seed, i), stop);
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

WindowEnd RedrawTrials(const LeastSquares& fit, const WindowEnd& end, std::uint64_t seed, int threads,
                       double enough, const std::function<bool()>& stop) {
  FitRecord* const record = fit.setup().record;
  Digest question;
  if (record != nullptr) {
    fit.AddTo(question);
    question.Add("all trials")
        .Add(seed)
        .Add(enough)
        .Add(end.x.data(), static_cast<std::size_t>(end.x.size()));
    if (const auto known = record->Find(question);
        known && known->numbers.size() == static_cast<std::size_t>(end.x.size()) + 2) {
      const Eigen::Map<const Vector> numbers(known->numbers.data(), end.x.size() + 2);
      return {numbers.tail(end.x.size()), numbers[0], numbers[1]};
    }
  }
  FitSetup setup = fit.setup();
  setup.record = nullptr;  // the answer as a whole is kept instead
  WindowEnd found =
      RedrawStretches(LeastSquares(fit.problem(), setup), end, {seed, threads, kIdleOfAll, enough}, stop);
  if (record == nullptr || (stop && stop())) return found;
  FitRecord::Answer answer;
  answer.numbers = {found.cost, found.marginal};
  answer.numbers.insert(answer.numbers.end(), found.x.begin(), found.x.end());
  record->Keep(question, std::move(answer));
  return found;
}

}  // namespace sinew::solvers
