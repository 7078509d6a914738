#include "models/muscle/elastic_tendon.h"

#include <algorithm>

namespace sinew::elastic_tendon {
namespace {

constexpr int kMaxIterations = 100;
constexpr double kTolerance = 1e-14;  // of the optimal length
// Newton's method alone: after so small a step the next one would be far below rounding, and after so few
// iterations with steps no longer than these it has found the equilibrium that belongs to the guess.
constexpr int kQuickIterations = 6;
constexpr double kQuickTolerance = 1e-9;  // of the optimal length
constexpr double kQuickStep = 0.1;        // of the optimal length
constexpr double kSlack = 0.5;            // optimal lengths by which the tendon hangs, at first
constexpr double kMaxSlack = 64;

}  // namespace

PlainSearch::PlainSearch(const MuscleCurves& curves, const HillMuscle<double>& muscle)
    : curves_(curves), muscle_(muscle) {
  sine_ = std::sin(muscle.pennation);
  thickness_ = muscle.optimal_length * sine_;
  per_length_ = 1 / muscle.optimal_length;
  per_speed_ = per_length_ / muscle.largest_velocity;
  strength_ = muscle.isometric_force * muscle.strength;
  hold_ = kHold * strength_ * per_length_;
}

double PlainSearch::At(double length) {
  const double sine = thickness_ / length;
  double cosine = std::sqrt(1 - kLargestSine * kLargestSine);
  double bend = 0;  // slope of the cosine
  if (sine < kLargestSine) {
    cosine = std::sqrt(1 - sine * sine);
    bend = sine * sine / (length * cosine);
  }
  const double stretch = length * per_length_;
  const double speed = (velocity_.rate * length + velocity_.past) * per_speed_;
  const auto active = curves_.active_force_length.At(stretch * per_optimal_);
  const auto moving = curves_.force_velocity.At(speed);
  const auto passive = curves_.passive_force_length.At(stretch);
  const double gain = activation_ * muscle_.active_gain;
  const double by_speed = velocity_.rate * per_speed_;
  const double fibre =
      strength_ * (active.value * moving.value * gain + passive.value + muscle_.damping * speed);
  const double fibre_slope =
      strength_ *
      ((active.slope * per_length_ * per_optimal_ * moving.value + active.value * moving.slope * by_speed) *
           gain +
       passive.slope * per_length_ + muscle_.damping * by_speed);
  const double per_strain = 1 / (muscle_.tendon_slack_length * muscle_.compliance);
  const auto tendon = curves_.tendon_force_strain.At(
      (unit_length_ - length * cosine - muscle_.tendon_slack_length) * per_strain);
  slope_ = fibre_slope * cosine + fibre * bend + hold_ +
           strength_ * tendon.slope * (cosine + length * bend) * per_strain;
  return fibre * cosine + hold_ * (length - rigid_) - strength_ * tendon.value;
}

Partials PlainSearch::PartialsAt(double length) const {
  const double slack = muscle_.tendon_slack_length;
  const Pull pull =
      PullAt(curves_, muscle_, sine_, length, velocity_.rate * length + velocity_.past, activation_);
  const double per_strain = 1 / (slack * muscle_.compliance);
  const double along = unit_length_ - length * pull.cosine;
  const double strain = (along - slack) * per_strain;
  const auto tendon = curves_.tendon_force_strain.At(strain);
  const double by_along = -strength_ * tendon.slope * per_strain;
  // The hold, by the length with a rigid tendon, and that by what it depends on.
  const bool shortest = !(rigid_ > kShortestFibre * muscle_.optimal_length);
  const double rigid_by_free = shortest ? 0 : (unit_length_ - slack) / rigid_;
  const double hold = hold_ * (length - rigid_);
  Partials by;
  by.length = pull.length + pull.velocity * velocity_.rate + hold_ -
              by_along * (pull.cosine + length * pull.cosine_by_length);
  by.velocity = pull.velocity;
  by.activation = pull.activation;
  by.unit_length = by_along - hold_ * rigid_by_free;
  by.optimal_length = pull.optimal_length - hold * per_length_ - (shortest ? hold_ * kShortestFibre : 0);
  by.thickness = pull.thickness - by_along * length * pull.cosine_by_thickness -
                 (shortest ? 0 : hold_ * thickness_ / rigid_);
  by.tendon_slack_length = -by_along * along / slack + hold_ * rigid_by_free;
  by.strength = pull.strength + hold / strength_ - tendon.value;
  by.length_change = pull.length_change;
  by.damping = pull.damping;
  by.largest_velocity = pull.largest_velocity;
  by.compliance = strength_ * tendon.slope * strain / muscle_.compliance;
  by.active_gain = pull.active_gain;
  return by;
}

void PlainSearch::Place(double unit_length, double activation, const FibreVelocity<double>& velocity) {
  unit_length_ = unit_length;
  activation_ = activation;
  velocity_ = velocity;
  per_optimal_ = 1 / (1 + muscle_.length_change * (1 - activation));
  rigid_ = RigidFibreLength(muscle_, sine_, unit_length);
}

Result<double> PlainSearch::Length(double unit_length, double activation,
                                   const FibreVelocity<double>& velocity, double guess) {
  Place(unit_length, activation, velocity);
  const double optimal = muscle_.optimal_length;
  const double low = kShortestFibre * optimal;
  const double high = std::max(rigid_, low) + kSlack * optimal;
  double length = guess;
  for (int i = 0; guess > 0 && i < kQuickIterations && length > low && length < high; ++i) {
    const double step = At(length) / slope_;
    if (!(slope_ > 0) || !(std::abs(step) <= kQuickStep * optimal)) break;
    length -= step;
    if (std::abs(step) <= kQuickTolerance * optimal && length > low && length < high) return length;
  }
  return Safeguarded(guess);
}

// The imbalance is negative for a short fibre, whose tendon is taut, and positive for a long one.
Result<double> PlainSearch::Safeguarded(double guess) {
  const double optimal = muscle_.optimal_length;
  double low = kShortestFibre * optimal;
  double high = std::max(rigid_, low) + kSlack * optimal;
  double imbalance = At(high);
  for (double slack = 2 * kSlack; !(imbalance >= 0) && slack <= kMaxSlack; slack *= 2) {
    low = high;
    high = std::max(rigid_, low) + slack * optimal;
    imbalance = At(high);
  }
  if (!(imbalance >= 0) || (low == kShortestFibre * optimal && !(At(low) <= 0))) {
    return Fail(
        "fibre and tendon find no equilibrium: unit of {:.4g} m, optimal fibre length {:.4g} m, tendon slack "
        "length {:.4g} m, activation {:.3g}",
        unit_length_, optimal, muscle_.tendon_slack_length, activation_);
  }
  double length = guess > low && guess < high ? guess : std::clamp(rigid_, low, high);
  for (int i = 0; i < kMaxIterations; ++i) {
    imbalance = At(length);
    (imbalance < 0 ? low : high) = length;
    double next = length - imbalance / slope_;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double step = std::abs(next - length);
    length = next;
    if (step <= kTolerance * optimal || high - low <= kTolerance * optimal) break;
  }
  return length;
}

}  // namespace sinew::elastic_tendon
