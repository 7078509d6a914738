#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/identification/identification.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using toy::MakeParameter;

// A problem with parameters a .. e, and an identification without any results.
class FindingsTest : public testing::Test {
 protected:
  FindingsTest() : problem_(Parameters(), {}, {}) {
    identification_.setup.parameters = problem_.parameters();
  }

  ParameterVerdict& Judge(int parameter, Verdict verdict, const std::string& reason = "",
                          const std::string& remedy = "") {
    ParameterVerdict v;
    v.parameter = parameter;
    v.verdict = verdict;
    v.reason = reason;
    v.remedy = remedy;
    v.value = 12.345;
    v.ci95_lower = 12;
    v.ci95_upper = 12.7;
    identification_.uncertainty.parameters.push_back(v);
    return identification_.uncertainty.parameters.back();
  }
  [[nodiscard]] std::vector<std::string> Findings() const {
    return DescribeFindings(problem_, identification_);
  }

  static std::vector<Parameter> Parameters() {
    std::vector<Parameter> parameters;
    for (const char* name : {"a", "b", "c", "d", "e"}) parameters.push_back(MakeParameter(name, 0, 100, 1));
    parameters[0].unit = "N/m";
    return parameters;
  }
  toy::ToyProblem problem_;
  Identification identification_;
};

TEST_F(FindingsTest, ADeterminedParameterHasItsValueUnitAndInterval) {
  Judge(0, Verdict::kIdentifiable);
  Judge(1, Verdict::kWeak, "its interval is wide");
  EXPECT_THAT(Findings(), ElementsAre("a = 12.3 N/m (95 % interval 12.0 to 12.7): identifiable.",
                                      "b = 12.3 (95 % interval 12.0 to 12.7): weak, its interval is wide."));
}

// An unconverged search: the interval belongs to the minimum near by, and the value does not.
TEST_F(FindingsTest, AValueOutsideItsIntervalIsNotCalledIdentifiable) {
  Judge(0, Verdict::kIdentifiable).value = 20;
  EXPECT_THAT(Findings(),
              ElementsAre("a = 20.0 N/m: NOT at the best fit, whose 95 % interval is 12.0 to 12.7; let the "
                          "search go on."));
}

TEST_F(FindingsTest, ABoundThatWasHitIsReported) {
  Judge(0, Verdict::kAtBound, "the cost still falls beyond 100");
  EXPECT_THAT(Findings(), ElementsAre("a = 12.3 N/m: AT BOUND: the cost still falls beyond 100."));
}

TEST_F(FindingsTest, ParametersOfOneReasonAndRemedyShareASentence) {
  Judge(0, Verdict::kNotIdentifiable, "no fitted channel responds", "measuring y would determine it");
  Judge(1, Verdict::kIdentifiable);
  Judge(2, Verdict::kNotIdentifiable, "no fitted channel responds", "measuring y would determine it");
  Judge(3, Verdict::kNotIdentifiable, "the excitation is too small");
  Judge(4, Verdict::kNotIdentifiable, "no fitted channel responds", "measuring y would determine it");
  EXPECT_THAT(Findings(),
              ElementsAre("b = 12.3 (95 % interval 12.0 to 12.7): identifiable.",
                          "a, c and e: NOT identifiable: no fitted channel responds. Measuring y would "
                          "determine it.",
                          "d: NOT identifiable: the excitation is too small."));
}

TEST_F(FindingsTest, NoRemedyIsLost) {
  Judge(0, Verdict::kNotIdentifiable, "no fitted channel responds", "measuring y would determine it");
  Judge(1, Verdict::kNotIdentifiable, "no fitted channel responds", "measuring z would determine it");
  EXPECT_THAT(Findings(),
              ElementsAre("a and b: NOT identifiable: no fitted channel responds. For a: measuring y would "
                          "determine it. For b: measuring z would determine it."));
}

// Standard errors differ from parameter to parameter; the sentence that they share leaves them to the table.
TEST_F(FindingsTest, RemediesThatDifferInFiguresOnlyAreOne) {
  Judge(0, Verdict::kNotIdentifiable, "no fitted channel responds",
        "measuring y would fix it (standard error 0.1); so would measuring z (0.2)");
  Judge(1, Verdict::kNotIdentifiable, "no fitted channel responds",
        "measuring y would fix it (standard error 0.3); so would measuring z (0.4)");
  EXPECT_THAT(
      Findings(),
      ElementsAre("a and b: NOT identifiable: no fitted channel responds. Measuring y would fix it; so "
                  "would measuring z."));
}

TEST_F(FindingsTest, UndeterminedDirectionsAreReported) {
  identification_.uncertainty.directions = {"a and b can grow together"};
  EXPECT_THAT(Findings(), ElementsAre("Not determined: a and b can grow together."));
}

TEST_F(FindingsTest, PredictionsOfTrainingAndValidationAreOneSentencePerQuantity) {
  identification_.prediction.pooled = {{"", BlockRole::kTrain, "vertical force", "N", 0.9123, 0.9991, 100},
                                       {"", BlockRole::kTrain, "angle", "rad", 0.01, 0.5, 100},
                                       {"", BlockRole::kValidate, "vertical force", "N", 1.234, 0.998, 50},
                                       {"", BlockRole::kPredicted, "free moment", "N*m", 3, 0, 50}};
  EXPECT_THAT(Findings(),
              ElementsAre("Vertical force: train 0.91 N RMSE (R2 0.999), validate 1.2 N (R2 0.998).",
                          "Angle: train 0.010 rad RMSE (R2 0.500)."));
}

}  // namespace
}  // namespace sinew
