#include "identify/solvers/local_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/numbers.h"

namespace sinew::solvers {
namespace {

// Close to Gauss-Newton: refits start near their solution, where full steps are best.
constexpr double kFirstRefitDamping = 1e-8;
constexpr double kLargestRefitDamping = 1e8;
// After a rejected step damping is raised by this factor, to no less than ...
constexpr double kRaise = 10;
constexpr double kLeastRaisedDamping = 1e-4;
// ... and without curved steps to much more, and with every further rejection by a larger factor: most of
// these are steps across a kink (a reversal under dry friction) or a narrow valley, which only much shorter
// ones avoid.
constexpr double kLeastRaisedStraight = 0.1;
constexpr double kRaiseGrowth = 3;
// Share of the step after which the residuals' second derivative along it is taken: Transtrum and Sethna
// (2012).
constexpr double kCurvatureStep = 0.1;
// Penalty scale: violating a constraint by a share e of its span costs as much as moving the variable with
// the largest gradient by 100 e.
constexpr double kPenalty = 1e4;

// Of an answer in the record, before the point: cost, converged, evaluations, penalty.
constexpr std::size_t kAnswerNumbers = 4;

}  // namespace

LocalFit::LocalFit(const LeastSquares& least_squares, double penalty)
    : least_squares_(least_squares),
      workspace_(least_squares.NewWorkspace()),
      jacobian_(least_squares.NewJacobian()),
      penalty_(penalty) {}

void LocalFit::AddPenalties(const Vector& x, double& cost, bool derivatives) {
  if (least_squares_.constraints() == 0) return;
  if (!least_squares_.Constraints(x, workspace_, constraint_, &constraint_jacobian_)) return;
  for (Eigen::Index i = 0; i < constraint_.size(); ++i) {
    const double span = constraint_jacobian_.row(i).squaredNorm();
    if (!(constraint_[i] > 0) || !(span > 0)) continue;
    const double weight = penalty_ / span;
    cost += 0.5 * weight * constraint_[i] * constraint_[i];
    if (!derivatives) continue;
    equations_.gradient += weight * constraint_[i] * constraint_jacobian_.row(i).transpose();
    equations_.normal += weight * constraint_jacobian_.row(i).transpose() * constraint_jacobian_.row(i);
  }
}

Status LocalFit::Cost(const Vector& x, double& cost) {
  ++evaluations_;
  SINEW_TRY(least_squares_.Evaluate(x, workspace_, residuals_, nullptr));
  cost = 0.5 * residuals_.squaredNorm();
  AddPenalties(x, cost, false);
  return {};
}

Status LocalFit::CostAndDerivatives(const Vector& x, double& cost) {
  ++evaluations_;
  SINEW_TRY(least_squares_.Evaluate(x, workspace_, residuals_, &jacobian_));
  at_x_ = residuals_;
  cost = 0.5 * residuals_.squaredNorm();
  if (!equations_.Set(x.size(), residuals_, jacobian_)) return Fail("a derivative is not finite");
  // Set at the first point and then constant, because a search needs one cost function.
  if (penalty_ == 0) penalty_ = kPenalty * equations_.normal.diagonal().maxCoeff();
  AddPenalties(x, cost, true);
  return {};
}

Result<double> LocalFit::ModelAt(const Vector& x) {
  double cost = 0;
  SINEW_TRY(CostAndDerivatives(x, cost));
  return cost;
}

LocalFit::Outcome LocalFit::Minimize(const Vector& start, int held, Tolerance tolerance,
                                     long max_evaluations) {
  FitRecord* const record = least_squares_.setup().record;
  if (record == nullptr) return Search(start, held, tolerance, max_evaluations);
  Digest question;
  least_squares_.AddTo(question);
  question.Add(penalty_).Add(start.data(), static_cast<std::size_t>(start.size()));
  question.Add(static_cast<double>(held)).Add(tolerance.absolute).Add(tolerance.relative);
  question.Add(static_cast<double>(max_evaluations)).Add(least_squares_.setup().straight_steps ? 1.0 : 0.0);
  const auto n = static_cast<std::size_t>(start.size());
  const auto known = record->Find(question);
  const bool fits = known && known->numbers.size() == kAnswerNumbers + n;
  if (const auto count = fits ? WholeNumber(known->numbers[2]) : std::nullopt; count) {
    Outcome outcome;
    outcome.cost = known->numbers[0];
    outcome.converged = known->numbers[1] != 0;
    evaluations_ += *count;
    penalty_ = known->numbers[3];
    outcome.x = Eigen::Map<const Vector>(known->numbers.data() + kAnswerNumbers, start.size());
    outcome.failure = known->text;
    return outcome;
  }
  const long before = evaluations_;
  Outcome outcome = Search(start, held, tolerance, max_evaluations);
  FitRecord::Answer answer;
  answer.numbers = {outcome.cost, outcome.converged ? 1.0 : 0.0, static_cast<double>(evaluations_ - before),
                    penalty_};
  answer.numbers.insert(answer.numbers.end(), outcome.x.data(), outcome.x.data() + outcome.x.size());
  answer.text = outcome.failure;
  record->Keep(question, std::move(answer));
  return outcome;
}

LocalFit::Outcome LocalFit::Search(const Vector& start, int held, Tolerance tolerance, long max_evaluations) {
  Outcome outcome;
  outcome.x = start.cwiseMax(0).cwiseMin(1);
  const long last = evaluations_ + max_evaluations;
  const Status status = CostAndDerivatives(outcome.x, outcome.cost);
  if (!status) {
    outcome.failure = status.error().message;
    outcome.cost = std::numeric_limits<double>::infinity();
    return outcome;
  }
  double damping = kFirstRefitDamping;
  const bool straight_only = least_squares_.setup().straight_steps;
  const double least_raised = straight_only ? kLeastRaisedStraight : kLeastRaisedDamping;
  double raise = kRaise;
  bool rejected = false;  // a step from this point
  bool curved = false;    // the last accepted step was
  while (true) {
    double predicted = 0;
    const Vector step = straight_only ? equations_.ProjectedStep(outcome.x, held, damping, predicted)
                                      : equations_.BoxStep(outcome.x, held, damping, predicted);
    const bool tiny_step = step.cwiseAbs().maxCoeff() <= std::numeric_limits<double>::epsilon();
    const double enough = std::max(tolerance.absolute + tolerance.relative * outcome.cost,
                                   least_squares_.problem().cost_noise_level() * outcome.cost);
    if (tiny_step || std::abs(predicted) <= enough) {
      outcome.converged = true;
      return outcome;
    }
    if (evaluations_ >= last || damping > kLargestRefitDamping) return outcome;
    Vector next;
    double cost = 0;
    const auto lowers = [&](const Vector& by) {
      next = (outcome.x + by).cwiseMax(0).cwiseMin(1);
      return Cost(next, cost) && cost < outcome.cost;
    };
    const bool straight = !curved && lowers(step);
    std::optional<Vector> along;
    if (!straight && !straight_only) along = CurvedStep(outcome.x, step, damping);
    const bool accepted = straight || (along && lowers(*along)) || (curved && lowers(step));
    if (!accepted) {
      damping = std::max(raise * damping, least_raised);
      if (straight_only) raise *= kRaiseGrowth;
      rejected = true;
      continue;
    }
    curved = !straight && along.has_value();
    const double gained = outcome.cost - cost;
    outcome.x = std::move(next);
    outcome.cost = cost;
    // The damping that was too small here is likely to be so at the next point.
    if (!rejected) damping = std::max(damping / 10, kFirstRefitDamping);
    rejected = false;
    raise = kRaise;
    if (gained <= enough) {
      outcome.converged = true;
      return outcome;
    }
    if (evaluations_ >= last || !CostAndDerivatives(outcome.x, cost)) return outcome;
  }
}

std::optional<Vector> LocalFit::CurvedStep(const Vector& x, const Vector& step, double damping) {
  const Vector near = x + kCurvatureStep * step;
  ++evaluations_;
  if (!least_squares_.Evaluate(near, workspace_, residuals_, nullptr)) return std::nullopt;
  const Vector curvature =
      2 / kCurvatureStep * ((residuals_ - at_x_) / kCurvatureStep - jacobian_.Times(step, at_x_.size()));
  auto half = equations_.Acceleration(x, step, damping, jacobian_.TransposedTimes(curvature, x.size()));
  if (half) *half += step;
  return half;
}

}  // namespace sinew::solvers
