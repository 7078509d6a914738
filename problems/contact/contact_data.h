// From measured trials to stances: which channels a contact problem needs, and what it computes of them once
// and for all.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "datasets/dataset.h"
#include "identify/layout.h"
#include "models/contact/contact_sums.h"
#include "problems/contact/contact_settings.h"

namespace sinew {

/// One foot on one force plate during one trial, prepared for any parameters.
struct Stance {
  std::string trial;
  std::string plate;
  std::vector<double> time;  ///< [T, s]
  struct Part {
    int group = 0;  ///< index into ContactSettings::Groups()
    ContactSums sums;
  };
  std::vector<Part> parts;
  struct RegionKinematics {
    int region = 0;  ///< index into ContactSettings::regions
    ContactKinematics kinematics;
  };
  std::vector<RegionKinematics> regions;
  std::array<double, 2> resting_cop{};  ///< x, z [m]: stands for the centre of pressure while no face presses
  std::array<int, 6> blocks{};          ///< index into the layout of each of kContactChannels
};

struct ContactData {
  std::vector<Stance> stances;
  Layout layout;  ///< `columns` count base parameters: five per group, in the order of the groups
  std::vector<std::string> notes;  ///< coordinates that rest at their default, samples that were left out
};

/// A trial takes part with every plate whose PLATE_force_y it has. It needs the coordinates of the model as
/// channels (from inverse kinematics, or imported) around the times of the forces.
/// @param margin [s] how far predictions go beyond the measured samples, as far as the motion is known; for
/// effects of sensors that look back or ahead. Errors: no trial with a force; forces and motion that do not
/// overlap in time; a gap in the motion; an .osim that is not there or not understood; a body that it lacks;
/// a channel that is to be fitted but is not measured or varies not.
Result<ContactData> PrepareContactData(const Dataset& data, const ContactSettings& settings, double margin);

/// A sentence per channel, for `sinew list channels contact`.
[[nodiscard]] std::string DescribeContactChannels();

}  // namespace sinew
