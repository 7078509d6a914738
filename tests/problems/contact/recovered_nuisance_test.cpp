// What a fit finds of values that are no result by themselves: a belt's velocity, and how much of the
// motion's errors differs from step to step.
#include <gtest/gtest.h>

#include <string>

#include "identify/identification/identification.h"
#include "problems/contact/laboratory/synthesis.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

// Two stances of a person on a floor at rest, whose recorded feet err by 5 mm and 1.5 degrees, independently.
const Dataset& ErringStances() {
  static const Dataset kData = [] {
    SynthesisRequest request;
    request.seed = 5;
    request.set = {{"person", 1},
                   {"encoders", 1},
                   {"train", 2},
                   {"validate", 0},
                   {"fine", 0},
                   {"slip", 0.1},
                   {"motion_error", 0.005},
                   {"rotation_error", 0.0262}};
    return SynthesizeContact(request).value();
  }();
  return kData;
}

Identification FitOn(const std::string& floor) {
  const std::string yaml = SettingsText(
      ErringStances(),
      "  regions:", "  motion_errors: {position: 0.005, rotation: 0.0262}\n" + floor + "  regions:");
  const auto problem = MakeContact(ErringStances(), yaml).value();
  IdentificationOptions options;
  options.solver = "continuation";
  options.profiles = false;
  return Identify(*problem, MakeFitSetup(*problem, {}).value(), options).value();
}

double Figure(const Identification& found, const std::string& name) {
  for (const FigureOfMerit& figure : found.figures) {
    if (figure.name == name) return figure.value;
  }
  ADD_FAILURE() << "no figure " << name;
  return 0;
}

TEST(RecoveredNuisance, AWronglyStatedFloorVelocityIsCorrected) {
  const Identification found = FitOn("  floor_velocity: [0.02, 0]\n");
  EXPECT_NEAR(Figure(found, "velocity of the floor along x"), 0, 0.006) << "0.02 m/s was stated";
  // The errors of the steps are independent.
  EXPECT_GT(Figure(found, "between steps"), 1.5);
  EXPECT_NEAR(Figure(found, "correlation time"), 0.2, 0.06);
  const Identification held = FitOn("  floor_velocity: [0.02, 0]\n  floor_velocity_error: [0, 0]\n");
  EXPECT_GT(held.result.cost, found.result.cost + 2);
}

}  // namespace
}  // namespace sinew
