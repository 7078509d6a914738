#include "problems/emg_shape/learning/windows.h"

#include <cmath>

namespace sinew {

BurstCut::Share EmgWindow::ShareAt(double place) const {
  const BurstCut::Share here = std::isfinite(begin) ? before.Later(place - begin) : BurstCut::Share{1, 0};
  const BurstCut::Share gone = std::isfinite(finish) ? after.Later(place - finish) : BurstCut::Share{};
  return {here.value * (1 - gone.value), here.slope * (1 - gone.value) - here.value * gone.slope};
}

std::vector<EmgWindow> FindEmgWindows(const BurstPattern& bursts, bool apart, const std::vector<int>& cycle,
                                      const std::vector<double>& phase, const std::vector<int>& compared) {
  std::vector<EmgWindow> windows;
  std::vector<std::size_t> window_of;
  int last = 0;
  for (std::size_t i = 0; i < phase.size(); ++i) {
    const int burst = bursts.BurstAt(cycle[i], phase[i]);
    const int together = bursts.CycleOf(burst);
    if (windows.empty() || (apart ? burst != last : together != windows.back().cycle)) {
      EmgWindow window;
      window.first = static_cast<int>(i);
      window.cycle = together;
      if (!windows.empty() && !bursts.cuts.empty()) {
        window.before = bursts.cuts[static_cast<std::size_t>(bursts.IndexOf(burst - 1))];
        window.begin = std::round(cycle[i] + phase[i] - window.before.phase) + window.before.phase;
        windows.back().finish = window.begin;
        windows.back().after = window.before;
      }
      windows.push_back(window);
    }
    windows.back().end = static_cast<int>(i) + 1;
    window_of.push_back(windows.size() - 1);
    last = burst;
  }
  for (const int i : compared) windows[window_of[static_cast<std::size_t>(i)]].fitted = true;
  // Timings move a burst into where its neighbours are.
  std::vector<int> ends;
  for (const EmgWindow& window : windows) ends.push_back(window.end);
  for (std::size_t w = windows.size(); w-- > 1;) windows[w].first = windows[w - 1].first;
  for (std::size_t w = 0; w + 1 < windows.size(); ++w) windows[w].end = ends[w + 1];
  return windows;
}

}  // namespace sinew
