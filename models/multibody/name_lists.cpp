#include "models/multibody/name_lists.h"

#include <fmt/format.h>

#include "base/text.h"

namespace sinew {

std::string ShowNames(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxShown = 3;
  if (names.empty()) return "none";
  if (names.size() <= kMaxShown) return fmt::format("{} ({})", Join(names, ", "), names.size());
  const std::vector<std::string> shown(names.begin(), names.begin() + kMaxShown);
  return fmt::format("{}, ... ({})", Join(shown, ", "), names.size());
}

}  // namespace sinew
