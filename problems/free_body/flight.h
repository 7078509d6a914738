// One window of a toss, integrated: from a state at its begin to the pose at each of its frames.
#pragma once

#include <array>
#include <vector>

#include "base/error.h"
#include "problems/free_body/dynamics.h"

namespace sinew {

/// Where a window begins: the pose as it is recorded, the mass centre's velocity [m/s], the angular velocity
/// in body axes [rad/s].
struct FlightStart {
  Pose pose{};
  Vec3 velocity = Vec3::Zero();
  Vec3 spin = Vec3::Zero();

  /// Moved by [kStartLanes]: place, turn about body axes, velocity, angular velocity.
  [[nodiscard]] FlightStart Moved(const Eigen::Ref<const Vector>& by) const;
  /// By how much this one must be moved to be the other; turns by less than pi.
  [[nodiscard]] Eigen::Matrix<double, kStartLanes, 1> MoveTo(const FlightStart& other) const;
};

struct FlightLimits {
  double accuracy = 1e-8;  ///< of place, speed and turn per step, as shares of the body's size, 1 m/s, 1 rad
  long most_steps = 4000;

  /// Ordinary windows take 3 to 10 steps per frame.
  static FlightLimits For(const FreeBody& body, std::size_t frames) {
    const long by_frames = 300 + 30 * static_cast<long>(frames);
    return {body.accuracy, body.most_steps > 0 ? static_cast<long>(body.most_steps) : by_frames};
  }
};

/// Dormand, Prince 1980, order 5(4). Steps are chosen on plain numbers, so that the values are the same with
/// and without derivatives; every frame ends a step.
/// @tparam P as in FreeBodyDynamics @param variables [kFreeBodySlots] @param start_lane first of kStartLanes
/// lanes of the start, or -1
/// @param times [N, s, increasing] of the frames; the window begins at the first
/// @param poses [N] Errors: too many steps or a state that is not finite, with the time.
template <class T, class P>
Status Fly(const FreeBody& body, const std::array<P, kFreeBodySlots>& variables,
           const std::array<bool, kFreeBodySlots>& used, const FlightStart& start, int start_lane,
           const std::vector<double>& times, const FlightLimits& limits, std::array<T, kPoseChannels>* poses);

}  // namespace sinew
