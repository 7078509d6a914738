// Where the sole of a foot is: its plane from the floor under the flat foot, its outline from markers and the
// path of the centre of pressure.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "problems/contact/soles/plate_foot.h"
#include "problems/contact/soles/plate_record.h"

namespace sinew {

/// Margins and proportions of a sole.
struct SoleRules {
  /// A marker's centre stands off the skin by its radius (7 mm) and its base (3 mm) [m].
  static constexpr double kMarkerStandOff = 0.01;
  /// From the centre of pressure of a foot that just touches to the end of its sole [m].
  static constexpr double kBeyondCop = 0.015;
  /// The centre of pressure lies at least so far inside a region's sides [m].
  static constexpr double kInsideSides = 0.01;
  /// Of the length of a foot: means of 6068 people (Gordon et al. 2014, 2012 Anthropometric Survey of U.S.
  /// Army Personnel, NATICK/TR-15/007: foot 263 mm, ball of foot length 195 mm, breadth 99 mm, heel 71 mm).
  static constexpr double kBall = 0.740;
  static constexpr double kBreadth = 0.376;
  static constexpr double kHeelBreadth = 0.269;
  /// Springs per length of the sole.
  static constexpr int kSpringsAlong = 20;
};

/// A foot is looked at for being flat above this share of its largest load.
inline constexpr double kFlatShare = 0.3;

enum class SoleEnd { kMarker, kCop, kRatio };
enum class SoleWidth { kMarkers, kRatio, kCop };

/// A rectangle of the sole, in the frame of its body.
struct SolePatch {
  int body = 0;                  ///< index of the model
  Vec3 forward = Vec3::UnitX();  ///< unit, along the foot
  Vec3 up = Vec3::UnitY();       ///< unit, out of the floor into the foot, perpendicular to `forward`
  double offset = 0;             ///< up . x of the plane [m]
  double back = 0;               ///< its ends along `forward` from the body's origin [m]
  double front = 0;
  double middle = 0;  ///< along `forward` x `up` from the body's origin [m]
  double width = 0;   ///< [m]
  SoleWidth width_from = SoleWidth::kRatio;

  [[nodiscard]] Vec3 side() const { return forward.cross(up); }
  /// In the frame of its body [m].
  [[nodiscard]] Vec3 centre() const { return 0.5 * (back + front) * forward + offset * up + middle * side(); }
};

/// How steadily a body stood on the floor.
struct FlatStand {
  int frames = 0;
  double tilt = 0;            ///< between `up` and the nearest axis of the body [rad]
  double tilt_scatter = 0;    ///< root mean square over the frames [rad]
  double height_scatter = 0;  ///< robust standard deviation of the floor's height [m]
  double turning = 0;         ///< median angular velocity [rad/s]
};

struct FootEstimate {
  std::vector<int> bodies;          ///< of the model, from the heel outwards
  std::vector<std::string> trials;  ///< stances it is estimated from
  FlatStand flat;
  FlatStand toes_flat;      ///< of the last body, if there are several
  bool toes_alone = false;  ///< it has a plane of its own
  SoleEnd heel_from = SoleEnd::kMarker;
  SoleEnd tip_from = SoleEnd::kMarker;
  SoleEnd ball_from = SoleEnd::kRatio;  ///< kMarker: the joint of the last body
  double length = 0;                    ///< [m]
  std::vector<SolePatch> patches;       ///< rearfoot, forefoot, toes
};

/// @param records of this foot's stances, at least one; @param bodies the foot's, from the heel outwards
/// @param markers, points see MarkersOfBodies and PointsOfBodies
/// Errors: too few frames with load; nothing that says how long the foot is.
Result<FootEstimate> EstimateFoot(const std::vector<const PlateRecord*>& records,
                                  const std::vector<int>& bodies, const BodyPoints& markers,
                                  const BodyPoints& points, double floor_height);

/// Whether the centre of pressure moves across a foot rather than along it: by more than 45 degrees from its
/// long axis, and by more than a fifth of its length.
[[nodiscard]] bool CopMovesAcross(const PlateRecord& record, const FootEstimate& foot);

/// Direction of the foot, ground axes, horizontal, in the middle of the stance.
[[nodiscard]] Vec3 ForwardOf(const PlateRecord& record, const FootEstimate& foot);

/// Frames of the loaded foot in which a body turns slowest: a quarter of those with more than the given share
/// of the largest load, at least four.
[[nodiscard]] std::vector<std::size_t> FlatFrames(const PlateRecord& record, int body, double share);

}  // namespace sinew
