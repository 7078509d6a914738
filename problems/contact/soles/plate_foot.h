// Which foot stands on a plate, and plates on which none does.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_model.h"
#include "problems/contact/soles/body_tree.h"
#include "problems/contact/soles/plate_record.h"

namespace sinew {

enum class PlateFault {
  kNone,
  kNotLoaded,     ///< its force never exceeds a twentieth of body weight
  kPartial,       ///< the record begins or ends within all of its stances
  kUpsideDown,    ///< its vertical force points down
  kNoFoot,        ///< its centre of pressure is away from every body
  kTurned,        ///< its centre of pressure follows a foot if its axes are exchanged or reversed
  kMillimetres,   ///< its centre of pressure follows a foot if it is divided by 1000
  kTwoFeet,       ///< its centre of pressure is under another foot for a part of the time
  kCopAcross,     ///< its centre of pressure moves across the foot, not along it
  kForceAcross,   ///< its horizontal force brakes and drives across the foot
  kForceReversed  ///< its horizontal force drives at first and brakes later
};

/// "upside_down", ...; "" of kNone.
[[nodiscard]] const char* ToString(PlateFault fault);

/// Points of bodies, in their frames [m].
using BodyPoints = std::vector<std::vector<Vec3>>;

/// [bodies of the model][markers] that some trial has measured (NAME_x, ...).
[[nodiscard]] BodyPoints MarkersOfBodies(const OsimModel& model, const MultibodyModel& multibody,
                                         const Dataset& data);

/// [bodies of the model][points]: those markers and the bodies' own points.
[[nodiscard]] BodyPoints PointsOfBodies(const OsimModel& model, const MultibodyModel& multibody,
                                        const BodyPoints& markers);

struct PlateFoot {
  PlateFault fault = PlateFault::kNone;
  int body = -1;        ///< the foot's first body, or the one that comes nearest; index of the model
  int other_body = -1;  ///< of kTwoFeet
  double distance = 0;  ///< of the body from the centre of pressure while the foot is loaded, mean [m]
  double share = 0;     ///< of kTwoFeet: of the frames
  std::string axes;     ///< of kTurned: what x and z are in truth: "z, -x"
};

/// The body nearest to the centre of pressure in the first two fifths of the loaded time, in which a heel
/// strikes; of bodies that are equally near (1 cm) the outermost; the body that it hangs on, if that is
/// nearest for a third of the whole stance (a foot that strikes with its toes). Without a centre of pressure
/// the body whose points are lowest on average.
/// @param body_weight [N]; @param floor_height [m]
[[nodiscard]] PlateFoot FindFoot(const PlateRecord& record, const BodyTree& tree, const BodyPoints& points,
                                 double body_weight, double floor_height);

/// How the horizontal force changes while a foot is loaded: a foot brakes first and drives later.
/// @param forward of the foot, ground axes. @return kForceAcross, kForceReversed or kNone
[[nodiscard]] PlateFault ForceDirectionFault(const PlateRecord& record, const Vec3& forward);

}  // namespace sinew
