#include "identify/solvers/scheduled_starts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.h"
#include "base/numbers.h"
#include "base/random.h"
#include "identify/solvers/continuation.h"
#include "identify/solvers/independent_starts.h"
#include "identify/solvers/levenberg_marquardt.h"
#include "identify/solvers/marginal_cost.h"
#include "identify/solvers/noise_cost.h"
#include "identify/solvers/polishing.h"
#include "identify/solvers/regularised_start.h"
#include "identify/solvers/trial_search.h"

namespace sinew::solvers {
namespace {

enum class From { kStart, kNear, kRegularised, kRegularisedNear };

struct Schedule {
  double first_weight;  // 0: that of the misfit
  double ratio;
  From from;
};
constexpr Schedule kSchedules[] = {{0, 0, From::kStart},
                                   {1.0 / 256, 1.4, From::kStart},
                                   {0, 0, From::kRegularised},
                                   {1.0 / 1024, 2, From::kStart},
                                   {1.0 / 256, 1.4, From::kRegularisedNear},
                                   {0, 0, From::kNear},
                                   {1.0 / 256, 1.4, From::kNear},
                                   {1.0 / 128, 1.4, From::kNear},
                                   {0, 0, From::kRegularisedNear},
                                   {1.0 / 512, 2, From::kNear},
                                   {1.0 / 64, 1.4, From::kNear},
                                   {1.0 / 256, 1.4, From::kRegularisedNear},
                                   {1.0 / 384, 1.6, From::kNear},
                                   {1.0 / 192, 1.3, From::kNear},
                                   {1.0 / 256, 2, From::kNear},
                                   {1.0 / 2048, 2, From::kNear}};
// The others are for data that the best end does not explain as noise.
constexpr std::size_t kUsual = 8;
// Improved ends that have to agree, one more where much more than noise is left, which a wrong minimum leaves
// as well as a wrong model; and by how much their costs and MarginalCosts may differ then.
constexpr int kAgreeing = 2;
constexpr double kAgreement = 3;
constexpr double kAgreementShare = 0.05;  // of the cost, at most
constexpr int kMostRounds = 12;
constexpr long kEvaluationsPerSearch = 400;
constexpr long kEvaluationsOfTrials = 150;  // of all values together, after those of trials
constexpr long kEvaluationsOfAnswer = 5000;
constexpr double kFirstDamping = 1e-3;

double SameAs(double cost) {
  return std::max(kSameMinimum * cost, kSamePosterior);
}

double AgreementAt(double cost) {
  return std::max(SameAs(cost), std::min(kAgreement, kAgreementShare * cost));
}

}  // namespace

ScheduledStarts::ScheduledStarts(Evaluator& evaluator, const SolverOptions& options)
    : evaluator_(evaluator), options_(options), sampler_(evaluator.fit()), random_(options.seed) {}

Search ScheduledStarts::Run(const Vector& start) {
  Attempt(0, start);
  if (!Done()) Attempt(1, start);
  std::size_t next = 2;
  // Ends that are improved should be as good as possible; without curves there is nothing to improve.
  while (HasCurves(evaluator_.fit()) && next < kUsual && !Done() && !LeavesNoise()) Attempt(next++, start);
  while (!Done() && !Agrees()) {
    if (End* const unimproved = NextToImprove(); unimproved != nullptr) {
      Improve(*unimproved);
    } else if (next < (LeavesNoise() ? kUsual : std::size(kSchedules))) {
      Attempt(next++, start);
    } else {
      break;
    }
  }
  return Finish();
}

ScheduledStarts::End* ScheduledStarts::NextToImprove() {
  End* best = nullptr;
  for (End& end : ends_) {
    if (end.given_up || end.improved) continue;
    if (best == nullptr || end.marginal < best->marginal) best = &end;
  }
  return best;
}

bool ScheduledStarts::Agrees() {
  return Agreeing() >= kAgreeing + (LeavesNoise() ? 0 : 1);
}

double ScheduledStarts::NoiseCost() const {
  return NearNoiseCost(evaluator_.fit());
}

bool ScheduledStarts::LeavesNoise() {
  return Best() != nullptr && Best()->stage.cost <= NoiseCost();
}

bool ScheduledStarts::Done() {
  return evaluator_.MustStop();
}

Stage ScheduledStarts::Polish(const Solver& solver, const std::string& name, const Vector& x,
                              long evaluations) {
  Stage stage;
  stage.x = x;
  stage.cost = kInfinity;
  const long left = evaluator_.remaining().max_evaluations;
  if (left <= 0) return stage;
  for (Polished& one :
       PolishAll(evaluator_, solver, name, {{x, std::min(evaluations, left)}}, options_.threads)) {
    search_.iterations += one.iterations;
    stage = std::move(one.stage);
  }
  return stage;
}

void ScheduledStarts::Attempt(std::size_t which, const Vector& start) {
  const Schedule& schedule = kSchedules[which];
  // Drawn also where it is not used: what follows must not depend on it.
  const Vector near = sampler_.Near(start, random_);
  End end;
  // The name tells searches of one start apart when a run is resumed.
  const std::string name = fmt::format("continuation {}", which + 1);
  if (schedule.from == From::kRegularised || schedule.from == From::kRegularisedNear) {
    end.stage = Polish(LevenbergMarquardt(options_.cost_tolerance, kFirstDamping), name,
                       Regularised(which, start), kEvaluationsPerSearch);
    end.given_up = !std::isfinite(end.stage.cost);
  } else {
    const double most = which < 2 || Best() == nullptr ? kInfinity : Best()->stage.cost;
    const Continuation solver(options_.cost_tolerance, kFirstDamping,
                              {schedule.first_weight, schedule.ratio, most});
    end.stage = Polish(solver, name, schedule.from == From::kNear ? near : start, kEvaluationsPerSearch);
    end.given_up = !std::isfinite(end.stage.cost) ||
                   (end.stage.stop.kind == Termination::kSolverFailed && end.stage.cost > most);
  }
  end.stage.solver = "continuation";
  end.marginal = end.given_up ? kInfinity : MarginalCost(evaluator_.fit(), end.stage.x);
  ends_.push_back(std::move(end));
}

Vector ScheduledStarts::Regularised(std::size_t which, const Vector& start) const {
  const Schedule& schedule = kSchedules[which];
  const LeastSquares& fit = evaluator_.fit();
  const std::uint64_t seed = Random::StreamSeed(options_.seed, 1000 + which);
  Vector from = fit.Parameters(start);
  if (schedule.from == From::kRegularisedNear) {
    Random random(seed);
    from = DrawnStart(fit.setup(), from, random);
  }
  return RegularisedStart(
      evaluator_, from,
      {{schedule.first_weight, schedule.ratio}, options_.cost_tolerance, seed, options_.threads});
}

// Single trials cost the least, all together find what single ones cannot; windows only serve ends that are
// far from a good one.
void ScheduledStarts::Improve(End& end) {
  end.improved = true;
  if (!HasCurves(evaluator_.fit())) return;
  for (int round = 0; round < kMostRounds && !end.given_up && !Done(); ++round) {
    while (!Done() && !Confirms(end) && Gains(end, [&] { ImproveTrials(end, false); })) {
    }
    if (Done() || Confirms(end)) return;
    if (Gains(end, [&] { Redraw(end, round); })) continue;
    const bool noise = end.stage.cost <= NoiseCost();
    if (noise || Done() || Confirms(end) || !Gains(end, [&] { ImproveTrials(end, true); })) return;
  }
}

bool ScheduledStarts::Agree(const End& a, const End& b) {
  return a.improved && b.improved && std::abs(a.marginal - b.marginal) <= kAgreement &&
         std::abs(a.stage.cost - b.stage.cost) <= AgreementAt(std::min(a.stage.cost, b.stage.cost));
}

bool ScheduledStarts::Confirms(const End& end) {
  const End* const best = Best();
  if (best == nullptr) return false;
  if (best != &end) return Agree(end, *best);
  // The best by no more than rounding: the improved end of the same minimum has been searched from.
  return std::any_of(ends_.begin(), ends_.end(), [&](const End& other) {
    return &other != &end && Agree(end, other) && other.marginal - end.marginal < kWorthTaking;
  });
}

bool ScheduledStarts::Gains(const End& end, const std::function<void()>& improve) {
  const double before = end.marginal;
  improve();
  return end.marginal < before - kWorthGoingOn;
}

void ScheduledStarts::ImproveTrials(End& end, bool in_windows) {
  TrialSearch search{options_.seed, options_.threads, in_windows, {}};
  for (const End& other : ends_) {
    if (&other != &end && !other.given_up) search.others.push_back(other.stage.x);
  }
  const Vector x =
      SearchTrials(evaluator_.fit(), end.stage.x, search, [&] { return evaluator_.StopRequested(); });
  if (x != end.stage.x && !Done()) Take(end, x);
}

void ScheduledStarts::Redraw(End& end, int round) {
  const End* const best = Best();
  const double enough =
      best != nullptr && best->improved && best->marginal < end.marginal ? best->marginal : -kInfinity;
  const WindowEnd found = RedrawTrials(evaluator_.fit(), {end.stage.x, end.stage.cost, end.marginal},
                                       Random::StreamSeed(options_.seed, static_cast<std::uint64_t>(round)),
                                       options_.threads, enough, [&] { return evaluator_.StopRequested(); });
  if (found.x != end.stage.x && !Done()) Take(end, found.x);
}

void ScheduledStarts::Take(End& end, const Vector& x) {
  const LevenbergMarquardt local(options_.cost_tolerance, kFirstDamping);
  Stage joint = Polish(local, "lm", x, kEvaluationsOfTrials);
  const double marginal = MarginalCost(evaluator_.fit(), joint.x);
  if (!(marginal < end.marginal - kWorthTaking)) return;
  joint.evaluations += end.stage.evaluations;
  joint.solver = end.stage.solver;
  end.stage = std::move(joint);
  end.marginal = marginal;
}

ScheduledStarts::End* ScheduledStarts::Best() {
  double least = kInfinity;
  for (const End& end : ends_) least = std::min(least, end.marginal);
  End* best = nullptr;
  for (End& end : ends_) {
    if (end.given_up || !(end.marginal <= least + kSameEvidence)) continue;
    if (best == nullptr || end.stage.cost < best->stage.cost) best = &end;
  }
  return best;
}

int ScheduledStarts::Agreeing() {
  const End* const best = Best();
  if (best == nullptr) return 0;
  return static_cast<int>(
      std::count_if(ends_.begin(), ends_.end(), [&](const End& end) { return Agree(end, *best); }));
}

Search ScheduledStarts::Finish() {
  const End* const best = Best();
  if (best == nullptr) {
    for (End& end : ends_) search_.stages.push_back(std::move(end.stage));
    search_.stop.kind = Termination::kStartsDone;
    search_.stop.test = "no start has a prediction";
    evaluator_.MustStop();
    return std::move(search_);
  }
  Stage answer = best->stage;
  const int agreeing = Agreeing();
  double next = kInfinity;  // lowest cost of the other minima that are higher
  int narrow = 0;           // minima of a lower cost
  int improved = 0;
  for (const End& end : ends_) {
    if (!end.improved) continue;
    ++improved;
    if (end.stage.cost > answer.cost + AgreementAt(answer.cost)) next = std::min(next, end.stage.cost);
    if (!end.given_up && end.stage.cost < answer.cost - SameAs(answer.cost)) ++narrow;
  }
  if (!evaluator_.MustStop()) {
    const LevenbergMarquardt local(options_.cost_tolerance, kFirstDamping, HasCurves(evaluator_.fit()));
    Stage last = Polish(local, "lm", answer.x, kEvaluationsOfAnswer);
    // It may still slide into a narrow minimum of a lower cost.
    if (last.cost <= answer.cost &&
        MarginalCost(evaluator_.fit(), last.x) <= best->marginal + kSameEvidence) {
      last.solver = answer.solver;
      last.evaluations += answer.evaluations;
      answer = std::move(last);
    }
  }
  search_.answer = {0, answer.cost, answer.x};
  search_.stop.kind = Termination::kStartsDone;
  search_.stop.test =
      fmt::format("{} of {} independent starts of continuation end at this minimum", agreeing, improved);
  if (std::isfinite(next) && answer.cost > 0)
    search_.stop.test +=
        fmt::format("; the next best is {} % worse", Readable(100 * (next / answer.cost - 1), 2));
  if (HasCurves(evaluator_.fit()))
    search_.stop.test += "; with stretches of time fitted anew none ends lower";
  if (answer.cost > LargestNoiseCost(evaluator_.fit())) search_.stop.test += "; more than noise is left";
  if (narrow > 0) search_.stop.test += "; a minimum of lower cost is so narrow that it is less probable";
  const std::ptrdiff_t at = best - ends_.data();
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    if (static_cast<std::ptrdiff_t>(i) != at) search_.stages.push_back(std::move(ends_[i].stage));
  }
  std::stable_sort(search_.stages.begin(), search_.stages.end(),
                   [](const Stage& a, const Stage& b) { return a.cost < b.cost; });
  search_.stages.insert(search_.stages.begin(), std::move(answer));
  evaluator_.MustStop();
  return std::move(search_);
}

}  // namespace sinew::solvers
