#include "problems/contact/soles/belt_velocity.h"

#include <Eigen/Geometry>
#include <cmath>

#include "datasets/robust.h"
#include "problems/contact/motion/foot_markers.h"
#include "problems/contact/settings.h"

namespace sinew {
namespace {

constexpr double kErrors = 3;  // standard errors

// Velocities along x and z of each flat frame.
struct Seen {
  std::vector<double> x;
  std::vector<double> z;
};

Seen ByMarkers(const StandingFoot& standing, const Trial& trial, const OsimModel& model,
               const MultibodyModel& multibody) {
  FootMotion bodies;
  bodies.indices = standing.foot->bodies;
  const std::vector<double>& time = standing.record->time;
  const FootMarkers markers = MeasuredMarkers(trial, model, multibody, bodies, time);
  Seen seen;
  for (const std::size_t t : FlatFrames(*standing.record, standing.foot->bodies.front(), kFlatShare)) {
    if (t == 0 || t + 1 >= time.size()) continue;
    std::vector<double> x;
    std::vector<double> z;
    for (const FootMarkers::Marker& marker : markers.markers) {
      const Vec3 velocity = (marker.measured[t + 1] - marker.measured[t - 1]) / (time[t + 1] - time[t - 1]);
      if (!velocity.allFinite()) continue;
      x.push_back(velocity.x());
      z.push_back(velocity.z());
    }
    if (x.empty()) continue;
    seen.x.push_back(Median(x));
    seen.z.push_back(Median(z));
  }
  return seen;
}

Seen ByBody(const StandingFoot& standing) {
  const SolePatch& rear = standing.foot->patches.front();
  Seen seen;
  for (const std::size_t t : FlatFrames(*standing.record, rear.body, kFlatShare)) {
    const BodyMotion& body = standing.record->motion[t][static_cast<std::size_t>(rear.body)];
    const Vec3 velocity = body.velocity + body.angular_velocity.cross(body.rotation * rear.centre());
    seen.x.push_back(velocity.x());
    seen.z.push_back(velocity.z());
  }
  return seen;
}

}  // namespace

BeltVelocity FindBeltVelocity(const std::vector<StandingFoot>& feet, const Dataset& data,
                              const OsimModel& model, const MultibodyModel& multibody) {
  BeltVelocity belt;
  belt.by_markers = true;
  double squares_x = 0;
  double squares_z = 0;
  for (const StandingFoot& standing : feet) {
    Seen seen = ByMarkers(standing, data.trials.at(standing.record->trial), model, multibody);
    if (seen.x.empty()) {
      seen = ByBody(standing);
      belt.by_markers = false;
    }
    if (seen.x.empty()) continue;
    ++belt.stances;
    belt.found_x += Median(seen.x);
    belt.found_z += Median(seen.z);
    squares_x += std::pow(RobustDeviation(seen.x), 2);
    squares_z += std::pow(RobustDeviation(seen.z), 2);
  }
  if (belt.stances == 0) return belt;
  const double n = belt.stances;
  belt.found_x /= n;
  belt.found_z /= n;
  // Frames of one stance are not independent: a stance counts once.
  belt.error_x = std::sqrt(kStandingFoot * kStandingFoot + squares_x / (n * n));
  belt.error_z = std::sqrt(kStandingFoot * kStandingFoot + squares_z / (n * n));
  if (std::abs(belt.found_x) > kErrors * belt.error_x) belt.x = belt.found_x;
  if (std::abs(belt.found_z) > kErrors * belt.error_z) belt.z = belt.found_z;
  return belt;
}

}  // namespace sinew
