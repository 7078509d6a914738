// What the data of a stepping robot determine about its soles, from synthesis to verdict.
#include "identify/identification/identification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "identify/text/findings.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::ElementsAre;

Identification IdentifyWithCeres(const Problem& problem, const FitRequest& request = {}) {
  auto found = Identify(problem, MakeFitSetup(problem, request).value(), {});
  EXPECT_TRUE(found) << found.error().message;
  return found ? std::move(*found) : Identification{};
}

std::map<std::string, Verdict> Verdicts(const Problem& problem, const Identification& identification) {
  std::map<std::string, Verdict> verdicts;
  for (const ParameterVerdict& v : identification.uncertainty.parameters)
    verdicts[problem.parameters()[static_cast<std::size_t>(v.parameter)].name] = v.verdict;
  return verdicts;
}

TEST(ContactIdentification, ExactDataGiveBackTheTruth) {
  constexpr double kTolerance = 1e-6;  // the solver stops at a relative cost change of 1e-12
  const auto problem = MakeContact(ExactData(), SettingsText(ExactData(), kFitsVertical, kFitsForce)).value();
  const Identification found = IdentifyWithCeres(*problem);
  ASSERT_TRUE(found.result.stop.converged()) << found.result.stop.test;
  const Vector truth = TruthOf(*problem);
  double worst = 0;
  for (Eigen::Index i = 0; i < 5; ++i) {
    worst = std::max(worst, std::abs(found.parameters[i] / truth[i] - 1));
    EXPECT_NEAR(found.parameters[i], truth[i], kTolerance * truth[i])
        << problem->parameters()[static_cast<std::size_t>(i)].name;
  }
  std::printf("worst relative error of a parameter %.2e\n", worst);
}

TEST(ContactIdentification, ExactVerticalForceAloneGivesStiffnessAndDissipation) {
  constexpr double kTolerance = 1e-6;
  const auto problem = MakeContact(ExactData(), SettingsText(ExactData())).value();
  const Identification found = IdentifyWithCeres(*problem);
  ASSERT_TRUE(found.result.stop.converged()) << found.result.stop.test;
  EXPECT_NEAR(found.parameters[0], kTruth.at("stiffness"), kTolerance * kTruth.at("stiffness"));
  EXPECT_NEAR(found.parameters[1], kTruth.at("dissipation"), kTolerance * kTruth.at("dissipation"));
}

TEST(ContactIdentification, VerticalForceAloneSaysNothingOfFriction) {
  const Dataset data = SteppingData();
  const auto problem = MakeContact(data, SettingsText(data)).value();
  const Identification found = IdentifyWithCeres(*problem);
  const auto verdicts = Verdicts(*problem, found);
  EXPECT_EQ(verdicts.at("stiffness"), Verdict::kIdentifiable);
  EXPECT_EQ(verdicts.at("dissipation"), Verdict::kIdentifiable);
  for (const char* friction : {"static_friction", "dynamic_friction", "viscous_friction"}) {
    EXPECT_EQ(verdicts.at(friction), Verdict::kNotIdentifiable) << friction;
  }
  const std::vector<text::Sentence> findings = text::Findings(found);
  const auto told = std::find_if(findings.begin(), findings.end(), [](const text::Sentence& finding) {
    return finding.kind == text::SentenceKind::kNotIdentifiable;
  });
  ASSERT_NE(told, findings.end());
  EXPECT_THAT(told->about, ElementsAre("static_friction", "dynamic_friction", "viscous_friction"))
      << "one sentence for all three";
}

// Viscous friction needs fast slip: at 0.05 m/s it adds 0.02 to a friction coefficient of 0.6, too little to
// distinguish it from dynamic friction.
TEST(ContactIdentification, TangentialForceIdentifiesFrictionIfTheFootSlipsFast) {
  constexpr double kFast = 0.3;    // [m/s]
  constexpr double kErrors = 4.5;  // standard errors; chance of failure 7e-6 each, the seed is fixed
  for (const double slip : {0.05, kFast}) {
    const Dataset data = SteppingData({{"slip", slip}});
    const auto problem = MakeContact(data, SettingsText(data, kFitsVertical, kFitsForce)).value();
    const Identification found = IdentifyWithCeres(*problem);
    for (const ParameterVerdict& v : found.uncertainty.parameters) {
      const std::string& name = problem->parameters()[static_cast<std::size_t>(v.parameter)].name;
      std::printf("slip %.2f m/s: %s = %.6g +- %.2g (%s), truth %.6g\n", slip, name.c_str(), v.value,
                  v.std_error, ToString(v.verdict), kTruth.at(name));
      const bool too_slow = slip < kFast && name == "viscous_friction";
      EXPECT_EQ(v.verdict, too_slow ? Verdict::kWeak : Verdict::kIdentifiable)
          << name << ": " << ToString(v.reason.kind);
      EXPECT_NEAR(v.value, kTruth.at(name), kErrors * v.std_error) << name;
    }
  }
}

// One stance of a person whose recorded foot errs by 5 mm and 1.5 degrees, where the sole sinks in by 10 mm.
TEST(ContactIdentification, MotionThatErrsByMillimetresTellsTheContactIfItsErrorsAreFitted) {
  SynthesisRequest request;
  request.seed = 8;
  request.set = {{"person", 1},
                 {"encoders", 1},
                 {"train", 1},
                 {"validate", 0},
                 {"fine", 0},
                 {"slip", 0.1},
                 {"motion_error", 0.005},
                 {"rotation_error", 0.0262}};
  const Dataset data = SynthesizeContact(request).value();
  IdentificationOptions options;
  options.solver = "restarts";
  const auto find = [&](const std::string& yaml) {
    const auto problem = MakeContact(data, yaml).value();
    auto found = Identify(*problem, MakeFitSetup(*problem, {}).value(), options).value();
    const auto verdicts = Verdicts(*problem, found);
    return std::tuple(found.parameters, verdicts, found.uncertainty.parameters);
  };
  const std::string text = SettingsText(data);
  const auto [ignored, ignored_verdicts, ignored_intervals] = find(text);
  const auto [fitted, verdicts, intervals] = find(
      SettingsText(data, "  regions:", "  motion_errors: {position: 0.005, rotation: 0.0262}\n  regions:"));
  EXPECT_NEAR(fitted[0] / 1.9e6, 1, 0.4)
      << "stiffness: 5 mm of 10 mm, and few independent errors in a stance";
  // The recorded motion is smoothed, so that the frictions are not exact; their intervals say how well they
  // are known.
  EXPECT_NEAR(fitted[2] / 0.9, 1, 0.05) << "static friction";
  ASSERT_GE(intervals.size(), 4U);
  EXPECT_LT(intervals[2].ci95_lower, 0.9);
  EXPECT_GT(intervals[2].ci95_upper, 0.9);
  EXPECT_LT(intervals[3].ci95_lower, 0.6);
  EXPECT_GT(intervals[3].ci95_upper, 0.6);
  EXPECT_EQ(verdicts.at("static_friction"), Verdict::kIdentifiable);
  EXPECT_GT(std::abs(ignored[2] / 0.9 - 1), 0.1) << "static friction from a motion that is taken for exact";
}

}  // namespace
}  // namespace sinew
