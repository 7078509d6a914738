// The Simbody system of an OpenSim model. Internal to models/: it shows Simbody, whose headers are heavy.
#pragma once

#include <Simbody.h>

#include <memory>
#include <string>
#include <vector>

#include "models/multibody/osim_model.h"

namespace sinew {

inline SimTK::Vec3 ToSimbody(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Vec3 FromSimbody(const SimTK::Vec3& v) {
  return {v[0], v[1], v[2]};
}
Mat3 FromSimbody(const SimTK::Mat33& m);

/// Bodies with their joints, couplers and gravity. Coordinates are numbered in the file's order of joints,
/// bodies in the file's order after ground, which is body 0. Forces may be added until the topology is
/// realized.
struct SimbodyModel {
  struct Coordinate {
    OsimCoordinate description;
    SimTK::MobilizedBodyIndex body;
    SimTK::MobilizerQIndex q;  ///< generalized speed u of the same number is its rate
    bool on_ground = false;    ///< its joint's parent is ground
  };
  /// dependent = function(independent); ordered so that an independent coordinate is settled before it is
  /// used.
  struct Coupler {
    int independent = 0;
    int dependent = 0;
    PiecewisePolynomial function;
  };
  struct Marker {
    std::string name;
    SimTK::MobilizedBodyIndex body;
    SimTK::Vec3 location;
  };

  std::string name;
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  std::vector<std::string> body_names;
  std::vector<SimTK::MobilizedBodyIndex> bodies;  ///< as body_names
  std::vector<Coordinate> coordinates;
  std::vector<Coupler> couplers;
  std::vector<Marker> markers;
  double total_mass_kg = 0;
  std::vector<std::string> notes;  ///< what was changed to make the model physically possible
};

/// Errors: a body with no joint or with two, a loop of joints, couplers that depend on each other in a
/// circle, a body that a joint or marker names and the model lacks.
Result<std::unique_ptr<SimbodyModel>> BuildSimbodyModel(const OsimModel& model);

}  // namespace sinew
