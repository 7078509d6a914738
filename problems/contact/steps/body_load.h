// What the ground does to the whole body during a stance (`sinew data dynamics`), and which part of it this
// foot alone has to carry.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "problems/contact/settings.h"

namespace sinew {

struct Stance;
class StanceNotes;

/// When a stance begins, when the other foot leaves, when it comes back, and when the stance ends.
enum SupportPhase { kFirstDouble, kSingle, kSecondDouble, kSupportPhases };

struct BodyLoad {
  std::vector<Vec3> force;   ///< [T] of all feet together [N]
  std::vector<Vec3> moment;  ///< [T] of all feet together, about `about` [N m]
  /// [T] In single support the middle of this foot, else where the other foot stands, both on the floor [m]:
  /// about that place the other foot's force has no moment, so that the moment is this foot's alone.
  std::vector<Vec3> about;
  std::vector<SupportPhase> phase;                ///< [T]
  std::array<double, 2 * kSupportPhases> span{};  ///< first and last time of each phase [s]
  /// Share of its phase that has passed at an instant, 0..1.
  [[nodiscard]] double ShareAt(double time, SupportPhase of) const;
};

/// Of a stance whose trial holds the whole body's load; nothing where it does not, or where the other foot's
/// touching cannot be told. The other foot leaves the floor when its foremost spring is farthest behind the
/// mass centre, and comes back when its hindmost one is farthest ahead (Zeni, Richards, Higginson 2008, Gait
/// & Posture 27:710); two hundredths of a second around these events count as double support.
/// @param bodies of settings.regions @param notes is told why, if the load is there and cannot be used
/// Errors: those of MultibodyModel::BodyMotions.
Result<std::optional<BodyLoad>> MeasuredBodyLoad(const Trial& trial, const Stance& stance,
                                                 const CoordinateTrajectory& motion,
                                                 const MultibodyModel& model, const std::vector<int>& bodies,
                                                 const ContactSettings& settings, StanceNotes& notes);

}  // namespace sinew
