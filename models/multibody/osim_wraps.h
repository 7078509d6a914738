// Reads the wrap objects of an OpenSim file. Internal to models/.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/multibody/osim_frames.h"
#include "models/multibody/osim_muscle_path.h"
#include "models/multibody/osim_xml.h"

namespace sinew {

/// Which objects of a model a path may wrap over.
class OsimWraps {
 public:
  /// Collects the members of the WrapObjectSets of all bodies, frames and of ground; none is read yet.
  OsimWraps(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& model);

  /// The wraps of a GeometryPath with `points` points, without those whose object is not active.
  /// @param muscle  for messages. Errors: no object of that name, one of an unsupported shape, impossible
  /// numbers.
  [[nodiscard]] Result<std::vector<OsimPathWrap>> Read(const pugi::xml_node& path, const std::string& muscle,
                                                       int points) const;

  /// The active objects of a GeometryPath whose shape Read refuses. Errors: `active` is no truth value.
  [[nodiscard]] Result<std::vector<pugi::xml_node>> UnsupportedObjects(const pugi::xml_node& path) const;

 private:
  [[nodiscard]] Result<std::optional<OsimPathWrap>> ReadWrap(const pugi::xml_node& wrap,
                                                             const std::string& muscle, int points) const;
  [[nodiscard]] Result<OsimWrapObject> ReadObject(const pugi::xml_node& object,
                                                  const std::string& muscle) const;
  [[nodiscard]] Result<double> ReadSize(const pugi::xml_node& object, const char* child) const;

  const OsimXml& xml_;
  const OsimFrames& frames_;
  std::vector<pugi::xml_node> objects_;
};

}  // namespace sinew
