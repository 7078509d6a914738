#include "models/multibody/osim_wraps.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sinew {
namespace {

struct Side {
  int axis;
  int sign;
};

// "x", "+x" or "-X"; "all" and nothing at all mean every side.
std::optional<Side> ParseQuadrant(const std::string& text) {
  std::string word = Lowercase(text);
  if (word.empty() || word == "all" || word == "unassigned") return Side{0, 0};
  const int sign = word[0] == '-' ? -1 : 1;
  if (word[0] == '-' || word[0] == '+') word.erase(0, 1);
  if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') return std::nullopt;
  return Side{word[0] - 'x', sign};
}

bool IsSupported(const pugi::xml_node& object) {
  const std::string_view type = object.name();
  return type == "WrapCylinder" || type == "WrapSphere";
}

}  // namespace

OsimWraps::OsimWraps(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& model)
    : xml_(xml), frames_(frames) {
  for (const pugi::xpath_node& set : model.select_nodes(".//WrapObjectSet")) {
    for (const pugi::xml_node& object : Members(set.node())) objects_.push_back(object);
  }
}

Result<double> OsimWraps::ReadSize(const pugi::xml_node& object, const char* child) const {
  if (!object.child(child))
    return xml_.FailAt(object, "{} '{}' has no {}", object.name(), NameOf(object), child);
  SINEW_ASSIGN(const double size, xml_.Number(object, child, 0));
  if (!(std::isfinite(size) && size > 0)) {
    return xml_.FailAt(object.child(child), "{} of {} '{}' is {} m, expected a number > 0", child,
                       object.name(), NameOf(object), size);
  }
  return size;
}

Result<OsimWrapObject> OsimWraps::ReadObject(const pugi::xml_node& object, const std::string& muscle) const {
  OsimWrapObject read;
  read.name = NameOf(object);
  const std::string_view type = object.name();
  if (type == "WrapCylinder") {
    read.shape = WrapShape::kCylinder;
    SINEW_ASSIGN(read.length, ReadSize(object, "length"));
  } else if (type == "WrapSphere") {
    read.shape = WrapShape::kSphere;
  } else {
    return xml_.FailAt(object,
                       "muscle '{}' wraps over {} '{}', which is not supported; supported are WrapCylinder, "
                       "WrapSphere",
                       muscle, type, read.name);
  }
  SINEW_ASSIGN(read.radius, ReadSize(object, "radius"));
  const std::string quadrant = ChildText(object, "quadrant");
  const auto side = ParseQuadrant(quadrant);
  if (!side) {
    return xml_.FailAt(object.child("quadrant"),
                       "quadrant of {} '{}' is '{}', expected all, x, -x, y, -y, z or -z", type, read.name,
                       quadrant);
  }
  read.side_axis = side->axis;
  read.side = side->sign;

  SINEW_ASSIGN(read.frame, frames_.ResolveElement(object.parent().parent().parent()));
  SINEW_ASSIGN(const Vec3 angles, xml_.Vector3(object, "xyz_body_rotation", Vec3::Zero()));
  SINEW_ASSIGN(const Vec3 translation, xml_.Vector3(object, "translation", Vec3::Zero()));
  read.frame.location += read.frame.rotation * translation;
  read.frame.rotation *= RotationFromEulerXyz(angles);
  return read;
}

Result<std::optional<OsimPathWrap>> OsimWraps::ReadWrap(const pugi::xml_node& wrap, const std::string& muscle,
                                                        int points) const {
  const std::string name = ChildText(wrap, "wrap_object");
  const auto found = std::find_if(objects_.begin(), objects_.end(),
                                  [&](const pugi::xml_node& object) { return NameOf(object) == name; });
  if (found == objects_.end()) {
    std::vector<std::string> names;
    for (const pugi::xml_node& object : objects_) names.push_back(NameOf(object));
    return xml_.FailAt(wrap, "muscle '{}' wraps over '{}', which the model lacks{}", muscle, name,
                       Suggestion(name, names));
  }
  SINEW_ASSIGN(const bool active, xml_.Flag(*found, "active", true));
  if (!active) return std::optional<OsimPathWrap>();

  OsimPathWrap read;
  SINEW_ASSIGN(read.object, ReadObject(*found, muscle));
  read.last = points - 1;
  if (wrap.child("range")) {  // counted from 1; below 1 is the first or last point
    SINEW_ASSIGN(const std::vector<double> range, xml_.Numbers(wrap, "range"));
    const bool whole = range.size() == 2 && std::all_of(range.begin(), range.end(), [&](double number) {
                         return std::trunc(number) == number && number <= points;
                       });
    if (whole && range[0] >= 1) read.first = static_cast<int>(range[0]) - 1;
    if (whole && range[1] >= 1) read.last = static_cast<int>(range[1]) - 1;
    if (!whole || read.first >= read.last) {
      return xml_.FailAt(wrap.child("range"),
                         "range of the wrap over '{}' of muscle '{}' is '{}', expected the numbers of two of "
                         "its {} points in order, -1 for an end",
                         name, muscle, ChildText(wrap, "range"), points);
    }
  }
  return std::optional(std::move(read));
}

Result<std::vector<pugi::xml_node>> OsimWraps::UnsupportedObjects(const pugi::xml_node& path) const {
  std::vector<pugi::xml_node> unsupported;
  for (const pugi::xml_node& element : Members(path.child("PathWrapSet"))) {
    const std::string name = ChildText(element, "wrap_object");
    const auto found = std::find_if(objects_.begin(), objects_.end(),
                                    [&](const pugi::xml_node& object) { return NameOf(object) == name; });
    if (found == objects_.end() || IsSupported(*found)) continue;
    SINEW_ASSIGN(const bool active, xml_.Flag(*found, "active", true));
    if (active) unsupported.push_back(*found);
  }
  return unsupported;
}

Result<std::vector<OsimPathWrap>> OsimWraps::Read(const pugi::xml_node& path, const std::string& muscle,
                                                  int points) const {
  std::vector<OsimPathWrap> wraps;
  for (const pugi::xml_node& element : Members(path.child("PathWrapSet"))) {
    SINEW_ASSIGN(std::optional<OsimPathWrap> wrap, ReadWrap(element, muscle, points));
    if (wrap) wraps.push_back(std::move(*wrap));
  }
  return wraps;
}

}  // namespace sinew
