#include "problems/contact/effects.h"

#include <algorithm>

namespace sinew {
namespace {

struct Kind {
  const char* parameter;
  const char* effect;
  const char* unit;
  const char* meaning;
  double lower;
  double upper;
};

// In the order of ContactEffect.
constexpr std::array<Kind, kContactEffects> kKinds{{
    {"height_offset", "height_offset", "m", "depth that the kinematics miss, the same in all stances", -0.01,
     0.01},
    {"floor_compliance", "floor_compliance", "m3/N", "give of the floor per pressure on it", 0, 1e-5},
    {"stiffness_exponent", "stiffness_exponent", "1",
     "n of pressure = stiffness x0 (depth / x0)^(1 + n), x0 = 1 mm", -0.5, 2},
    {"floor_slope_x", "tilted_floor", "rad", "rise of the floor along x", -0.05, 0.05},
    {"floor_slope_z", "tilted_floor", "rad", "rise of the floor along z", -0.05, 0.05},
    {"unmodelled_mass", "unmodelled_mass", "kg", "mass that moves with the foot while it is on the plate", -5,
     5},
    {"toe_region_weight", "missing_toe_region", "1",
     "share of the sole's springs that a strip in front of it has", 0, 1},
    {"heel_region_weight", "missing_heel_region", "1",
     "share of the sole's springs that a strip behind it has", 0, 1},
}};

constexpr const char* kHeightExperiment =
    "stand still and load the foot in steps: a height that is wrong gives force at zero depth, or none at a "
    "depth";

}  // namespace

ContactEffectList::ContactEffectList(int first, std::vector<std::string> plates)
    : first_(first), plates_(std::move(plates)) {
  if (plates_.size() < 2) plates_.clear();
}

int ContactEffectList::size() const {
  return static_cast<int>(kContactEffects + plates_.size());
}

std::vector<Parameter> ContactEffectList::MakeParameters() const {
  std::vector<Parameter> parameters;
  const auto add = [&](const Kind& kind, const std::string& prefix, const std::string& meaning) {
    parameters.push_back(EffectParameter(prefix + kind.parameter, kind.unit, meaning, kind.lower, kind.upper,
                                         0, prefix + kind.effect));
  };
  for (const Kind& kind : kKinds) add(kind, "", kind.meaning);
  for (const std::string& plate : plates_) {
    add(kKinds[kHeightOffset], plate + ".", "depth that the kinematics miss on plate " + plate);
  }
  return parameters;
}

std::vector<Effect> ContactEffectList::MakeEffects() const {
  const int f = first_;
  const auto at = [f](ContactEffect effect) { return f + static_cast<int>(effect); };
  std::vector<Effect> effects{
      {"height_offset",
       Level::kHuman,
       "the kinematics hold the soles at a wrong height, by the same amount in all stances",
       kHeightExperiment,
       {at(kHeightOffset)}},
      {"floor_compliance",
       Level::kBoundary,
       "the floor under the springs gives way in proportion to the pressure",
       "press the plate with a stiff stamp and measure how far it goes down",
       {at(kFloorCompliance)}},
      {"stiffness_exponent",
       Level::kBoundary,
       "the pressure does not grow in proportion to the depth but by a power of it",
       "slow loading to several depths: force against depth is then a curve",
       {at(kStiffnessExponent)}},
      {"tilted_floor",
       Level::kBoundary,
       "the floor is not level in the axes of the kinematics",
       "a spirit level, or markers on the floor, or stances far apart on the plate",
       {at(kFloorSlopeX), at(kFloorSlopeZ)}},
      {"unmodelled_mass",
       Level::kHuman,
       "the plate carries a mass that moves with the foot and that the springs do not see (a shoe, a segment "
       "whose mass is wrong)",
       "weigh it, or stamp: its force follows the acceleration of the foot",
       {at(kUnmodelledMass)}},
      {"missing_toe_region",
       Level::kBoundary,
       "the foot also touches in front of the modelled sole",
       "a pressure mat, or the centre of pressure at push-off",
       {at(kToeRegion)}},
      {"missing_heel_region",
       Level::kBoundary,
       "the foot also touches behind the modelled sole",
       "a pressure mat, or the centre of pressure at heel strike",
       {at(kHeelRegion)}},
  };
  for (const std::string& plate : plates_) {
    effects.push_back({plate + ".height_offset",
                       Level::kHuman,
                       "the kinematics hold the sole on plate " + plate + " at a wrong height",
                       kHeightExperiment,
                       {OwnHeight(plate)}});
  }
  return effects;
}

std::vector<int> ContactEffectList::ColumnsOf(const std::string& plate) const {
  std::vector<int> columns;
  for (std::size_t i = 0; i < kContactEffects; ++i) columns.push_back(first_ + static_cast<int>(i));
  const int own = OwnHeight(plate);
  if (own >= 0) columns.push_back(own);
  return columns;
}

int ContactEffectList::OwnHeight(const std::string& plate) const {
  const auto found = std::find(plates_.begin(), plates_.end(), plate);
  if (found == plates_.end()) return -1;
  return first_ + static_cast<int>(kContactEffects) + static_cast<int>(found - plates_.begin());
}

}  // namespace sinew
