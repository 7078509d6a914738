#include "datasets/check/signals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "datasets/order_statistics.h"

namespace sinew {
namespace {

// Sets the centre of pressure and the free moment of an unloaded plate to NaN. A force at any angle counts,
// so that a wrong axis does not hide them.
void LeaveOutUnloaded(const std::string& channel, const Grid& grid, SignalValues& values) {
  const auto cop = channel.find("_cop_");
  const auto at = cop != std::string::npos ? cop : channel.find("_moment_");
  if (at == std::string::npos) return;
  const std::string plate = channel.substr(0, at);
  std::vector<double> load(values.size(), 0);
  bool found = false;
  for (const char* axis : {"_force_x", "_force_y", "_force_z"}) {
    const auto force = grid.channels.find(plate + axis);
    if (force == grid.channels.end()) continue;
    found = true;
    for (std::size_t i = 0; i < load.size(); ++i) load[i] = std::hypot(load[i], force->second.values[i]);
  }
  if (!found) return;
  const double heavy = FiniteQuantiles(load, {0.99}).front();
  const double most = std::isfinite(heavy) ? heavy : 0;
  for (std::size_t i = 0; i < load.size(); ++i) {
    if (!(load[i] > kUnloadedShare * most)) values.MakeGap(i);
  }
}

}  // namespace

// What another copy holds, too, stays as it is.
std::vector<double>& SignalValues::Own() {
  if (own_.use_count() != 1) own_ = std::make_shared<std::vector<double>>(*values_);
  values_ = own_.get();
  return *own_;
}

void SignalValues::MakeGap(std::size_t sample) {
  if (!std::isnan((*values_)[sample])) Own()[sample] = std::numeric_limits<double>::quiet_NaN();
}

void SignalValues::MakeGap(std::size_t first, std::size_t end) {
  for (std::size_t i = first; i < end; ++i) MakeGap(i);
}

Finding Signal::Found(FindingKind found) const {
  Finding finding;
  finding.kind = found;
  finding.trial = trial;
  finding.grid = grid;
  finding.channel = channel;
  finding.unit = unit;
  return finding;
}

std::vector<ChannelGroup> GroupSignals(const Dataset& dataset) {
  std::map<std::string, ChannelGroup> groups;
  for (const auto& [trial_name, trial] : dataset.trials) {
    std::map<std::string, int> count;
    for (const auto& [grid_name, grid] : trial.grids) {
      for (const auto& [name, channel] : grid.channels) ++count[name];
    }
    for (const auto& [grid_name, grid] : trial.grids) {
      for (const auto& [name, channel] : grid.channels) {
        Signal signal{trial_name,   trial.task,   grid_name,  name,          trial.role,
                      channel.kind, channel.unit, &grid.time, channel.values};
        LeaveOutUnloaded(name, grid, signal.values);
        ChannelGroup& group = groups[name + "/" + channel.unit + (count[name] > 1 ? "/" + grid_name : "")];
        group.channel = name;
        group.signals.push_back(std::move(signal));
      }
    }
  }
  std::vector<ChannelGroup> all;
  all.reserve(groups.size());
  for (auto& [key, group] : groups) all.push_back(std::move(group));
  return all;
}

std::vector<ChannelGroup> ByTask(const std::vector<ChannelGroup>& groups) {
  std::vector<ChannelGroup> all;
  for (const ChannelGroup& group : groups) {
    std::map<std::string, ChannelGroup> of_task;
    for (const Signal& signal : group.signals) {
      ChannelGroup& own = of_task[signal.task];
      own.channel = group.channel;
      own.signals.push_back(signal);
    }
    for (auto& [task, own] : of_task) all.push_back(std::move(own));
  }
  return all;
}

double RangeOf(const Signal& signal) {
  if (CountFinite(signal.values) < 10) return 0;
  const auto ends = FiniteQuantiles(signal.values, {0.02, 0.98});
  return ends[1] - ends[0];
}

std::vector<Run> EqualRuns(const std::vector<double>& values, std::size_t shortest) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < values.size();) {
    std::size_t last = i;
    while (last + 1 < values.size() && values[last + 1] == values[i]) ++last;
    if (std::isfinite(values[i]) && last - i + 1 >= shortest) runs.push_back({i, last, values[i]});
    i = last + 1;
  }
  return runs;
}

std::vector<double> Increments(const std::vector<double>& values) {
  std::vector<double> increments(values.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 1; i < values.size(); ++i) increments[i] = values[i] - values[i - 1];
  return increments;
}

}  // namespace sinew
