#include "models/multibody/path_tracing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/multibody/wrap_contact.h"

namespace sinew {
namespace {

// A conditional point is there a little beyond its range, as in OpenSim. [rad or m]
constexpr double kConditionMargin = 1e-5;
// Contacts with several objects depend on each other; they are found in turn until the length stands still.
// OpenSim stops at 5e-4 m or after 8 rounds, too early for exact moment arms. [m]
constexpr double kLengthTolerance = 1e-12;
constexpr int kMaxRounds = 100;

bool IsActive(const TracedMuscle::Point& point, const Vector& values) {
  if (point.condition < 0) return true;
  const double value = values[point.condition];
  return value >= point.lower - kConditionMargin && value <= point.upper + kConditionMargin;
}

class Tracer {
 public:
  Tracer(const TracedMuscle& muscle, const Vector& values, const std::vector<BodyMotion>& poses)
      : muscle_(muscle), poses_(poses) {
    for (std::size_t i = 0; i < muscle.points.size(); ++i) {
      const TracedMuscle::Point& point = muscle.points[i];
      if (!IsActive(point, values)) continue;
      const Vec3 local = point.moving < 0
                             ? point.location
                             : PlaceOf(muscle.moving[static_cast<std::size_t>(point.moving)], values);
      const BodyMotion& pose = poses[static_cast<std::size_t>(point.body)];
      PathCorner corner;
      corner.body = point.body;
      corner.place = pose.position + pose.rotation * local;
      corner.point = static_cast<int>(i);
      corners_.push_back(corner);
    }
  }

  TracedPath Trace() {
    const bool settled = corners_.size() < 2 || muscle_.wraps.empty() || WrapOverAll();
    return {std::move(corners_), settled};
  }

 private:
  struct Candidate {
    WrapContact contact;
    std::size_t segment = 0;  // between this corner and the next
  };

  // Wraps the path over all objects in turn until its length converges; false if it does not.
  bool WrapOverAll() {
    std::vector<int> order;
    for (std::size_t i = 0; i < muscle_.wraps.size(); ++i) order.push_back(static_cast<int>(i));
    std::vector<WrapOutcome> outcomes(order.size(), WrapOutcome::kNone);
    double length = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kMaxRounds; ++round) {
      for (std::size_t i = 0; i < order.size(); ++i) outcomes[i] = WrapOver(order[i]);
      if (order.size() == 1) return true;  // nothing else moves its ends
      const double before = std::exchange(length, LengthOf(corners_));
      if (std::abs(length - before) < kLengthTolerance) return true;
      // OpenSim's rule: if the second object was not wrapped only because a point was inside it, it is tried
      // first.
      if (round == 0 && outcomes[0] == WrapOutcome::kNone && outcomes[1] == WrapOutcome::kInside)
        std::swap(order[0], order[1]);
    }
    return false;
  }

  // Removes the path from one object and wraps it again; the outcome of the last segment tried.
  WrapOutcome WrapOver(int index) {
    const TracedMuscle::Wrap& wrap = muscle_.wraps[static_cast<std::size_t>(index)];
    corners_.erase(std::remove_if(corners_.begin(), corners_.end(),
                                  [&](const PathCorner& corner) { return corner.wrap == index; }),
                   corners_.end());
    std::size_t first = corners_.size();
    std::size_t last = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const int point = corners_[i].point;
      if (point < wrap.description.first || point > wrap.description.last) continue;
      first = std::min(first, i);
      last = i;
    }
    WrapOutcome outcome = WrapOutcome::kNone;
    Candidate best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = first; i < last; ++i) {
      if (AreOnOneObject(corners_[i], corners_[i + 1])) continue;
      const WrapContact contact = ContactOf(wrap, corners_[i].place, corners_[i + 1].place);
      outcome = contact.outcome;
      if (outcome == WrapOutcome::kMandatory) {
        best = {contact, i};
        break;
      }
      if (outcome != WrapOutcome::kPossible) continue;
      const double longer = (contact.first - corners_[i].place).norm() + contact.arc +
                            (corners_[i + 1].place - contact.last).norm() -
                            (corners_[i + 1].place - corners_[i].place).norm();
      if (longer >= least) continue;
      least = longer;
      best = {contact, i};
    }
    if (best.contact.outcome != WrapOutcome::kNone) Insert(best, index, wrap.body);
    return outcome;
  }

  [[nodiscard]] bool AreOnOneObject(const PathCorner& a, const PathCorner& b) const {
    return a.wrap >= 0 && b.wrap >= 0 &&
           muscle_.wraps[static_cast<std::size_t>(a.wrap)].object ==
               muscle_.wraps[static_cast<std::size_t>(b.wrap)].object;
  }

  // In ground.
  [[nodiscard]] WrapContact ContactOf(const TracedMuscle::Wrap& wrap, const Vec3& from,
                                      const Vec3& to) const {
    const BodyMotion& pose = poses_[static_cast<std::size_t>(wrap.body)];
    const OsimFrame& frame = wrap.description.object.frame;
    const Mat3 rotation = pose.rotation * frame.rotation;
    const Vec3 origin = pose.position + pose.rotation * frame.location;
    WrapContact contact = FindWrapContact(wrap.description.object, rotation.transpose() * (from - origin),
                                          rotation.transpose() * (to - origin));
    contact.first = origin + rotation * contact.first;
    contact.last = origin + rotation * contact.last;
    return contact;
  }

  void Insert(const Candidate& best, int wrap, int body) {
    PathCorner meets;
    meets.body = body;
    meets.place = best.contact.first;
    meets.wrap = wrap;
    PathCorner leaves = meets;
    leaves.place = best.contact.last;
    leaves.arc = best.contact.arc;
    leaves.after_arc = true;
    const auto at = corners_.begin() + static_cast<std::ptrdiff_t>(best.segment) + 1;
    corners_.insert(at, {meets, leaves});
  }

  const TracedMuscle& muscle_;
  const std::vector<BodyMotion>& poses_;
  std::vector<PathCorner> corners_;
};

}  // namespace

Result<TracedPath> TracePath(const TracedMuscle& muscle, const Vector& values,
                             const std::vector<BodyMotion>& poses) {
  TracedPath path = Tracer(muscle, values, poses).Trace();
  if (path.corners.size() < 2) {
    return Fail("{} point(s) of muscle '{}' are in the path, expected at least 2", path.corners.size(),
                muscle.name);
  }
  return path;
}

double LengthOf(const std::vector<PathCorner>& corners) {
  double length = 0;
  for (std::size_t i = 1; i < corners.size(); ++i)
    length += corners[i].after_arc ? corners[i].arc : (corners[i].place - corners[i - 1].place).norm();
  return length;
}

}  // namespace sinew
