// Mathematical constants that the C++17 library does not have.
#pragma once

namespace sinew {

inline constexpr double kPi = 3.14159265358979323846;

}  // namespace sinew
