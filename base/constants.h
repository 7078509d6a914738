// Numbers that C++17's library lacks.
#pragma once

namespace sinew {

inline constexpr double kPi = 3.14159265358979323846;

}  // namespace sinew
