#include "datasets/ground_loads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/median.h"
#include "base/text.h"
#include "datasets/stances/stances.h"

namespace sinew {
namespace {

using Load = std::array<double, 9>;
constexpr std::size_t kVertical = 1;
constexpr std::array<const char*, 9> kKinds{"force_x", "force_y",  "force_z",  "cop_x",   "cop_y",
                                            "cop_z",   "moment_x", "moment_y", "moment_z"};
constexpr double kSameInstant = 1e-9;  // [s]

bool IsForce(std::size_t kind) {
  return kind < 3;
}
bool IsPoint(std::size_t kind) {
  return kind >= 3 && kind < 6;
}
bool IsNeeded(std::size_t kind) {
  return IsForce(kind) || kind == 3 || kind == 5;
}

bool HasValues(const Channel& channel) {
  return std::any_of(channel.values.begin(), channel.values.end(), [](double v) { return std::isfinite(v); });
}

// Values that are not known become those of the nearest sample that is; false if none is.
bool FillFromNearest(const std::vector<double>& time, std::vector<double>& values) {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) known.push_back(i);
  }
  if (known.empty()) return false;
  std::size_t next = 0;  // the first known sample at or after i
  for (std::size_t i = 0; i < values.size(); ++i) {
    while (next < known.size() && known[next] < i) ++next;
    if (next < known.size() && known[next] == i) continue;
    std::size_t nearest = next < known.size() ? known[next] : known[next - 1];
    if (next > 0 &&
        std::abs(time[known[next - 1]] - time[i]) <= std::abs(time[nearest] - time[i]) + kSameInstant)
      nearest = known[next - 1];
    values[i] = values[nearest];
  }
  return true;
}

// One plate in one source.
struct Record {
  std::string source;
  const std::vector<double>* time = nullptr;
  std::array<std::vector<double>, 9> values;  // empty: zero

  [[nodiscard]] std::optional<Load> At(double t) const {
    if (t < time->front() - kSameInstant || t > time->back() + kSameInstant) return {};
    const auto upper = std::lower_bound(time->begin(), time->end(), t - kSameInstant);
    if (upper == time->end()) return {};
    const auto right = static_cast<std::size_t>(upper - time->begin());
    const bool on_sample = right == 0 || std::abs((*time)[right] - t) <= kSameInstant;
    const std::size_t left = on_sample ? right : right - 1;
    const double share = on_sample ? 0 : (t - (*time)[left]) / ((*time)[right] - (*time)[left]);
    Load load{};
    for (std::size_t k = 0; k < load.size(); ++k) {
      if (values[k].empty()) continue;
      load[k] = on_sample ? values[k][right] : (1 - share) * values[k][left] + share * values[k][right];
      if (!std::isfinite(load[k])) {
        if (IsForce(k)) return {};
        load[k] = 0;  // a moment that was not measured
      }
    }
    return load;
  }
};

Result<std::optional<Record>> RecordOf(const LoadSource& source, const std::string& plate) {
  const auto vertical = source.trial->Find(plate + "_force_y");
  if (!vertical || vertical.grid->time.empty()) return std::optional<Record>();
  Record record;
  record.source = source.name;
  record.time = &vertical.grid->time;
  if (!HasValues(*vertical.channel)) {
    record.values[kVertical] = vertical.channel->values;
    return std::optional<Record>(std::move(record));
  }
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    const std::string name = plate + "_" + kKinds[k];
    const auto channel = vertical.grid->channels.find(name);
    if (channel == vertical.grid->channels.end()) {
      if (!IsNeeded(k)) continue;
      return Fail("trial '{}': has {}_force_y without {} on the same instants", source.name, plate, name);
    }
    record.values[k] = channel->second.values;
    if (IsPoint(k) && !FillFromNearest(*record.time, record.values[k]) && IsNeeded(k))
      return Fail("trial '{}': {} has no values beside {}_force_y", source.name, name, plate);
  }
  return std::optional<Record>(std::move(record));
}

double RateOf(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  return steps.empty() ? 0 : 1 / UpperMedian(std::move(steps));
}

double LargestForce(const std::vector<Record>& records) {
  double largest = 0;
  for (const Record& record : records) {
    for (const double force : record.values[kVertical]) {
      if (std::isfinite(force)) largest = std::max(largest, force);
    }
  }
  return largest;
}

// The first record that has a sample before and one after an instant, or there.
const Record* Covering(const std::vector<Record>& records, double t) {
  const auto found = std::find_if(records.begin(), records.end(), [&](const Record& record) {
    return t >= record.time->front() - kSameInstant && t <= record.time->back() + kSameInstant;
  });
  return found == records.end() ? nullptr : &*found;
}

// Makes `spans` longer by an instant at which `source` counts (nullptr: none), as it did before or newly.
void Continue(const std::string& plate, double t, const Record* source, const Record*& before,
              std::vector<LoadSpan>& spans) {
  if (source != nullptr && source != before) spans.push_back({plate, source->source, t, t});
  if (source != nullptr) spans.back().to = t;
  before = source;
}

// The record that counts at an instant, and its load.
std::pair<const Record*, Load> Chosen(const std::vector<Record>& records, double t, double loaded) {
  std::pair<const Record*, Load> chosen{nullptr, {}};
  for (const Record& record : records) {
    const auto load = record.At(t);
    if (!load) continue;
    if ((*load)[kVertical] > loaded) return {&record, *load};
    if (chosen.first == nullptr) chosen = {&record, *load};
  }
  return chosen;
}

Status CheckSize(double duration, double rate) {
  constexpr double kMost = 2e7;
  if (duration * rate <= kMost) return {};
  return Fail("{:.4g} s at {:.4g} Hz are {:.3g} instants, expected at most {:.0e}", duration, rate,
              duration * rate, kMost);
}

}  // namespace

bool HoldsLoad(const Trial& trial) {
  const std::vector<std::string> plates = PlateNames(trial);
  return std::any_of(plates.begin(), plates.end(), [&](const std::string& plate) {
    return HasValues(*trial.Find(plate + "_force_y").channel);
  });
}

Result<GroundLoads> JoinGroundLoads(const std::vector<LoadSource>& sources, double rate) {
  for (const LoadSource& source : sources) {
    if (source.recording == sources.front().recording) continue;
    return Fail("trials '{}' and '{}' are of two recordings ('{}', '{}'), whose times differ: choose one",
                sources.front().name, source.name, sources.front().recording, source.recording);
  }
  std::set<std::string> plates;
  for (const LoadSource& source : sources) {
    for (const std::string& plate : PlateNames(*source.trial)) plates.insert(plate);
  }
  std::map<std::string, std::vector<Record>> records;
  double begin = std::numeric_limits<double>::infinity();
  double end = -begin;
  double greatest_rate = 0;
  for (const std::string& plate : plates) {
    for (const LoadSource& source : sources) {
      SINEW_ASSIGN(std::optional<Record> record, RecordOf(source, plate));
      if (!record) continue;
      begin = std::min(begin, record->time->front());
      end = std::max(end, record->time->back());
      greatest_rate = std::max(greatest_rate, RateOf(*record->time));
      records[plate].push_back(std::move(*record));
    }
  }
  const bool any = std::any_of(sources.begin(), sources.end(),
                               [](const LoadSource& source) { return HoldsLoad(*source.trial); });
  if (!any) return Fail("no trial has values of a vertical force (channel PLATE_force_y)");
  if (rate <= 0) rate = greatest_rate;
  if (!(rate > 0)) return Fail("one sample has no rate: give one");
  SINEW_TRY(CheckSize(end - begin, rate));

  GroundLoads joined;
  const auto count = static_cast<std::size_t>(std::floor((end - begin) * rate + 1e-6)) + 1;
  joined.time.reserve(count);
  for (std::size_t i = 0; i < count; ++i) joined.time.push_back(begin + static_cast<double>(i) / rate);
  constexpr double kLoadedShare = 0.02;
  for (const auto& [plate, of] : records) {
    const double loaded = kLoadedShare * LargestForce(of);
    PlateLoad& load = joined.plates.emplace_back();
    load.plate = plate;
    const Record* loading = nullptr;
    const Record* missing = nullptr;
    for (const double t : joined.time) {
      const auto [record, at] = Chosen(of, t, loaded);
      for (std::size_t k = 0; k < at.size(); ++k) load.values[k].push_back(at[k]);
      Continue(plate, t, at[kVertical] > loaded ? record : nullptr, loading, joined.spans);
      Continue(plate, t, record == nullptr ? Covering(of, t) : nullptr, missing, joined.gaps);
    }
  }
  return joined;
}

}  // namespace sinew
