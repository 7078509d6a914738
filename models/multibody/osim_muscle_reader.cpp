#include "models/multibody/osim_muscle_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "base/text.h"
#include "models/multibody/osim_frames.h"
#include "models/multibody/osim_functions.h"
#include "models/multibody/osim_wraps.h"
#include "models/multibody/osim_xml.h"

namespace sinew {
namespace {

constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

// The path of a force; since OpenSim 4.5 it may stand in a property of its own.
pugi::xml_node PathOf(const pugi::xml_node& force) {
  const pugi::xml_node direct = force.child("GeometryPath");
  return direct ? direct : force.child("path").child("GeometryPath");
}

class MuscleReader {
 public:
  MuscleReader(const OsimXml& xml, const pugi::xml_node& file, const OsimModel& model)
      : xml_(xml), frames_(xml, file, model.bodies), wraps_(xml, frames_, file) {
    for (const OsimJoint& joint : model.joints) {
      for (const OsimCoordinate& coordinate : joint.coordinates) coordinates_.push_back(coordinate.name);
    }
  }

  Result<OsimMusclePath> Read(const pugi::xml_node& force) const {
    OsimMusclePath read;
    read.name = NameOf(force);
    const pugi::xml_node path = PathOf(force);
    for (const pugi::xml_node& element : Members(path.child("PathPointSet"))) {
      SINEW_ASSIGN(OsimPathPoint point, ReadPoint(element, read.name));
      read.points.push_back(std::move(point));
    }
    if (read.points.size() < 2) {
      return xml_.FailAt(path, "the path of muscle '{}' has {} point(s), expected at least 2", read.name,
                         read.points.size());
    }
    SINEW_ASSIGN(read.wraps, wraps_.Read(path, read.name, static_cast<int>(read.points.size())));
    return read;
  }

  // The first part of its path that is not supported, if any.
  Result<std::optional<UnsupportedMuscle>> FindUnsupported(const pugi::xml_node& force) const {
    const pugi::xml_node path = PathOf(force);
    const auto made = [&](const pugi::xml_node& part) {
      return std::optional<UnsupportedMuscle>(
          {NameOf(force), fmt::format("{} '{}'", part.name(), NameOf(part)), xml_.Line(part)});
    };
    for (const pugi::xml_node& point : Members(path.child("PathPointSet"))) {
      if (!IsSupportedPoint(point.name())) return made(point);
    }
    SINEW_ASSIGN(const auto objects, wraps_.UnsupportedObjects(path));
    if (!objects.empty()) return made(objects.front());
    return std::optional<UnsupportedMuscle>();
  }

 private:
  static bool IsSupportedPoint(std::string_view type) {
    return type == "PathPoint" || type == "ConditionalPathPoint" || type == "MovingPathPoint";
  }

  Result<OsimPathPoint> ReadPoint(const pugi::xml_node& element, const std::string& muscle) const {
    OsimPathPoint point;
    point.name = NameOf(element);
    const std::string_view type = element.name();
    const pugi::xml_node body = element.child("body");  // up to OpenSim 3
    auto frame = body ? frames_.Resolve(ChildText(element, "body"), body, "")
                      : frames_.ResolveSocket(element, "parent_frame", "");
    if (!frame) return tl::unexpected(frame.error());
    point.frame = *frame;
    if (type == "MovingPathPoint") {
      SINEW_ASSIGN(point.motion, ReadMotion(element));
      return point;
    }
    SINEW_ASSIGN(point.location, xml_.Vector3(element, "location", Vec3::Zero()));
    if (type == "ConditionalPathPoint") {
      SINEW_ASSIGN(point.condition, ReadCondition(element));
    } else if (!IsSupportedPoint(type)) {
      return xml_.FailAt(element,
                         "muscle '{}' has a {} '{}', which is not supported; supported are PathPoint, "
                         "ConditionalPathPoint, MovingPathPoint",
                         muscle, type, point.name);
    }
    return point;
  }

  Result<OsimPointCondition> ReadCondition(const pugi::xml_node& element) const {
    OsimPointCondition condition;
    SINEW_ASSIGN(condition.coordinate, ReadCoordinate(element, "coordinate"));
    if (condition.coordinate.empty())
      return xml_.FailAt(element, "{} '{}' has no coordinate", element.name(), NameOf(element));
    SINEW_ASSIGN(const std::vector<double> range, xml_.Numbers(element, "range"));
    if (range.size() != 2 || !(range[0] <= range[1])) {
      return xml_.FailAt(element.child("range") ? element.child("range") : element,
                         "range of {} '{}' is '{}', expected a lower and an upper number", element.name(),
                         NameOf(element), ChildText(element, "range"));
    }
    condition.lower = range[0];
    condition.upper = range[1];
    return condition;
  }

  Result<std::array<OsimPointComponent, 3>> ReadMotion(const pugi::xml_node& element) const {
    std::array<OsimPointComponent, 3> components;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string axis = kAxes[i];
      SINEW_ASSIGN(components[i].coordinate, ReadCoordinate(element, axis + "_coordinate"));
      pugi::xml_node function = FindFunction(element, (axis + "_location").c_str());
      if (!function) {  // OpenSim 2
        const char upper = static_cast<char>(axis[0] - 'x' + 'X');
        function = FindFunction(element, (upper + std::string("Attachment")).c_str());
      }
      if (!function) {
        return xml_.FailAt(element, "{} '{}' has no {}_location", element.name(), NameOf(element), axis);
      }
      SINEW_ASSIGN(components[i].function, ReadFunction(xml_, function));
    }
    return components;
  }

  // Named in <NAME> up to OpenSim 3, in <socket_NAME> since, there as a path. Empty if there is none.
  Result<std::string> ReadCoordinate(const pugi::xml_node& element, const std::string& name) const {
    for (const std::string& tag : {name, "socket_" + name, "socket_" + name + "_connectee_name"}) {
      const std::string path = ChildText(element, tag.c_str());
      if (path.empty()) continue;
      std::string coordinate(Split(path, '/').back());
      if (std::count(coordinates_.begin(), coordinates_.end(), coordinate) == 0) {
        return xml_.FailAt(element.child(tag.c_str()),
                           "{} '{}' names coordinate '{}', which the model lacks{}", element.name(),
                           NameOf(element), coordinate, Suggestion(coordinate, coordinates_));
      }
      return coordinate;
    }
    return std::string();
  }

  const OsimXml& xml_;
  OsimFrames frames_;
  OsimWraps wraps_;
  std::vector<std::string> coordinates_;
};

Result<pugi::xml_node> FindModel(const OsimXml& xml) {
  const pugi::xml_node model = xml.root().child("Model");
  if (!model) return xml.FailAt(xml.root(), "there is no <Model>; expected an OpenSim model file");
  return model;
}

std::vector<pugi::xml_node> ForcesWithPath(const pugi::xml_node& model) {
  std::vector<pugi::xml_node> forces;
  for (const pugi::xml_node& force : Members(model.child("ForceSet"))) {
    if (PathOf(force)) forces.push_back(force);
  }
  return forces;
}

Result<std::vector<std::string>> UniqueNamesOf(const OsimXml& xml,
                                               const std::vector<pugi::xml_node>& forces) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const pugi::xml_node& force : forces) {
    names.push_back(NameOf(force));
    if (!seen.insert(names.back()).second)
      return xml.FailAt(force, "there are two muscles named '{}'", names.back());
  }
  return names;
}

}  // namespace

Result<std::vector<std::string>> ListOsimMuscles(std::string_view text, const std::string& file_name) {
  SINEW_ASSIGN(const OsimXml xml, OsimXml::Parse(text, file_name));
  SINEW_ASSIGN(const pugi::xml_node model, FindModel(xml));
  return UniqueNamesOf(xml, ForcesWithPath(model));
}

Result<std::vector<UnsupportedMuscle>> ListUnsupportedMuscles(std::string_view text,
                                                              const std::string& file_name,
                                                              const OsimModel& model,
                                                              const std::vector<std::string>& muscles) {
  SINEW_ASSIGN(const OsimXml xml, OsimXml::Parse(text, file_name));
  SINEW_ASSIGN(const pugi::xml_node file, FindModel(xml));
  const MuscleReader reader(xml, file, model);
  const std::vector<pugi::xml_node> forces = ForcesWithPath(file);
  std::vector<UnsupportedMuscle> unsupported;
  for (const std::string& muscle : muscles) {
    const auto force = std::find_if(forces.begin(), forces.end(),
                                    [&](const pugi::xml_node& f) { return NameOf(f) == muscle; });
    if (force == forces.end()) continue;
    SINEW_ASSIGN(auto found, reader.FindUnsupported(*force));
    if (found) unsupported.push_back(std::move(*found));
  }
  return unsupported;
}

Result<std::vector<OsimMusclePath>> ReadOsimMuscles(std::string_view text, const std::string& file_name,
                                                    const OsimModel& model,
                                                    const std::vector<std::string>& muscles) {
  SINEW_ASSIGN(const OsimXml xml, OsimXml::Parse(text, file_name));
  SINEW_ASSIGN(const pugi::xml_node file, FindModel(xml));
  const std::vector<pugi::xml_node> forces = ForcesWithPath(file);
  std::vector<std::string> names;
  for (const pugi::xml_node& force : forces) names.push_back(NameOf(force));

  const MuscleReader reader(xml, file, model);
  SINEW_ASSIGN(const auto unsupported, ListUnsupportedMuscles(text, file_name, model, muscles));
  std::vector<OsimMusclePath> paths;
  std::set<std::string> seen;
  for (const std::string& muscle : muscles) {
    const auto found = std::find(names.begin(), names.end(), muscle);
    if (found == names.end())
      return Fail("{}: there is no muscle '{}'{}", file_name, muscle, Suggestion(muscle, names));
    if (!seen.insert(muscle).second) return Fail("muscle '{}' is asked for twice", muscle);
    const auto second = std::find(found + 1, names.end(), muscle);
    if (second != names.end())
      return xml.FailAt(forces[static_cast<std::size_t>(second - names.begin())],
                        "there are two muscles named '{}'", muscle);
    auto path = reader.Read(forces[static_cast<std::size_t>(found - names.begin())]);
    const bool is_unsupported = !unsupported.empty() && unsupported.front().muscle == muscle;
    if (!path && is_unsupported && unsupported.size() > 1) {
      std::vector<std::string> all;
      for (const UnsupportedMuscle& one : unsupported) all.push_back(one.muscle + " (" + one.part + ")");
      return Fail("{}; {} muscles have a part that is not: {}", path.error().message, all.size(),
                  Join(all, ", "));
    }
    if (!path) return tl::unexpected(path.error());
    paths.push_back(std::move(*path));
  }
  return paths;
}

}  // namespace sinew
