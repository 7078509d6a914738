#include "problems/contact/stance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.h"

namespace sinew {
namespace {

EffectRegion Prepare(const ContactRegion& region, int part, const std::vector<BodyMotion>& motion,
                     const Floor& floor) {
  EffectRegion prepared;
  prepared.part = part;
  prepared.kinematics = ComputeContactKinematics(region, motion, floor);
  for (const BodyMotion& body : motion) {
    prepared.turning_x.push_back(body.angular_velocity.x());
    prepared.turning_z.push_back(body.angular_velocity.z());
  }
  const std::vector<double>& depth = prepared.kinematics.depth;
  for (auto first = depth.begin(); first != depth.end(); first += prepared.kinematics.faces)
    prepared.deepest.push_back(*std::max_element(first, first + prepared.kinematics.faces));
  return prepared;
}

// The foremost and the hindmost region of a foot along a direction.
struct Ends {
  Vec3 direction;
  std::array<int, 2> region{};                      // foremost, hindmost: index into the stance's regions
  std::array<double, 2> at{-kInfinity, kInfinity};  // [m] along the direction

  [[nodiscard]] double length() const { return at[0] - at[1]; }
};

Ends FindEnds(const std::vector<const ContactRegion*>& regions,
              const std::vector<std::vector<BodyMotion>>& motions, std::size_t instant,
              const Vec3& direction) {
  Ends ends;
  ends.direction = direction;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const ContactRegion& region = *regions[r];
    const BodyMotion& body = motions[r][instant];
    for (const int face : region.SpringFaceIndices()) {
      for (const int corner : region.mesh.faces[static_cast<std::size_t>(face)]) {
        const Vec3& vertex = region.mesh.vertices[static_cast<std::size_t>(corner)];
        const double at =
            direction.dot(body.position + body.rotation * (region.position + region.rotation * vertex));
        if (at > ends.at[0]) ends.region[0] = static_cast<int>(r), ends.at[0] = at;
        if (at < ends.at[1]) ends.region[1] = static_cast<int>(r), ends.at[1] = at;
      }
    }
  }
  return ends;
}

// How far each spring of a region is ahead of the foot's middle along the direction of its ends.
std::vector<double> AheadOf(const ContactRegion& region, const BodyMotion& body, const Ends& ends) {
  std::vector<double> along;
  for (const int face : region.SpringFaceIndices()) {
    along.push_back(ends.direction.dot(
        body.position + body.rotation * (region.position + region.rotation * region.mesh.Centre(face))));
  }
  return AheadOfMiddle(along, ends.at[1], ends.at[0]);
}

// @param sole whose springs the region has; @param along, outward ends of the whole foot
void SetPlaces(const ContactRegion& sole, const BodyMotion& body, const Ends& along, const Ends& outward,
               EffectRegion& region) {
  region.ahead = AheadOf(sole, body, along);
  for (const double at : region.ahead) region.reach = std::max(region.reach, std::abs(at));
  region.stiffness_modes =
      StiffnessModesOf(region.ahead, AheadOf(sole, body, outward), along.length(), outward.length());
}

}  // namespace

std::array<std::size_t, 2> Stance::RecordedInstants() const {
  const auto first = std::lower_bound(time.begin(), time.end(), recorded[0]);
  const auto after = std::upper_bound(first, time.end(), recorded[1]);
  return {static_cast<std::size_t>(first - time.begin()), static_cast<std::size_t>(after - time.begin()) - 1};
}

void Stance::LookForward(std::size_t instant) {
  Vec3 pointing = foot.bodies.front().motion[instant].rotation * Vec3::UnitX();
  pointing.y() = 0;
  if (pointing.norm() > 0) forward = pointing.normalized();
}

Result<Stance> MakeStance(const std::string& trial, const std::string& plate, std::vector<double> time,
                          const CoordinateTrajectory& motion, const MultibodyModel& model,
                          const std::vector<int>& bodies, const ContactSettings& settings) {
  Stance stance;
  stance.trial = trial;
  stance.plate = plate;
  stance.time = std::move(time);
  EffectKinematics& kinematics = stance.kinematics;
  kinematics.floor_velocity = {settings.floor.velocity_x, settings.floor.velocity_z};
  kinematics.transition_velocity = settings.transition_velocity;

  SINEW_ASSIGN(const auto motions, model.BodyMotions(stance.time, motion, bodies));
  std::vector<const ContactRegion*> regions;
  std::vector<std::vector<BodyMotion>> motion_of;  // [regions][instants]
  double deepest = -kInfinity;
  std::size_t deepest_instant = 0;
  for (std::size_t r = 0; r < settings.regions.size(); ++r) {
    if (settings.regions[r].plate != plate) continue;
    regions.push_back(&settings.regions[r].region);
    auto& of_body = motion_of.emplace_back();
    for (const auto& at_instant : motions) of_body.push_back(at_instant[r]);
    EffectRegion region = Prepare(*regions.back(), 0, of_body, settings.floor);
    const ContactKinematics& k = region.kinematics;
    for (std::size_t i = 0; i < k.depth.size(); ++i) {
      if (k.depth[i] <= deepest) continue;
      deepest = k.depth[i];
      deepest_instant = i / static_cast<std::size_t>(k.faces);
      stance.resting_cop = {k.point_x[i], k.point_z[i]};
    }
    stance.regions.push_back(static_cast<int>(r));
    kinematics.regions.push_back(std::move(region));
  }
  const auto groups = settings.Groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<const ContactKinematics*> members;
    for (std::size_t i = 0; i < stance.regions.size(); ++i) {
      if (settings.regions[static_cast<std::size_t>(stance.regions[i])].group != groups[g]) continue;
      kinematics.regions[i].part = static_cast<int>(stance.parts.size());
      members.push_back(&kinematics.regions[i].kinematics);
    }
    if (!members.empty()) {
      stance.parts.push_back({static_cast<int>(g), ContactSums(members, settings.transition_velocity)});
    }
  }

  int springs = 0;
  for (const EffectRegion& region : kinematics.regions) {
    const ContactKinematics& k = region.kinematics;
    const auto first = deepest_instant * static_cast<std::size_t>(k.faces);
    for (std::size_t f = 0; f < static_cast<std::size_t>(k.faces); ++f) {
      stance.middle[0] += k.point_x[first + f];
      stance.middle[1] += k.point_z[first + f];
    }
    springs += k.faces;
  }
  for (double& coordinate : stance.middle) coordinate /= springs;

  for (const BodyMotion& body : motion_of.front()) {
    kinematics.foot_position.push_back(body.position);
    kinematics.foot_acceleration.push_back(body.acceleration);
  }
  std::vector<FootRegion> foot_regions;
  for (std::size_t i = 0; i < regions.size(); ++i)
    foot_regions.push_back({regions[i], bodies[static_cast<std::size_t>(stance.regions[i])]});
  constexpr double kShare = 0.2;               // of the foot's length that a strip beyond its end has
  constexpr std::array<int, 2> kStrips{4, 7};  // squares of it along x and z
  SINEW_ASSIGN(const auto standing,
               model.BodyMotionAt(model.default_values(), Vector::Zero(model.default_values().size()),
                                  {foot_regions.front().body}));
  stance.side = standing.front().position.z() < 0 ? -1 : 1;
  const Mat3& foot = motion_of.front()[deepest_instant].rotation;
  const Ends ends = FindEnds(regions, motion_of, deepest_instant, foot * Vec3::UnitX());
  const Ends outward = FindEnds(regions, motion_of, deepest_instant, foot * Vec3(0, 0, stance.side));
  stance.length = ends.length();
  for (std::size_t r = 0; r < regions.size(); ++r)
    SetPlaces(*regions[r], motion_of[r][deepest_instant], ends, outward, kinematics.regions[r]);
  std::array<ContactRegion, 2> edges;
  for (const std::size_t end : {0U, 1U}) {
    const auto of = static_cast<std::size_t>(ends.region[end]);
    SINEW_ASSIGN(edges[end], EdgeRegion(*regions[of], end == 0, kShare * stance.length, kStrips));
    kinematics.edges[end].push_back(
        Prepare(edges[end], kinematics.regions[of].part, motion_of[of], settings.floor));
    SetPlaces(edges[end], motion_of[of][deepest_instant], ends, outward, kinematics.edges[end].back());
    foot_regions.push_back({&edges[end], foot_regions[of].body});
  }
  if (settings.moves_springs()) {
    SINEW_ASSIGN(stance.foot, RecordedFootMotion(stance.time, motion, model, foot_regions));
    stance.LookForward(stance.time.size() / 2);
  }
  return stance;
}

}  // namespace sinew
