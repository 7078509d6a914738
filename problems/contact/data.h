// From measured trials to stances: which channels a contact problem needs, and what it computes of them once
// and for all.
#pragma once

#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "identify/layout.h"
#include "problems/contact/settings.h"
#include "problems/contact/stance.h"

namespace sinew {

struct ContactData {
  std::vector<Stance> stances;
  /// `columns` count base parameters, five per group, in the order of the groups; a sole height per group if
  /// it is fitted; then those of `effects`; then motion errors, stance by stance.
  Layout layout;
  ContactEffectList effects;
  int next_parameter = 0;          ///< index after those of motion errors, which follow the effects
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
