#include "datasets/stances/stances.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/order_statistics.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr double kStanceLower = 0.1;  // of the range of the force: what lies below may be unloaded
constexpr double kStanceOnDeviations = 6;
constexpr double kStanceOffDeviations = 3;
constexpr double kStanceOnShare = 0.03;  // of the largest force
constexpr double kStanceOffShare = 0.015;
constexpr double kStanceUnloaded = 0.02;  // share of samples that must be unloaded, and loaded
constexpr double kStanceLongestInterruption_s = 0.04;
constexpr double kStanceLight = 0.2;  // of the median peak
constexpr double kStanceShortest_s = 0.1;
constexpr double kStanceShort = 1.0 / 3;  // of the median duration
constexpr double kStanceLong = 1.6;       // the same
constexpr std::size_t kStanceMany = 8;    // contacts that tell how much durations scatter:
constexpr double kStanceScatter = 6;      // robust deviations, and
constexpr double kStanceLonger = 0.15;    // of the median duration are too long
constexpr double kStanceJumpTime_s = 0.15;
constexpr double kStanceJump_m = 0.25;  // within it, more than usual
constexpr double kStancePlace_m = 0.6;
constexpr double kStanceCopLoad = 0.15;  // of the peak: below it the centre of pressure is rough

const std::vector<double>* ChannelOf(const Grid& grid, const std::string& name) {
  const auto found = grid.channels.find(name);
  return found == grid.channels.end() ? nullptr : &found->second.values;
}

PlateContacts Thresholds(const std::string& plate, const std::vector<double>& force) {
  PlateContacts found;
  found.plate = plate;
  const std::size_t known = CountFinite(force);
  if (known < 20) {
    found.seen = false;
    return found;
  }
  const auto ends = FiniteQuantiles(force, {0.01, 0.99});
  const double low = ends[0];
  const double high = ends[1];
  const auto unloaded = [&](auto add) {
    for (const double f : force) {
      if (std::isfinite(f) && f < low + kStanceLower * (high - low)) add(f);
    }
  };
  std::size_t below = 0;
  unloaded([&](double) { ++below; });
  const auto n = static_cast<double>(known);
  const auto count = static_cast<double>(below);
  found.seen = high > low && count > kStanceUnloaded * n && count < (1 - kStanceUnloaded) * n;
  if (!found.seen) return found;
  found.level_N = QuantileOf(0.5, unloaded);
  found.noise_N = RobustDeviationOf(unloaded);
  const double load = high - found.level_N;
  found.on_N = found.level_N + std::max(kStanceOnDeviations * found.noise_N, kStanceOnShare * load);
  found.off_N = found.level_N + std::max(kStanceOffDeviations * found.noise_N, kStanceOffShare * load);
  return found;
}

struct Stretch {
  std::size_t first;
  std::size_t last;
};

// Samples from where the force rises above `off` to where it falls below it, if it exceeds `on` between.
std::vector<Stretch> Loaded(const std::vector<double>& time, const std::vector<double>& force,
                            const PlateContacts& plate) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < force.size();) {
    if (!(force[i] > plate.off_N)) {
      ++i;
      continue;
    }
    std::size_t last = i;
    double peak = force[i];
    // A gap inside belongs to the contact if it is loaded on both sides.
    while (last + 1 < force.size() && !(force[last + 1] <= plate.off_N))
      peak = std::fmax(peak, force[++last]);
    const std::size_t next = last + 1;
    while (last > i && std::isnan(force[last])) --last;
    if (peak > plate.on_N) {
      if (!stretches.empty() && time[i] - time[stretches.back().last] < kStanceLongestInterruption_s) {
        stretches.back().last = last;
      } else {
        stretches.push_back({i, last});
      }
    }
    i = next;
  }
  return stretches;
}

// Largest distance that the centre of pressure moves within kStanceJumpTime_s.
double CopJump(const std::vector<double>& time, const std::vector<double>& force,
               const std::vector<double>& x, const std::vector<double>& z, const Stretch& stretch,
               double least_N) {
  double largest = 0;
  std::size_t from = stretch.first;
  for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
    while (time[i] - time[from] > kStanceJumpTime_s) ++from;
    if (!(force[i] > least_N) || !(force[from] > least_N)) continue;
    const double moved = std::hypot(x[i] - x[from], z[i] - z[from]);
    if (std::isfinite(moved)) largest = std::max(largest, moved);
  }
  return largest;
}

void SetPressure(const Grid& grid, const Stretch& stretch, const std::vector<double>& force,
                 Contact& contact) {
  contact.cop_x_m = contact.cop_z_m = std::numeric_limits<double>::quiet_NaN();
  const auto* x = ChannelOf(grid, contact.plate + "_cop_x");
  const auto* z = ChannelOf(grid, contact.plate + "_cop_z");
  if (x == nullptr || z == nullptr) return;
  std::vector<double> xs;
  std::vector<double> zs;
  for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
    if (!(force[i] > kStanceCopLoad * contact.peak_N) || !std::isfinite((*x)[i] + (*z)[i])) continue;
    xs.push_back((*x)[i]);
    zs.push_back((*z)[i]);
  }
  if (xs.empty()) return;
  contact.cop_x_m = Median(xs);
  contact.cop_z_m = Median(zs);
  contact.cop_jump_m = CopJump(grid.time, force, *x, *z, stretch, kStanceCopLoad * contact.peak_N);
}

int Places(const std::vector<Contact>& contacts) {
  std::vector<std::pair<double, double>> places;
  for (const Contact& contact : contacts) {
    if (!std::isfinite(contact.cop_x_m)) continue;
    const bool known = std::any_of(places.begin(), places.end(), [&](const auto& place) {
      return std::hypot(place.first - contact.cop_x_m, place.second - contact.cop_z_m) < kStancePlace_m;
    });
    if (!known) places.emplace_back(contact.cop_x_m, contact.cop_z_m);
  }
  return std::max(1, static_cast<int>(places.size()));
}

// What is usual is told by the whole contacts of all plates.
void Judge(std::vector<Contact>& contacts) {
  std::vector<double> peaks;
  std::vector<double> durations;
  std::vector<double> jumps;
  for (const Contact& contact : contacts) {
    if (contact.fault == ContactFault::kNone) {
      durations.push_back(contact.to - contact.from);
      jumps.push_back(contact.cop_jump_m);
    }
    peaks.push_back(contact.peak_N);
  }
  if (durations.empty()) return;
  const double usual_peak = Quantile(peaks, 0.75);
  const double usual_jump = Median(jumps);
  std::vector<double> whole;
  for (const Contact& contact : contacts) {
    if (contact.fault == ContactFault::kNone && contact.peak_N > kStanceLight * usual_peak)
      whole.push_back(contact.to - contact.from);
  }
  const double usual_duration = whole.empty() ? Median(durations) : Median(whole);
  const double scatter = whole.empty() ? 0 : RobustDeviation(whole);
  const double most_scatter = std::max(kStanceScatter * scatter, kStanceLonger * usual_duration);
  std::vector<double> supports;
  for (const Contact& contact : contacts) supports.push_back(contact.double_support_s);
  const double usual_support = Median(supports);
  for (Contact& contact : contacts) {
    const double duration = contact.to - contact.from;
    if (contact.fault != ContactFault::kNone) continue;
    if (contact.peak_N < kStanceLight * usual_peak) {
      contact.fault = ContactFault::kLight;
    } else if (duration < kStanceShortest_s || duration < kStanceShort * usual_duration) {
      contact.fault = ContactFault::kShort;
    } else if (contact.cop_jump_m > std::min(usual_jump, kStanceJump_m) + kStanceJump_m) {
      contact.fault = ContactFault::kTwoFeet;
    } else if (whole.size() >= kStanceMany && duration > usual_duration + most_scatter) {
      // The other foot is down for as much longer: it came too early to this plate, or left it too late.
      const bool both = contact.double_support_s > usual_support + 0.5 * (duration - usual_duration);
      contact.fault = both ? ContactFault::kTwoFeet : ContactFault::kLong;
    } else if (whole.size() >= 3 && duration > kStanceLong * usual_duration) {
      contact.fault = ContactFault::kLong;
    }
  }
}

}  // namespace

const char* ToString(ContactFault fault) {
  switch (fault) {
    case ContactFault::kNone:
      return "";
    case ContactFault::kBegan:
      return "began";
    case ContactFault::kEnds:
      return "ends";
    case ContactFault::kLight:
      return "light";
    case ContactFault::kShort:
      return "short";
    case ContactFault::kLong:
      return "long";
    case ContactFault::kTwoFeet:
      return "two_feet";
    case ContactFault::kGap:
      return "gap";
  }
  return "";
}

std::vector<std::string> PlateNames(const Trial& trial) {
  const std::string ending = "_force_y";
  std::vector<std::string> plates;
  for (const std::string& name : trial.ChannelNames()) {
    if (name.size() > ending.size() &&
        name.compare(name.size() - ending.size(), ending.size(), ending) == 0) {
      plates.push_back(name.substr(0, name.size() - ending.size()));
    }
  }
  std::sort(plates.begin(), plates.end());
  plates.erase(std::unique(plates.begin(), plates.end()), plates.end());
  return plates;
}

TrialContacts FindContacts(const Trial& trial) {
  TrialContacts found;
  for (const std::string& plate : PlateNames(trial)) {
    const auto [grid, channel] = trial.Find(plate + "_force_y");
    const std::vector<double>& force = channel->values;
    PlateContacts thresholds = Thresholds(plate, force);
    std::vector<Contact> contacts;
    if (thresholds.seen) {
      for (const Stretch& stretch : Loaded(grid->time, force, thresholds)) {
        Contact contact;
        contact.plate = plate;
        contact.from = grid->time[stretch.first];
        contact.to = grid->time[stretch.last];
        const auto begin = force.begin() + static_cast<std::ptrdiff_t>(stretch.first);
        const auto inside = Finite({begin, force.begin() + static_cast<std::ptrdiff_t>(stretch.last) + 1});
        contact.peak_N = Quantile(inside, 0.98) - thresholds.level_N;
        SetPressure(*grid, stretch, force, contact);
        if (stretch.first == 0) {
          contact.fault = ContactFault::kBegan;
        } else if (stretch.last + 1 == force.size()) {
          contact.fault = ContactFault::kEnds;
        } else if (inside.size() < stretch.last - stretch.first + 1) {
          contact.fault = ContactFault::kGap;
        }
        contacts.push_back(contact);
      }
      thresholds.places = Places(contacts);
    }
    found.contacts.insert(found.contacts.end(), contacts.begin(), contacts.end());
    found.plates.push_back(thresholds);
  }
  std::stable_sort(found.contacts.begin(), found.contacts.end(),
                   [](const Contact& a, const Contact& b) { return a.from < b.from; });
  for (Contact& contact : found.contacts) {
    for (const Contact& other : found.contacts) {
      if (other.plate != contact.plate)
        contact.double_support_s +=
            std::max(0.0, std::min(contact.to, other.to) - std::max(contact.from, other.from));
    }
  }
  Judge(found.contacts);
  return found;
}

}  // namespace sinew
