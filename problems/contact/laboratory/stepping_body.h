// Who steps in synthetic contact data: a small robot, or a body with the feet and the load of a person.
#pragma once

#include <array>
#include <map>
#include <string>

#include "base/linear_algebra.h"
#include "problems/contact/laboratory/stepping_robot.h"

namespace sinew {

struct SteppingBody {
  std::string title;
  std::string subject;
  std::string osim;                   ///< text of the model
  std::string settings;               ///< text of contact.yaml
  double size = 1;                    ///< lengths over those of nao_like.osim
  Step step;                          ///< the mean step
  Vec3 sole_size = Vec3::Zero();      ///< along x, y, z [m]
  Vec3 sole_position = Vec3::Zero();  ///< of its middle, in the frame of calcn_r and calcn_l [m]
  std::array<int, 2> squares{};       ///< of the sole in contact.yaml, along x and z
  /// Values of the synthesis that differ from those of the robot, by name.
  std::map<std::string, double> defaults;
};

/// 5.8 kg, 0.573 m, on a sole of 0.16 m that sinks in by 4.5 mm.
[[nodiscard]] SteppingBody RobotThatSteps();

/// 70 kg on a sole of 0.26 x 0.146 m that sinks in by 10 mm: lengths of the robot times 1.625, masses
/// rescaled. The legs keep the robot's proportions and are shorter than a person's, which the contact does
/// not feel: it knows of the body no more than how its soles move.
[[nodiscard]] SteppingBody PersonThatSteps();

}  // namespace sinew
