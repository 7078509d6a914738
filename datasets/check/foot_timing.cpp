#include "datasets/check/foot_timing.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "datasets/check/marker_paths.h"
#include "datasets/robust.h"
#include "datasets/stances/stances.h"

namespace sinew {
namespace {

constexpr std::size_t kFootFewestMarkers = 4;
constexpr double kFootHeight_m = 0.25;    // above the lowest marker: it may be one of a foot
constexpr double kFootOnFloor_m = 0.015;  // above a marker's own lowest place
constexpr double kFootRest_m_s = 0.5;     // slower markers stand
constexpr double kFootNear_m = 0.5;       // from the centre of pressure
constexpr double kFootOne_m = 0.3;        // from the marker that is nearest to it
constexpr double kFootSwings_m_s = 1.5;   // a marker that walks is faster at times
constexpr double kFootGap_s = 0.04;
constexpr double kFootDelay_s = 0.05;
constexpr double kFootScatter = 0.75;

// A marker near the floor.
struct FootMarker {
  const Marker* marker = nullptr;
  Path path;
  Path velocity;             // [frames, m/s]
  std::vector<bool> stands;  // [frames]
};

double Slowness(const Vec3& velocity, const Vec3& floor) {
  return (velocity - floor).norm();
}

Path Velocity(const Path& path, const std::vector<double>& time) {
  constexpr std::size_t kWidth = 1;
  Path velocity(path.size(), Vec3(NAN, NAN, NAN));
  for (std::size_t i = kWidth; i + kWidth < path.size(); ++i)
    velocity[i] = (path[i + kWidth] - path[i - kWidth]) / (time[i + kWidth] - time[i - kWidth]);
  return velocity;
}

double Lowest(const Marker& marker) {
  const auto heights = Finite(marker.axes[1]->values);
  return heights.size() < 20 ? INFINITY : Quantile(heights, 0.05);
}

// Those that walk, with the times at which they stand; empty if nothing walks here.
std::vector<FootMarker> FootMarkers(const std::vector<Marker>& markers) {
  double floor_height = INFINITY;
  for (const Marker& marker : markers) floor_height = std::min(floor_height, Lowest(marker));
  std::vector<FootMarker> feet;
  std::vector<double> forward;
  std::vector<double> sideways;
  for (const Marker& marker : markers) {
    const double lowest = Lowest(marker);
    if (!(lowest < floor_height + kFootHeight_m)) continue;
    FootMarker foot{&marker, PathOf(marker), {}, {}};
    foot.velocity = Velocity(foot.path, marker.time());
    for (std::size_t i = 0; i < foot.path.size(); ++i) {
      if (!(foot.path[i].y() < lowest + kFootOnFloor_m) || !foot.velocity[i].allFinite()) continue;
      forward.push_back(foot.velocity[i].x());
      sideways.push_back(foot.velocity[i].z());
    }
    feet.push_back(std::move(foot));
  }
  if (feet.size() < kFootFewestMarkers || forward.empty()) return {};
  const Vec3 floor(Median(forward), 0, Median(sideways));
  std::vector<FootMarker> walking;
  for (FootMarker& foot : feet) {
    std::vector<double> speeds;
    for (const Vec3& v : foot.velocity) {
      const double speed = Slowness(v, floor);
      foot.stands.push_back(speed < kFootRest_m_s);
      if (std::isfinite(speed)) speeds.push_back(speed);
    }
    if (!speeds.empty() && Quantile(speeds, 0.95) > kFootSwings_m_s) walking.push_back(std::move(foot));
  }
  return walking;
}

struct FootOnPlate {
  double late = NAN;     // [s] of the markers: mean of the differences at both ends
  double scatter = NAN;  // [s] half of the difference between them
  const Marker* marker = nullptr;
};

FootOnPlate Compare(const std::vector<FootMarker>& feet, const Contact& contact) {
  const std::vector<double>& time = feet.front().marker->time();
  const double middle = 0.5 * (contact.from + contact.to);
  const auto at = static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), middle) - time.begin());
  if (at == 0 || at + 1 >= time.size()) return {};
  const FootMarker* nearest = nullptr;
  double least = kFootNear_m;
  for (const FootMarker& foot : feet) {
    if (!foot.stands[at]) continue;
    const double away = std::hypot(foot.path[at].x() - contact.cop_x_m, foot.path[at].z() - contact.cop_z_m);
    if (!(away < least)) continue;
    least = away;
    nearest = &foot;
  }
  if (nearest == nullptr) return {};
  std::vector<const FootMarker*> foot;
  for (const FootMarker& other : feet) {
    if (other.stands[at] && (other.path[at] - nearest->path[at]).norm() < kFootOne_m) foot.push_back(&other);
  }
  if (foot.size() < 2) return {};
  const auto stands = [&](std::size_t i) {
    return std::any_of(foot.begin(), foot.end(), [&](const FootMarker* f) { return f->stands[i]; });
  };
  std::size_t first = at;
  for (std::size_t i = at; i > 0 && time[first] - time[i] < kFootGap_s; --i) {
    if (stands(i)) first = i;
  }
  std::size_t last = at;
  for (std::size_t i = at; i < time.size() && time[i] - time[last] < kFootGap_s; ++i) {
    if (stands(i)) last = i;
  }
  // The record begins or ends while the foot stands.
  if (first < 3 || last + 3 >= time.size()) return {};
  const double begins = time[first] - contact.from;
  const double ends = time[last] - contact.to;
  return {0.5 * (begins + ends), 0.5 * std::abs(begins - ends), nearest->marker};
}

}  // namespace

std::vector<Finding> FindLatePlates(const Dataset& dataset, const std::vector<ChannelGroup>& groups) {
  std::vector<Finding> found;
  for (const std::vector<Marker>& markers : MarkerSets(groups)) {
    if (markers.size() < kFootFewestMarkers) continue;
    const std::string& trial = markers.front().trial();
    if (PlateNames(dataset.trials.at(trial)).empty()) continue;
    const std::vector<FootMarker> feet = FootMarkers(markers);
    if (feet.empty()) continue;
    std::map<std::string, std::vector<FootOnPlate>> of_plate;
    for (const Contact& contact : FindContacts(dataset.trials.at(trial)).contacts) {
      if (contact.fault != ContactFault::kNone) continue;
      const FootOnPlate compared = Compare(feet, contact);
      if (compared.marker != nullptr) of_plate[contact.plate].push_back(compared);
    }
    for (const auto& [plate, all] : of_plate) {
      std::vector<double> late;
      std::vector<double> scatter;
      for (const FootOnPlate& one : all) {
        late.push_back(one.late);
        scatter.push_back(one.scatter);
      }
      const double delay = Median(late);
      if (std::abs(delay) < std::max(kFootDelay_s, kFootScatter * Median(scatter))) continue;
      for (const ChannelGroup& group : groups) {
        for (const Signal& signal : group.signals) {
          if (signal.trial != trial || signal.channel != plate + "_force_y") continue;
          Finding finding = signal.Found(FindingKind::kLag);
          finding.whole = true;
          finding.spans = {signal.Whole()};
          finding.size = -delay;
          finding.other = all.front().marker->axes[0]->channel;
          finding.undecided = true;
          found.push_back(std::move(finding));
        }
      }
    }
  }
  return found;
}

}  // namespace sinew
