#include "identify/uncertainty/profile_end.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.h"
#include "identify/solvers/box_minimum.h"

namespace sinew::uncertainty {
namespace {

// Distances that are tried within one model, and what is left of the rise between the last one and the end.
// Half of it is the error of the end.
constexpr int kMaxDistances = 25;
constexpr double kModelTolerance = 1e-4;
constexpr double kRiseTolerance = 5e-4;
// A point is an end if the others' next step would gain less than this share of the rise.
constexpr double kGainLeft = 1e-3;
// A point with a rise of more than kLargestRise times the allowed one is rejected: its model would be one of
// another place. Below kGoodRise the model was right.
constexpr double kLargestRise = 1.5;
constexpr double kGoodRise = 1.2;
// Of the others' columns, scaled to unit length; tenfold after each rejection, a tenth after each good step.
// Where damping is no help, because it is the held value that moved too far, steps are halved, too.
constexpr double kFirstDamping = 1e-3;
constexpr double kSmallestDamping = 1e-5;
constexpr double kShorteningDamping = 0.1;
constexpr double kLargestDamping = 1e4;
// Kinks (a muscle's fibre at its shortest, a contact that opens) keep steps from ending. The search stops
// when kPatience points have moved the end by less than kWorthwhile of its distance.
constexpr double kWorthwhile = 0.005;
constexpr int kPatience = 8;
// Then there must be one with about the allowed rise, nearly as far away as the farthest. Where the cost
// jumps beside the minimum, all points are too high, and their heights tell no distance.
constexpr double kLeastHeight = 0.9;
constexpr double kLargestHeight = 1.05;
constexpr double kNearlyAsFar = 0.9;
// Share of the way from the minimum to the end at which a search goes on that was too high to go on.
constexpr double kRetreat = 0.95;

/// The question in distances from the minimum, and the search within one model.
class Search {
 public:
  explicit Search(const EndQuestion& question)
      : q_(question),
        held_(question.request.variable),
        rise_(question.request.rise),
        room_(question.sign > 0 ? 1 - question.minimum[held_] : question.minimum[held_]) {}

  [[nodiscard]] double room() const { return room_; }
  [[nodiscard]] double DistanceOf(const Vector& x) const { return q_.sign * (x[held_] - q_.minimum[held_]); }
  [[nodiscard]] double At(double distance) const {
    return std::clamp(q_.minimum[held_] + q_.sign * distance, 0.0, 1.0);
  }

  /// The model's end: moves x [n], whose cost is given, there. @return false if the model has none.
  bool ModelEnd(const solvers::BoxQuadraticModel& model, double cost, double damping, double first,
                Vector& x) const {
    solvers::BoxMinimum minimum(model, x, held_, damping);
    Vector step = Vector::Zero(x.size());
    double inside = 0;
    double outside = kInfinity;
    double distance = std::min(first, room_);
    for (int i = 0; i < kMaxDistances; ++i) {
      step[held_] = At(distance) - x[held_];
      const double now = cost + minimum.Find(step, kModelTolerance * rise_) - q_.cost;
      const double height = std::sqrt(std::max(now / rise_, 0.0));
      const bool narrow = std::isfinite(outside) && outside - inside <= kRiseTolerance * outside;
      const bool done =
          narrow || std::abs(now - rise_) <= kRiseTolerance * rise_ || (now < rise_ && distance >= room_);
      if (done) {
        x = (x + step).cwiseMax(0).cwiseMin(1);
        x[held_] = At(distance);
        return true;
      }
      (now < rise_ ? inside : outside) = distance;
      // Newton on the height, which is linear in the distance where no bound is reached.
      const double slope = q_.sign * minimum.slope() / (2 * std::max(height, 1e-3) * rise_);
      double next = slope > 0 ? distance + (1 - height) / slope : kInfinity;
      if (std::isinf(outside)) {
        next = std::min({std::max(next, 1.05 * distance), 4 * distance, room_});
      } else if (!(next > inside && next < outside)) {
        next = 0.5 * (inside + outside);
      }
      if (!(std::abs(next - distance) > 0)) return false;
      distance = next;
    }
    return false;
  }

  [[nodiscard]] double GainOfOthers(const solvers::BoxQuadraticModel& model, const Vector& x) const {
    Vector step = Vector::Zero(x.size());
    return -solvers::BoxMinimum(model, x, held_).Find(step, kModelTolerance * rise_);
  }

 private:
  const EndQuestion& q_;
  int held_;
  double rise_;
  double room_;
};

}  // namespace

std::optional<ProfileEnd> FindEnd(solvers::LocalFit& fit, const EndQuestion& question, LowestCost& lowest) {
  const Search search(question);
  const double rise = question.request.rise;
  if (search.room() <= 0) return ProfileEnd{search.At(0), true, ProfileFailure::kNone};
  const long last = fit.evaluations() + question.max_evaluations;
  const solvers::BoxQuadraticModel* model = &question.model;
  Vector x = question.minimum;
  double cost = question.cost;
  double first = question.request.step;
  solvers::BoxQuadraticModel kept;
  double damping = 0;
  double farthest = 0;
  double farthest_at_rise = 0;
  double share = 1;  // of the model's step
  int idle = 0;
  while (fit.evaluations() < last) {
    if (question.interrupt != nullptr && question.interrupt->load(std::memory_order_relaxed))
      return std::nullopt;
    Vector next = x;
    if (!search.ModelEnd(*model, cost, damping, first, next)) {
      // Too high for its own damped model: back towards the minimum, on which way the cost falls.
      const double above = std::sqrt(std::max(cost - question.cost, 0.0) / rise);
      if (!(above > 1)) return std::nullopt;
      next = question.minimum + (x - question.minimum) * (kRetreat / above);
    } else if (share < 1) {
      next = x + share * (next - x);
    }
    double after = kInfinity;
    if (const Result<double> found = fit.ModelAt(next); found) after = *found;
    if (farthest > 0 && ++idle > kPatience) {
      if (farthest_at_rise < kNearlyAsFar * farthest) return std::nullopt;
      return ProfileEnd{search.At(farthest), false, ProfileFailure::kNone};
    }
    if (!(after <= question.cost + kLargestRise * rise)) {
      damping = std::max(10 * damping, kFirstDamping);
      if (damping > kShorteningDamping) share *= 0.5;
      if (damping > kLargestDamping) return std::nullopt;
      continue;
    }
    const double root = std::sqrt(std::max(after - question.cost, 0.0) / rise);
    if (search.DistanceOf(next) / std::max(root, 1.0) > (1 + kWorthwhile) * farthest) {
      farthest = search.DistanceOf(next) / std::max(root, 1.0);
      idle = 0;
    }
    if (root >= kLeastHeight && root <= kLargestHeight)
      farthest_at_rise = std::max(farthest_at_rise, search.DistanceOf(next));
    if (after < lowest.cost) lowest = {after, next};
    damping =
        after <= question.cost + kGoodRise * rise ? (damping > kSmallestDamping ? damping / 10 : 0) : damping;
    share = 1;
    x = std::move(next);
    cost = after;
    kept = fit.model();
    model = &kept;
    first = std::max(search.DistanceOf(x), question.end_tolerance * question.request.step);
    // The bound is an end as soon as some point on it is good enough.
    if (search.DistanceOf(x) >= search.room() && cost <= question.cost + rise)
      return ProfileEnd{x[question.request.variable], true, ProfileFailure::kNone};
    const double height = std::sqrt(std::max(cost - question.cost, 0.0) / rise);
    if (std::abs(height - 1) <= question.end_tolerance && search.GainOfOthers(*model, x) <= kGainLeft * rise)
      return ProfileEnd{x[question.request.variable], false, ProfileFailure::kNone};
  }
  return std::nullopt;
}

std::optional<Vector> LinearEnd(const EndQuestion& question) {
  const Search search(question);
  if (search.room() <= 0) return question.minimum;
  Vector x = question.minimum;
  if (!search.ModelEnd(question.model, question.cost, 0, question.request.step, x)) return std::nullopt;
  return x;
}

}  // namespace sinew::uncertainty
