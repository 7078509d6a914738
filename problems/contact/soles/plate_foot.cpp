#include "problems/contact/soles/plate_foot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kReach = 0.2;  // [m] of a foot's points from the centre of pressure under it
constexpr double kTie = 0.01;   // [m]

using Cop = std::function<Vec3(const Vec3&)>;

// Frames of the loaded foot with a centre of pressure, the earliest first.
std::vector<std::size_t> LoadedFrames(const PlateRecord& record, double share, bool with_cop) {
  std::vector<std::size_t> frames;
  for (std::size_t t = 0; t < record.time.size(); ++t) {
    if (record.Loaded(t, share) && (!with_cop || record.cop[t].allFinite())) frames.push_back(t);
  }
  return frames;
}

double Distance(const BodyMotion& body, const std::vector<Vec3>& points, const Vec3& place) {
  double least = kInfinity;
  for (const Vec3& point : points)
    least = std::min(least, (body.position + body.rotation * point - place).norm());
  return least;
}

// Of values per body (ground excepted) the least; of nearly equal ones that of the outermost body.
int Least(const std::vector<double>& values, const BodyTree& tree) {
  const double least = *std::min_element(values.begin() + 1, values.end());
  int best = -1;
  for (int b = 1; b < static_cast<int>(values.size()); ++b) {
    const double value = values[static_cast<std::size_t>(b)];
    if (value > least + kTie) continue;
    if (best < 0 || tree.depth(b) > tree.depth(best) ||
        (tree.depth(b) == tree.depth(best) && value < values[static_cast<std::size_t>(best)]))
      best = b;
  }
  return best;
}

// Mean distance of every body from the centre of pressure.
std::vector<double> MeanDistances(const PlateRecord& record, const BodyPoints& points,
                                  const std::vector<std::size_t>& frames, const Cop& cop) {
  std::vector<double> mean(points.size(), 0.0);
  for (const std::size_t t : frames) {
    const Vec3 place = cop(record.cop[t]);
    for (std::size_t b = 0; b < points.size(); ++b)
      mean[b] += Distance(record.motion[t][b], points[b], place) / static_cast<double>(frames.size());
  }
  return mean;
}

std::vector<std::size_t> Strike(const std::vector<std::size_t>& loaded) {
  return {loaded.begin(), loaded.begin() + static_cast<std::ptrdiff_t>((2 * loaded.size() + 4) / 5)};
}

// The body whose lowest point is lowest on average.
PlateFoot LowestFoot(const PlateRecord& record, const BodyTree& tree, const BodyPoints& points,
                     double floor_height) {
  std::vector<double> height(points.size(), 0.0);
  const auto frames = LoadedFrames(record, 0.5, false);
  for (const std::size_t t : frames) {
    for (std::size_t b = 0; b < points.size(); ++b) {
      double lowest = kInfinity;
      for (const Vec3& point : points[b]) {
        const BodyMotion& body = record.motion[t][b];
        lowest = std::min(lowest, body.position.y() + (body.rotation * point).y() - floor_height);
      }
      height[b] += lowest / static_cast<double>(frames.size());
    }
  }
  PlateFoot foot;
  foot.body = Least(height, tree);
  foot.distance = height[static_cast<std::size_t>(foot.body)];
  return foot;
}

// A plate whose centre of pressure no body is near: is it near one if it is read otherwise?
PlateFoot ReadOtherwise(const PlateRecord& record, const BodyTree& tree, const BodyPoints& points,
                        const std::vector<std::size_t>& frames, PlateFoot foot) {
  foot.fault = PlateFault::kNoFoot;
  struct Reading {
    PlateFault fault;
    const char* axes;
    Cop cop;
  };
  const std::vector<Reading> readings{
      {PlateFault::kTurned, "z, -x", [](const Vec3& p) { return Vec3(p.z(), p.y(), -p.x()); }},
      {PlateFault::kTurned, "-z, x", [](const Vec3& p) { return Vec3(-p.z(), p.y(), p.x()); }},
      {PlateFault::kTurned, "-x, -z", [](const Vec3& p) { return Vec3(-p.x(), p.y(), -p.z()); }},
      {PlateFault::kTurned, "z, x", [](const Vec3& p) { return Vec3(p.z(), p.y(), p.x()); }},
      {PlateFault::kTurned, "-z, -x", [](const Vec3& p) { return Vec3(-p.z(), p.y(), -p.x()); }},
      {PlateFault::kTurned, "x, -z", [](const Vec3& p) { return Vec3(p.x(), p.y(), -p.z()); }},
      {PlateFault::kTurned, "-x, z", [](const Vec3& p) { return Vec3(-p.x(), p.y(), p.z()); }},
      {PlateFault::kMillimetres, "", [](const Vec3& p) { return Vec3(1e-3 * p.x(), p.y(), 1e-3 * p.z()); }},
  };
  constexpr double kLongPath = 5;  // [m] no foot is so long
  double path = 0;
  for (const std::size_t t : frames)
    path = std::max(path, (record.cop[t] - record.cop[frames.front()]).norm());
  double nearest = kReach;
  for (const Reading& reading : readings) {
    if (reading.fault == PlateFault::kMillimetres && path < kLongPath) continue;
    const auto mean = MeanDistances(record, points, frames, reading.cop);
    const int body = Least(mean, tree);
    const double distance = mean[static_cast<std::size_t>(body)];
    if (distance >= nearest) continue;
    nearest = distance;
    foot.fault = reading.fault;
    foot.axes = reading.axes;
    foot.body = body;
  }
  return foot;
}

}  // namespace

const char* ToString(PlateFault fault) {
  switch (fault) {
    case PlateFault::kNone:
      return "";
    case PlateFault::kNotLoaded:
      return "not_loaded";
    case PlateFault::kPartial:
      return "partial";
    case PlateFault::kUpsideDown:
      return "upside_down";
    case PlateFault::kNoFoot:
      return "no_foot";
    case PlateFault::kTurned:
      return "turned_axes";
    case PlateFault::kMillimetres:
      return "millimetres";
    case PlateFault::kTwoFeet:
      return "two_feet";
    case PlateFault::kCopAcross:
      return "cop_across";
    case PlateFault::kForceAcross:
      return "force_across";
    case PlateFault::kForceReversed:
      return "force_reversed";
  }
  return "";
}

BodyPoints MarkersOfBodies(const OsimModel& model, const MultibodyModel& multibody, const Dataset& data) {
  BodyPoints markers(multibody.body_names().size());
  for (const OsimMarker& marker : model.markers) {
    const auto index = multibody.BodyIndex(marker.body);
    const bool measured = std::any_of(data.trials.begin(), data.trials.end(), [&](const auto& named) {
      return static_cast<bool>(named.second.Find(marker.name + "_x"));
    });
    if (index && measured) markers[static_cast<std::size_t>(*index)].push_back(marker.location);
  }
  return markers;
}

BodyPoints PointsOfBodies(const OsimModel& model, const MultibodyModel& multibody,
                          const BodyPoints& markers) {
  BodyPoints points = markers;
  for (auto& of_body : points) of_body.emplace_back(Vec3::Zero());
  for (const OsimBody& body : model.bodies) {
    const auto index = multibody.BodyIndex(body.name);
    if (index && !body.mass_center.isZero())
      points[static_cast<std::size_t>(*index)].push_back(body.mass_center);
  }
  return points;
}

PlateFoot FindFoot(const PlateRecord& record, const BodyTree& tree, const BodyPoints& points,
                   double body_weight, double floor_height) {
  constexpr double kLeast = 0.05;  // of body weight
  constexpr double kOften = 0.33;  // of the stance
  constexpr double kSeldom = 0.1;  // of the stance
  PlateFoot foot;
  if (-record.lowest > record.peak && -record.lowest > kLeast * body_weight) {
    foot.fault = PlateFault::kUpsideDown;
    return foot;
  }
  if (!(record.peak > kLeast * body_weight)) {
    foot.fault = record.partial ? PlateFault::kPartial : PlateFault::kNotLoaded;
    return foot;
  }
  const auto loaded = LoadedFrames(record, kLoadedShare, true);
  if (loaded.empty()) return LowestFoot(record, tree, points, floor_height);
  const auto strike = Strike(loaded);
  const auto mean = MeanDistances(record, points, strike, [](const Vec3& p) { return p; });
  foot.body = Least(mean, tree);
  foot.distance = mean[static_cast<std::size_t>(foot.body)];
  if (foot.distance > kReach) return ReadOtherwise(record, tree, points, strike, foot);

  std::map<int, int> nearest;
  for (const std::size_t t : loaded) {
    std::vector<double> distances;
    for (std::size_t b = 0; b < points.size(); ++b)
      distances.push_back(Distance(record.motion[t][b], points[b], record.cop[t]));
    ++nearest[Least(distances, tree)];
  }
  const auto all = static_cast<double>(loaded.size());
  const int inner = tree.parent(foot.body);
  if (tree.Outwards(foot.body).size() == 1 && inner > 0 && nearest[inner] > kOften * all) foot.body = inner;
  int strangers = 0;
  int most = 0;
  for (const auto& [body, frames] : nearest) {
    if (tree.SameLimb(body, foot.body)) continue;
    strangers += frames;
    if (frames > most) foot.other_body = body, most = frames;
  }
  foot.share = strangers / all;
  if (foot.share > kSeldom) foot.fault = PlateFault::kTwoFeet;
  return foot;
}

PlateFault ForceDirectionFault(const PlateRecord& record, const Vec3& forward) {
  constexpr double kNotable = 0.03;  // of the largest vertical force
  constexpr double kMore = 1.25;     // of the scatter along the foot; walking has a quarter across
  const Vec3 ahead = Vec3(forward.x(), 0, forward.z()).normalized();
  const Vec3 aside = ahead.cross(Vec3::UnitY());
  std::vector<Vec3> forces;
  for (const std::size_t t : LoadedFrames(record, kLoadedShare, false)) {
    if (record.force[t].allFinite()) forces.push_back(record.force[t]);
  }
  constexpr std::size_t kFewest = 8;
  if (forces.size() < kFewest) return PlateFault::kNone;
  const auto count = static_cast<double>(forces.size());
  Vec3 mean = Vec3::Zero();
  for (const Vec3& force : forces) mean += force / count;
  double along = 0;
  double across = 0;
  double later = 0;  // mean of the second half less that of the first, halved
  for (std::size_t i = 0; i < forces.size(); ++i) {
    along += std::pow(ahead.dot(forces[i] - mean), 2) / count;
    across += std::pow(aside.dot(forces[i] - mean), 2) / count;
    later += (2 * i < forces.size() ? -1 : 1) * ahead.dot(forces[i]) / count;
  }
  if (std::sqrt(across) > kNotable * record.peak && across > kMore * kMore * along)
    return PlateFault::kForceAcross;
  return later < -kNotable * record.peak ? PlateFault::kForceReversed : PlateFault::kNone;
}

}  // namespace sinew
