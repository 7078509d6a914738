// What a check of the data says of the channels that a problem uses, as warnings of a result.
#pragma once

#include <string>
#include <vector>

#include "datasets/check/finding.h"
#include "datasets/dataset.h"
#include "identify/layout.h"
#include "identify/warning.h"

namespace sinew {

/// The findings about channels that the problem predicts and compares, and about inputs and clocks of the
/// trials that it uses.
[[nodiscard]] std::vector<Finding> FindingsOf(const Dataset& data, const Layout& layout,
                                              const std::vector<Finding>& findings);

/// The channels that the problem compares with.
[[nodiscard]] std::vector<std::string> ComparedChannels(const Layout& layout);

/// At most five findings, how many more there are, and what was masked before.
[[nodiscard]] std::vector<Warning> DataWarnings(const Dataset& data, const Layout& layout,
                                                const std::string& path);

}  // namespace sinew
