#include "problems/contact/laboratory/truth.h"

#include <map>
#include <string>
#include <vector>

#include "identify/observation/sensor_parameters.h"
#include "problems/kit/hidden_effects.h"

namespace sinew {
namespace {

constexpr double kLargestForce = 1e4;  // [N] and the growth of its error in a second

struct Distortion {
  SensorEffect effect;
  double PlateDistortion::*value;
};
constexpr Distortion kDistortions[] = {{kOffset, &PlateDistortion::offset},
                                       {kDrift, &PlateDistortion::drift},
                                       {kGain, &PlateDistortion::gain},
                                       {kTimeOffset, &PlateDistortion::time_offset}};

// What can be hidden, and by parameter where its value goes.
struct Places {
  ParameterList list;
  std::map<std::string, std::vector<double*>> targets;
};

void AddContactEffects(ContactTruth& truth, Places& places) {
  ParameterListBuilder add(places.list);
  ContactEffectList(0, {"right", "left"}).Declare(add);
  // In the order of ContactEffect, then right, then left.
  for (std::size_t i = 0; i < places.list.parameters.size(); ++i) {
    places.targets[places.list.parameters[i].name] = {
        i < kContactEffects ? &truth.effects[i] : &truth.own_height[i - kContactEffects]};
  }
}

void AddPlate(const std::string& side, std::size_t axis, ContactTruth& truth, Places& places) {
  ChannelSummary channel;
  channel.channel = side + "force_" + "xyz"[axis];
  channel.unit = "N";
  channel.magnitude = kLargestForce;
  std::vector<Parameter> parameters;
  std::vector<Effect> effects;
  AddSensorEffects(channel, parameters, effects);
  ParameterListBuilder add(places.list);
  for (const Distortion& distortion : kDistortions) {
    const Effect& effect = effects[distortion.effect];
    add.Copy(effect, parameters);
    auto& targets = places.targets[effect.name];
    if (side != "left_") targets.push_back(&(truth.plates[0][axis].*distortion.value));
    if (side != "right_") targets.push_back(&(truth.plates[1][axis].*distortion.value));
  }
}

}  // namespace

ContactEffectValues ContactTruth::EffectsOn(bool right) const {
  ContactEffectValues values = effects;
  values[kHeightOffset] += own_height[right ? 0 : 1];
  return values;
}

Result<ContactTruth> ReadContactTruth(const RequestedEffects& effects) {
  ContactTruth truth;
  Places places;
  AddContactEffects(truth, places);
  for (const char* side : {"", "right_", "left_"}) {
    for (std::size_t axis = 0; axis < 3; ++axis) AddPlate(side, axis, truth, places);
  }
  // A value for one plate replaces an earlier one for both plates.
  for (const auto& requested : effects) {
    SINEW_ASSIGN(const auto hidden, ReadHiddenEffects({requested}, places.list));
    for (const auto& [parameter, value] : hidden) {
      for (double* target : places.targets.at(parameter)) *target = value;
    }
  }
  return truth;
}

}  // namespace sinew
