// Finds the body and the place that a name or a path in an OpenSim file means. Internal to models/.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "models/multibody/osim_model.h"
#include "models/multibody/osim_xml.h"

namespace sinew {

/// Rotation of an orientation given by x-y-z angles [rad], each about the axis that the ones before have
/// turned.
Mat3 RotationFromEulerXyz(const Vec3& angles);

/// Bodies and offset frames by name.
class OsimFrames {
 public:
  /// Collects the PhysicalOffsetFrames anywhere in the model.
  OsimFrames(const OsimXml& xml, const pugi::xml_node& model, const std::vector<OsimBody>& bodies);

  /// @param reference  a name ("femur_r", "ground", "pelvis_offset") or path ("/bodyset/femur_r",
  /// "/jointset/hip_r/pelvis_offset", ".." for the owner); @param element  where it stands, for the message;
  /// @param owner  the joint whose own frames a bare name means first. Errors: no such body or frame, or a
  /// circle of frames.
  [[nodiscard]] Result<OsimFrame> Resolve(const std::string& reference, const pugi::xml_node& element,
                                          const std::string& owner) const;

  /// What a socket of the element is connected to: <socket_NAME>, or <socket_NAME_connectee_name> in files of
  /// the first OpenSim 4 versions. Errors: absent, or as for Resolve.
  [[nodiscard]] Result<OsimFrame> ResolveSocket(const pugi::xml_node& element, const std::string& socket,
                                                const std::string& owner) const;

  /// The frame that an element is: a Body, Ground or a PhysicalOffsetFrame. Errors: as for Resolve.
  [[nodiscard]] Result<OsimFrame> ResolveElement(const pugi::xml_node& element) const;

 private:
  [[nodiscard]] Result<OsimFrame> Resolve(const std::string& reference, const pugi::xml_node& element,
                                          const std::string& owner, int depth) const;

  const OsimXml& xml_;
  std::vector<std::string> body_names_;           // with ground
  std::map<std::string, pugi::xml_node> frames_;  // by "owner/name"
};

}  // namespace sinew
