#include "problems/ankle_on_dynamometer/unknown_terms.h"

#include <algorithm>

namespace sinew {
namespace {

// Wider, random points of the box have no equilibrium of foot and plate.
constexpr double kMomentReach = 10;  // [N m]
constexpr double kShareReach = 0.5;

struct SignalName {
  const char* name;
  const char* unit;
};
constexpr SignalName kOfMoment[kMomentSignals] = {
    {"ankle_angle", "rad"}, {"ankle_velocity", "rad/s"}, {"mean_activation", "1"}, {"time", "s"}};
constexpr SignalName kOfActivation[kActivationSignals] = {
    {"time", "s"}, {"machine_angle", "rad"}, {"excitation", "1"}};

std::vector<double> Evenly(SignalRange range, std::size_t count) {
  constexpr double kLeast = 1e-3;
  const double middle = 0.5 * (range.lowest + range.highest);
  const double half = 0.5 * std::max(kLeast, range.highest - range.lowest);
  std::vector<double> knots;
  for (std::size_t k = 0; k < count; ++k)
    knots.push_back(middle + half * (2 * static_cast<double>(k) / static_cast<double>(count - 1) - 1));
  return knots;
}

}  // namespace

UnknownTermKnots KnotsOver(const AnkleRanges& ranges, std::size_t muscles) {
  UnknownTermKnots knots;
  const SignalRange of_moment[kMomentSignals] = {
      ranges.ankle_angle, ranges.ankle_velocity, {0, ranges.mean_activation}, {0, ranges.duration}};
  for (std::size_t i = 0; i < kMomentSignals; ++i) knots.moment[i] = Evenly(of_moment[i], kMomentKnots);
  for (std::size_t m = 0; m < muscles; ++m) {
    const double largest = m < ranges.excitation.size() ? ranges.excitation[m] : 1;
    const SignalRange of_activation[kActivationSignals] = {
        {0, ranges.duration}, ranges.machine_angle, {0, largest}};
    ActivationKnots own;
    for (std::size_t i = 0; i < kActivationSignals; ++i) own[i] = Evenly(of_activation[i], kActivationKnots);
    knots.activation.push_back(std::move(own));
  }
  return knots;
}

void AddMomentPort(const UnknownTermKnots& knots, bool muscles, int first_slot, ParameterListBuilder& add) {
  add.BeginPort("ankle_moment", "N*m", "an unknown moment acts on the ankle");
  for (std::size_t i = 0; i < kMomentSignals; ++i) {
    if (!muscles && i == static_cast<std::size_t>(MomentSignal::kActivation)) continue;
    add.Term(kOfMoment[i].name, kOfMoment[i].unit, knots.moment[i], -kMomentReach, kMomentReach,
             "unknown moment at the ankle", first_slot + static_cast<int>(i * kMomentKnots));
  }
}

void AddActivationPort(const ActivationKnots& knots, const std::string& muscle, int first_slot,
                       ParameterListBuilder& add) {
  add.BeginPort("activation." + muscle, "1", "an unknown share is added to the activation of " + muscle);
  for (std::size_t i = 0; i < kActivationSignals; ++i)
    add.Term(kOfActivation[i].name, kOfActivation[i].unit, knots[i], -kShareReach, kShareReach,
             "unknown share of the activation of " + muscle,
             first_slot + static_cast<int>(i * kActivationKnots));
}

}  // namespace sinew
