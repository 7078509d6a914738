// The prior of a pose's errors, where a first search ends in a wrong minimum.
#include <gtest/gtest.h>

#include "identify/solvers/prior_choice.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

const char* const kOneSole = R"(contact:
  objective: likelihood
  fit: [force_x, force_y, force_z, cop_x, cop_z, moment_y]
  motion_errors: {position: 0.005, rotation: 0.0262}
  regions:
    - {name: right_sole, body: calcn_r, plate: right, position: [0.0325, -0.07343375, 0.0],
       mesh: {box: {size: [0.26, 0.0325, 0.14625], strips: [18, 10]}}}
    - {name: left_sole, body: calcn_l, plate: left, position: [0.0325, -0.07343375, 0.0],
       mesh: {box: {size: [0.26, 0.0325, 0.14625], strips: [18, 10]}}}
  parameters:
    stiffness: {lower: 1.0e4, upper: 1.0e8, start: 1.0e6}
    dissipation: {lower: 0, upper: 100, start: 1}
)";

// A person whose recorded pose errs by 5 mm and 1.5 degrees, with rates of that over 0.2 s and without a
// rough part.
Dataset PersonOf(std::uint64_t seed, double stiffness, double dissipation, double static_friction,
                 double dynamic_friction, double viscous_friction) {
  SynthesisRequest request;
  request.seed = seed;
  request.set = {{"stiffness", stiffness},
                 {"dissipation", dissipation},
                 {"static_friction", static_friction},
                 {"dynamic_friction", dynamic_friction},
                 {"viscous_friction", viscous_friction},
                 {"person", 1},
                 {"encoders", 1},
                 {"train", 1},
                 {"validate", 0},
                 {"slip", 0.1},
                 {"motion_error", 0.005},
                 {"rotation_error", 0.0262}};
  auto data = SynthesizeContact(request);
  EXPECT_TRUE(data) << data.error().message;
  return data ? std::move(*data) : Dataset{};
}

// One stance each; a search at the start prior ends in a wrong minimum, where a prior with three times the
// rates, or a rough one, is the most probable one, at a cost below that of the noise.
TEST(ChosenPrior, AWrongMinimumDoesNotChooseIt) {
  for (const Dataset& data : {PersonOf(5943, 1652666, 4.824, 1.070, 0.5702, 0.3532),
                              PersonOf(5947, 1893402, 1.934, 1.184, 0.8173, 0.4310)}) {
    const auto problem = MakeContact(data, kOneSole).value();
    const auto choice = solvers::ChoosePriors(*problem, MakeFitSetup(*problem, {}).value(), {});
    ASSERT_TRUE(choice.any_chosen);
    const int spectrum = problem->data().stances.front().motion_errors.spectrum;
    EXPECT_NEAR(choice.setup.rest[spectrum], 0.2, 0.05);
    EXPECT_LT(choice.setup.rest[spectrum + 1], 2e-3);
  }
}

}  // namespace
}  // namespace sinew
