// Reads the joints of an OpenSim file. Internal to models/.
#pragma once

#include "models/multibody/osim_frames.h"
#include "models/multibody/osim_model.h"
#include "models/multibody/osim_xml.h"

namespace sinew {

/// A joint of OpenSim 4, which names its two frames.
Result<OsimJoint> ReadJoint(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& joint);

/// A joint of OpenSim 2 and 3, which stands inside the body it moves.
Result<OsimJoint> ReadJointInBody(const OsimXml& xml, const OsimFrames& frames, const pugi::xml_node& joint,
                                  const std::string& child_body);

}  // namespace sinew
