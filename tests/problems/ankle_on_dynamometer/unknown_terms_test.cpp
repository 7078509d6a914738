#include "problems/ankle_on_dynamometer/unknown_terms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/observation/sensor_effects.h"
#include "tests/problems/ankle_on_dynamometer/ankle_bench.h"
#include "tests/problems/support/jacobian_check.h"

namespace sinew {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;
using testing::StartsWith;

constexpr const char* kWide = "wide";  // a trial that widens what the signals span

/// Of all trials but kWide.
double FarthestApart(const Problem& problem, const Prediction& a, const Prediction& b) {
  double worst = 0;
  for (int i = 0; i < static_cast<int>(problem.layout().size()); ++i) {
    if (problem.layout()[static_cast<std::size_t>(i)].trial != kWide)
      worst = std::max(worst, (a.values(i) - b.values(i)).cwiseAbs().maxCoeff());
  }
  return worst;
}

const DiscrepancyTerm& TermOf(const Problem& problem, const std::string& name) {
  for (const DiscrepancyPort& port : problem.ports()) {
    for (const DiscrepancyTerm& term : port.terms) {
      if (term.name == name) return term;
    }
  }
  ADD_FAILURE() << "no term " << name;
  return problem.ports().front().terms.front();
}

/// A point at which the term's curve is f(signal).
template <class F>
Vector WithCurve(const Problem& problem, Vector point, const std::string& name, const F& f) {
  const DiscrepancyTerm& term = TermOf(problem, name);
  for (std::size_t k = 0; k < term.knots.size(); ++k) point[term.parameters[k]] = f(term.knots[k]);
  return point;
}

Vector With(const Problem& problem, Vector point, const std::string& name, double change) {
  point[*FindParameter(problem.parameters(), name)] += change;
  return point;
}

TEST(AnkleUnknownTerms, PortsAndTheirSignals) {
  const auto problem = BindAnkleBench();
  std::vector<std::string> names;
  for (const DiscrepancyPort& port : problem->ports()) {
    for (const DiscrepancyTerm& term : port.terms) names.push_back(term.name);
  }
  EXPECT_THAT(names, ElementsAre("ankle_moment(ankle_angle)", "ankle_moment(ankle_velocity)",
                                 "ankle_moment(mean_activation)", "ankle_moment(time)",
                                 "activation.soleus_r(time)", "activation.soleus_r(machine_angle)",
                                 "activation.soleus_r(excitation)", "activation.tib_ant_r(time)",
                                 "activation.tib_ant_r(machine_angle)", "activation.tib_ant_r(excitation)"));
  // Knots span what the trials span: the plate goes from -0.4 to 0.2 rad, a trial lasts 1 s.
  const auto& angles = TermOf(*problem, "ankle_moment(ankle_angle)").knots;
  EXPECT_NEAR(angles.front(), -0.46, 0.01);
  EXPECT_NEAR(angles.back(), 0.26, 0.01);
  EXPECT_EQ(TermOf(*problem, "activation.soleus_r(time)").knots.back(), 1);
  EXPECT_NEAR(TermOf(*problem, "activation.soleus_r(excitation)").knots.back(), 0.58, 1e-3);
}

// Straight lines of a signal are what known laws are: the traces are the same.
TEST(AnkleUnknownTerms, LinesOfTheMomentAreTheKnownLaws) {
  AnkleSettings settings = AnkleBenchSettings();
  settings.parameters["passive_linear_stiffness"].upper = 1000;
  // Knots that no other trial goes beyond.
  Dataset data = AnkleBenchData();
  data.trials[kWide] = AnkleBenchTrial(AnkleBench::kPassive);
  Grid& wide = MachineGrid(data, kWide);
  for (std::size_t i = 0; i < wide.time.size(); ++i)
    wide.channels.at("machine_angle").values[i] = -0.1 + 0.4 * std::cos(25 * wide.time[i]);
  const auto problem = BindAnkleBench(data, settings);
  const Vector rest = RestPoint(*problem);
  const double rest_angle = AnkleDefaults(settings)[kPassiveAngle];
  const auto check = [&](const std::string& term, const auto& curve, const std::string& law, double change) {
    const Prediction by_curve = PredictAnkle(*problem, WithCurve(*problem, rest, term, curve));
    const Prediction by_law = PredictAnkle(*problem, With(*problem, rest, law, change));
    EXPECT_LT(FarthestApart(*problem, by_curve, by_law), 1e-8) << term;
    EXPECT_GT(FarthestApart(*problem, by_curve, PredictAnkle(*problem, rest)), 1e-2) << term;
  };
  check(
      "ankle_moment(ankle_angle)", [&](double q) { return -3 * (q - rest_angle); },
      "passive_linear_stiffness", 3);
  check(
      "ankle_moment(ankle_velocity)", [](double v) { return -0.2 * v; }, "passive_damping", 0.2);
  check(
      "ankle_moment(mean_activation)", [](double a) { return -20 * a; }, "antagonist", 20);
}

TEST(AnkleUnknownTerms, ACurveOfTimeInAllMusclesIsFatigue) {
  const auto problem = BindAnkleBench();
  const Vector rest = RestPoint(*problem);
  const auto falls = [](double t) { return -0.08 * t; };
  Vector curves = WithCurve(*problem, rest, "activation.soleus_r(time)", falls);
  curves = WithCurve(*problem, curves, "activation.tib_ant_r(time)", falls);
  EXPECT_LT(FarthestApart(*problem, PredictAnkle(*problem, curves),
                          PredictAnkle(*problem, With(*problem, rest, "fatigue", 0.08))),
            1e-9);
  // A constant share is the same whatever the signal.
  const auto constant = [](double) { return 0.1; };
  const Prediction over_time =
      PredictAnkle(*problem, WithCurve(*problem, rest, "activation.soleus_r(time)", constant));
  for (const char* signal : {"machine_angle", "excitation"}) {
    const std::string name = "activation.soleus_r(" + std::string(signal) + ")";
    EXPECT_LT(
        FarthestApart(*problem, PredictAnkle(*problem, WithCurve(*problem, rest, name, constant)), over_time),
        1e-9);
  }
  EXPECT_GT(FarthestApart(*problem, over_time, PredictAnkle(*problem, rest)), 0.1);
}

TEST(AnkleUnknownTerms, DerivativesAgreeWithDifferences) {
  AnkleSettings settings = AnkleBenchSettings();
  settings.rate = 20;
  settings.foot.strips = 3;
  const auto problem = BindAnkleBench(AnkleBenchData(), settings);
  Vector point = RestPoint(*problem);
  Random random(4);
  for (const DiscrepancyPort& port : problem->ports()) {
    for (const DiscrepancyTerm& term : port.terms) {
      for (const int weight : term.parameters)
        point[weight] = (port.unit == "1" ? 0.02 : 0.3) * random.Normal();
    }
  }
  const JacobianCheck check = CheckJacobian(*problem, point);
  EXPECT_LT(check.worst, 1e-5);
  EXPECT_GE(check.compared, check.columns / 2);
}

/// Two passive trials and one of the attachment alone, their plates at different speeds.
Dataset PassiveData() {
  Dataset data;
  const double speeds[] = {2, 5, 3.3};
  const char* names[] = {"alone", "slow", "fast"};
  const AnkleBench kinds[] = {AnkleBench::kAttachment, AnkleBench::kPassive, AnkleBench::kPassive};
  for (int i = 0; i < 3; ++i) {
    Trial trial = AnkleBenchTrial(kinds[i]);
    Grid& grid = trial.grids.at("machine");
    std::vector<double> time;
    for (int k = 0; k <= 60; ++k) time.push_back(0.04 * k);
    for (auto& [name, channel] : grid.channels) {
      channel.values.clear();
      for (const double t : time) channel.values.push_back(-0.1 + 0.3 * std::cos(speeds[i] * t));
    }
    grid.time = time;
    data.trials[names[i]] = trial;
  }
  return data;
}

/// A diagnosis of what the model itself predicts at a point, with noise.
Diagnosis DiagnosisOf(const Vector& truth, std::uint64_t seed) {
  Dataset data = PassiveData();
  AnkleSettings settings = AnkleBenchSettings();
  settings.step = 0.04;
  settings.foot.strips = 4;
  const auto made = BindAnkleBench(data, settings);
  const Prediction prediction = PredictAnkle(*made, truth);
  Random random(seed);
  for (std::size_t b = 0; b < made->layout().size(); ++b) {
    const Block& block = made->layout()[b];
    Channel& channel = MachineGrid(data, block.trial).channels.at(block.channel);
    for (std::size_t i = 0; i < channel.values.size(); ++i)
      channel.values[i] = prediction.values(static_cast<int>(b))[static_cast<Eigen::Index>(i)] +
                          *channel.sigma * random.Normal();
  }
  const SensorEffects problem(BindAnkleBench(data, settings));
  FitRequest request;
  request.free = {"attachment_inertia", "attachment_gravity",       "attachment_friction",
                  "passive_stiffness",  "passive_linear_stiffness", "passive_damping"};
  auto setup = MakeFitSetup(problem, request);
  EXPECT_TRUE(setup) << setup.error().message;
  DiagnosisOptions options;
  options.solver = "lm";
  auto diagnosis = Diagnose(problem, *setup, options);
  EXPECT_TRUE(diagnosis) << diagnosis.error().message;
  return diagnosis ? *diagnosis : Diagnosis();
}

std::vector<std::string> UnknownNames(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const UnknownFinding& finding : diagnosis.unknown_terms) names.push_back(finding.name);
  return names;
}

std::vector<std::string> CauseNames(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const auto& cause : diagnosis.causes) names.push_back(cause.effect);
  return names;
}

// A moment with a bump where no law of the library has one.
TEST(AnkleUnknownTerms, AnUnknownLawIsFoundAtItsPortAndSignal) {
  const auto problem = BindAnkleBench(PassiveData());
  const auto bump = [](double q) { return 6 * std::exp(-0.5 * std::pow((q + 0.1) / 0.08, 2)); };
  const Diagnosis found =
      DiagnosisOf(WithCurve(*problem, RestPoint(*problem), "ankle_moment(ankle_angle)", bump), 5);
  EXPECT_EQ(found.verdict, DiagnosisVerdict::kUnexplained);
  ASSERT_FALSE(found.unknown_terms.empty());
  EXPECT_THAT(UnknownNames(found), Contains("ankle_moment(ankle_angle)"));
}

TEST(AnkleUnknownTerms, AKnownEffectIsNamedAllTheSame) {
  const auto problem = BindAnkleBench(PassiveData());
  const Diagnosis found = DiagnosisOf(With(*problem, RestPoint(*problem), "passive_hysteresis", 0.6), 6);
  EXPECT_NE(found.verdict, DiagnosisVerdict::kUnexplained);
  EXPECT_THAT(CauseNames(found), ElementsAre("passive_hysteresis"));
  EXPECT_THAT(UnknownNames(found), Not(Contains(StartsWith("ankle_moment"))));
}

}  // namespace
}  // namespace sinew
