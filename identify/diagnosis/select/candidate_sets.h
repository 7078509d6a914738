// Sets of candidates, as increasing indices.
#pragma once

#include <vector>

namespace sinew::diagnosis {

/// `set` with `c`; without `c`.
[[nodiscard]] std::vector<int> With(std::vector<int> set, int c);
[[nodiscard]] std::vector<int> Without(std::vector<int> set, int c);
/// True if `c` is a member.
[[nodiscard]] bool Contains(const std::vector<int>& set, int c);
/// True if `smaller` is `set` without one of its members.
[[nodiscard]] bool IsOneLess(const std::vector<int>& smaller, const std::vector<int>& set);
/// That member. @pre IsOneLess
[[nodiscard]] int MemberBeyond(const std::vector<int>& smaller, const std::vector<int>& set);

}  // namespace sinew::diagnosis
