// Unknown terms of the ankle on a dynamometer: curves of one signal that are added where the model may lack
// something, a moment about the ankle and a share of each muscle's activation. An unknown torque of the
// machine is a curve that is added to machine_torque (ReadingPort): the plate's motion is prescribed, so that
// nothing else follows from it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include "base/linear_curve.h"
#include "models/dynamometer/unknown_moment.h"
#include "problems/kit/parameter_list.h"

namespace sinew {

/// What the unknown share of a muscle's activation may depend on.
enum class ActivationSignal {
  kTime,          ///< since the trial began [s]
  kMachineAngle,  ///< [rad]
  kExcitation,    ///< of that muscle, as it acts: filtered and late [1]
  kCount
};
inline constexpr std::size_t kActivationSignals = static_cast<std::size_t>(ActivationSignal::kCount);
/// Few, because there is a curve of every signal for every muscle: what changes the force of one muscle
/// within a trial is seldom more than a bend.
inline constexpr std::size_t kActivationKnots = 4;
using ActivationKnots =
    std::array<std::vector<double>, kActivationSignals>;  ///< [signals][kActivationKnots, increasing]

/// What signals span in the trials.
struct SignalRange {
  double lowest = 0;
  double highest = 1;
};

/// The knots of all curves: evenly over what the signals span in all trials.
struct UnknownTermKnots {
  MomentKnots moment;
  std::vector<ActivationKnots> activation;  ///< [muscles]
};

struct AnkleRanges {
  SignalRange ankle_angle{-0.8, 0.6};    ///< [rad]
  SignalRange ankle_velocity{-3, 3};     ///< [rad/s]
  SignalRange machine_angle{-0.8, 0.6};  ///< [rad]
  double duration = 10;                  ///< of the longest trial [s, > 0]
  double mean_activation = 1;            ///< largest [> 0]
  std::vector<double> excitation;        ///< largest of each muscle [> 0]; empty: 1
};

/// Ranges without extent are widened to a thousandth.
[[nodiscard]] UnknownTermKnots KnotsOver(const AnkleRanges& ranges, std::size_t muscles);

/// Adds the port ankle_moment with its terms. @param first_slot of its weights [signals x kMomentKnots]
void AddMomentPort(const UnknownTermKnots& knots, bool muscles, int first_slot, ParameterListBuilder& add);

/// Adds the port activation.MUSCLE with its terms. @param first_slot of its weights [signals x
/// kActivationKnots]
void AddActivationPort(const ActivationKnots& knots, const std::string& muscle, int first_slot,
                       ParameterListBuilder& add);

/// True for 0 without derivatives.
template <class T>
[[nodiscard]] bool IsAlwaysZero(const T& x) {
  if constexpr (!std::is_same_v<T, double>) {
    for (const double slope : x.d) {
      if (slope != 0) return false;
    }
  }
  return Value(x) == 0;
}

/// Whether any of some weights is not 0.
template <class T>
[[nodiscard]] bool AnyActs(const T* weights, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    if (!IsAlwaysZero(weights[k])) return true;
  }
  return false;
}

/// The moment's curves from their weights [signals x kMomentKnots]. @param knots must outlive it
template <class T>
[[nodiscard]] UnknownMoment<T> MomentOf(const MomentKnots& knots, const T* weights) {
  UnknownMoment<T> moment;
  moment.knots = &knots;
  for (std::size_t i = 0; i < kMomentSignals; ++i) {
    for (std::size_t k = 0; k < kMomentKnots; ++k) moment.weights[i][k] = weights[i * kMomentKnots + k];
    moment.acts[i] = AnyActs(moment.weights[i].data(), kMomentKnots);
  }
  return moment;
}

/// The unknown share of a muscle's activation: its activation is multiplied by one plus this.
/// @param weights [signals x kActivationKnots]
template <class T>
class UnknownShare {
 public:
  UnknownShare(const ActivationKnots& knots, const T* weights) : knots_(knots), weights_(weights) {
    for (std::size_t i = 0; i < kActivationSignals; ++i)
      acts_[i] = AnyActs(weights + i * kActivationKnots, kActivationKnots);
  }
  [[nodiscard]] bool acts() const { return acts_[0] || acts_[1] || acts_[2]; }
  [[nodiscard]] T At(double time, double machine_angle, const T& excitation) const {
    T sum(0.0);
    const auto add = [&](ActivationSignal signal, const auto& x) {
      const auto i = static_cast<std::size_t>(signal);
      if (acts_[i]) sum += LinearCurveAt(knots_[i], weights_ + i * kActivationKnots, x);
    };
    add(ActivationSignal::kTime, time);
    add(ActivationSignal::kMachineAngle, machine_angle);
    add(ActivationSignal::kExcitation, excitation);
    return sum;
  }

 private:
  const ActivationKnots& knots_;
  const T* weights_;
  std::array<bool, kActivationSignals> acts_{};
};

}  // namespace sinew
