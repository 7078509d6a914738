#include "models/multibody/osim_joints.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "models/multibody/osim_functions.h"

namespace sinew {
namespace {

// Axes of OsimJoint::axes.
constexpr int kRotX = 0, kRotY = 1, kRotZ = 2, kMoveX = 3, kMoveY = 4, kMoveZ = 5;

struct StandardJoint {
  const char* type;
  std::vector<int> axes;  // the axis that each coordinate moves
};

// OpenSim's joints other than CustomJoint. Angles of Ball and Free are x-y-z angles, as OpenSim sets them.
const std::vector<StandardJoint>& StandardJoints() {
  static const std::vector<StandardJoint> joints{
      {"WeldJoint", {}},
      {"PinJoint", {kRotZ}},
      {"SliderJoint", {kMoveX}},
      {"UniversalJoint", {kRotX, kRotY}},
      {"BallJoint", {kRotX, kRotY, kRotZ}},
      {"GimbalJoint", {kRotX, kRotY, kRotZ}},
      {"PlanarJoint", {kRotZ, kMoveX, kMoveY}},
      {"FreeJoint", {kRotX, kRotY, kRotZ, kMoveX, kMoveY, kMoveZ}},
  };
  return joints;
}

constexpr std::array<const char*, 6> kAxisNames{"rotation1",    "rotation2",    "rotation3",
                                                "translation1", "translation2", "translation3"};

std::array<OsimAxis, 6> AxesAtRest() {
  std::array<OsimAxis, 6> axes;
  for (int i = 0; i < 6; ++i) axes[static_cast<std::size_t>(i)].axis = Vec3::Unit(i % 3);
  return axes;
}

Result<OsimCoordinate> ReadCoordinate(const OsimXml& xml, const pugi::xml_node& element) {
  OsimCoordinate coordinate;
  coordinate.name = NameOf(element);
  if (coordinate.name.empty()) return xml.FailAt(element, "a Coordinate has no name");
  SINEW_ASSIGN(coordinate.default_value, xml.Number(element, "default_value", 0));
  if (!std::isfinite(coordinate.default_value))
    return xml.FailAt(element, "default_value of coordinate '{}' is not finite", coordinate.name);
  SINEW_ASSIGN(const std::vector<double> range, xml.Numbers(element, "range"));
  if (element.child("range")) {
    if (range.size() != 2 || !(range[0] <= range[1])) {
      return xml.FailAt(element.child("range"), "range of coordinate '{}' is not a lower and an upper number",
                        coordinate.name);
    }
    coordinate.lower = range[0];
    coordinate.upper = range[1];
  }
  SINEW_ASSIGN(coordinate.clamped, xml.Flag(element, "clamped", false));
  SINEW_ASSIGN(coordinate.locked, xml.Flag(element, "locked", false));
  SINEW_ASSIGN(const bool prescribed, xml.Flag(element, "prescribed", false));
  if (prescribed && FindFunction(element, "prescribed_function")) {
    return xml.FailAt(element,
                      "coordinate '{}' is prescribed by a function, which is not supported; expected "
                      "<prescribed>false</prescribed>",
                      coordinate.name);
  }
  return coordinate;
}

Status ReadCoordinates(const OsimXml& xml, const pugi::xml_node& element, OsimJoint& joint) {
  const auto in_set = Members(element.child("CoordinateSet"));
  for (const pugi::xml_node& node : in_set.empty() ? Elements(element.child("coordinates")) : in_set) {
    if (std::string_view(node.name()) != "Coordinate")
      return xml.FailAt(node, "joint '{}' holds a {}, expected a Coordinate", joint.name, node.name());
    SINEW_ASSIGN(OsimCoordinate coordinate, ReadCoordinate(xml, node));
    joint.coordinates.push_back(std::move(coordinate));
  }
  return {};
}

bool HasCoordinate(const OsimJoint& joint, const std::string& name) {
  return std::any_of(joint.coordinates.begin(), joint.coordinates.end(),
                     [&](const OsimCoordinate& coordinate) { return coordinate.name == name; });
}

Result<OsimAxis> ReadAxis(const OsimXml& xml, const pugi::xml_node& element, const OsimJoint& joint,
                          const Vec3& default_axis) {
  OsimAxis axis;
  SINEW_ASSIGN(axis.axis, xml.Vector3(element, "axis", default_axis));
  const std::string text = ChildText(element, "coordinates");
  const auto names = SplitBlanks(text);
  if (names.size() > 1) {
    return xml.FailAt(element, "{} of joint '{}' depends on {} coordinates, supported is one",
                      NameOf(element), joint.name, names.size());
  }
  if (!names.empty()) {
    axis.coordinate = std::string(names.front());
    if (!HasCoordinate(joint, axis.coordinate)) {
      return xml.FailAt(element.child("coordinates"),
                        "{} of joint '{}' depends on '{}', which the joint lacks", NameOf(element),
                        joint.name, axis.coordinate);
    }
    axis.function = PiecewisePolynomial::Linear(1, 0);
  }
  if (const pugi::xml_node function = FindFunction(element, "function")) {
    SINEW_ASSIGN(axis.function, ReadFunction(xml, function));
  }
  return axis;
}

// As OpenSim: two axes of a triple that are nearly parallel cannot be told apart.
bool AreIndependent(const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double kSmallestCross = 1e-5;
  return a.cross(b).norm() >= kSmallestCross && a.cross(c).norm() >= kSmallestCross &&
         b.cross(c).norm() >= kSmallestCross && std::abs(a.dot(b.cross(c))) >= kSmallestCross;
}

Status ReadSpatialTransform(const OsimXml& xml, const pugi::xml_node& element, OsimJoint& joint) {
  const pugi::xml_node transform = element.child("SpatialTransform");
  if (!transform) return xml.FailAt(element, "CustomJoint '{}' has no SpatialTransform", joint.name);
  for (const pugi::xml_node& node : Elements(transform)) {
    const std::string name = NameOf(node);
    const auto known = std::find(kAxisNames.begin(), kAxisNames.end(), name);
    if (known == kAxisNames.end()) {
      return xml.FailAt(node, "joint '{}' has an axis '{}', expected rotation1..3 or translation1..3",
                        joint.name, name);
    }
    OsimAxis& axis = joint.axes[static_cast<std::size_t>(known - kAxisNames.begin())];
    SINEW_ASSIGN(axis, ReadAxis(xml, node, joint, axis.axis));
  }
  const auto& axes = joint.axes;
  if (!AreIndependent(axes[0].axis, axes[1].axis, axes[2].axis) ||
      !AreIndependent(axes[3].axis, axes[4].axis, axes[5].axis)) {
    return xml.FailAt(transform, "two axes of joint '{}' are parallel or zero, expected independent axes",
                      joint.name);
  }
  return {};
}

// OpenSim's rule: a coordinate is the angle about an axis or the length along it if the axis follows it with
// slope 1 or -1 (the left hip of some models); a coordinate that works through other functions only is
// neither.
MotionType MotionOf(const OsimJoint& joint, const std::string& coordinate) {
  for (std::size_t i = 0; i < joint.axes.size(); ++i) {
    const auto slope = joint.axes[i].function.Slope();
    if (joint.axes[i].coordinate == coordinate && slope && std::abs(*slope) == 1)
      return i < 3 ? MotionType::kRotational : MotionType::kTranslational;
  }
  return MotionType::kCoupled;
}

// A coordinate that works through functions only is an angle if a rotation follows from it (a patella that
// turns and glides with an angle), else a length.
bool IsAngle(const OsimJoint& joint, const OsimCoordinate& coordinate) {
  if (coordinate.motion != MotionType::kCoupled) return coordinate.motion == MotionType::kRotational;
  return std::any_of(joint.axes.begin(), joint.axes.begin() + 3,
                     [&](const OsimAxis& axis) { return axis.coordinate == coordinate.name; });
}

Status ReadStandardAxes(const OsimXml& xml, const pugi::xml_node& element, const StandardJoint& standard,
                        OsimJoint& joint) {
  if (joint.coordinates.size() != standard.axes.size()) {
    return xml.FailAt(element, "{} '{}' has {} coordinate(s), expected {}", joint.type, joint.name,
                      joint.coordinates.size(), standard.axes.size());
  }
  for (std::size_t i = 0; i < standard.axes.size(); ++i) {
    OsimAxis& axis = joint.axes[static_cast<std::size_t>(standard.axes[i])];
    axis.coordinate = joint.coordinates[i].name;
    axis.function = PiecewisePolynomial::Linear(1, 0);
  }
  return {};
}

// Everything but the frames.
Result<OsimJoint> ReadMobility(const OsimXml& xml, const pugi::xml_node& element) {
  OsimJoint joint;
  joint.name = NameOf(element);
  joint.type = element.name();
  joint.axes = AxesAtRest();
  SINEW_ASSIGN(const bool reversed, xml.Flag(element, "reverse", false));
  if (reversed) {
    return xml.FailAt(element, "joint '{}' is reversed, which is not supported; expected parent to child",
                      joint.name);
  }
  SINEW_TRY(ReadCoordinates(xml, element, joint));
  if (joint.type == "CustomJoint") {
    SINEW_TRY(ReadSpatialTransform(xml, element, joint));
  } else {
    const auto& standard = StandardJoints();
    const auto found = std::find_if(standard.begin(), standard.end(),
                                    [&](const StandardJoint& kind) { return joint.type == kind.type; });
    if (found == standard.end()) {
      std::vector<std::string> supported{"CustomJoint"};
      for (const StandardJoint& kind : standard) supported.emplace_back(kind.type);
      return xml.FailAt(element, "{} '{}' is not supported; supported are {}", joint.type, joint.name,
                        Join(supported, ", "));
    }
    SINEW_TRY(ReadStandardAxes(xml, element, *found, joint));
  }
  for (OsimCoordinate& coordinate : joint.coordinates) {
    coordinate.motion = MotionOf(joint, coordinate.name);
    coordinate.is_angle = IsAngle(joint, coordinate);
  }
  return joint;
}

Result<OsimFrame> OffsetFrom(const OsimXml& xml, const pugi::xml_node& element, OsimFrame body,
                             const char* location, const char* orientation) {
  SINEW_ASSIGN(body.location, xml.Vector3(element, location, Vec3::Zero()));
  SINEW_ASSIGN(const Vec3 angles, xml.Vector3(element, orientation, Vec3::Zero()));
  body.rotation = RotationFromEulerXyz(angles);
  return body;
}

}  // namespace

Result<OsimJoint> ReadJoint(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& joint) {
  SINEW_ASSIGN(OsimJoint read, ReadMobility(xml, joint));
  SINEW_ASSIGN(read.parent, frames.ResolveSocket(joint, "parent_frame", read.name));
  SINEW_ASSIGN(read.child, frames.ResolveSocket(joint, "child_frame", read.name));
  return read;
}

Result<OsimJoint> ReadJointInBody(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& joint,
                                  const std::string& child_body) {
  SINEW_ASSIGN(OsimJoint read, ReadMobility(xml, joint));
  const pugi::xml_node parent = joint.child("parent_body");
  if (!parent) return xml.FailAt(joint, "joint '{}' of body '{}' has no parent_body", read.name, child_body);
  SINEW_ASSIGN(OsimFrame parent_body, frames.Resolve(ChildText(joint, "parent_body"), parent, read.name));
  SINEW_ASSIGN(read.parent,
               OffsetFrom(xml, joint, parent_body, "location_in_parent", "orientation_in_parent"));
  OsimFrame child;
  child.body = child_body;
  SINEW_ASSIGN(read.child, OffsetFrom(xml, joint, child, "location", "orientation"));
  return read;
}

}  // namespace sinew
