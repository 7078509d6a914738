// The contact settings that a command of `sinew data` works with.
#pragma once

#include <string>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/contact/settings.h"

namespace sinew {

/// Among the files of a data set.
constexpr const char* kContactSettingsFile = "contact.yaml";

/// @param path of the data set, which errors name. @param config a file; empty: contact.yaml of the data set
Result<ContactSettings> ContactSettingsOf(const std::string& path, const Dataset& data,
                                          const std::string& config);

}  // namespace sinew
