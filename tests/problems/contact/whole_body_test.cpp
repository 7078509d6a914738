// Steps without their plates: by the mean deviation of fitted ones, and by the dynamics of the whole body.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/solvers/solver.h"
#include "problems/contact/steps/body_rows.h"
#include "problems/contact/steps/step_estimate.h"
#include "problems/whole_body_dynamics.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::HasSubstr;

const char* const kByMotion = "from the motion alone";
const char* const kByMeanLoad = "from the motion and the mean load of the fitted stances";
const char* const kByBody = "from the motion of the whole body";

// One fitted stance, and one held out, whose recorded motion sinks in and rises by half a millimetre.
Dataset TwoStances() {
  Dataset data = SteppingData({{"fine", 0}, {"train", 1}, {"validate", 1}, {"moments", 1}}, 0);
  for (auto& [name, trial] : data.trials) {
    trial.grids.erase("markers");
    if (trial.role == Role::kTrain) continue;
    Grid& grid = trial.grids.at("coordinates");
    std::vector<double>& height = grid.channels.at("pelvis_ty").values;
    for (std::size_t i = 0; i < height.size(); ++i) height[i] += 5e-4 * std::sin(12 * grid.time[i]);
  }
  return data;
}

// What the plate measured becomes the load of a whole body, whose other foot carries nothing. Its errors are
// a constant, which all stances share in the frame of the foot, and noise.
void AddBodyLoad(double constant, double noise, Dataset& data) {
  Random random(5);
  for (auto& [name, trial] : data.trials) {
    const Grid& forces = trial.grids.at("forces");
    const std::string plate = forces.channels.count("right_force_y") > 0 ? "right" : "left";
    const double side = plate == "right" ? 1 : -1;
    const auto measured = [&](const char* channel, std::size_t i) {
      const double value = forces.channels.at(plate + "_" + channel).values[i];
      return std::isfinite(value) ? value : 0;
    };
    Grid grid;
    grid.time = forces.time;
    for (std::size_t i = 0; i < grid.time.size(); ++i) {
      Vec3 force(measured("force_x", i), measured("force_y", i), measured("force_z", i));
      const Vec3 place(measured("cop_x", i), 0, measured("cop_z", i));
      Vec3 moment = place.cross(force) + Vec3(0, measured("moment_y", i), 0);
      force += constant * Vec3(1, 1, side);
      for (int axis = 0; axis < 3; ++axis) {
        force[axis] += noise * random.Normal();
        moment[axis] += 0.1 * noise * random.Normal();
      }
      const auto add = [&](const std::string& channel, const char* unit, const Vec3& value) {
        for (int axis = 0; axis < 3; ++axis) {
          Channel& of = grid.channels[channel + "_" + "xyz"[axis]];
          of.unit = unit;
          of.values.push_back(value[axis]);
        }
      };
      add(kWholeBodyForce, "N", force);
      add(kWholeBodyMoment, "N*m", moment);
      add(kMassCentre, "m", Vec3(0.03 * (grid.time[i] - grid.time.back() / 2), 0.3, 0));
    }
    trial.grids[kDynamicsGrid] = std::move(grid);
  }
}

double Error(const std::vector<AlternativeQuality>& all, const std::string& name,
             const std::string& quantity) {
  for (const AlternativeQuality& one : all) {
    if (one.name != name) continue;
    for (const FitQuality& quality : one.pooled) {
      if (quality.role == BlockRole::kValidate && quality.channel == quantity) return quality.rmse;
    }
  }
  ADD_FAILURE() << name << " predicts no " << quantity;
  return NAN;
}

Vector TrueParameters(const ContactProblem& problem) {
  Vector truth = RestPoint(problem);
  for (Eigen::Index i = 0; i < kContactParametersPerGroup; ++i)
    truth[i] = kTruth.at(problem.parameters()[static_cast<std::size_t>(i)].name);
  return truth;
}

TEST(WholeBody, ItsDynamicsSayHowAStepWithoutAPlateDeviates) {
  for (const double constant : {0.0, 4.0}) {
    Dataset data = TwoStances();
    AddBodyLoad(constant, 0.2, data);
    const auto problem = MakeContact(data, MovingSettings(data)).value();
    const Vector truth = TrueParameters(*problem);
    const auto compared = CompareAlternatives(*problem, truth);
    const double by_motion = Error(compared, kByMotion, "vertical force");
    const double by_body = Error(compared, kByBody, "vertical force");
    EXPECT_GT(by_motion, 2) << "half a millimetre under a sole of 11 N/mm";
    EXPECT_LT(by_body, 0.6) << "a constant error of " << constant << " N of all steps";
    EXPECT_LT(Error(compared, std::string(kByBody) + ", in single support", "vertical force"), 0.6);
  }
}

// Effects of late sensors need predictions beside the plate's record, where nothing is known of the body.
TEST(WholeBody, InstantsBesideTheRecordChangeNothing) {
  constexpr double kRounding = 1e-9;
  constexpr double kMargin = 0.05;  // [s]
  Dataset data = TwoStances();
  AddBodyLoad(4, 0.2, data);
  for (auto& [name, trial] : data.trials) {
    Grid& forces = trial.grids.at("forces");
    Grid& dynamics = trial.grids.at(kDynamicsGrid);
    for (Grid* grid : {&forces, &dynamics}) {
      const auto inside = [&](double t) { return t > 0.1 && t < grid->time.back() - 0.1; };
      std::vector<double> time;
      for (auto& [channel, of] : grid->channels) {
        std::vector<double> values;
        for (std::size_t i = 0; i < grid->time.size(); ++i) {
          if (inside(grid->time[i])) values.push_back(of.values[i]);
        }
        of.values = values;
      }
      std::copy_if(grid->time.begin(), grid->time.end(), std::back_inserter(time), inside);
      grid->time = time;
    }
  }
  const auto without = MakeContact(data, MovingSettings(data)).value();
  const auto with = MakeContact(data, MovingSettings(data), kMargin).value();
  ASSERT_GT(with->data().stances.front().time.size(), without->data().stances.front().time.size());
  const auto compared = CompareAlternatives(*with, TrueParameters(*with));
  const auto expected = CompareAlternatives(*without, TrueParameters(*without));
  for (const char* quantity : {"vertical force", "forward force"}) {
    const double error = Error(expected, kByBody, quantity);
    EXPECT_NEAR(Error(compared, kByBody, quantity), error, kRounding + 0.1 * error) << quantity;
  }
}

TEST(WholeBody, ThePlateOfAHeldOutStepIsNotUsed) {
  Dataset data = TwoStances();
  AddBodyLoad(0, 0.2, data);
  const auto with = MakeContact(data, MovingSettings(data)).value();
  for (auto& [name, trial] : data.trials) {
    if (trial.role == Role::kTrain) continue;
    for (auto& [channel, of] : trial.grids.at("forces").channels)
      for (double& value : of.values) value *= 1.5;  // begins and ends when it did
  }
  const auto without = MakeContact(data, MovingSettings(data)).value();
  const auto expected = with->Alternatives(TrueParameters(*with));
  const auto found = without->Alternatives(TrueParameters(*without));
  ASSERT_EQ(expected.size(), found.size());
  for (std::size_t a = 0; a < expected.size(); ++a)
    EXPECT_EQ(expected[a].values, found[a].values) << expected[a].name;
}

TEST(WholeBody, WithoutItsLoadThereIsNoSuchPrediction) {
  const Dataset data = TwoStances();
  const auto problem = MakeContact(data, MovingSettings(data)).value();
  const auto compared = CompareAlternatives(*problem, TrueParameters(*problem));
  ASSERT_EQ(compared.size(), 3U);
  EXPECT_EQ(compared[0].name, kByMotion);
  EXPECT_EQ(compared[1].name, kByMeanLoad);
  EXPECT_THAT(compared[2].name, HasSubstr("mean curve"));
  // A prediction of which little is known says so.
  EXPECT_GT(compared[0].pooled_half_width.front(), Error(compared, kByMotion, "forward force"));
  EXPECT_EQ(compared[2].pooled_half_width.front(), 0);
  // The mean load says more than a motion whose height is known to half a millimetre.
  for (const char* quantity : {"vertical force", "forward force"})
    EXPECT_LT(Error(compared, kByMeanLoad, quantity), 0.8 * Error(compared, kByMotion, quantity)) << quantity;
  EXPECT_LT(compared[1].pooled_half_width.front(), 0.5 * compared[0].pooled_half_width.front());
}

// Its sideways force is another one than that of the fitted step.
TEST(WholeBody, TheMeanLoadDoesNotOverruleAMotionThatIsKnown) {
  Dataset data = SteppingData({{"fine", 0}, {"train", 1}, {"validate", 1}, {"moments", 1}}, 0);
  for (auto& [name, trial] : data.trials) trial.grids.erase("markers");
  std::string settings = MovingSettings(data);
  const std::string prior = "position: 0.001, rotation: 0.005";
  settings.replace(settings.find(prior), prior.size(), "position: 0.00003, rotation: 0.00015");
  const auto problem = MakeContact(data, settings).value();
  const auto compared = CompareAlternatives(*problem, TrueParameters(*problem));
  const char* const sideways = "sideways force";
  EXPECT_GT(Error(compared, compared[2].name, sideways), 10);
  EXPECT_LT(Error(compared, kByMotion, sideways), 4);
  EXPECT_LT(Error(compared, kByMeanLoad, sideways), 4);
}

TEST(WholeBody, NoiseIsFoundFromFittedSteps) {
  Dataset data = TwoStances();
  AddBodyLoad(0, 2, data);
  const auto problem = MakeContact(data, MovingSettings(data)).value();
  const auto figures = problem->FiguresOfMerit(TrueParameters(*problem), {});
  const auto noise = std::find_if(figures.begin(), figures.end(), [](const FigureOfMerit& figure) {
    return figure.name == "error of the whole body's vertical force";
  });
  ASSERT_NE(noise, figures.end());
  EXPECT_NEAR(noise->value, 2, 1);  // a dozen samples of single support
}

// Of a fit of the vertical force alone, whose friction nothing determines, horizontal forces of other steps
// follow from the measured ones.
TEST(WholeBody, HorizontalForcesNeedNotBeFitted) {
  Dataset data = TwoStances();
  AddBodyLoad(0, 0.2, data);
  std::string text = MovingSettings(data);
  text.replace(text.find(kFitsForce), std::string(kFitsForce).size(), kFitsVertical);
  const auto problem = MakeContact(data, text).value();
  Vector wrong = TrueParameters(*problem);
  for (Eigen::Index i = 2; i < kContactParametersPerGroup; ++i) wrong[i] = 0;  // no friction at all
  const auto full = PredictAll(*problem, wrong).value();
  const auto alternatives = problem->Alternatives(wrong);
  const auto by_body = std::find_if(alternatives.begin(), alternatives.end(),
                                    [](const auto& one) { return one.name == kByBody; });
  ASSERT_NE(by_body, alternatives.end());
  int compared = 0;
  for (std::size_t b = 0; b < problem->layout().size(); ++b) {
    const Block& block = problem->layout()[b];
    if (block.quantity != "forward force" || by_body->values[b].size() == 0) continue;
    double error = 0;
    double size = 0;
    for (std::size_t i = 0; i < block.sample.size(); ++i) {
      error += std::pow(by_body->values[b][block.sample[i]] - block.measured[i], 2);
      size += std::pow(block.measured[i], 2);
      EXPECT_EQ(full.values[b][block.sample[i]], 0);
    }
    EXPECT_LT(error, 0.05 * size);
    ++compared;
  }
  EXPECT_EQ(compared, 1);
}

TEST(WholeBody, AnotherBodysLoadIsNotUsed) {
  Dataset data = TwoStances();
  AddBodyLoad(200, 0.2, data);
  const auto problem = MakeContact(data, MovingSettings(data)).value();
  const auto compared = CompareAlternatives(*problem, TrueParameters(*problem));
  ASSERT_EQ(compared.size(), 3U);
  EXPECT_EQ(compared[1].name, kByMeanLoad);
}

// Curves whose weights are twice, or a third, of what the prior expects of each step.
// Recorded errors of the foot that all steps share are learnt on fitted steps; errors of each step are not.
TEST(WholeBody, SharedErrorsOfTheMotionAreLearnt) {
  double before = 0;
  for (const double share : {1.0, 0.0}) {
    Dataset data = SteppingData(
        {{"train", 2}, {"validate", 2}, {"moments", 1}, {"motion_error", 0.001}, {"shared_error", share}});
    for (auto& [name, trial] : data.trials) trial.grids.erase("markers");
    const auto problem = MakeContact(data, MovingSettings(data)).value();
    // The deviations of the fitted stances, by their plates.
    FitSetup setup = MakeFitSetup(*problem, {}).value();
    setup.rest = TrueParameters(*problem);
    setup.free.erase(std::remove_if(setup.free.begin(), setup.free.end(),
                                    [&](int i) {
                                      return setup.parameters[static_cast<std::size_t>(i)].kind !=
                                             ParameterKind::kNuisance;
                                    }),
                     setup.free.end());
    const LeastSquares fit(*problem, setup);
    Evaluator evaluator(fit, {});
    const auto solver = MakeSolver("continuation", {}).value();
    const Vector estimated = fit.Parameters(solver->Solve(evaluator, fit.Start()).x);
    const double error = Error(CompareAlternatives(*problem, estimated), kByMotion, "vertical force");
    if (share == 1) {
      EXPECT_LT(error, 5.7) << "a tenth of the robot's weight";
    }
    if (share == 0) {
      EXPECT_GT(error, 2 * before);
    }
    before = error;
  }
}

TEST(StepEstimate, TheSpreadOfStepsIsFoundFromSeveralOfThem) {
  const Dataset data = SteppingData({{"fine", 0}, {"train", 6}, {"validate", 0}}, 0);
  const auto problem = MakeContact(data, MovingSettings(data)).value();
  std::vector<const Stance*> stances;
  for (const Stance& stance : problem->data().stances) stances.push_back(&stance);
  EXPECT_DOUBLE_EQ(SpreadOfSteps(*problem, {stances[0]}, TrueParameters(*problem)), std::sqrt(2));
  double before = 0;
  for (const double size : {0.33, 2.0}) {
    Vector parameters = TrueParameters(*problem);
    Random random(3);
    for (const Stance* stance : stances) {
      const auto [from, to] = stance->motion_errors.OwnRange();
      for (int i = from; i < to; ++i) parameters[i] = size * random.Normal();
    }
    const double spread = SpreadOfSteps(*problem, stances, parameters);
    EXPECT_GT(spread, 5 * before);  // the ratio of 6, whatever share of the weights the plates determine
    EXPECT_GT(spread, size);        // all curves deviate, also where no plate determines them
    before = spread;
  }
}

TEST(StepEstimate, LoadsFollowFromThePlatesChannels) {
  // Forces along x, y, z, centre of pressure at x = 0.08, z = -0.03, free moment of 3 N m.
  const ContactLoad load = LoadOf({10, 500, -20, 0.08, -0.03, 3});
  ContactLoad expected;
  expected << 10, 500, -20, 3 + (-0.03 * 10 - 0.08 * -20), 0.08 * 500, -0.03 * 500;
  EXPECT_LT((load - expected).norm(), 1e-12 * load.norm());
}

}  // namespace
}  // namespace sinew
