#include "problems/contact/steps/body_load.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "problems/contact/load/plate_samples.h"
#include "problems/contact/stance.h"
#include "problems/contact/stance_notes.h"
#include "problems/whole_body_dynamics.h"

namespace sinew {
namespace {

// A vector channel at the stance's times, before and after the plate's record as at its ends (there are
// instants beside it for late sensors); nothing if the trial lacks it or has a gap.
std::optional<std::vector<Vec3>> VectorAt(const Trial& trial, const std::string& name, const Stance& stance) {
  const auto [begin, end] = stance.recorded;
  std::vector<Vec3> values(stance.time.size());
  for (int axis = 0; axis < 3; ++axis) {
    const auto found = trial.Find(name + "_" + "xyz"[axis]);
    if (!found) return {};
    for (std::size_t t = 0; t < stance.time.size(); ++t)
      values[t][axis] = ValueAt(*found.grid, *found.channel, std::clamp(stance.time[t], begin, end));
  }
  const auto known = [](const Vec3& value) { return value.allFinite(); };
  if (!std::all_of(values.begin(), values.end(), known)) return {};
  return values;
}

// The springs of the regions that are not on this stance's foot, in ground [T][springs, m].
Result<std::vector<std::vector<Vec3>>> OtherFoot(const Stance& stance, const CoordinateTrajectory& motion,
                                                 const MultibodyModel& model, const std::vector<int>& bodies,
                                                 const ContactSettings& settings) {
  std::vector<int> of_region;
  std::vector<const ContactRegion*> regions;
  for (std::size_t r = 0; r < bodies.size(); ++r) {
    const auto& own = stance.foot.indices;
    if (std::find(own.begin(), own.end(), bodies[r]) != own.end()) continue;
    of_region.push_back(bodies[r]);
    regions.push_back(&settings.regions[r].region);
  }
  std::vector<std::vector<Vec3>> springs(regions.empty() ? 0 : stance.time.size());
  if (regions.empty()) return springs;
  SINEW_ASSIGN(const auto motions, model.BodyMotions(stance.time, motion, of_region));
  for (std::size_t t = 0; t < motions.size(); ++t) {
    for (std::size_t r = 0; r < regions.size(); ++r) {
      const BodyMotion& body = motions[t][r];
      for (const int face : regions[r]->SpringFaceIndices())
        springs[t].emplace_back(
            body.position +
            body.rotation * (regions[r]->position + regions[r]->rotation * regions[r]->mesh.Centre(face)));
    }
  }
  return springs;
}

// The middle of the springs that are lowest, on the floor.
Vec3 Standing(const std::vector<Vec3>& springs, double length, double floor_height) {
  constexpr double kNear = 0.05;  // of the sole's length over the lowest one
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vec3& spring : springs) lowest = std::min(lowest, spring.y());
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (const Vec3& spring : springs) {
    if (spring.y() > lowest + kNear * length) continue;
    sum += spring;
    count += 1;
  }
  sum /= count;
  sum.y() = floor_height;
  return sum;
}

}  // namespace

double BodyLoad::ShareAt(double time, SupportPhase of) const {
  const auto first = static_cast<std::size_t>(2 * of);
  const double length = span[first + 1] - span[first];
  return length > 0 ? std::clamp((time - span[first]) / length, 0.0, 1.0) : 0.5;
}

Result<std::optional<BodyLoad>> MeasuredBodyLoad(const Trial& trial, const Stance& stance,
                                                 const CoordinateTrajectory& motion,
                                                 const MultibodyModel& model, const std::vector<int>& bodies,
                                                 const ContactSettings& settings, StanceNotes& notes) {
  constexpr double kAround = 0.02;  // [s]
  const std::optional<BodyLoad> none;
  const auto force = VectorAt(trial, kWholeBodyForce, stance);
  const auto moment = VectorAt(trial, kWholeBodyMoment, stance);
  const auto mass_centre = VectorAt(trial, kMassCentre, stance);
  if (!force || !moment || !mass_centre) return none;
  const auto unusable = [&](const char* why) {
    notes.NoBodyLoad(stance, why);
    return none;
  };
  SINEW_ASSIGN(const auto other, OtherFoot(stance, motion, model, bodies, settings));
  if (other.empty()) return unusable("no region of another foot tells when it touches");

  // The body moves over a foot that stands.
  const auto [first, last] = stance.RecordedInstants();
  Vec3 forward =
      (mass_centre->back() - stance.foot.centre[last]) - (mass_centre->front() - stance.foot.centre[first]);
  forward.y() = 0;
  if (!(forward.norm() > 0)) return unusable("the body does not move over the foot");
  forward.normalize();
  std::size_t leaves = 0;
  std::size_t lands = 0;
  double farthest_behind = std::numeric_limits<double>::infinity();
  double farthest_ahead = -farthest_behind;
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    if (stance.time[t] < stance.loaded[0] || stance.time[t] > stance.loaded[1]) continue;
    double toe = -std::numeric_limits<double>::infinity();
    double heel = -toe;
    for (const Vec3& spring : other[t]) {
      const double ahead = forward.dot(spring - (*mass_centre)[t]);
      toe = std::max(toe, ahead);
      heel = std::min(heel, ahead);
    }
    if (toe < farthest_behind) farthest_behind = toe, leaves = t;
    if (heel > farthest_ahead) farthest_ahead = heel, lands = t;
  }
  const double single_from = stance.time[leaves] + kAround;
  const double single_to = stance.time[lands] - kAround;
  if (!(single_to > single_from)) return unusable("the other foot does not swing past this one");

  BodyLoad load;
  load.force = *force;
  load.span = {stance.loaded[0], single_from, single_from, single_to, single_to, stance.loaded[1]};
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    const double time = stance.time[t];
    load.phase.push_back(time < single_from ? kFirstDouble : time <= single_to ? kSingle : kSecondDouble);
    Vec3 about = stance.foot.centre[t];
    about.y() = settings.floor.height;
    if (load.phase.back() != kSingle) about = Standing(other[t], stance.length, settings.floor.height);
    load.about.push_back(about);
    load.moment.emplace_back((*moment)[t] - about.cross((*force)[t]));
  }
  return std::optional(std::move(load));
}

}  // namespace sinew
