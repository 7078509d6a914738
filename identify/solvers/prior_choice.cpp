#include "identify/solvers/prior_choice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "base/constants.h"
#include "identify/execution/evaluator.h"
#include "identify/solvers/continuation.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/marginal_cost.h"
#include "identify/solvers/noise_cost.h"
#include "identify/solvers/pattern_search.h"
#include "identify/solvers/regularised_start.h"

namespace sinew::solvers {
namespace {

constexpr int kMostSearches = 4;  // from one beginning
// Of the marginal cost, that counts: a change of the prior that gains less is none.
constexpr double kWorthMoving = 0.5;
// Of the error of the last prediction of a gain.
constexpr double kTimesWrong = 2;
constexpr double kDamping = 1e-3;
constexpr long kTrialEvaluations = 100;
constexpr LocalFit::Tolerance kTrialTolerance{1e-3, 1e-6};
constexpr LocalFit::Tolerance kEndTolerance{0, 1e-9};
constexpr long kEndEvaluations = 500;

// A search ends in different minima under different schedules, and a wrong one wants another prior.
enum class PriorsAt { kStart, kFirstOthers, kLastOthers };  // of the starts of the parameters of priors
struct Beginning {
  PriorsAt priors = PriorsAt::kStart;
  bool regularised = false;  // with priors on the shared parameters, for the beginning alone
};
constexpr Beginning kBeginnings[] = {{PriorsAt::kStart, false},
                                     {PriorsAt::kFirstOthers, false},
                                     {PriorsAt::kLastOthers, false},
                                     {PriorsAt::kStart, true}};
constexpr std::size_t kMostAtNoise = 2;       // of these, where the best end is near the noise
constexpr double kBeginningTolerance = 1e-6;  // relative change of the cost
constexpr long kBeginningEvaluations = 600;

// Where all of these end at higher costs, in units of NearNoiseCost, they tell nothing of the prior.
constexpr double kMostCost = 1.5;

struct Point {
  Vector parameters;  // [P]
  double marginal = kInfinity;
  double cost = kInfinity;
};

// Parameters of priors that are to be chosen.
std::vector<int> ChosenPriors(const FitSetup& setup) {
  std::vector<int> chosen;
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    const auto index = static_cast<int>(i);
    if (p.kind == ParameterKind::kPrior && !p.other_starts.empty() && !setup.IsHeld(index))
      chosen.push_back(index);
  }
  return chosen;
}

PatternSearch SearchOver(const FitSetup& setup, const std::vector<int>& chosen,
                         PatternSearch::IsBetter is_better, std::function<bool()> stopped) {
  const auto count = static_cast<Eigen::Index>(chosen.size());
  Vector lower(count);
  Vector upper(count);
  Vector factors(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(chosen[static_cast<std::size_t>(k)])];
    lower[k] = p.lower;
    upper[k] = p.upper;
    factors[k] = std::max(p.other_starts.front() / p.start, p.start / p.other_starts.front());
  }
  return {std::move(lower), std::move(upper), factors, std::move(is_better), std::move(stopped)};
}

class Choice {
 public:
  Choice(const Problem& problem, const FitSetup& setup, const PriorChoiceOptions& options)
      : problem_(problem),
        setup_(setup),
        options_(options),
        chosen_(ChosenPriors(setup)),
        search_(SearchOver(
            setup, chosen_, [this](const Vector& values) { return Try(values); },
            [this] { return Stopped(); })) {}

  PriorChoice Run() {
    PriorChoice choice;
    choice.setup = setup_;
    if (chosen_.empty() || !setup_.HasNuisancePriors()) return choice;
    noise_ = LargestNoiseCost(LeastSquares(problem_, setup_));
    near_noise_ = NearNoiseCost(LeastSquares(problem_, setup_));
    Point best;
    bool confirmed = false;
    for (std::size_t which = 0; which < std::size(kBeginnings) && !Stopped(); ++which) {
      if (best.cost <= near_noise_ && (confirmed || which == kMostAtNoise)) break;
      // Near the noise a better minimum shows where it is met, before its own prior is chosen.
      const double most = best.cost <= near_noise_ ? best.marginal : kInfinity;
      const Point end = SearchFrom(kBeginnings[which], most, which == 0 ? &choice.at_start : nullptr);
      const bool same = IsSame(end, best);
      if (end.marginal < best.marginal || best.parameters.size() == 0) {
        best = end;
        confirmed = found_directly_;
      }
      confirmed = confirmed || same;
    }
    if (best.parameters.size() == 0) return choice;  // interrupted
    choice.evaluations = evaluations_;
    if (best.cost > kMostCost * near_noise_) {
      for (const int index : chosen_) choice.setup.rest[index] = AllowingMore(index);
      choice.undetermined = true;
      return choice;
    }
    if (best.cost > noise_) best = LeastOfAll(best);
    choice.evaluations = evaluations_;
    choice.setup.rest = best.parameters;
    choice.marginal = best.marginal;
    choice.any_chosen = true;
    return choice;
  }

 private:
  [[nodiscard]] bool Stopped() const {
    return options_.interrupt != nullptr && options_.interrupt->load(std::memory_order_relaxed);
  }

  [[nodiscard]] double AllowingMore(int index) const {
    return setup_.parameters[static_cast<std::size_t>(index)].other_starts.back();
  }

  [[nodiscard]] static bool IsSame(const Point& a, const Point& b) {
    return std::abs(a.marginal - b.marginal) <= kWorthMoving;
  }

  // One beginning, and pattern searches from where it ends until one of them moves nothing. In between, a
  // search from the start at what was chosen may end in a better minimum. Sets found_directly_.
  // @param most marginal cost of a beginning that is gone on from
  Point SearchFrom(const Beginning& beginning, double most, double* at_start) {
    FitSetup at = setup_;
    for (const int index : chosen_) {
      const std::vector<double>& others = setup_.parameters[static_cast<std::size_t>(index)].other_starts;
      if (beginning.priors == PriorsAt::kFirstOthers) at.rest[index] = others.front();
      if (beginning.priors == PriorsAt::kLastOthers) at.rest[index] = others.back();
    }
    wrong_by_ = kInfinity;
    MoveTo(Found(at, beginning.regularised));
    found_directly_ = !beginning.regularised;
    if (at_start != nullptr) *at_start = best_.marginal;
    if (best_.marginal > most) return best_;
    for (int again = 0; again < kMostSearches && !Stopped(); ++again) {
      const Vector before = PriorsOf(best_);
      if (search_.From(before) == before || Stopped()) break;
      for (const int index : chosen_) at.rest[index] = best_.parameters[index];
      const Point found = Found(at, beginning.regularised);
      found_directly_ = !beginning.regularised && found.marginal <= best_.marginal + kWorthMoving;
      if (found.marginal < best_.marginal - kWorthMoving) MoveTo(found);
    }
    return best_;
  }

  // @param regularised with priors on the shared parameters
  Point Found(const FitSetup& at, bool regularised) {
    const FitSetup regularised_setup = regularised ? Regularised(at, at.rest) : at;
    const LeastSquares from(problem_, regularised_setup);
    Evaluator::Options how;
    how.interrupt = options_.interrupt;
    how.budget.max_evaluations = kBeginningEvaluations;
    Evaluator evaluator(from, std::move(how));
    const SolverResult found = Continuation(kBeginningTolerance, kDamping).Solve(evaluator, from.Start());
    evaluations_ += evaluator.evaluations();
    Point point{from.Parameters(found.x)};
    if (found.stop.usable()) point.marginal = MarginalCost(LeastSquares(problem_, at), found.x);
    if (!regularised) point.cost = found.cost;
    return point;
  }

  // Where more than noise is left there are many minima at one prior, such as those that differ by when a
  // foot begins to slide, and rounding decides in which of them a search ends: so those that were found at
  // other priors are carried over.
  Point LeastOfAll(Point best) {
    constexpr std::size_t kMostEnds = 8;
    std::sort(ends_.begin(), ends_.end(),
              [](const Point& a, const Point& b) { return a.marginal < b.marginal; });
    const auto same = [](const Point& a, const Point& b) { return a.marginal == b.marginal; };
    ends_.erase(std::unique(ends_.begin(), ends_.end(), same), ends_.end());
    if (ends_.size() > kMostEnds) ends_.resize(kMostEnds);
    const Vector priors = best.parameters;
    for (const Point& end : ends_) {
      if (Stopped()) break;
      const auto there = MinimumFrom(problem_.AtPriors(end.parameters, priors, Problem::CarryOver::kAllowed),
                                     kEndTolerance, kEndEvaluations);
      if (there && there->marginal < best.marginal) best = *there;
    }
    return best;
  }

  // Where a local fit ends that begins there, at its parameters of priors; nothing where it fails.
  std::optional<Point> MinimumFrom(Vector start, LocalFit::Tolerance tolerance, long max_evaluations) {
    FitSetup at = setup_;
    at.rest = std::move(start);
    const LeastSquares fit(problem_, at);
    LocalFit local(fit);
    const LocalFit::Outcome end = local.Minimize(fit.Start(), -1, tolerance, max_evaluations);
    evaluations_ += local.evaluations();
    if (!end.failure.empty()) return std::nullopt;
    return Point{fit.Parameters(end.x), MarginalCost(fit, end.x), end.cost};
  }

  void MoveTo(Point point) {
    best_ = std::move(point);
    predicted_at_best_.reset();
  }

  [[nodiscard]] Vector PriorsOf(const Point& point) const { return point.parameters(chosen_); }

  // A trial from there is better than the best point; it is the best one then.
  bool Try(const Vector& values) {
    Vector priors = best_.parameters;
    for (std::size_t k = 0; k < chosen_.size(); ++k)
      priors[chosen_[k]] = values[static_cast<Eigen::Index>(k)];
    double predicted = kInfinity;
    if (best_.cost <= near_noise_) {
      const PredictedMinimum there = MinimumWith(priors);
      if (!predicted_at_best_) predicted_at_best_ = MinimumWith(best_.parameters).marginal;
      predicted = *predicted_at_best_ - there.marginal;
      // At the noise no fit is made where the linear model predicts too little, by more than it has just been
      // wrong by; elsewhere it may be the model of a wrong minimum.
      if (best_.cost <= noise_ && predicted + kTimesWrong * wrong_by_ < kWorthMoving) return false;
      if (predicted > kWorthMoving && TryFrom(there.parameters, predicted)) return true;
    }
    return TryFrom(problem_.AtPriors(best_.parameters, priors, Problem::CarryOver::kAllowed), predicted);
  }

  // As the linear model at the best point has it.
  PredictedMinimum MinimumWith(const Vector& priors) {
    FitSetup trial = setup_;
    trial.rest = problem_.AtPriors(best_.parameters, priors, Problem::CarryOver::kSame);
    ++evaluations_;
    return PredictMinimum(problem_, trial);
  }

  // Whether a fit from there, at its parameters of priors, is a better point.
  // @param predicted gain, or infinite
  bool TryFrom(Vector start, double predicted) {
    auto end = MinimumFrom(std::move(start), kTrialTolerance, kTrialEvaluations);
    if (!end) return false;
    if (std::isfinite(end->marginal)) ends_.push_back(*end);
    if (std::isfinite(predicted)) wrong_by_ = std::abs(best_.marginal - end->marginal - predicted);
    if (!(end->marginal < best_.marginal - kWorthMoving)) return false;
    MoveTo(std::move(*end));
    return true;
  }

  const Problem& problem_;
  const FitSetup& setup_;
  const PriorChoiceOptions& options_;
  double noise_ = 0;         // LargestNoiseCost
  double near_noise_ = 0;    // NearNoiseCost
  std::vector<int> chosen_;  // parameters
  PatternSearch search_;
  Point best_;
  bool found_directly_ = false;              // the best point, by `continuation` at its prior
  std::optional<double> predicted_at_best_;  // its marginal cost, by the linear model
  double wrong_by_ = kInfinity;              // the last gain that the linear model predicted
  std::vector<Point> ends_;                  // of all trials
  long evaluations_ = 0;
};

}  // namespace

FitSetup WithPriorsOf(const FitSetup& chosen, FitSetup setup) {
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    if (setup.parameters[i].kind == ParameterKind::kPrior) setup.rest[index] = chosen.rest[index];
  }
  return setup;
}

PriorChoice ChoosePriors(const Problem& problem, const FitSetup& setup, const PriorChoiceOptions& options) {
  return Choice(problem, setup, options).Run();
}

}  // namespace sinew::solvers
