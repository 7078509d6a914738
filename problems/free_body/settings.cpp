#include "problems/free_body/settings.h"

#include <algorithm>

#include "base/text.h"

namespace sinew {
namespace {

Result<Vec3> ReadPositives(const YamlReader& yaml, const char* key) {
  SINEW_ASSIGN(const YamlReader value, yaml.At(key));
  SINEW_ASSIGN(const auto numbers, value.Numbers(3));
  for (const double x : numbers) {
    if (!(x > 0)) return FailAt(value.file(), value.line(), "{}: {}, expected numbers above 0", key, x);
  }
  return Vec3(numbers[0], numbers[1], numbers[2]);
}

Result<FreeBodyContact> ReadContact(const YamlReader& yaml) {
  if (!yaml.Has("contact")) return FreeBodyContact::kVertices;
  SINEW_ASSIGN(const YamlReader value, yaml.At("contact"));
  SINEW_ASSIGN(const std::string name, value.Text());
  if (name == "vertices") return FreeBodyContact::kVertices;
  if (name == "elastic_foundation") return FreeBodyContact::kElasticFoundation;
  return FailAt(value.file(), value.line(), "contact: '{}' does not exist{}", name,
                Suggestion(name, {"vertices", "elastic_foundation"}));
}

}  // namespace

Result<FreeBodySettings> ReadFreeBodySettings(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"box", "mass", "inertia", "contact", "divisions", "horizon", "window", "gravity",
                           "transition_velocity", "accuracy", "most_steps"}));
  FreeBodySettings settings;
  FreeBody& body = settings.body;
  SINEW_ASSIGN(settings.edges, ReadPositives(yaml, "box"));
  SINEW_TRY(yaml.At("mass"));
  SINEW_ASSIGN(body.mass, yaml.NumberOr("mass", 1, 1e-9, 1e9));
  if (yaml.Has("inertia")) {
    SINEW_ASSIGN(body.inertia, ReadPositives(yaml, "inertia"));
    const double sum = body.inertia.sum();
    if (2 * body.inertia.maxCoeff() > sum * (1 + 1e-9)) {
      SINEW_ASSIGN(const YamlReader value, yaml.At("inertia"));
      return FailAt(value.file(), value.line(),
                    "inertia: no body has such moments, the largest exceeds the sum of the others");
    }
  } else {
    const Vec3 squares = settings.edges.cwiseAbs2();
    body.inertia = body.mass / 12 * (Vec3::Constant(squares.sum()) - squares);
  }
  SINEW_ASSIGN(body.contact, ReadContact(yaml));
  SINEW_ASSIGN(const double divisions, yaml.NumberOr("divisions", 10, 1, 100));
  if (divisions != static_cast<int>(divisions)) {
    SINEW_ASSIGN(const YamlReader value, yaml.At("divisions"));
    return FailAt(value.file(), value.line(), "divisions: {}, expected a whole number", divisions);
  }
  SINEW_ASSIGN(settings.horizon, yaml.NumberOr("horizon", 0.2, 0, 1e6));
  SINEW_ASSIGN(settings.window, yaml.NumberOr("window", 0, 0, 1e6));
  SINEW_ASSIGN(body.gravity, yaml.NumberOr("gravity", 9.81, 0, 1000));
  SINEW_ASSIGN(body.transition_velocity, yaml.NumberOr("transition_velocity", 0.01, 1e-5, 10));
  SINEW_ASSIGN(body.accuracy, yaml.NumberOr("accuracy", 1e-8, 1e-12, 1e-2));
  SINEW_ASSIGN(body.most_steps, yaml.NumberOr("most_steps", 0, 0, 1e9));
  body.points = PointsOfBox(settings.edges, body.contact, static_cast<int>(divisions));
  body.size = settings.edges.maxCoeff() / 2;
  body.reach = settings.edges.norm() / 2;
  return settings;
}

}  // namespace sinew
