#include "identify/solvers/redrawn_stretches.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/random.h"
#include "identify/execution/executor.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/marginal_cost.h"
#include "identify/solvers/time_factors.h"

namespace sinew::solvers {
namespace {

// Stretches that are redrawn at a time, whatever the number of threads.
constexpr std::size_t kAtATime = 4;
// Lengths of stretches, as shares of the trial.
constexpr double kShortest = 0.06;
constexpr double kLongest = 0.4;
// Of its length, how far a stretch reaches to one side of the residual that it was chosen by.
constexpr double kFarthest = 0.85;
// Deviations of the draws, over those of the posterior.
constexpr double kDraws[] = {0, 0.5, 1};
// Steps in which the data of a stretch come back.
constexpr int kReturnSteps = 5;
// Share of the trial in which the factor on residuals falls by e ahead of them.
constexpr double kEdge = 0.03;
// Ratios of successive noise levels.
constexpr double kLevels[] = {1.5, 2, 4};
constexpr long kReturnEvaluations = 8;
constexpr double kReturnTolerance = 1e-2;
constexpr long kWholeEvaluations = 40;
constexpr double kWholeTolerance = 1e-4;
// Of a stretch's cost over that of the minimum: it is given up before all of its data are back.
constexpr double kMostAbove = 2;
// Squared distance from the minimum, in standard deviations, within which a search with all data back is on
// its way to it. Its tolerance leaves about two; other minima are tens of deviations away.
constexpr double kReturned = 4;

enum Return { kFromBegin, kFromEnd, kFromBothEnds, kAsNoise, kReturns };

struct Stretch {
  std::size_t trial = 0;
  double from = 0;
  double to = 0;
  Return how = kFromBegin;  // its data come back

  [[nodiscard]] bool Holds(std::size_t of_trial, double share) const {
    return of_trial == trial && share >= from && share <= to;
  }
  // On a residual in it.
  [[nodiscard]] double FactorAt(double share, int step, double levels) const {
    const double back = static_cast<double>(step) / kReturnSteps * (to - from);
    double ahead = 0;
    switch (how) {
      case kFromBegin:
        ahead = share - (from + back);
        break;
      case kFromEnd:
        ahead = to - back - share;
        break;
      case kFromBothEnds:
        ahead = std::min(share - from, to - share) - 0.5 * back;
        break;
      default:
        return std::pow(levels, step - kReturnSteps);
    }
    return std::exp(-std::max(0.0, ahead) / kEdge);
  }
};

// A minimum, and the normal matrix there: of its Gaussian posterior.
struct Minimum {
  WindowEnd end;
  Matrix normal;  // empty: not known

  Minimum(const LeastSquares& fit, WindowEnd at) : end(std::move(at)) {
    LocalFit local(fit);
    if (local.ModelAt(end.x)) normal = local.model().normal;
  }
  [[nodiscard]] bool IsNear(const Vector& x) const {
    if (normal.size() == 0) return false;
    const Vector apart = x - end.x;
    return apart.dot(normal.selfadjointView<Eigen::Lower>() * apart) < kReturned;
  }
};

// One redrawn stretch.
class Redraw {
 public:
  Redraw(const LeastSquares& fit, const Minimum& from, std::uint64_t seed, const std::function<bool()>& stop)
      : fit_(fit.problem(), fit.setup()),
        stop_(stop),
        random_(seed),
        factors_(fit),
        minimum_(from),
        from_(from.end) {}

  // Where it ends; nothing if that is not lower.
  std::optional<WindowEnd> Try() {
    if (Stopped()) return std::nullopt;
    Choose();
    const double deviations = kDraws[random_.Index(std::size(kDraws))];
    fit_.set_transform(&factors_);
    factors_.Set([&](std::size_t trial, double share) {
      return std::any_of(stretches_.begin(), stretches_.end(),
                         [&](const Stretch& stretch) { return stretch.Holds(trial, share); })
                 ? 0.0
                 : 1.0;
    });
    const auto without = Minimize(from_.x, kReturnEvaluations, kReturnTolerance);
    const Vector drawn = Draw(without.failure.empty() ? without.x : from_.x, deviations);
    const auto back = BringBack(drawn);
    fit_.set_transform(nullptr);
    if (!back || Stopped()) return std::nullopt;
    auto outcome = Minimize(*back, kWholeEvaluations, kWholeTolerance);
    if (!outcome.failure.empty()) return std::nullopt;
    const double marginal = MarginalCost(fit_, outcome.x);
    if (!(marginal < from_.marginal - kWorthTaking)) return std::nullopt;
    return WindowEnd{std::move(outcome.x), outcome.cost, marginal};
  }

 private:
  [[nodiscard]] bool Stopped() const { return stop_ && stop_(); }

  LocalFit::Outcome Minimize(const Vector& x, long evaluations, double tolerance) {
    return LocalFit(fit_).Minimize(x, -1, {0, tolerance}, evaluations);
  }

  // One, or the same in all trials: what they have in common moves with difficulty while one of them holds
  // it.
  void Choose() {
    levels_ = kLevels[random_.Index(std::size(kLevels))];
    const bool in_all = random_.Index(2) == 1;
    stretches_.push_back(AboutAResidual());
    for (std::size_t trial = 0; in_all && trial < factors_.trials(); ++trial) {
      if (trial == stretches_.front().trial) continue;
      stretches_.push_back(stretches_.front());
      stretches_.back().trial = trial;
    }
  }

  // About a residual, drawn in proportion to its square, but at least as often as a quarter of the mean one.
  Stretch AboutAResidual() {
    LeastSquares::Workspace workspace = fit_.NewWorkspace();
    Vector residuals;
    if (!fit_.Evaluate(from_.x, workspace, residuals, nullptr)) return {};
    Vector squares = residuals.head(fit_.data_rows()).array().square();
    squares.array() += 0.25 * squares.mean();
    double left = random_.Uniform() * squares.sum();
    double middle = 0.5;
    std::size_t trial = 0;
    for (std::size_t b = 0; b < fit_.train_blocks().size(); ++b) {
      const Vector& shares = factors_.shares()[b];
      for (Eigen::Index i = 0; i < shares.size() && left >= 0; ++i) {
        left -= squares[fit_.train_blocks()[b].first_row + i];
        middle = shares[i];
        trial = factors_.TrialOf(b);
      }
    }
    const double length = kShortest * std::pow(kLongest / kShortest, random_.Uniform());
    const double from = middle - length * random_.Uniform(1 - kFarthest, kFarthest);
    return {trial, from, from + length, static_cast<Return>(random_.Index(kReturns))};
  }

  // Of the Gaussian posterior about a point, with the data that count now.
  Vector Draw(const Vector& x, double deviations) {
    LocalFit local(fit_);
    if (deviations == 0 || !local.ModelAt(x)) return x;
    const Eigen::LLT<Matrix> root(local.model().normal);
    if (root.info() != Eigen::Success) return x;
    Vector normal(x.size());
    for (double& value : normal) value = deviations * random_.Normal();
    return (x + root.matrixU().solve(normal)).cwiseMax(0).cwiseMin(1);
  }

  // The values after the data of the stretch came back; nothing where that costs too much, or where they are
  // on their way to the minimum.
  std::optional<Vector> BringBack(Vector x) {
    for (int step = 1; step <= kReturnSteps && !minimum_.IsNear(x); ++step) {
      if (Stopped()) return std::nullopt;
      factors_.Set([&](std::size_t trial, double share) {
        double factor = 1;
        for (const Stretch& stretch : stretches_) {
          if (stretch.Holds(trial, share)) factor = std::min(factor, stretch.FactorAt(share, step, levels_));
        }
        return factor;
      });
      auto outcome = Minimize(x, kReturnEvaluations, kReturnTolerance);
      if (!outcome.failure.empty() || outcome.cost > from_.cost + kMostAbove) return std::nullopt;
      x = std::move(outcome.x);
    }
    if (minimum_.IsNear(x)) return std::nullopt;
    return x;
  }

  LeastSquares fit_;
  const std::function<bool()>& stop_;
  Random random_;
  TimeFactors factors_;
  std::vector<Stretch> stretches_;
  double levels_ = 1;
  const Minimum& minimum_;
  const WindowEnd& from_;
};

}  // namespace

WindowEnd RedrawStretches(const LeastSquares& fit, WindowEnd end, const Redraws& how,
                          const std::function<bool()>& stop) {
  const auto executor = MakeExecutor(how.threads);
  const LeastSquares untransformed(fit.problem(), fit.setup());
  Minimum minimum(untransformed, std::move(end));
  std::uint64_t drawn = 0;
  for (int idle = 0; idle < how.idle && !(stop && stop());) {
    std::array<std::optional<WindowEnd>, kAtATime> found;
    executor->ForEach(found.size(), [&](std::size_t i, std::size_t) {
      found[i] = Redraw(fit, minimum, Random::StreamSeed(how.seed, drawn + i), stop).Try();
    });
    drawn += found.size();
    idle += static_cast<int>(found.size());
    std::optional<WindowEnd> lower;
    for (auto& one : found) {
      if (!one || !(one->marginal < (lower ? *lower : minimum.end).marginal)) continue;
      if (one->marginal < minimum.end.marginal - kWorthGoingOn) idle = 0;
      lower = std::move(one);
    }
    if (!lower) continue;
    minimum = Minimum(untransformed, std::move(*lower));
    if (minimum.end.marginal <= how.enough) break;
  }
  return std::move(minimum.end);
}

}  // namespace sinew::solvers
