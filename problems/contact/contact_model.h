// The model that a contact problem's motion belongs to.
#pragma once

#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_model.h"
#include "problems/contact/settings.h"

namespace sinew {

struct ContactModel {
  OsimModel osim;
  MultibodyModel multibody;
  std::vector<int> bodies;  ///< of each of ContactSettings::regions
};

/// Errors: the data set holds no such file; those of ReadOsim and MultibodyModel::Build; a region's body that
/// does not exist.
Result<ContactModel> LoadContactModel(const Dataset& data, const ContactSettings& settings);

}  // namespace sinew
