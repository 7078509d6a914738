#include "problems/contact/soles/foot_estimate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/constants.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr double kSteady = 1.5;       // [rad/s] a body that turns faster does not lie on the floor
constexpr double kStiffJoint = 0.02;  // [rad] a joint that moves less is none
constexpr double kSnap = 0.94;        // cosine of 20 degrees
constexpr std::size_t kFewestFlat = 4;
constexpr double kOutermost = 0.05;  // share of the frames whose centre of pressure may lie beyond

struct Frame {
  const PlateRecord* record = nullptr;
  std::size_t at = 0;
  [[nodiscard]] const BodyMotion& Body(int body) const {
    return record->motion[at][static_cast<std::size_t>(body)];
  }
};

Vec3 MedianOf(const std::vector<Vec3>& vectors) {
  Vec3 median;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3& v : vectors) values.push_back(v[axis]);
    median[axis] = Median(values);
  }
  return median;
}

double AngleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The floor seen from a body over some frames.
struct Plane {
  Vec3 up = Vec3::UnitY();
  double offset = 0;
  FlatStand stand;
  std::size_t typical = 0;  // index into the frames
};

// @param below a point in the body's frame under which the floor's height is taken
Plane FloorUnder(const std::vector<Frame>& frames, int body, const Vec3& below, double floor_height) {
  std::vector<Vec3> ups;
  std::vector<double> heights;
  std::vector<double> turning;
  for (const Frame& frame : frames) {
    const BodyMotion& motion = frame.Body(body);
    ups.emplace_back(motion.rotation.row(1).transpose());
    heights.push_back((motion.position + motion.rotation * below).y() - floor_height);
    turning.push_back(motion.angular_velocity.norm());
  }
  Plane plane;
  plane.up = MedianOf(ups).normalized();
  const double height = Median(heights);
  plane.offset = plane.up.dot(below) - height;
  double squares = 0;
  double least = kInfinity;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double angle = AngleBetween(ups[i], plane.up);
    squares += angle * angle;
    constexpr double kLever = 0.1;  // [m] makes an angle of a height
    const double unlike = angle + std::abs(heights[i] - height) / kLever;
    if (unlike < least) least = unlike, plane.typical = i;
  }
  const auto count = static_cast<double>(frames.size());
  plane.stand = {static_cast<int>(frames.size()), kPi, std::sqrt(squares / count), RobustDeviation(heights),
                 Median(turning)};
  for (int axis = 0; axis < 3; ++axis) {
    const double angle = std::acos(std::min(1.0, std::abs(plane.up[axis])));
    plane.stand.tilt = std::min(plane.stand.tilt, angle);
  }
  return plane;
}

std::vector<Frame> Refer(const PlateRecord& record, const std::vector<std::size_t>& at) {
  std::vector<Frame> frames;
  for (const std::size_t t : at) frames.push_back({&record, t});
  return frames;
}

Vec3 Project(const Vec3& v, const Vec3& up) {
  return v - up.dot(v) * up;
}

// The quarter of the frames in which a body turns slowest, at least four.
std::vector<std::size_t> Slowest(const PlateRecord& record, int body, std::vector<std::size_t> frames) {
  const auto turning = [&](std::size_t t) {
    return record.motion[t][static_cast<std::size_t>(body)].angular_velocity.norm();
  };
  std::sort(frames.begin(), frames.end(),
            [&](std::size_t a, std::size_t b) { return turning(a) < turning(b); });
  frames.resize(std::min(frames.size(), std::max(kFewestFlat, frames.size() / 4)));
  std::sort(frames.begin(), frames.end());
  return frames;
}

// From the frame of `from` to that of `to`, as they are in this frame of the motion.
Vec3 Carry(const Frame& frame, int from, int to, const Vec3& point) {
  const BodyMotion& a = frame.Body(from);
  const BodyMotion& b = frame.Body(to);
  return b.rotation.transpose() * (a.position + a.rotation * point - b.position);
}
Vec3 Turn(const Frame& frame, int from, int to, const Vec3& direction) {
  return frame.Body(to).rotation.transpose() * (frame.Body(from).rotation * direction);
}

// Mean of the centre of pressure in the last third of the loaded stance less that in the first, body frame.
std::optional<Vec3> CopProgress(const PlateRecord& record, int body) {
  std::vector<Vec3> path;
  for (std::size_t t = 0; t < record.time.size(); ++t) {
    if (!record.cop[t].allFinite()) continue;
    const BodyMotion& motion = record.motion[t][static_cast<std::size_t>(body)];
    path.emplace_back(motion.rotation.transpose() * (record.cop[t] - motion.position));
  }
  const std::size_t third = path.size() / 3;
  if (third < 2) return std::nullopt;
  const auto third_of = static_cast<std::ptrdiff_t>(third);
  return Vec3(MedianOf({path.end() - third_of, path.end()}) -
              MedianOf({path.begin(), path.begin() + third_of}));
}

// The longest direction of points in the plane, if they have one.
std::optional<Vec3> LongAxis(const std::vector<Vec3>& points, const Vec3& up) {
  constexpr double kSlender = 1.5;  // of the standard deviations
  if (points.size() < 3) return std::nullopt;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  const Vec3 a = Project(std::abs(up.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitZ(), up).normalized();
  const Vec3 b = up.cross(a);
  double aa = 0;
  double ab = 0;
  double bb = 0;
  for (const Vec3& p : points) {
    const double u = a.dot(p - mean);
    const double v = b.dot(p - mean);
    aa += u * u;
    ab += u * v;
    bb += v * v;
  }
  const double root = std::hypot(0.5 * (aa - bb), ab);
  const double large = 0.5 * (aa + bb) + root;
  const double small = 0.5 * (aa + bb) - root;
  if (!(large > kSlender * kSlender * std::max(small, 0.0)) || !(large > 0)) return std::nullopt;
  const double angle = 0.5 * std::atan2(2 * ab, aa - bb);
  return Vec3(std::cos(angle) * a + std::sin(angle) * b);
}

// Direction of the foot in its plane: the axis of the body nearest to its long direction, if one is near.
std::optional<Vec3> FindForward(const std::vector<const PlateRecord*>& records, int body,
                                const std::vector<Vec3>& points, const Vec3& up) {
  Vec3 progress = Vec3::Zero();
  for (const PlateRecord* record : records) progress += CopProgress(*record, body).value_or(Vec3::Zero());
  progress = Project(progress, up);
  auto axis = LongAxis(points, up);
  if (!axis) {
    if (progress.isZero()) return std::nullopt;
    axis = progress.normalized();
  }
  // Heel to toes; without a centre of pressure the toes are farther from the joint to the leg.
  Vec3 ahead = progress;
  if (ahead.isZero()) {
    for (const Vec3& p : points) ahead += Project(p, up);
  }
  Vec3 forward = ahead.dot(*axis) < 0 ? Vec3(-*axis) : *axis;
  for (int k = 0; k < 3; ++k) {
    const Vec3 of_body = Project(Vec3::Unit(k), up).normalized();
    const double along = of_body.dot(forward);
    if (std::abs(along) > kSnap) return Vec3(along < 0 ? Vec3(-of_body) : of_body);
  }
  return forward;
}

// Whether two bodies are one, as far as the motion says.
bool MoveAsOne(const std::vector<const PlateRecord*>& records, int a, int b) {
  std::optional<Mat3> first;
  for (const PlateRecord* record : records) {
    for (const auto& bodies : record->motion) {
      const Mat3 relative = bodies[static_cast<std::size_t>(a)].rotation.transpose() *
                            bodies[static_cast<std::size_t>(b)].rotation;
      if (!first) first = relative;
      if (Eigen::AngleAxisd(first->transpose() * relative).angle() > kStiffJoint) return false;
    }
  }
  return true;
}

struct Spot {
  double along = 0;
  double aside = 0;
};

// The foot while it is flat: everything is expressed in its plane.
class FlatFoot {
 public:
  FlatFoot(const std::vector<const PlateRecord*>& records, const std::vector<int>& bodies, Plane plane,
           Frame typical, Vec3 forward)
      : records_(records), bodies_(bodies), plane_(std::move(plane)), typical_(typical), forward_(forward) {
    side_ = forward_.cross(plane_.up);
  }

  [[nodiscard]] Spot At(int body, const Vec3& point) const {
    const Vec3 p = Carry(typical_, body, bodies_.front(), point);
    return {forward_.dot(p), side_.dot(p)};
  }

  // The loaded path of the centre of pressure: of the outermost body that it lies in front of.
  [[nodiscard]] std::vector<Spot> CopPath() const {
    std::vector<Spot> path;
    for (const PlateRecord* record : records_) {
      for (std::size_t t = 0; t < record->time.size(); ++t) {
        if (!record->cop[t].allFinite()) continue;
        Spot spot;
        for (const int body : bodies_) {
          const BodyMotion& motion = record->motion[t][static_cast<std::size_t>(body)];
          const Spot seen = At(body, motion.rotation.transpose() * (record->cop[t] - motion.position));
          if (body == bodies_.front() || seen.along > At(body, Vec3::Zero()).along) spot = seen;
        }
        path.push_back(spot);
      }
    }
    return path;
  }

  // A rectangle of the plane on a body of the foot.
  [[nodiscard]] SolePatch Patch(int body, const Plane& own, double back, double front, double middle,
                                double width) const {
    SolePatch patch;
    patch.body = body;
    patch.up = own.up;
    patch.offset = own.offset;
    patch.forward = Project(Turn(typical_, bodies_.front(), body, forward_), own.up).normalized();
    const Vec3 centre = Carry(typical_, bodies_.front(), body,
                              0.5 * (back + front) * forward_ + plane_.offset * plane_.up + middle * side_);
    const double along = patch.forward.dot(centre);
    patch.back = along - 0.5 * (front - back);
    patch.front = along + 0.5 * (front - back);
    patch.middle = patch.side().dot(centre);
    patch.width = width;
    return patch;
  }

 private:
  const std::vector<const PlateRecord*>& records_;
  const std::vector<int>& bodies_;
  Plane plane_;
  Frame typical_;
  Vec3 forward_;
  Vec3 side_;
};

// The lowest and highest of the values along or aside within a stretch; nothing if there are fewer than two.
std::optional<std::array<double, 2>> Sides(const std::vector<Spot>& spots, double from, double to) {
  std::optional<std::array<double, 2>> sides;
  int count = 0;
  for (const Spot& spot : spots) {
    if (spot.along < from || spot.along > to) continue;
    if (!sides) sides = {spot.aside, spot.aside};
    (*sides)[0] = std::min((*sides)[0], spot.aside);
    (*sides)[1] = std::max((*sides)[1], spot.aside);
    ++count;
  }
  return count < 2 ? std::nullopt : sides;
}

// Middle and width of a region.
struct Breadth {
  double middle = 0;
  double width = 0;
  SoleWidth from = SoleWidth::kRatio;
};

// Markers at both sides are nearly as far apart as is usual, or more: their middle and distance count, and a
// centre of pressure beyond them widens the region, but not beyond what is usual: that would be an error of
// the motion. Else the region has its usual width about the given middle or the centre of pressure, moved so
// that it reaches the markers.
// @param usual width by its proportion
Breadth BreadthOf(const std::vector<Spot>& markers, const std::vector<Spot>& cop, double from, double to,
                  double usual, std::optional<double> middle) {
  constexpr double kNearly = 0.95;
  Breadth breadth{middle.value_or(0), usual, SoleWidth::kRatio};
  std::vector<double> aside;
  for (const Spot& spot : cop) {
    if (spot.along >= from && spot.along <= to) aside.push_back(spot.aside);
  }
  const auto sides = Sides(markers, from, to);
  if (!sides || (*sides)[1] - (*sides)[0] < kNearly * usual) {
    if (!middle && !aside.empty()) breadth.middle = Median(aside);
    if (!middle && aside.empty() && sides) breadth.middle = 0.5 * ((*sides)[0] + (*sides)[1]);
    if (!sides) return breadth;
    const double inside = 0.5 * usual + SoleRules::kMarkerStandOff;
    breadth.middle = std::clamp(breadth.middle, (*sides)[1] - inside, (*sides)[0] + inside);
    return breadth;
  }
  breadth.middle = 0.5 * ((*sides)[0] + (*sides)[1]);
  breadth.width = (*sides)[1] - (*sides)[0] - 2 * SoleRules::kMarkerStandOff;
  breadth.from = SoleWidth::kMarkers;
  if (aside.empty()) return breadth;
  const double reach = std::max(Quantile(aside, 1 - kOutermost) - breadth.middle,
                                breadth.middle - Quantile(aside, kOutermost));
  const double reached = std::min(usual, 2 * (reach + SoleRules::kInsideSides));
  if (reached > breadth.width) {
    breadth.width = reached;
    breadth.from = SoleWidth::kCop;
  }
  return breadth;
}

// Of the markers behind a place: a heel's marker is in its middle.
std::optional<double> MiddleOfHeel(const std::vector<Spot>& markers, double before) {
  std::vector<double> aside;
  for (const Spot& spot : markers) {
    if (spot.along < before) aside.push_back(spot.aside);
  }
  if (aside.empty()) return std::nullopt;
  return 0.5 *
         (*std::min_element(aside.begin(), aside.end()) + *std::max_element(aside.begin(), aside.end()));
}

}  // namespace

std::vector<std::size_t> FlatFrames(const PlateRecord& record, int body, double share) {
  std::vector<std::size_t> frames;
  for (std::size_t t = 0; t < record.time.size(); ++t) {
    if (record.Loaded(t, share)) frames.push_back(t);
  }
  return Slowest(record, body, std::move(frames));
}

Result<FootEstimate> EstimateFoot(const std::vector<const PlateRecord*>& records,
                                  const std::vector<int>& bodies, const BodyPoints& markers,
                                  const BodyPoints& points, double floor_height) {
  const int foot = bodies.front();
  FootEstimate estimate;
  estimate.bodies = bodies;
  std::vector<Frame> flat;
  for (const PlateRecord* record : records) {
    estimate.trials.push_back(record->trial);
    for (const Frame& frame : Refer(*record, FlatFrames(*record, foot, kFlatShare))) flat.push_back(frame);
  }
  if (flat.empty()) return Fail("no frame of the motion with load");

  // A first plane tells which frame is typical, so that all points can be seen from one body.
  Plane plane = FloorUnder(flat, foot, Vec3::Zero(), floor_height);
  const Frame typical = flat[plane.typical];
  std::vector<Vec3> all_points;
  for (const int body : bodies) {
    for (const Vec3& point : points[static_cast<std::size_t>(body)])
      all_points.push_back(Carry(typical, body, foot, point));
  }
  Vec3 below = Vec3::Zero();
  for (const Vec3& point : all_points) below += point / static_cast<double>(all_points.size());
  plane = FloorUnder(flat, foot, below, floor_height);
  estimate.flat = plane.stand;
  const auto forward = FindForward(records, foot, all_points, plane.up);
  if (!forward) return Fail("neither markers nor a centre of pressure say which way it points");

  const FlatFoot sole(records, bodies, plane, typical, *forward);
  std::vector<Spot> spots;
  for (const int body : bodies) {
    for (const Vec3& marker : markers[static_cast<std::size_t>(body)]) spots.push_back(sole.At(body, marker));
  }
  const std::vector<Spot> path = sole.CopPath();
  std::vector<double> along;
  for (const Spot& spot : path) along.push_back(spot.along);

  // Ends.
  double heel = kInfinity;
  double tip = -kInfinity;
  for (const Spot& spot : spots) {
    heel = std::min(heel, spot.along + SoleRules::kMarkerStandOff);
    tip = std::max(tip, spot.along);
  }
  if (!along.empty()) {
    const double first = Quantile(along, kOutermost) - SoleRules::kBeyondCop;
    const double last = Quantile(along, 1 - kOutermost) + SoleRules::kBeyondCop;
    if (first < heel) heel = first, estimate.heel_from = SoleEnd::kCop;
    if (last > tip) tip = last, estimate.tip_from = SoleEnd::kCop;
  }
  const bool has_toes = bodies.size() > 1;
  double ball = 0;
  if (has_toes) {
    ball = sole.At(bodies.back(), Vec3::Zero()).along;
    estimate.ball_from = SoleEnd::kMarker;
    const double usual = heel + (ball - heel) / SoleRules::kBall;
    if (usual > tip) tip = usual, estimate.tip_from = SoleEnd::kRatio;
  }
  constexpr double kShortest = 0.05;  // [m] of a foot
  if (!(tip - heel > kShortest)) return Fail("neither markers nor a centre of pressure say how long it is");
  estimate.length = tip - heel;
  const bool joint_in_sole = has_toes && ball > heel + 0.3 * estimate.length && ball < tip;
  if (!joint_in_sole) {
    ball = heel + SoleRules::kBall * estimate.length;
    estimate.ball_from = SoleEnd::kRatio;
  }
  const double split = 0.5 * (heel + ball);

  // The last body has a plane of its own if it moves against the first one.
  std::vector<Plane> planes;
  for (const int body : bodies) {
    const Vec3 under = Carry(typical, foot, body, below);
    planes.push_back(body == foot ? plane : FloorUnder(flat, body, under, floor_height));
  }
  if (has_toes) {
    estimate.toes_flat = planes.back().stand;
    std::vector<Frame> toes;
    if (!MoveAsOne(records, foot, bodies.back())) {
      for (const PlateRecord* record : records) {
        std::vector<std::size_t> late;
        for (std::size_t t = 0; t < record->time.size(); ++t) {
          if (!record->Loaded(t, kLoadedShare) || !record->cop[t].allFinite()) continue;
          const BodyMotion& motion = record->motion[t][static_cast<std::size_t>(bodies.back())];
          const Vec3 cop = motion.rotation.transpose() * (record->cop[t] - motion.position);
          if (sole.At(bodies.back(), cop).along > ball) late.push_back(t);
        }
        for (const std::size_t t : Slowest(*record, bodies.back(), std::move(late)))
          toes.push_back({record, t});
      }
    }
    if (toes.size() >= kFewestFlat) {
      const Vec3 middle =
          Carry(typical, foot, bodies.back(), 0.5 * (ball + tip) * *forward + plane.offset * plane.up);
      const Plane own = FloorUnder(toes, bodies.back(), middle, floor_height);
      if (own.stand.turning < kSteady) {
        planes.back() = own;
        estimate.toes_flat = own.stand;
        estimate.toes_alone = true;
      }
    }
  }

  const double breadth = SoleRules::kBreadth * estimate.length;
  const Breadth front = BreadthOf(spots, path, split, kInfinity, breadth, std::nullopt);
  const double heel_third = heel + (ball - heel) / 3;
  const Breadth rear = BreadthOf(spots, path, -kInfinity, split, SoleRules::kHeelBreadth * estimate.length,
                                 MiddleOfHeel(spots, heel_third));
  const Breadth toes{front.middle, front.width, front.from};
  const std::size_t of_forefoot = bodies.size() > 2 ? 1 : 0;
  const std::size_t of_toes = bodies.size() - 1;
  const auto add = [&](std::size_t body, double from, double to, const Breadth& sides) {
    SolePatch patch = sole.Patch(bodies[body], planes[body], from, to, sides.middle, sides.width);
    patch.width_from = sides.from;
    estimate.patches.push_back(patch);
  };
  add(0, heel, split, rear);
  add(of_forefoot, split, ball, front);
  add(of_toes, ball, tip, toes);
  return estimate;
}

bool CopMovesAcross(const PlateRecord& record, const FootEstimate& foot) {
  const SolePatch& rear = foot.patches.front();
  const auto progress = CopProgress(record, rear.body);
  if (!progress) return false;
  const double along = std::abs(rear.forward.dot(*progress));
  const double aside = std::abs(rear.side().dot(*progress));
  return aside > along && std::hypot(along, aside) > 0.2 * foot.length;
}

Vec3 ForwardOf(const PlateRecord& record, const FootEstimate& foot) {
  const SolePatch& rear = foot.patches.front();
  Vec3 sum = Vec3::Zero();
  for (const std::size_t t : FlatFrames(record, rear.body, kFlatShare))
    sum += record.motion[t][static_cast<std::size_t>(rear.body)].rotation * rear.forward;
  sum.y() = 0;
  return sum.normalized();
}

}  // namespace sinew
