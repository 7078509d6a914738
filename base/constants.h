// Mathematical constants that the C++17 library lacks, or has only under a long name.
#pragma once

#include <limits>

namespace sinew {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace sinew
