// The version of sinew, for result files and --version.
#pragma once

namespace sinew {

inline constexpr const char* kVersion = "0.1.0";

}  // namespace sinew
