#include "problems/emg_shape/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/fit_setup.h"
#include "identify/identification/identification.h"
#include "problems/emg_shape/prediction/band.h"
#include "tests/problems/emg_shape/emg_shape_study.h"

namespace sinew {
namespace {

using testing::Contains;
using testing::HasSubstr;

std::unique_ptr<EmgShapeProblem> Bound(const Dataset& data, const std::string& more = "") {
  auto problem = EmgShapeProblem::Make(data, EmgSettings(more));
  EXPECT_TRUE(problem) << problem.error().message;
  return problem ? std::move(*problem) : nullptr;
}

Identification Fitted(const Problem& problem, const std::vector<std::string>& released = {}) {
  IdentificationOptions options;
  options.solver = "lm";
  options.profiles = false;
  FitRequest request;
  request.release = released;
  auto setup = MakeFitSetup(problem, request);
  EXPECT_TRUE(setup);
  auto fit = Identify(problem, std::move(*setup), std::move(options));
  EXPECT_TRUE(fit) << fit.error().message;
  return std::move(*fit);
}

double ValueOf(const Problem& problem, const Vector& parameters, const std::string& name) {
  return parameters[FindParameter(problem.parameters(), name).value()];
}

const FitQuality& QualityOf(const Identification& fit, const std::string& trial, const std::string& channel) {
  for (const FitQuality& quality : fit.prediction.quality) {
    if (quality.trial == trial && quality.channel == channel) return quality;
  }
  throw std::invalid_argument(trial);
}

TEST(EmgShapeProblem, TheTruthIsFoundInItsOwnEmg) {
  const Dataset data = EmgStudy({{"exact", 1},
                                 {"lead", 0.12},
                                 {"lat_gas_r.amplitude_exponent", 0.6},
                                 {"med_gas_r.amplitude_exponent", -0.3}});
  const auto problem = Bound(data, ", low_pass: 0");
  const Identification fit = Fitted(*problem);
  // Priors draw the deviations of speeds to 0, which is their truth; floors and shapes may exchange a little.
  EXPECT_NEAR(ValueOf(*problem, fit.parameters, "lead"), 0.12, 1e-5);
  EXPECT_NEAR(ValueOf(*problem, fit.parameters, "lat_gas_r.amplitude_exponent"), 0.6, 1e-4);
  EXPECT_NEAR(ValueOf(*problem, fit.parameters, "med_gas_r.amplitude_exponent"), -0.3, 1e-4);
  EXPECT_LT(QualityOf(fit, "validate_120", "lat_gas_r").rmse, 1e-5);
}

TEST(EmgShapeProblem, LawsPredictASpeedThatWasNotMeasured) {
  const Dataset data = EmgStudy({{"speeds", 6}, {"noisy", 0}, {"subject", 2}, {"train", 6}});
  const auto with = Bound(data, ", low_pass: 0, hold_out: [train_120]");
  const auto without = Bound(data, ", low_pass: 0, hold_out: [train_120], laws: []");
  for (const char* muscle : {"lat_gas_r", "med_gas_r"}) {
    const double lawful = QualityOf(Fitted(*with), "train_120", muscle).rmse;
    const double lawless = QualityOf(Fitted(*without), "train_120", muscle).rmse;
    EXPECT_LT(lawful, 0.8 * lawless) << muscle << ", person 2 shifts phase with speed";
  }
  EXPECT_THAT(
      with->WarningsAt(RestPoint(*with)),
      Contains(testing::Field(
          &Warning::message,
          HasSubstr("trial 'train_120' moves at 2.09 rad/s, outside of the measured 0.524 .. 1.57"))));
}

// Bursts of both muscles come early and late together, so what is heard moves as the muscle's own EMG does.
TEST(EmgShapeProblem, CrossTalkIsFoundWhereMusclesVaryTogether) {
  for (const double share : {0.1, 0.3, 0.6}) {
    SynthesisRequest request;
    request.seed = 107;
    request.set = {{"speeds", 4},   {"muscles", 2}, {"raw", 0},   {"moments", 0},  {"train", 6},
                   {"validate", 2}, {"laws", 0},    {"noisy", 0}, {"subject", 107}};
    request.effects = {{"cross_talk.lat_gas_r", {{"cross_talk.lat_gas_r", share}}}};
    const auto data = SynthesizeEmgShape(request);
    ASSERT_TRUE(data) << data.error().message;
    const auto problem = Bound(*data, ", laws: [], low_pass: 0");
    const Identification fit = Fitted(*problem, {"cross_talk.lat_gas_r"});
    EXPECT_NEAR(ValueOf(*problem, fit.parameters, "cross_talk.lat_gas_r"), share, 0.1 * share);
  }
}

TEST(EmgShapeProblem, OneSpeedHasNoLaws) {
  const auto problem = Bound(EmgStudy({{"speeds", 1}}));
  EXPECT_FALSE(FindParameter(problem->parameters(), "lead"));
  EXPECT_THAT(problem->data().notes, Contains(HasSubstr("one speed was measured")));
}

// What a patient at home has: an angle. The model comes from elsewhere.
TEST(EmgShapeProblem, AnAngleAloneIsEnoughToPredict) {
  const Dataset data = EmgStudy({{"noisy", 0}});
  const auto learnt = Bound(data, ", low_pass: 0");
  const Identification fit = Fitted(*learnt);
  Dataset home;
  home.trials["validate_075"] = data.trials.at("validate_075");
  home.trials.at("validate_075").grids.erase("excitations");
  std::string jitter;
  for (const EmgMuscle& muscle : learnt->data().muscles)
    jitter += fmt::format("{}{}: {}", jitter.empty() ? "" : ", ", muscle.name, muscle.timing.total);
  const auto problem =
      Bound(home, fmt::format(", low_pass: 0, muscles: [lat_gas_r, med_gas_r], reference: {{speed: {}, "
                              "period: {}}}, jitter: {{{}}}",
                              learnt->data().reference.speed, learnt->data().reference.period, jitter));
  Vector point = RestPoint(*problem);
  for (std::size_t i = 0; i < problem->parameters().size(); ++i) {
    const auto found = FindParameter(learnt->parameters(), problem->parameters()[i].name);
    if (found) point[static_cast<Eigen::Index>(i)] = fit.parameters[*found];
  }
  const auto prediction = PredictAll(*problem, point);
  ASSERT_TRUE(prediction) << prediction.error().message;
  const auto& block = problem->layout()[0];
  EXPECT_EQ(block.role, BlockRole::kPredicted);
  // The same as with the EMG beside it, whose samples it does not look at.
  for (std::size_t b = 0; b < learnt->layout().size(); ++b) {
    const Block& other = learnt->layout()[b];
    if (other.trial != block.trial || other.channel != block.channel) continue;
    for (std::size_t i = 0; i < block.prediction_time.size(); i += 10) {
      const auto at = std::lower_bound(other.prediction_time.begin(), other.prediction_time.end(),
                                       block.prediction_time[i] - 1e-9) -
                      other.prediction_time.begin();
      if (at == other.predictions()) break;
      EXPECT_NEAR(prediction->values[0][static_cast<Eigen::Index>(i)], fit.prediction.values[b][at], 1e-9);
    }
  }
}

TEST(PredictionBand, HoldsTheCyclesThatWereNotFitted) {
  const Dataset data = EmgStudy({{"speeds", 4}, {"subject", 3}, {"train", 9}, {"validate", 12}});
  const auto problem = Bound(data);
  const Identification fit = Fitted(*problem);
  const auto band = PredictionBand(*problem, fit.parameters);
  ASSERT_TRUE(band) << band.error().message;
  double within = 0;
  double count = 0;
  for (std::size_t b = 0; b < problem->layout().size(); ++b) {
    const Block& block = problem->layout()[b];
    if (block.role != BlockRole::kValidate) continue;
    for (int i = 0; i < block.samples(); ++i) {
      const int at = block.sample[static_cast<std::size_t>(i)];
      const double error = fit.prediction.values[b][at] - block.measured[static_cast<std::size_t>(i)];
      within += std::abs(error) <= 1.96 * (*band)[b][at] ? 1 : 0;
      count += 1;
    }
  }
  EXPECT_GT(within / count, 0.88);
  EXPECT_LT(within / count, 0.99) << "so wide that it says nothing";
}

}  // namespace
}  // namespace sinew
