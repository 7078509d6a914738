// What the sentences have in common: lists, numbers with units, percent, chances.
#pragma once

#include <string>
#include <vector>

namespace sinew {
struct LeftOutData;
}

namespace sinew::text {

/// "a", "a and b", "a, b and c".
[[nodiscard]] std::string And(const std::vector<std::string>& names);

/// The same, cut after four: "a, b, c, d and 4 others".
[[nodiscard]] std::string Some(std::vector<std::string> names);

/// " N", or nothing for a number without unit.
[[nodiscard]] std::string Unit(const std::string& unit);

/// "12.3 N". @param digits significant ones
[[nodiscard]] std::string WithUnit(double value, const std::string& unit, int digits = 3);

/// "17 %" of 0.17.
[[nodiscard]] std::string Percent(double share);

/// "p < 0.001", "p = 0.04".
[[nodiscard]] std::string Chance(double p);

/// With a capital letter, unless the first word is a name (it has an underscore).
[[nodiscard]] std::string Capitalised(std::string text);

/// A group of trials: "walk", "walk and 5 more".
[[nodiscard]] std::string TrialGroup(const std::vector<std::string>& trials);

/// The same, or "walk from 1 to 2 s".
[[nodiscard]] std::string LeftOutText(const LeftOutData& data);

}  // namespace sinew::text
