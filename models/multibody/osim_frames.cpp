#include "models/multibody/osim_frames.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "base/text.h"

namespace sinew {
namespace {

// A frame may be offset from another; real files have one or two levels.
constexpr int kDeepestFrame = 16;

// The nearest element above that is a component of its own; sets and lists of objects are not.
std::string OwnerOf(const pugi::xml_node& frame) {
  for (pugi::xml_node above = frame.parent(); above; above = above.parent()) {
    const std::string_view tag = above.name();
    if (tag != "objects" && tag != "frames" && tag != "components" && above.attribute("name"))
      return NameOf(above);
  }
  return "";
}

struct PathTail {
  std::string owner;
  std::string name;
};

PathTail LastTwo(const std::string& path) {
  const auto parts = Split(path, '/');
  return {parts.size() > 1 ? std::string(parts[parts.size() - 2]) : "", std::string(parts.back())};
}

}  // namespace

Mat3 RotationFromEulerXyz(const Vec3& angles) {
  return (Eigen::AngleAxisd(angles.x(), Vec3::UnitX()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()))
      .toRotationMatrix();
}

OsimFrames::OsimFrames(const OsimXml& xml, const pugi::xml_node& model, const std::vector<OsimBody>& bodies)
    : xml_(xml), body_names_{kGround} {
  for (const OsimBody& body : bodies) body_names_.push_back(body.name);
  for (const pugi::xpath_node& found : model.select_nodes(".//PhysicalOffsetFrame"))
    frames_.emplace(OwnerOf(found.node()) + "/" + NameOf(found.node()), found.node());
}

Result<OsimFrame> OsimFrames::Resolve(const std::string& reference, const pugi::xml_node& element,
                                      const std::string& owner) const {
  return Resolve(reference, element, owner, 0);
}

Result<OsimFrame> OsimFrames::ResolveSocket(const pugi::xml_node& element, const std::string& socket,
                                            const std::string& owner) const {
  const std::string tag = "socket_" + socket;
  for (const std::string& name : {tag, tag + "_connectee_name"}) {
    if (element.child(name.c_str()))
      return Resolve(ChildText(element, name.c_str()), element.child(name.c_str()), owner);
  }
  return xml_.FailAt(element, "{} '{}' has no {}", element.name(), NameOf(element), tag);
}

Result<OsimFrame> OsimFrames::ResolveElement(const pugi::xml_node& element) const {
  const std::string_view type = element.name();
  if (type == "Ground") return OsimFrame();
  if (type == "PhysicalOffsetFrame") return Resolve(OwnerOf(element) + "/" + NameOf(element), element, "");
  return Resolve(NameOf(element), element, "");
}

Result<OsimFrame> OsimFrames::Resolve(const std::string& reference, const pugi::xml_node& element,
                                      const std::string& owner, int depth) const {
  if (depth > kDeepestFrame) return xml_.FailAt(element, "frame '{}' is attached to itself", reference);
  PathTail tail = LastTwo(reference);
  if (tail.name == "..") tail = {"", owner};  // the component that holds the frame
  auto offset = frames_.find(tail.owner + "/" + tail.name);
  if (offset == frames_.end()) offset = frames_.find(owner + "/" + tail.name);
  if (offset == frames_.end()) {
    if (std::count(body_names_.begin(), body_names_.end(), tail.name) == 0) {
      return xml_.FailAt(element, "there is no body or frame '{}'{}", reference,
                         Suggestion(tail.name, body_names_));
    }
    OsimFrame frame;
    frame.body = tail.name;
    return frame;
  }

  const pugi::xml_node node = offset->second;
  const char* socket = node.child("socket_parent") ? "socket_parent" : "socket_parent_connectee_name";
  if (!node.child(socket))
    return xml_.FailAt(node, "PhysicalOffsetFrame '{}' has no socket_parent", NameOf(node));
  SINEW_ASSIGN(const OsimFrame parent,
               Resolve(ChildText(node, socket), node.child(socket), OwnerOf(node), depth + 1));
  SINEW_ASSIGN(const Vec3 translation, xml_.Vector3(node, "translation", Vec3::Zero()));
  SINEW_ASSIGN(const Vec3 orientation, xml_.Vector3(node, "orientation", Vec3::Zero()));
  return OsimFrame{parent.body, parent.location + parent.rotation * translation,
                   parent.rotation * RotationFromEulerXyz(orientation)};
}

}  // namespace sinew
