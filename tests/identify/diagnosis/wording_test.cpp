#include "identify/diagnosis/wording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/identify/support/made_up_diagnosis.h"

namespace sinew {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using toy::Diagnosed;

std::vector<std::string> Sentences(const std::function<void(Diagnosis&)>& change) {
  const toy::ToyProblem problem = toy::JointProblem();
  Diagnosis d = toy::JointDiagnosis(problem);
  change(d);
  return DescribeDiagnosis(d, true);
}

TEST(Wording, ReportsTheBiasOfABaseParameter) {
  const auto moved = [](double before, double now, const std::string& bound) {
    return Sentences([&](Diagnosis& d) {
      d.base_parameters = {Diagnosed("rate", before, 0.1, before)};
      d.base_parameters[0].at_bound = bound;
      d.extended_parameters[0] = Diagnosed("rate", now, 0.02, before);
    });
  };
  EXPECT_THAT(moved(1.5, 1.2, ""),
              Contains("With it, rate moves from 1.50 to 1.20 N: what was missing had biased it "
                       "by 25 %."));
  EXPECT_THAT(moved(1.2005, 1.2, ""), Not(Contains(HasSubstr("rate moves")))) << "within chance";
  EXPECT_THAT(moved(0, 1.2, ""), Contains(HasSubstr("had biased it by -1.20 N."))) << "no share of nothing";
  EXPECT_THAT(moved(-1, 1.2, ""), Contains(HasSubstr("had biased it by -2.20 N."))) << "another sign";
  EXPECT_THAT(moved(5, 1.2, "upper"), Contains(HasSubstr("had driven it to its upper bound.")));
}

TEST(Wording, AValueAtItsBoundIsMarked) {
  EXPECT_EQ(DescribeParameters({Diagnosed("delay", 0.5, 0.1, 0)}), "delay = 0.500 N +-0.20");
  DiagnosedParameter held = Diagnosed("delay", 0.5, NAN, 0);
  held.at_bound = "upper";
  EXPECT_EQ(DescribeParameters({held}), "delay = 0.500 N (its upper bound)");
}

TEST(Wording, HeldOutTrialsThatGetWorseAreNamed) {
  const auto with = [](double first, double second) {
    return Sentences([&](Diagnosis& d) {
      d.traces = {{"slow", BlockRole::kTrain, "y", "N", {0, 1}, {0, 0}, {1, 1}, {9, 9}},
                  {"check", BlockRole::kValidate, "y", "N", {0, 1}, {0, 0}, {1, 1}, {first, first}},
                  {"fast", BlockRole::kValidate, "y", "N", {0, 1}, {0, 0}, {1, 1}, {second, second}}};
    });
  };
  EXPECT_THAT(with(0.5, 1.01), Not(Contains(HasSubstr("WORSE")))) << "one percent is nothing";
  const auto worse = with(0.5, 2);
  EXPECT_THAT(
      worse,
      Contains("Held-out trial 'fast' is predicted WORSE by the extended model: y 1.00 -> 2.00 N RMSE."));
  EXPECT_THAT(worse, Not(Contains(HasSubstr("'check' is predicted"))));
  EXPECT_THAT(worse, Not(Contains(HasSubstr("'slow' is predicted")))) << "it was fitted";
}

}  // namespace
}  // namespace sinew
