#include "datasets/check/rotations.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sinew {
namespace {

constexpr double kRotationNorm = 0.02;  // largest difference of a rotation's norm from 1

using Quaternion = std::array<const Channel*, 4>;

bool IsQuaternion(const Grid& grid, const std::string& name, Quaternion& parts) {
  std::size_t i = 0;
  for (const char* part : {"_w", "_x", "_y", "_z"}) {
    const auto found = grid.channels.find(name + part);
    if (found == grid.channels.end() || found->second.unit != "1") return false;
    parts[i++] = &found->second;
  }
  return true;
}

// Of NAME_w in one grid; no spans if all is well, or if most of it was never a unit quaternion.
Finding Judge(const Grid& grid, const Quaternion& parts) {
  Finding finding;
  finding.kind = FindingKind::kInconsistent;
  std::size_t wrong = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < grid.time.size(); ++i) {
    double square = 0;
    for (const Channel* part : parts) square += part->values[i] * part->values[i];
    const double off = std::abs(std::sqrt(square) - 1);
    if (!(off > kRotationNorm)) continue;
    finding.size = std::max(finding.size, off);
    if (wrong > 0 && i <= last + 3) {
      finding.spans.back().to = grid.time[i];
    } else {
      finding.spans.push_back({grid.time[i], grid.time[i]});
    }
    last = i;
    ++wrong;
  }
  finding.usual =
      static_cast<double>(wrong) / static_cast<double>(std::max<std::size_t>(1, grid.time.size()));
  return finding;
}

}  // namespace

std::vector<Finding> FindBrokenRotations(const Dataset& dataset) {
  std::vector<Finding> found;
  std::size_t fine = 0;
  for (const auto& [trial_name, trial] : dataset.trials) {
    for (const auto& [grid_name, grid] : trial.grids) {
      for (const auto& [name, channel] : grid.channels) {
        if (name.size() < 3 || name.compare(name.size() - 2, 2, "_w") != 0) continue;
        const std::string base = name.substr(0, name.size() - 2);
        Quaternion parts{};
        if (!IsQuaternion(grid, base, parts)) continue;
        Finding finding = Judge(grid, parts);
        fine += finding.spans.empty() ? 1 : 0;
        if (finding.spans.empty()) continue;
        finding.trial = trial_name;
        finding.grid = grid_name;
        finding.channel = name;
        finding.unit = "1";
        finding.other = base + "_x, " + base + "_y and " + base + "_z";
        found.push_back(std::move(finding));
      }
    }
  }
  // Where no four of a name are ever a rotation, they are something else.
  if (fine == 0) {
    found.erase(std::remove_if(found.begin(), found.end(), [](const Finding& f) { return f.usual > 0.25; }),
                found.end());
  }
  return found;
}

}  // namespace sinew
