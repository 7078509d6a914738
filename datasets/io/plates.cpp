#include "datasets/io/plates.h"

#include <algorithm>

#include "base/text.h"
#include "datasets/io/cells.h"

namespace sinew {
namespace {

std::string FirstWithAxes(const std::vector<std::string>& candidates, const std::vector<std::string>& names) {
  for (const std::string& candidate : candidates) {
    if (HasAxes(candidate, names)) return candidate;
  }
  return {};
}

// "ground_force_1_" -> ground_torque_1_, ground_moment_1_m, ...; programs do not agree.
std::vector<std::string> TorqueCandidates(const std::string& force_stem) {
  std::vector<std::string> candidates;
  const auto at = force_stem.rfind("force");
  if (at == std::string::npos) return candidates;
  for (const char* word : {"torque", "moment"}) {
    std::string stem = force_stem;
    stem.replace(at, 5, word);
    candidates.push_back(stem);
    candidates.push_back(stem + "m");
  }
  return candidates;
}

// @param stem what stands before the letters v and p: "ground_force_"
PlateColumns ColumnsOfStem(const std::string& plate, const std::string& stem,
                           const std::vector<std::string>& names) {
  return {plate, stem + "v", FirstWithAxes({stem + "p"}, names),
          FirstWithAxes(TorqueCandidates(stem), names)};
}

}  // namespace

bool HasAxes(const std::string& identifier, const std::vector<std::string>& names) {
  return std::all_of(std::begin("xyz"), std::end("xyz") - 1, [&](char axis) {
    return std::find(names.begin(), names.end(), identifier + axis) != names.end();
  });
}

Result<std::vector<PlatePrefix>> ParsePlates(std::string_view text) {
  std::vector<PlatePrefix> plates;
  for (const std::string_view piece : Split(text, ',')) {
    const auto at = piece.find('=');
    const std::string plate(Trim(piece.substr(0, at)));
    const std::string prefix(at == std::string_view::npos ? std::string_view() : Trim(piece.substr(at + 1)));
    if (plate.empty() || prefix.empty()) {
      return Fail("plates: {} is not PLATE=PREFIX; expected for example right=ground_,left=1_ground_",
                  Quoted(piece));
    }
    for (const PlatePrefix& other : plates) {
      if (other.plate == plate) return Fail("plates: {} appears twice", Quoted(plate));
    }
    plates.push_back({plate, prefix});
  }
  return plates;
}

Result<std::optional<PlateColumns>> FindPlateColumns(const PlatePrefix& prefix,
                                                     const std::vector<std::string>& names) {
  std::vector<std::string> stems = {prefix.prefix + "force_", prefix.prefix};
  if (!prefix.prefix.empty() && prefix.prefix.back() == 'v')
    stems.push_back(prefix.prefix.substr(0, prefix.prefix.size() - 1));
  std::optional<PlateColumns> found;
  for (const std::string& stem : stems) {
    if (!HasAxes(stem + "v", names)) continue;
    if (found) {
      return Fail("plate '{}': the prefix '{}' fits {}x and {}vx; write a longer one", prefix.plate,
                  prefix.prefix, found->force, stem);
    }
    found = ColumnsOfStem(prefix.plate, stem, names);
  }
  return found;
}

}  // namespace sinew
