#include "identify/solvers/independent_starts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/numbers.h"
#include "base/random.h"
#include "identify/solvers/displacement.h"
#include "identify/solvers/levenberg_marquardt.h"
#include "identify/solvers/polishing.h"
#include "identify/solvers/scheduled_starts.h"

namespace sinew::solvers {
namespace {

// Searches at a time, whatever the number of threads.
constexpr int kAtOnce = 4;
constexpr int kMaxChains = 6;
// Chains that have to end at the same cost where white noise is left; one more where there is structure,
// which a wrong minimum leaves as well as a wrong model.
constexpr int kAgreeing = 2;
// Successive displacements without gain that end a chain.
constexpr int kPatience = 32;
// A local search that has not reached a lower cost after so many evaluations rarely does.
constexpr long kEvaluationsPerSearch = 60;
constexpr double kFirstDamping = 1e-3;
// To tell the ends of two chains apart their cost has to be converged to much less than kSameMinimum.
constexpr long kEvaluationsAtEnd = 500;
// The last search; valleys along which the cost hardly changes could take for ever.
constexpr long kEvaluationsOfAnswer = 5000;
constexpr double kMayBeSame = 1.05;
constexpr double kLeastGain = 1e-3;
// Residuals of a ten millionth of what was measured: no instrument has less noise.
constexpr double kExactShare = 1e-14;
// White noise that is left, and is more than this share of what was measured: no minimum stands out of it.
constexpr double kNothingExplained = 0.9;
// Where only white noise is left by the search from the given start, and searches from random ones end so
// many times higher, random starts reach no useful minimum (a trajectory over which small differences grow),
// and the given one came from the measurement. Where it leaves this share of what was measured, and all of
// the others more than that one, this is so whatever is left.
constexpr double kNearlyAllExplained = 1e-4;
constexpr double kLost = 0.1;
constexpr double kFarWorse = 100;

// Cost of predicting the mean of every training block: the size of what is to be explained.
double SizeOfSignals(const LeastSquares& fit) {
  double cost = 0;
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const Block& block = fit.problem().layout()[static_cast<std::size_t>(train.block)];
    const auto measured =
        Eigen::Map<const Vector>(block.measured.data(), static_cast<Eigen::Index>(block.measured.size()));
    if (measured.size() == 0) continue;
    const double mean = measured.mean();
    for (std::size_t i = 0; i < block.measured.size(); ++i)
      cost += 0.5 * std::pow(block.WeightOf(i) * (block.measured[i] - mean), 2);
  }
  return cost;
}

// Neither successive residuals nor sums over stretches of 4, 16, ... residuals tell of an error that lasts.
// Of white noise the mean squared difference of successive values is twice their variance (von Neumann 1941),
// with a standard deviation of 1 / sqrt(n) of the ratio, and squared sums over m values are as large as m
// squared values, with one of sqrt(2 m / n) (variance ratio; Lo and MacKinlay 1988).
bool AreWhite(const Eigen::Ref<const Vector>& residuals) {
  const Eigen::Index n = residuals.size();
  if (n < 10) return true;
  const double differences = (residuals.tail(n - 1) - residuals.head(n - 1)).squaredNorm() / (2.0 * (n - 1));
  const double variance = residuals.squaredNorm() / static_cast<double>(n);
  if (!(differences > (1 - 3 / std::sqrt(static_cast<double>(n))) * variance)) return false;
  for (Eigen::Index m = 4; 8 * m <= n; m *= 4) {
    const Eigen::Index sums = n / m;
    double ratio = 0;
    for (Eigen::Index k = 0; k < sums; ++k) ratio += std::pow(residuals.segment(k * m, m).sum(), 2);
    ratio /= static_cast<double>(sums * m) * variance;
    if (ratio > 1 + 3 * std::sqrt(2.0 / static_cast<double>(sums))) return false;
  }
  return true;
}

class Searching {
 public:
  Searching(Evaluator& evaluator, const SolverOptions& options)
      : evaluator_(evaluator),
        options_(options),
        local_(options.cost_tolerance, kFirstDamping),
        sampler_(evaluator.fit()),
        size_of_signals_(SizeOfSignals(evaluator.fit())),
        exact_(kExactShare * size_of_signals_) {}

  Search Run(const Vector& start) {
    std::vector<Stage> first = Polish(Sample(start, 0, true), kEvaluationsPerSearch);
    const Stage* best = Best(first);
    if (best != nullptr && !Done()) {
      const bool start_is_best = best == &first.front();
      const bool start_stands_out = start_is_best && CountWithin(first, kFarWorse * best->cost) == 1;
      const bool others_are_lost = start_is_best && best->cost < kNearlyAllExplained * size_of_signals_ &&
                                   CountWithin(first, kLost * size_of_signals_) == 1;
      // Searches that end close to each other may have run out of evaluations on the way to one minimum.
      Stage end = *best;
      if (CountWithin(first, kMayBeSame * end.cost) > 1) end = Finish(std::move(end));
      given_ = first.front();
      const bool same_again = CountWithin(first, (1 + kSameMinimum) * end.cost) >= kAgreeing;
      *std::min_element(first.begin(), first.end(), IsBetter) = end;
      const bool nothing_explained = end.cost > kNothingExplained * size_of_signals_;
      if (others_are_lost || ((same_again || nothing_explained || start_stands_out) && IsNoise()))
        return End(std::move(first), "local searches");
      const double reached = end.cost;
      if (!Done()) end = Hop(std::move(end), 0);
      // Where structure is left, local searches that agree may all have missed a lower minimum near by.
      if (same_again && !(end.cost < (1 - kSameMinimum) * reached))
        return End(std::move(first), "local searches");
      ends_.push_back(std::move(end));
    }
    for (int chain = 1; chain < kMaxChains && !Done() && !Agrees(); ++chain) {
      std::vector<Stage> starts = Polish(Sample(start, chain, false), kEvaluationsPerSearch);
      best = Best(starts);
      if (best != nullptr && !Done())
        ends_.push_back(Hop(*best, chain));
      else if (best != nullptr)
        ends_.push_back(*best);
    }
    return End(ends_.empty() ? std::move(first) : std::move(ends_), "basin hopping");
  }

 private:
  static bool IsBetter(const Stage& a, const Stage& b) { return a.cost < b.cost; }

  static std::ptrdiff_t CountWithin(const std::vector<Stage>& stages, double cost) {
    return std::count_if(stages.begin(), stages.end(),
                         [&](const Stage& stage) { return stage.cost <= cost; });
  }

  static const Stage* Best(const std::vector<Stage>& stages) {
    const auto best = std::min_element(stages.begin(), stages.end(), IsBetter);
    return best == stages.end() || !std::isfinite(best->cost) ? nullptr : &*best;
  }

  [[nodiscard]] bool Exact() const { return evaluator_.has_best() && evaluator_.best().cost <= exact_; }
  [[nodiscard]] bool Done() { return Exact() || evaluator_.MustStop(); }
  [[nodiscard]] bool Agrees() {
    const int agreeing = AgreementOf(ends_).agreeing;
    return agreeing >= kAgreeing + 1 || (agreeing == kAgreeing && IsNoise());
  }

  // Whether nothing but white noise is left at the best point.
  bool IsNoise() {
    const LeastSquares& fit = evaluator_.fit();
    LeastSquares::Workspace workspace = fit.NewWorkspace();
    Vector residuals;
    if (!fit.Evaluate(evaluator_.best().x, workspace, residuals, nullptr)) return false;
    const auto& blocks = fit.train_blocks();
    return std::all_of(blocks.begin(), blocks.end(), [&](const LeastSquares::TrainBlock& train) {
      const Block& block = fit.problem().layout()[static_cast<std::size_t>(train.block)];
      return AreWhite(residuals.segment(train.first_row, block.samples()));
    });
  }

  std::vector<Vector> Sample(const Vector& start, int chain, bool with_start) const {
    // Seeds of different chains must not share points.
    const std::uint64_t seed = options_.seed + 1000003ULL * static_cast<std::uint64_t>(chain + 1);
    std::vector<Vector> starts = sampler_.Anywhere(start, with_start ? kAtOnce - 1 : kAtOnce, seed);
    if (with_start) starts.insert(starts.begin(), start);
    return starts;
  }

  std::vector<Stage> Polish(const std::vector<Vector>& points, long evaluations) {
    std::vector<PolishingStart> starts;
    long left = evaluator_.remaining().max_evaluations;
    for (const Vector& x : points) {
      if (left <= 0) break;
      starts.push_back({x, std::min(evaluations, left)});
      if (left != kUnlimitedEvaluations) left -= starts.back().evaluations;
    }
    std::vector<Stage> stages;
    for (Polished& one : PolishAll(evaluator_, local_, "lm", starts, options_.threads)) {
      search_.iterations += one.iterations;
      stages.push_back(std::move(one.stage));
    }
    return stages;
  }

  // A search that a limit ended goes on.
  Stage Finish(Stage stage) {
    if (stage.stop.converged() || Done()) return stage;
    for (Stage& further : Polish({stage.x}, kEvaluationsAtEnd)) {
      further.evaluations += stage.evaluations;
      if (further.cost <= stage.cost) stage = std::move(further);
    }
    return stage;
  }

  Stage Hop(Stage at, int chain) {
    Random random(options_.seed + 7919ULL * static_cast<std::uint64_t>(chain));
    int without_gain = 0;
    while (without_gain < kPatience && !Done()) {
      std::vector<Vector> points;
      for (int i = 0; i < kAtOnce; ++i) points.push_back(sampler_.Near(at.x, random));
      const double before = at.cost;
      for (Stage& hop : Polish(points, kEvaluationsPerSearch)) {
        at.evaluations += hop.evaluations;
        if (!(hop.cost < at.cost)) continue;
        hop.evaluations = at.evaluations;
        at = std::move(hop);
      }
      without_gain = at.cost < (1 - kLeastGain) * before ? 0 : without_gain + kAtOnce;
    }
    return Finish(std::move(at));
  }

  Search End(std::vector<Stage> ends, const char* how) {
    const bool exact = Exact();
    if (evaluator_.has_best() && !evaluator_.MustStop()) {
      for (Stage& last : Polish({evaluator_.best().x}, kEvaluationsOfAnswer)) {
        const auto best = std::min_element(ends.begin(), ends.end(), IsBetter);
        if (best != ends.end() && last.cost <= best->cost) *best = std::move(last);
      }
    }
    if (evaluator_.has_best() && given_.x.size() > 0 && given_.cost <= (1 + kTie) * evaluator_.best().cost)
      search_.answer = {0, given_.cost, given_.x};
    std::stable_sort(ends.begin(), ends.end(), IsBetter);
    const Agreement agreement = AgreementOf(ends);
    search_.stages = std::move(ends);
    search_.stop.kind = Termination::kStartsDone;
    if (exact) {
      search_.stop.test = fmt::format("cost {:.2g} is zero to rounding", evaluator_.best().cost);
    } else {
      search_.stop.test = EndsOfStarts(agreement, fmt::format("independent starts of {}", how));
    }
    evaluator_.MustStop();
    return std::move(search_);
  }

  Evaluator& evaluator_;
  const SolverOptions& options_;
  LevenbergMarquardt local_;
  StartSampler sampler_;
  double size_of_signals_;
  double exact_;
  std::vector<Stage> ends_;
  Stage given_;  // where the search from the given start ended
  Search search_;
};

}  // namespace

Agreement AgreementOf(const std::vector<Stage>& ends) {
  Agreement agreement;
  agreement.starts = static_cast<int>(ends.size());
  double best = kInfinity;
  for (const Stage& end : ends) best = std::min(best, end.cost);
  double next = kInfinity;
  for (const Stage& end : ends) {
    if (end.cost <= (1 + kSameMinimum) * best)
      ++agreement.agreeing;
    else
      next = std::min(next, end.cost);
  }
  if (!std::isfinite(best)) agreement.agreeing = 0;
  if (std::isfinite(next) && best > 0) agreement.next_best = next / best;
  return agreement;
}

std::string EndsOfStarts(const Agreement& agreement, const std::string& starts) {
  std::string text =
      fmt::format("{} of {} {} end at the lowest cost", agreement.agreeing, agreement.starts, starts);
  if (agreement.next_best > 1)
    text += fmt::format("; the next best is {} % worse", Readable(100 * (agreement.next_best - 1), 2));
  return text;
}

Search IndependentStarts::DoSolve(Evaluator& evaluator, const Vector& start) const {
  if (evaluator.fit().setup().HasNuisancePriors()) return ScheduledStarts(evaluator, options_).Run(start);
  return Searching(evaluator, options_).Run(start);
}

}  // namespace sinew::solvers
