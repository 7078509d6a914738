#include "identify/probe_grid.h"

namespace sinew {

std::vector<ProbeValues> ProbeGrid(const std::vector<Parameter>& parameters, const std::vector<int>& group) {
  std::vector<ProbeValues> grid{{}};
  for (const int index : group) {
    const std::vector<double>& values = parameters[static_cast<std::size_t>(index)].probes;
    if (values.empty()) continue;
    std::vector<ProbeValues> finer;
    for (const ProbeValues& entry : grid) {
      for (const double value : values) {
        finer.push_back(entry);
        finer.back().emplace_back(index, value);
      }
    }
    grid = std::move(finer);
  }
  return grid;
}

}  // namespace sinew
