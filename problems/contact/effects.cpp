#include "problems/contact/effects.h"

#include <algorithm>

namespace sinew {
namespace {

constexpr const char* kHeightExperiment =
    "stand still and load the foot in steps: a height that is wrong gives force at zero depth, or none at a "
    "depth";

constexpr double kHeightReach = 0.01;  // [m]

// In the order of ShapeMode.
void DeclareShapes(ParameterListBuilder& add) {
  const auto declare = [&](const char* name, const char* description, const char* experiment,
                           const char* unit, const std::string& what, double reach) {
    auto& effect = add.BeginEffect(name, Level::kHuman, description, experiment);
    for (const auto& [phase, when] : {std::pair("early", "at a quarter of the stance"),
                                      std::pair("middle", "in the middle of the stance"),
                                      std::pair("late", "at three quarters of the stance")}) {
      effect.TwoSided(ParameterListBuilder::kNoSlot, std::string(name) + "_" + phase, unit,
                      what + ", " + when, reach);
    }
  };
  declare("foot_bend", "the foot bends in its middle, by the same angle at the same phase of every stance",
          "markers on the forefoot and on the heel, or a foot model of several segments", "rad",
          "forefoot turned up against the heel", 0.2);
  declare(
      "foot_pitch",
      "the foot is turned against the recorded one by the same angle at the same phase of every stance (skin "
      "slides over the bones)",
      "markers on more places of the foot, or a cluster on a rigid plate", "rad", "toes turned up", 0.1);
  declare("foot_height",
          "the foot is higher than the recorded one by as much at the same phase of every stance (skin "
          "slides, the "
          "heel pad flows)",
          "markers on more places of the foot, or a pressure mat", "m", "foot higher than recorded", 0.01);
}

}  // namespace

ContactEffectList::ContactEffectList(int first, std::vector<std::string> plates)
    : first_(first), plates_(std::move(plates)) {
  if (plates_.size() < 2) plates_.clear();
}

void ContactEffectList::Declare(ParameterListBuilder& add) const {
  constexpr int kNone = ParameterListBuilder::kNoSlot;
  add.BeginEffect("height_offset", Level::kHuman,
                  "the soles have a wrong height in the kinematics, by the same amount in all stances",
                  kHeightExperiment)
      .TwoSided(kNone, "height_offset", "m", "depth beyond that of the kinematics, the same in all stances",
                kHeightReach);
  add.BeginEffect("floor_compliance", Level::kBoundary,
                  "the floor under the springs deflects in proportion to the pressure",
                  "press the plate with a stiff stamp and measure its deflection")
      .Positive(kNone, "floor_compliance", "m3/N", "deflection of the floor per pressure on it", 1e-5);
  add.BeginEffect("stiffness_exponent", Level::kBoundary,
                  "the pressure does not grow in proportion to the depth but by a power of it",
                  "slow loading to several depths: force against depth is then a curve")
      .Number(kNone, "stiffness_exponent", "1",
              "n of pressure = stiffness x0 (depth / x0)^(1 + n), x0 = 1 mm", -0.5, 2);
  add.BeginEffect("tilted_floor", Level::kBoundary, "the floor is not level in the axes of the kinematics",
                  "a spirit level, or markers on the floor, or stances far apart on the plate")
      .TwoSided(kNone, "floor_slope_x", "rad", "rise of the floor along x", 0.05)
      .TwoSided(kNone, "floor_slope_z", "rad", "rise of the floor along z", 0.05);
  add.BeginEffect(
         "unmodelled_mass", Level::kHuman,
         "the plate carries a mass that moves with the foot and that the springs do not carry (a shoe, a "
         "segment whose mass is wrong)",
         "weigh it, or stamp: its force follows the acceleration of the foot")
      .TwoSided(kNone, "unmodelled_mass", "kg", "mass that moves with the foot while it is on the plate", 5);
  add.BeginEffect("missing_toe_region", Level::kBoundary,
                  "the foot also touches in front of the modelled sole",
                  "a pressure mat, or the centre of pressure at push-off")
      .Positive(kNone, "toe_region_weight", "1",
                "share of the sole's springs that a strip in front of it has", 1);
  add.BeginEffect("missing_heel_region", Level::kBoundary, "the foot also touches behind the modelled sole",
                  "a pressure mat, or the centre of pressure at heel strike")
      .Positive(kNone, "heel_region_weight", "1", "share of the sole's springs that a strip behind it has",
                1);
  add.BeginEffect("linear_damping", Level::kBoundary,
                  "a part of the damping does not depend on the depth (Kelvin and Voigt's law)",
                  "drop a weight on the sole from several heights: such damping makes a step of the force at "
                  "touch-down")
      .Positive(kNone, "linear_damping", "N*s/m3", "pressure per rate of the depth, at any depth", 1e6);
  add.BeginEffect("shear_compliance", Level::kBoundary,
                  "the sole gives way horizontally under friction, so that its contact lags behind the foot "
                  "(rubber, skin, heel pad)",
                  "pull the loaded foot sideways with a known force and measure how far it moves before it "
                  "slides")
      .Positive(kNone, "shear_compliance", "m/N",
                "horizontal displacement of the foot over its contact per horizontal force", 1e-4);
  constexpr double kLargestRatio = 2;  // natural logarithm: 7.4 times as stiff
  add.BeginEffect("uneven_stiffness", Level::kBoundary,
                  "the stiffness varies smoothly under the sole (heel pad, arch, ball)",
                  "press the sole with a small stamp at several places, or stand on a pressure mat")
      .TwoSided(kNone, "stiffness_toes_to_heel", "1",
                "natural logarithm of the stiffness at the toes over that at the heel", kLargestRatio)
      .TwoSided(kNone, "stiffness_middle_to_ends", "1",
                "natural logarithm of the stiffness in the middle of the sole over that at both ends",
                kLargestRatio)
      .TwoSided(kNone, "stiffness_outside_to_inside", "1",
                "natural logarithm of the stiffness at the outer edge over that at the inner one",
                kLargestRatio);
  DeclareShapes(add);
  for (const std::string& plate : plates_) {
    add.BeginEffect(plate + ".height_offset", Level::kHuman,
                    "the sole on plate " + plate + " has a wrong height in the kinematics", kHeightExperiment)
        .TwoSided(kNone, plate + ".height_offset", "m",
                  "depth beyond that of the kinematics on plate " + plate, kHeightReach);
  }
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
