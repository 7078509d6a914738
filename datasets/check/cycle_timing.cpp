#include "datasets/check/cycle_timing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kTimingPhases = 100;
constexpr std::size_t kTimingMostCycles = 40;
constexpr double kTimingAlike = 0.85;     // correlation of a channel's median cycles in two trials
constexpr std::size_t kTimingFewest = 3;  // channels of a grid that tell its shift
constexpr double kTimingPeriod =
    0.15;  // largest difference of the periods: muscles act at other phases at other speeds
constexpr double kTimingDelay_s = 0.06;
constexpr double kTimingShare = 0.07;  // of the cycle
constexpr double kTimingDeviations = 4;
constexpr double kTimingExplains = 0.3;  // of what differs without the shift

using TimingCycle = std::vector<double>;  // [kTimingPhases], mean 0 and norm 1

// Channels by grid and name.
using OfTrial = std::map<std::pair<std::string, std::string>, TimingCycle>;

TimingCycle MedianOf(const Signal& signal, const Cycles& cycles) {
  TimingCycle median(kTimingPhases);
  const auto count = static_cast<std::size_t>(cycles.count());
  const std::size_t stride = (count + kTimingMostCycles - 1) / kTimingMostCycles;
  for (std::size_t i = 0; i < kTimingPhases; ++i) {
    std::vector<double> at;
    for (std::size_t k = 0; k < count; k += stride) {
      const double from = cycles.starts[k];
      const double v = ValueAt(*signal.time, signal.values,
                               from + (cycles.starts[k + 1] - from) * static_cast<double>(i) / kTimingPhases);
      if (std::isfinite(v)) at.push_back(v);
    }
    if (3 * at.size() < count / stride) return {};
    median[i] = Median(std::move(at));
  }
  double mean = 0;
  for (const double v : median) mean += v / kTimingPhases;
  double norm = 0;
  for (double& v : median) {
    v -= mean;
    norm += v * v;
  }
  if (!(norm > 0)) return {};
  for (double& v : median) v /= std::sqrt(norm);
  return median;
}

double CorrelationAt(const TimingCycle& a, const TimingCycle& b, std::size_t shift) {
  double r = 0;
  for (std::size_t i = 0; i < kTimingPhases; ++i) r += a[(i + shift) % kTimingPhases] * b[i];
  return r;
}

// By how much a channel is later in trial a than in trial b; shares of the cycle, [-0.5, 0.5).
struct Shift {
  std::pair<std::string, std::string> channel;
  double share = 0;
  double alike = 0;
  const TimingCycle* a = nullptr;
  const TimingCycle* b = nullptr;
};

double Wrapped(double share) {
  return share - std::floor(share + 0.5);
}

std::vector<Shift> Shifts(const OfTrial& a, const OfTrial& b) {
  std::vector<Shift> shifts;
  for (const auto& [channel, cycle] : a) {
    const auto other = b.find(channel);
    if (other == b.end() || cycle.empty() || other->second.empty()) continue;
    std::size_t best = 0;
    double alike = -1;
    for (std::size_t s = 0; s < kTimingPhases; ++s) {
      const double r = CorrelationAt(cycle, other->second, s);
      if (r > alike) {
        alike = r;
        best = s;
      }
    }
    if (alike < kTimingAlike) continue;
    shifts.push_back(
        {channel, Wrapped(static_cast<double>(best) / kTimingPhases), alike, &cycle, &other->second});
  }
  return shifts;
}

// Median of values on a circle: the one that is nearest to all others.
double CircularMedian(const std::vector<double>& shares) {
  double best = 0;
  double least = INFINITY;
  for (const double middle : shares) {
    double sum = 0;
    for (const double s : shares) sum += std::abs(Wrapped(s - middle));
    if (sum < least) {
      least = sum;
      best = middle;
    }
  }
  return best;
}

struct Device {
  double share = 0;    // median shift
  double scatter = 0;  // median distance from it
  std::size_t channels = 0;
};

std::map<std::string, Device> Devices(const std::vector<Shift>& shifts) {
  std::map<std::string, std::vector<double>> of_grid;
  for (const Shift& shift : shifts) of_grid[shift.channel.first].push_back(shift.share);
  std::map<std::string, Device> devices;
  for (const auto& [grid, shares] : of_grid) {
    if (shares.size() < kTimingFewest) continue;
    Device device{CircularMedian(shares), 0, shares.size()};
    std::vector<double> distances;
    for (const double s : shares) distances.push_back(std::abs(Wrapped(s - device.share)));
    device.scatter = 1.4826 * Median(distances);
    devices[grid] = device;
  }
  return devices;
}

Finding LagOf(const Signal& signal, bool whole_grid, double delay, const std::string& other, bool undecided) {
  Finding finding = signal.Found(FindingKind::kLag);
  if (whole_grid) finding.channel.clear();
  finding.whole = true;
  finding.spans = {signal.Whole()};
  finding.size = delay;
  finding.other = "trial '" + other + "'";
  finding.undecided = undecided;
  return finding;
}

}  // namespace

std::vector<Finding> FindLateInCycles(const std::map<std::string, Cycles>& cycles,
                                      const std::map<std::string, std::vector<const Signal*>>& signals) {
  std::map<std::string, OfTrial> medians;
  for (const auto& [trial, of] : cycles) {
    if (of.count() == 0) continue;
    for (const Signal* signal : signals.at(trial))
      medians[trial][{signal->grid, signal->channel}] = MedianOf(*signal, of);
  }
  std::vector<Finding> found;
  if (medians.size() < 2) return found;
  // Each trial against the one whose cycles last most alike; of two, once.
  for (const auto& [trial, of] : medians) {
    std::vector<std::pair<double, std::string>> others;
    for (const auto& [other, unused] : medians) {
      if (other == trial) continue;
      const double differs = std::abs(std::log(cycles.at(other).period / cycles.at(trial).period));
      if (differs < kTimingPeriod) others.emplace_back(differs, other);
    }
    if (others.empty()) continue;
    std::sort(others.begin(), others.end());
    const bool undecided = others.size() == 1;
    if (undecided && trial > others.front().second) continue;
    // With several others two of them must agree.
    std::map<std::pair<std::string, std::string>, std::vector<double>> late;
    for (std::size_t k = 0; k < std::min<std::size_t>(3, others.size()); ++k) {
      const auto shifts = Shifts(of, medians.at(others[k].second));
      const auto devices = Devices(shifts);
      if (devices.empty()) continue;
      std::vector<double> shares;
      for (const auto& [grid, device] : devices) shares.push_back(device.share);
      const double period = cycles.at(trial).period;
      const double least = std::max(kTimingDelay_s / period, kTimingShare);
      // Where the cycles begin: of two devices that of the one with more channels.
      double begin = CircularMedian(shares);
      if (devices.size() == 2) {
        const auto& [a, b] = std::pair(devices.begin()->second, devices.rbegin()->second);
        begin = a.channels > b.channels ? a.share : b.share;
      }
      for (const auto& [grid, device] : devices) {
        const double delay = Wrapped(device.share - begin);
        if (std::abs(delay) > std::max(least, kTimingDeviations * device.scatter))
          late[{grid, ""}].push_back(delay * period);
      }
      for (const Shift& shift : shifts) {
        const auto device = devices.find(shift.channel.first);
        if (device == devices.end()) continue;
        const double delay = Wrapped(shift.share - device->second.share);
        if (std::abs(delay) < std::max(least, kTimingDeviations * device->second.scatter)) continue;
        const auto usual = static_cast<std::size_t>(std::lround(
                               (device->second.share - std::floor(device->second.share)) * kTimingPhases)) %
                           kTimingPhases;
        const double before = 1 - CorrelationAt(*shift.a, *shift.b, usual);
        if (1 - shift.alike < kTimingExplains * before) late[shift.channel].push_back(delay * period);
      }
    }
    for (const auto& [channel, delays] : late) {
      if (!undecided && delays.size() < 2) continue;
      const Signal* signal = nullptr;
      for (const Signal* s : signals.at(trial)) {
        if (s->grid == channel.first && (channel.second.empty() || s->channel == channel.second)) signal = s;
      }
      if (signal != nullptr)
        found.push_back(
            LagOf(*signal, channel.second.empty(), Median(delays), others.front().second, undecided));
    }
  }
  return found;
}

}  // namespace sinew
