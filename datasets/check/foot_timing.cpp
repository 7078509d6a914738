#include "datasets/check/foot_timing.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "datasets/check/marker_paths.h"
#include "datasets/order_statistics.h"
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
  std::vector<bool> stands;  // [frames]

  // [m/s] NaN at the ends and beside gaps.
  [[nodiscard]] Vec3 Velocity(std::size_t i) const {
    if (i == 0 || i + 1 >= path.size()) return {NAN, NAN, NAN};
    const std::vector<double>& time = marker->time();
    return (path[i + 1] - path[i - 1]) / (time[i + 1] - time[i - 1]);
  }
};

double Slowness(const Vec3& velocity, const Vec3& floor) {
  return (velocity - floor).norm();
}

double Lowest(const Marker& marker) {
  const std::vector<double>& heights = marker.axes[1]->values;
  return CountFinite(heights) < 20 ? INFINITY : FiniteQuantiles(heights, {0.05}).front();
}

// Those that walk, with the times at which they stand; empty if nothing walks here.
std::vector<FootMarker> FootMarkers(const std::vector<Marker>& markers) {
  double floor_height = INFINITY;
  for (const Marker& marker : markers) floor_height = std::min(floor_height, Lowest(marker));
  std::vector<FootMarker> feet;
  std::vector<double> lowest;
  for (const Marker& marker : markers) {
    const double height = Lowest(marker);
    if (!(height < floor_height + kFootHeight_m)) continue;
    feet.push_back({&marker, Path(marker), {}});
    lowest.push_back(height);
  }
  if (feet.size() < kFootFewestMarkers) return {};
  // Velocities of what is on the floor.
  const auto on_floor = [&](const auto& use) {
    for (std::size_t f = 0; f < feet.size(); ++f) {
      for (std::size_t i = 0; i < feet[f].path.size(); ++i) {
        if (!(feet[f].path[i].y() < lowest[f] + kFootOnFloor_m)) continue;
        const Vec3 velocity = feet[f].Velocity(i);
        if (velocity.allFinite()) use(velocity);
      }
    }
  };
  const Vec3 floor(QuantileOf(0.5, [&](auto add) { on_floor([&](const Vec3& v) { add(v.x()); }); }), 0,
                   QuantileOf(0.5, [&](auto add) { on_floor([&](const Vec3& v) { add(v.z()); }); }));
  if (!floor.allFinite()) return {};
  std::vector<FootMarker> walking;
  for (FootMarker& foot : feet) {
    for (std::size_t i = 0; i < foot.path.size(); ++i)
      foot.stands.push_back(Slowness(foot.Velocity(i), floor) < kFootRest_m_s);
    const double fast = QuantileOf(0.95, [&](auto add) {
      for (std::size_t i = 0; i < foot.path.size(); ++i) {
        const double speed = Slowness(foot.Velocity(i), floor);
        if (std::isfinite(speed)) add(speed);
      }
    });
    if (fast > kFootSwings_m_s) walking.push_back(std::move(foot));
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
