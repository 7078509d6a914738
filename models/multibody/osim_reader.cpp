#include "models/multibody/osim_reader.h"

#include <algorithm>
#include <set>

#include "base/text.h"
#include "models/multibody/osim_frames.h"
#include "models/multibody/osim_functions.h"
#include "models/multibody/osim_joints.h"
#include "models/multibody/osim_xml.h"

namespace sinew {
namespace {

constexpr long kFirstSpatialTransform = 10901;  // older files hold a TransformAxisSet (OpenSim before 2.0)
constexpr long kFirstJointSet = 30500;          // since then joints stand beside the bodies, not inside

// Beyond these, which no part of a person or machine has, moments of inertia about the mass center are lost
// in the rounding of those about the origin, and Simbody refuses the body without saying which.
constexpr double kLargestMass = 1e6;      // [kg]
constexpr double kLargestDistance = 1e3;  // [m]

Result<Mat3> ReadInertia(const OsimXml& xml, const pugi::xml_node& body) {
  std::vector<double> six;  // xx yy zz xy xz yz
  if (body.child("inertia")) {
    SINEW_ASSIGN(six, xml.Numbers(body, "inertia"));
    if (six.size() != 6) {
      return xml.FailAt(body.child("inertia"), "inertia has {} value(s), expected six: xx yy zz xy xz yz",
                        six.size());
    }
  } else {
    for (const char* name :
         {"inertia_xx", "inertia_yy", "inertia_zz", "inertia_xy", "inertia_xz", "inertia_yz"}) {
      SINEW_ASSIGN(const double moment, xml.Number(body, name, 0));
      six.push_back(moment);
    }
  }
  Mat3 inertia;
  inertia << six[0], six[3], six[4], six[3], six[1], six[5], six[4], six[5], six[2];
  if (!inertia.allFinite()) return xml.FailAt(body, "inertia of body '{}' is not finite", NameOf(body));
  return inertia;
}

Result<OsimBody> ReadBody(const OsimXml& xml, const pugi::xml_node& element) {
  OsimBody body;
  body.name = NameOf(element);
  if (body.name.empty()) return xml.FailAt(element, "a {} has no name", element.name());
  SINEW_ASSIGN(body.mass_kg, xml.Number(element, "mass", 0));
  if (!(body.mass_kg >= 0 && body.mass_kg <= kLargestMass)) {
    return xml.FailAt(element.child("mass"), "mass of body '{}' is {} kg, expected a number from 0 to {}",
                      body.name, body.mass_kg, kLargestMass);
  }
  SINEW_ASSIGN(body.mass_center, xml.Vector3(element, "mass_center", Vec3::Zero()));
  if (!(body.mass_center.norm() <= kLargestDistance)) {
    return xml.FailAt(element.child("mass_center"),
                      "mass_center of body '{}' is {} m from its origin, expected at most {}", body.name,
                      body.mass_center.norm(), kLargestDistance);
  }
  SINEW_ASSIGN(body.inertia, ReadInertia(xml, element));
  return body;
}

std::vector<pugi::xml_node> BodyElements(const pugi::xml_node& model) {
  std::vector<pugi::xml_node> elements;
  for (const pugi::xml_node& element : Members(model.child("BodySet"))) {
    if (NameOf(element) != kGround) elements.push_back(element);
  }
  return elements;
}

// The names so far of one kind of element, each of which must be new.
class UniqueNames {
 public:
  UniqueNames(const OsimXml& xml, const char* kind) : xml_(xml), kind_(kind) {}

  Status Add(const pugi::xml_node& element, const std::string& name) {
    if (!seen_.insert(name).second) return xml_.FailAt(element, "there are two {} named '{}'", kind_, name);
    return {};
  }

 private:
  const OsimXml& xml_;
  const char* kind_;
  std::set<std::string> seen_;
};

Status ReadBodies(const OsimXml& xml, const pugi::xml_node& model, OsimModel& read) {
  UniqueNames names(xml, "bodies");
  for (const pugi::xml_node& element : BodyElements(model)) {
    SINEW_ASSIGN(OsimBody body, ReadBody(xml, element));
    SINEW_TRY(names.Add(element, body.name));
    read.bodies.push_back(std::move(body));
  }
  if (read.bodies.empty()) return xml.FailAt(model, "the model has no bodies");
  return {};
}

Status ReadJoints(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& model,
                  OsimModel& read) {
  UniqueNames names(xml, "coordinates");
  const auto add = [&](const pugi::xml_node& element, Result<OsimJoint> joint) -> Status {
    if (!joint) return tl::unexpected(joint.error());
    for (const OsimCoordinate& coordinate : joint->coordinates)
      SINEW_TRY(names.Add(element, coordinate.name));
    read.joints.push_back(std::move(*joint));
    return {};
  };
  if (xml.version() >= kFirstJointSet) {
    for (const pugi::xml_node& element : Members(model.child("JointSet")))
      SINEW_TRY(add(element, ReadJoint(xml, frames, element)));
    return {};
  }
  for (const pugi::xml_node& body : BodyElements(model)) {
    for (const pugi::xml_node& element : Elements(body.child("Joint")))
      SINEW_TRY(add(element, ReadJointInBody(xml, frames, element, NameOf(body))));
  }
  return {};
}

Result<OsimCoupler> ReadCoupler(const OsimXml& xml, const pugi::xml_node& element,
                                const std::vector<std::string>& coordinates) {
  OsimCoupler coupler;
  coupler.name = NameOf(element);
  coupler.independent = ChildText(element, "independent_coordinate_names");
  coupler.dependent = ChildText(element, "dependent_coordinate_name");
  if (SplitBlanks(coupler.independent).size() != 1) {
    return xml.FailAt(element, "coupler '{}' has independent coordinates '{}', supported is one",
                      coupler.name, coupler.independent);
  }
  for (const std::string& name : {coupler.independent, coupler.dependent}) {
    if (std::count(coordinates.begin(), coordinates.end(), name) == 0) {
      return xml.FailAt(element, "coupler '{}' names coordinate '{}', which the model lacks{}", coupler.name,
                        name, Suggestion(name, coordinates));
    }
  }
  const pugi::xml_node function = FindFunction(element, "coupled_coordinates_function");
  if (!function) return xml.FailAt(element, "coupler '{}' has no coupled_coordinates_function", coupler.name);
  SINEW_ASSIGN(const PiecewisePolynomial unscaled, ReadFunction(xml, function));
  SINEW_ASSIGN(const double scale, xml.Number(element, "scale_factor", 1));
  coupler.function = unscaled.Scaled(scale);
  return coupler;
}

Status ReadConstraints(const OsimXml& xml, const pugi::xml_node& model, OsimModel& read) {
  std::vector<std::string> coordinates;
  for (const OsimJoint& joint : read.joints) {
    for (const OsimCoordinate& coordinate : joint.coordinates) coordinates.push_back(coordinate.name);
  }
  for (const pugi::xml_node& element : Members(model.child("ConstraintSet"))) {
    SINEW_ASSIGN(const bool disabled, xml.Flag(element, "isDisabled", false));
    SINEW_ASSIGN(const bool enforced, xml.Flag(element, "isEnforced", true));
    if (disabled || !enforced) continue;
    if (std::string_view(element.name()) != "CoordinateCouplerConstraint") {
      return xml.FailAt(element, "{} '{}' is not supported; supported is CoordinateCouplerConstraint",
                        element.name(), NameOf(element));
    }
    SINEW_ASSIGN(OsimCoupler coupler, ReadCoupler(xml, element, coordinates));
    read.couplers.push_back(std::move(coupler));
  }
  return {};
}

Result<OsimMarker> ReadMarker(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& element) {
  const pugi::xml_node body = element.child("body");  // up to OpenSim 3
  auto frame = body ? frames.Resolve(ChildText(element, "body"), body, "")
                    : frames.ResolveSocket(element, "parent_frame", "");
  if (!frame) return tl::unexpected(frame.error());
  SINEW_ASSIGN(const Vec3 location, xml.Vector3(element, "location", Vec3::Zero()));
  return OsimMarker{NameOf(element), frame->body, frame->location + frame->rotation * location};
}

Status ReadMarkers(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& model,
                   OsimModel& read) {
  UniqueNames names(xml, "markers");
  for (const pugi::xml_node& element : Members(model.child("MarkerSet"))) {
    SINEW_ASSIGN(OsimMarker marker, ReadMarker(xml, frames, element));
    SINEW_TRY(names.Add(element, marker.name));
    read.markers.push_back(std::move(marker));
  }
  return {};
}

}  // namespace

Result<OsimModel> ReadOsim(std::string_view text, const std::string& file_name) {
  SINEW_ASSIGN(const OsimXml xml, OsimXml::Parse(text, file_name));
  const pugi::xml_node model = xml.root().child("Model");
  if (!model) return xml.FailAt(xml.root(), "there is no <Model>; expected an OpenSim model file");
  if (xml.version() < kFirstSpatialTransform) {
    return xml.FailAt(xml.root(),
                      "version {} is older than OpenSim 2.0; open and save the file in a newer OpenSim",
                      xml.version());
  }
  OsimModel read;
  read.name = NameOf(model);
  SINEW_ASSIGN(read.gravity, xml.Vector3(model, "gravity", read.gravity));
  SINEW_TRY(ReadBodies(xml, model, read));
  const OsimFrames frames(xml, model, read.bodies);
  SINEW_TRY(ReadJoints(xml, frames, model, read));
  SINEW_TRY(ReadConstraints(xml, model, read));
  SINEW_TRY(ReadMarkers(xml, frames, model, read));
  return read;
}

}  // namespace sinew
