// Steps that no plate measured: what is predicted of them, and that they leave everything else alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "identify/fit_quality.h"
#include "problems/contact/steps/load_estimate.h"
#include "problems/contact/steps/mean_load.h"
#include "problems/contact/steps/motion_steps.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::HasSubstr;

Dataset RobotSteps() {
  Dataset data = SteppingData({{"fine", 0}, {"train", 1}, {"validate", 1}, {"moments", 1}}, 0);
  for (auto& [name, trial] : data.trials) trial.grids.erase("markers");
  return data;
}

// Takes the values of the plate away.
void Forget(Trial& trial) {
  for (auto& [name, channel] : trial.grids.at("forces").channels)
    channel.values.assign(channel.values.size(), std::numeric_limits<double>::quiet_NaN());
}

Vector StepTruth(const ContactProblem& problem) {
  Vector truth = RestPoint(problem);
  for (Eigen::Index i = 0; i < kContactParametersPerGroup; ++i)
    truth[i] = kTruth.at(problem.parameters()[static_cast<std::size_t>(i)].name);
  return truth;
}

TEST(UnmeasuredSteps, LeaveThePredictionOfTheOthersAsItIs) {
  const Dataset data = RobotSteps();
  Dataset more = data;
  const auto held_out = std::find_if(data.trials.begin(), data.trials.end(),
                                     [](const auto& t) { return t.second.role == Role::kValidate; });
  Trial unmeasured = held_out->second;
  Forget(unmeasured);
  more.trials["a_step"] = unmeasured;  // the first by name
  const auto before = MakeContact(data, MovingSettings(data)).value();
  const auto after = MakeContact(more, MovingSettings(more)).value();
  Vector at = StepTruth(*before);
  Vector then = StepTruth(*after);
  for (std::size_t i = 0; i < before->parameters().size(); ++i) {
    const Parameter& p = before->parameters()[i];
    if (p.kind != ParameterKind::kNuisance) continue;
    at[static_cast<Eigen::Index>(i)] = 0.3 * std::sin(static_cast<double>(i));
    const int index = FindParameter(after->parameters(), p.name).value();
    then[index] = at[static_cast<Eigen::Index>(i)];
  }
  const FullPrediction expected = PredictAll(*before, at).value();
  const FullPrediction found = PredictAll(*after, then).value();
  std::size_t compared = 0;
  for (std::size_t b = 0; b < before->layout().size(); ++b) {
    for (std::size_t c = 0; c < after->layout().size(); ++c) {
      const Block& one = before->layout()[b];
      const Block& other = after->layout()[c];
      if (one.trial != other.trial || one.channel != other.channel) continue;
      EXPECT_EQ(expected.values[b], found.values[c]) << one.trial << " " << one.channel;
      EXPECT_EQ(one.role, other.role);
      ++compared;
    }
  }
  EXPECT_EQ(compared, before->layout().size());
  for (const Block& block : after->layout()) {
    if (block.trial == "a_step") {
      EXPECT_EQ(block.role, BlockRole::kPredicted);
    }
  }
}

TEST(UnmeasuredSteps, ArePredictedAsIfTheyWereHeldOut) {
  Dataset data = RobotSteps();
  const auto measured = MakeContact(data, MovingSettings(data)).value();
  const auto alternatives = measured->Alternatives(StepTruth(*measured));
  ASSERT_FALSE(alternatives.empty());
  EXPECT_FALSE(measured->EstimateUnmeasured(StepTruth(*measured)));
  for (const Stance& stance : measured->data().stances) {
    Trial& trial = data.trials.at(stance.trial);
    if (trial.role == Role::kTrain) continue;
    trial.conditions["window_start_s"] = stance.loaded[0];
    trial.conditions["window_end_s"] = stance.loaded[1];
    Forget(trial);
  }
  const auto problem = MakeContact(data, MovingSettings(data)).value();
  const auto estimate = problem->EstimateUnmeasured(StepTruth(*problem));
  ASSERT_TRUE(estimate);
  std::size_t compared = 0;
  for (std::size_t b = 0; b < problem->layout().size(); ++b) {
    const Vector& values = estimate->values[b];
    EXPECT_EQ(values.size() == 0, data.trials.at(problem->layout()[b].trial).role == Role::kTrain);
    if (values.size() == 0) continue;
    EXPECT_EQ(estimate->from[b], "the motion and the mean load of the fitted stances");
    EXPECT_EQ(estimate->half_width[b].size(), values.size());
    EXPECT_TRUE(values.allFinite() && estimate->half_width[b].allFinite()) << problem->layout()[b].channel;
    EXPECT_GT(estimate->half_width[b].minCoeff(), 0);
    EXPECT_EQ(alternatives[1].name, "from " + estimate->from[b]);
    const Vector& expected = alternatives[1].values[b];
    const double scale = expected.cwiseAbs().maxCoeff();
    EXPECT_LT((values - expected).cwiseAbs().maxCoeff(), 0.02 * scale) << problem->layout()[b].channel;
    ++compared;
  }
  EXPECT_EQ(compared, ContactProblem::kChannels);
  EXPECT_EQ(Describe(problem->layout(), *estimate).size(), ContactProblem::kChannels);
}

// The largest half width of the band of an unmeasured step's vertical force, without the load of the whole
// body. @param longer by so much its duration differs from that of the fitted step
double BandOf(double longer) {
  Dataset data = RobotSteps();
  const auto measured = MakeContact(data, MovingSettings(data)).value();
  for (const Stance& stance : measured->data().stances) {
    Trial& trial = data.trials.at(stance.trial);
    if (trial.role == Role::kTrain) continue;
    trial.conditions["window_start_s"] = stance.loaded[0];
    trial.conditions["window_end_s"] = stance.loaded[1] + longer * (stance.loaded[1] - stance.loaded[0]);
    Forget(trial);
  }
  const auto problem = MakeContact(data, MovingSettings(data)).value();
  const auto estimate = problem->EstimateUnmeasured(StepTruth(*problem));
  EXPECT_TRUE(estimate);
  for (const Stance& stance : problem->data().stances) {
    if (!stance.measured) return estimate->half_width[static_cast<std::size_t>(stance.blocks[1])].maxCoeff();
  }
  ADD_FAILURE() << "every step was measured";
  return NAN;
}

TEST(UnmeasuredSteps, AStepOfAnotherDurationIsLessNearToTheMeanLoad) {
  const double as_usual = BandOf(0);
  EXPECT_GT(as_usual, 0);
  EXPECT_GT(BandOf(-0.2), 2 * as_usual);
}

TEST(UnmeasuredSteps, CannotBeFitted) {
  Dataset data = RobotSteps();
  for (auto& [name, trial] : data.trials) {
    if (trial.role == Role::kTrain) Forget(trial);
  }
  const auto problem = MakeContact(data, MovingSettings(data));
  ASSERT_FALSE(problem);
  EXPECT_THAT(problem.error().message, HasSubstr("a step without a plate can only be predicted"));
}

LoadRow RowOf(int instant, ContactLoadRow component, double measured, double deviation) {
  ContactLoad factors = ContactLoad::Zero();
  factors[component] = 1;
  return {{{instant, factors}}, measured, deviation};
}

TEST(LoadEstimate, WeighsWhatIsKnownByItsPrecision) {
  std::vector<LoadRow> rows;
  for (int component = 0; component < 6; ++component) {
    for (const int instant : {1, 3})
      rows.push_back(RowOf(instant, static_cast<ContactLoadRow>(component), 0, 10));
  }
  rows.push_back(RowOf(1, kForceY, 100, 5));  // against 0 +- 10
  // The change from instant 1 to 3 is known to be 20 +- 1.
  LoadRow change = RowOf(3, kForceX, 20, 1);
  change.terms.push_back({1, -change.terms.front().factors});
  rows.push_back(change);
  const LoadEstimate estimate = EstimateLoad(rows, 5);
  ASSERT_EQ(estimate.load.size(), 5U);
  EXPECT_NEAR(estimate.load[1][kForceY], 80, 1e-9);
  EXPECT_NEAR(estimate.covariance[1](kForceY, kForceY), 1 / (1 / 100.0 + 1 / 25.0), 1e-9);
  // By symmetry half of the change on both sides, less what the prior takes.
  EXPECT_NEAR(estimate.load[3][kForceX], 10 / (1 + 1 / 200.0), 1e-9);
  EXPECT_NEAR(estimate.load[1][kForceX], -estimate.load[3][kForceX], 1e-9);
  EXPECT_EQ(estimate.load[0], ContactLoad::Zero());
}

TEST(MeanLoad, IsMirroredForTheOtherFoot) {
  const Dataset data = RobotSteps();
  const auto problem = MakeContact(data, MovingSettings(data)).value();
  const Stance& stance = problem->data().stances.front();
  ContactLoad load = ContactLoad::Zero();
  load[kForceX] = 3;
  load[kForceY] = 50;
  load[kForceZ] = 2;
  const std::vector<std::vector<ContactLoad>> loads{std::vector<ContactLoad>(stance.time.size(), load)};
  const MeanLoad mean({&stance}, loads, problem->settings().floor.height);
  Stance other = stance;
  other.side = -stance.side;
  const auto outward = [](const std::vector<LoadRow>& rows) {
    return rows[2];  // of the first instant
  };
  const LoadRow same = outward(mean.RowsFor(stance, Wrench::Ones()));
  const LoadRow mirrored = outward(mean.RowsFor(other, Wrench::Ones()));
  EXPECT_NEAR(same.terms.front().factors.dot(load), same.measured, 1e-9);
  EXPECT_EQ(mirrored.measured, same.measured);
  EXPECT_NEAR(mirrored.terms.front().factors.dot(load), -same.measured, 1e-9);
  EXPECT_NEAR(same.deviation, mean.scatter()[2], 1e-12);
  Wrench larger = Wrench::Ones();
  larger[2] = 3;
  EXPECT_NEAR(outward(mean.RowsFor(stance, larger)).deviation, 3 * same.deviation, 1e-12);
}

TEST(MeanLoad, ScatterIsLearntFromHowStepsDiffer) {
  const Dataset data = RobotSteps();
  const auto problem = MakeContact(data, MovingSettings(data)).value();
  const Stance& stance = problem->data().stances.front();
  const auto scatter_of = [&](double apart) {
    std::vector<std::vector<ContactLoad>> loads;
    for (const double sign : {-1.0, 1.0}) {
      ContactLoad load = ContactLoad::Zero();
      load[kForceY] = 50 + 0.5 * sign * apart;
      loads.emplace_back(stance.time.size(), load);
    }
    return MeanLoad({&stance, &stance}, loads, 0).scatter()[1];
  };
  // The expectation counts as three steps, and the mean of two steps is uncertain itself.
  const double expected = 0.04 * stance.greatest_force;
  EXPECT_NEAR(scatter_of(0), std::sqrt(3 * expected * expected / 4 * 1.5), 1e-9);
  EXPECT_NEAR(scatter_of(30), std::sqrt((3 * expected * expected + 2 * 15 * 15) / 4 * 1.5), 1e-9);
}

}  // namespace
}  // namespace sinew
