// Shows a set of names in a message: a few of them and how many there are.
#pragma once

#include <string>
#include <vector>

namespace sinew {

/// "R.ASIS, L.ASIS, V.Sacral, ... (39)".
std::string ShowNames(const std::vector<std::string>& names);

}  // namespace sinew
