#include "problems/contact/contact_model.h"

#include <string>

#include "base/text.h"
#include "models/multibody/osim_reader.h"

namespace sinew {

Result<ContactModel> LoadContactModel(const Dataset& data, const ContactSettings& settings) {
  const auto file = data.files.find(settings.model);
  if (file == data.files.end()) {
    std::vector<std::string> names;
    for (const auto& [name, text] : data.files) names.push_back(name);
    return Fail(
        "the data set holds no file '{}' (its files: {}); import the .osim that the motion belongs to",
        settings.model, names.empty() ? "none" : Join(names, ", "));
  }
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(file->second, settings.model));
  SINEW_ASSIGN(MultibodyModel multibody, MultibodyModel::Build(osim));
  std::vector<int> bodies;
  for (const ContactRegionSettings& region : settings.regions) {
    const auto index = multibody.BodyIndex(region.body);
    if (!index) return Fail("contact region '{}': {}", region.region.name, index.error().message);
    bodies.push_back(*index);
  }
  return ContactModel{osim, std::move(multibody), std::move(bodies)};
}

}  // namespace sinew
