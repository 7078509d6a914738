#include "datasets/check/sides.h"

#include <cctype>
#include <utility>

namespace sinew {

std::vector<std::string> OtherSides(const std::string& name) {
  std::vector<std::string> names;
  const std::vector<std::pair<std::string, std::string>> sides = {
      {"_r", "_l"}, {"right", "left"}, {"R.", "L."}, {"Right", "Left"}, {"R_", "L_"}};
  for (const auto& [a, b] : sides) {
    for (const auto& [here, there] : {std::pair{a, b}, std::pair{b, a}}) {
      const auto at = name.find(here);
      if (at == std::string::npos) continue;
      const std::size_t end = at + here.size();
      if (here[0] == '_' && end < name.size() && name[end] != '_') continue;
      if (here == "R_" || here == "L_") {
        if (at != 0) continue;
      }
      names.push_back(name.substr(0, at) + there + name.substr(end));
    }
  }
  const bool initial = name.size() > 2 && (name[0] == 'R' || name[0] == 'L') &&
                       std::isupper(static_cast<unsigned char>(name[1])) != 0;
  if (initial) names.push_back((name[0] == 'R' ? "L" : "R") + name.substr(1));
  return names;
}

}  // namespace sinew
