#include "problems/contact/truth.h"

#include <algorithm>

#include "base/numbers.h"
#include "base/text.h"

namespace sinew {
namespace {

// One number that --effect takes.
struct Entry {
  std::string effect;
  std::string parameter;
  std::string unit;
  double lower;
  double upper;
  std::vector<double*> targets;
};

std::vector<Entry> Entries(ContactTruth& truth) {
  std::vector<Entry> entries;
  // Indices start at 0: the values stand in the order of ContactEffect, then right, then left.
  for (const Parameter& p : ContactEffectList(0, {"right", "left"}).MakeParameters()) {
    const std::size_t at = entries.size();
    double* target = at < kContactEffects ? &truth.effects[at] : &truth.own_height[at - kContactEffects];
    entries.push_back({p.effect, p.name, p.unit, p.lower, p.upper, {target}});
  }
  constexpr double kLargestForce = 1e4;  // [N]
  constexpr double kLatest = 0.15;       // [s] the motion is known 0.2 s around the stance
  for (const char* side : {"", "right_", "left_"}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string channel = std::string(side) + "force_" + "xyz"[axis];
      const auto add = [&](const char* kind, const char* unit, double lower, double upper,
                           double PlateDistortion::*member) {
        Entry entry{channel + "." + kind, channel + "." + kind, unit, lower, upper, {}};
        if (*side != 'l') entry.targets.push_back(&(truth.plates[0][axis].*member));
        if (*side != 'r') entry.targets.push_back(&(truth.plates[1][axis].*member));
        entries.push_back(std::move(entry));
      };
      add("offset", "N", -kLargestForce, kLargestForce, &PlateDistortion::offset);
      add("drift", "N/s", -kLargestForce, kLargestForce, &PlateDistortion::drift);
      add("gain", "1", 0.1, 10, &PlateDistortion::gain);
      add("time_offset", "s", -kLatest, kLatest, &PlateDistortion::time_offset);
    }
  }
  return entries;
}

}  // namespace

ContactEffectValues ContactTruth::EffectsOn(bool right) const {
  ContactEffectValues values = effects;
  values[kHeightOffset] += own_height[right ? 0 : 1];
  return values;
}

Result<ContactTruth> ReadContactTruth(
    const std::vector<std::pair<std::string, std::map<std::string, double>>>& effects) {
  ContactTruth truth;
  const std::vector<Entry> entries = Entries(truth);
  std::vector<std::string> names;
  for (const Entry& entry : entries) {
    if (names.empty() || names.back() != entry.effect) names.push_back(entry.effect);
  }
  for (const auto& [effect, parameters] : effects) {
    std::vector<const Entry*> own;
    std::vector<std::string> known;
    for (const Entry& entry : entries) {
      if (entry.effect != effect) continue;
      own.push_back(&entry);
      known.push_back(entry.parameter);
    }
    if (own.empty()) return Fail("--effect: '{}' does not exist{}", effect, Suggestion(effect, names));
    if (parameters.empty())
      return Fail("--effect {}: expected {}:{}=NUMBER", effect, effect, own.front()->parameter);
    for (const auto& [parameter, value] : parameters) {
      const auto found = std::find_if(own.begin(), own.end(), [&, &name = parameter](const Entry* entry) {
        return entry->parameter == name || (name == "value" && own.size() == 1);
      });
      if (found == own.end())
        return Fail("--effect {}: '{}' does not exist{}", effect, parameter, Suggestion(parameter, known));
      const Entry& entry = **found;
      if (!(value >= entry.lower && value <= entry.upper)) {
        return Fail("--effect {}:{}={}: expected {} to {} {}", effect, parameter, value,
                    Readable(entry.lower), Readable(entry.upper), entry.unit);
      }
      for (double* target : entry.targets) *target = value;
    }
  }
  return truth;
}

}  // namespace sinew
