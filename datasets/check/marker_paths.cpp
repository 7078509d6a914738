#include "datasets/check/marker_paths.h"

#include <algorithm>
#include <map>
#include <utility>

#include "datasets/check/sides.h"

namespace sinew {
namespace {

void SetMirrors(std::vector<Marker>& markers) {
  for (Marker& marker : markers) {
    const auto names = OtherSides(marker.name);
    if (names.empty()) marker.mirror = static_cast<int>(&marker - markers.data());
    for (const std::string& name : names) {
      const auto other =
          std::find_if(markers.begin(), markers.end(), [&](const Marker& m) { return m.name == name; });
      if (other != markers.end()) marker.mirror = static_cast<int>(other - markers.begin());
    }
  }
}

}  // namespace

std::vector<std::vector<Marker>> MarkerSets(const std::vector<ChannelGroup>& groups) {
  std::map<std::pair<std::string, std::string>, std::map<std::string, Marker>> sets;
  for (const ChannelGroup& group : groups) {
    for (const Signal& signal : group.signals) {
      const std::string& name = signal.channel;
      if (signal.unit != "m" || name.size() < 3 || name[name.size() - 2] != '_') continue;
      const int axis = name.back() - 'x';
      if (axis < 0 || axis > 2) continue;
      const std::string marker = name.substr(0, name.size() - 2);
      if (marker.find("_cop") != std::string::npos) continue;
      Marker& of = sets[{signal.trial, signal.grid}][marker];
      of.name = marker;
      of.axes[static_cast<std::size_t>(axis)] = &signal;
    }
  }
  std::vector<std::vector<Marker>> all;
  for (const auto& [where, set] : sets) {
    std::vector<Marker> markers;
    for (const auto& [name, marker] : set) {
      if (marker.axes[0] != nullptr && marker.axes[1] != nullptr && marker.axes[2] != nullptr)
        markers.push_back(marker);
    }
    if (markers.empty()) continue;
    SetMirrors(markers);
    all.push_back(std::move(markers));
  }
  return all;
}

}  // namespace sinew
