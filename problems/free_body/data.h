// The recorded tosses as the problem uses them: frames with a pose, windows, and what is left out.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "identify/layout.h"
#include "problems/free_body/flight.h"
#include "problems/free_body/settings.h"

namespace sinew {

/// Frames that determine a state well.
constexpr int kMinInFlight = 4;

/// Consecutive frames of a toss that are simulated from a state of their own.
struct TossWindow {
  int toss = 0;
  int first = 0;              ///< frame of the toss
  std::vector<double> times;  ///< [N] of its frames [s]
  int in_flight = 0;          ///< so many frames from the first on fall freely
  FlightStart guess;          ///< from its first two frames
};

/// Frames before the first touch have channels of their own: there the model is certain and only the camera
/// errs, after it every small error grows.
enum TossPhase { kFlight, kContact, kTossPhases };

struct Toss {
  std::string trial;
  std::vector<double> times;   ///< [N, s] from the release until the body is at rest
  std::vector<Pose> poses;     ///< [N] quaternions of unit length that do not change sign
  std::vector<double> height;  ///< [N] of the lowest corner over the table [m]
  int in_flight = 0;           ///< so many frames from the first on are before the first touch
  int compared = 0;            ///< so many frames from the first on are within the horizon
  int first_block = 0;         ///< of the layout; kPoseChannels per phase, in the order of a Pose

  [[nodiscard]] TossPhase PhaseOf(int frame) const { return frame < in_flight ? kFlight : kContact; }
};

struct FreeBodyData {
  FreeBody body;
  std::vector<Toss> tosses;
  std::vector<TossWindow> windows;
  Layout layout;  ///< kTossPhases * kPoseChannels blocks per toss
  std::array<std::array<double, kPoseChannels>, kTossPhases> weight{};
  double speed = 1;  ///< highest between two frames [m/s]
  std::vector<std::string> notes;
};

[[nodiscard]] std::string DescribeFreeBodyChannels();

/// The channels of a pose, in its order.
extern const std::array<const char*, kPoseChannels> kPoseNames;

/// Angle between two orientations [rad].
[[nodiscard]] double AngleBetween(const Pose& a, const Pose& b);

/// From the state at the first frame and the difference to the second.
/// @param times, poses [>= 2]
[[nodiscard]] FlightStart GuessStart(const FreeBody& body, const std::vector<double>& times,
                                     const Pose* poses);

/// Errors: a channel that is missing or on another grid, a quaternion that is none, too few frames, with the
/// trial's name; no trial.
Result<FreeBodyData> PrepareFreeBodyData(const Dataset& data, const FreeBodySettings& settings);

}  // namespace sinew
