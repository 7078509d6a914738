#include "models/multibody/traced_muscle.h"

#include <algorithm>

namespace sinew {
namespace {

Result<TracedMuscle::Component> NumberComponent(const MultibodyModel& model,
                                                const OsimPointComponent& component) {
  TracedMuscle::Component made;
  made.function = component.function;
  if (component.coordinate.empty()) return made;
  SINEW_ASSIGN(made.coordinate, model.CoordinateIndex(component.coordinate));
  made.lower = model.coordinate(made.coordinate).lower;
  made.upper = model.coordinate(made.coordinate).upper;
  return made;
}

Status AddPoint(const MultibodyModel& model, const OsimPathPoint& point, TracedMuscle& muscle) {
  TracedMuscle::Point made;
  SINEW_ASSIGN(made.body, model.BodyIndex(point.frame.body));
  made.location = point.frame.location + point.frame.rotation * point.location;
  if (point.condition) {
    SINEW_ASSIGN(made.condition, model.CoordinateIndex(point.condition->coordinate));
    made.lower = point.condition->lower;
    made.upper = point.condition->upper;
  }
  if (point.motion) {
    TracedMuscle::Moving moving;
    moving.origin = point.frame.location;
    moving.rotation = point.frame.rotation;
    for (std::size_t i = 0; i < 3; ++i) {
      SINEW_ASSIGN(moving.components[i], NumberComponent(model, (*point.motion)[i]));
    }
    made.moving = static_cast<int>(muscle.moving.size());
    muscle.moving.push_back(std::move(moving));
  }
  muscle.points.push_back(made);
  return {};
}

}  // namespace

Result<TracedMuscle> NumberPath(const MultibodyModel& model, const OsimMusclePath& path,
                                std::map<std::string, int>& object_numbers) {
  TracedMuscle muscle;
  muscle.name = path.name;
  for (const OsimPathPoint& point : path.points) SINEW_TRY(AddPoint(model, point, muscle));
  for (const OsimPathWrap& wrap : path.wraps) {
    SINEW_ASSIGN(const int body, model.BodyIndex(wrap.object.frame.body));
    const auto number = static_cast<int>(object_numbers.size());
    muscle.wraps.push_back({body, object_numbers.emplace(wrap.object.name, number).first->second, wrap});
  }
  return muscle;
}

Vec3 PlaceOf(const TracedMuscle::Moving& point, const Vector& values) {
  Vec3 place;
  for (int i = 0; i < 3; ++i) {
    const TracedMuscle::Component& c = point.components[static_cast<std::size_t>(i)];
    const double x = c.coordinate < 0 ? 0 : std::clamp(values[c.coordinate], c.lower, c.upper);
    place[i] = c.function.At(x).value;
  }
  return point.origin + point.rotation * place;
}

Vec3 VelocityOf(const TracedMuscle::Moving& point, const Vector& values, const Vector& rates) {
  Vec3 velocity = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const TracedMuscle::Component& c = point.components[static_cast<std::size_t>(i)];
    if (c.coordinate < 0) continue;
    const double x = values[c.coordinate];
    if (x < c.lower || x > c.upper) continue;
    velocity[i] = c.function.At(x).first * rates[c.coordinate];
  }
  return point.rotation * velocity;
}

}  // namespace sinew
