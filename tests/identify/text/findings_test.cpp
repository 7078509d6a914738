// Which sentences there are, and about what; how they read stands in golden/.
#include "identify/text/findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identify/text/reasons.h"
#include "tests/identify/text/made_up_verdicts.h"

namespace sinew::text {
namespace {

using testing::ElementsAre;
using toy::Judged;
using toy::Option;
using toy::ReasonOf;

class FindingsTest : public testing::Test {
 protected:
  void Judge(int parameter, Verdict verdict, Reason reason = {}, Remedy remedy = {}) {
    identification_.uncertainty.parameters.push_back(
        Judged(parameter, verdict, std::move(reason), std::move(remedy)));
  }
  [[nodiscard]] std::vector<Sentence> Found() const { return Findings(identification_); }
  /// "identifiable a", "not_identifiable b c".
  [[nodiscard]] std::vector<std::string> Facts() const {
    std::vector<std::string> facts;
    for (const Sentence& sentence : Found()) {
      facts.emplace_back(ToString(sentence.kind));
      for (const std::string& name : sentence.about) facts.back() += " " + name;
    }
    return facts;
  }

  const Reason no_response_ = ReasonOf(ReasonKind::kNoResponse);
  Identification identification_ = toy::FiveParameters();
};

TEST_F(FindingsTest, EveryVerdictHasItsKind) {
  Judge(0, Verdict::kIdentifiable);
  Judge(1, Verdict::kWeak, ReasonOf(ReasonKind::kWeakExcitation));
  Judge(2, Verdict::kAtBound, ReasonOf(ReasonKind::kAtBound));
  Judge(3, Verdict::kNotIdentifiable, no_response_);
  EXPECT_THAT(Facts(), ElementsAre("identifiable a", "weak b", "at_bound c", "not_identifiable d"));
}

TEST_F(FindingsTest, ManyParametersBeginWithASummaryAndThePrediction) {
  identification_.pooled_fit = {{}};
  identification_.pooled_fit[0].channel = "force";
  for (int i = 0; i < 11; ++i)
    Judge(i % 5,
          i < 3   ? Verdict::kIdentifiable
          : i < 8 ? Verdict::kWeak
                  : Verdict::kAtBound,
          ReasonOf(i < 8 ? ReasonKind::kWeakExcitation : ReasonKind::kAtBound));
  const std::vector<Sentence> found = Found();
  ASSERT_EQ(found.size(), 13U);
  EXPECT_EQ(found[0].kind, SentenceKind::kSummary);
  EXPECT_EQ(found[0].text, "3 of 11 parameters are identifiable, 5 weak, 0 not identifiable, 3 at a bound.");
  EXPECT_EQ(found[1].kind, SentenceKind::kPrediction);
  EXPECT_EQ(found.back().kind, SentenceKind::kAtBound);
}

TEST_F(FindingsTest, OfManyDirectionsFiveAreTold) {
  Judge(0, Verdict::kIdentifiable);
  const OpenDirection direction = {true, {{"a", "N/m", 1.0, 0.1}, {"b", "", -2.0, -0.2}}};
  identification_.uncertainty.directions.assign(6, direction);
  EXPECT_EQ(Found().size(), 7U);
  identification_.uncertainty.directions.assign(9, direction);
  const std::vector<Sentence> found = Found();
  ASSERT_EQ(found.size(), 7U);
  EXPECT_EQ(found.back().text, "4 further directions are not determined; the run file lists them.");
  EXPECT_THAT(found.back().about, ElementsAre());
}

TEST_F(FindingsTest, GroupsAndDerivedQuantitiesAreSaid) {
  for (const int shared : {0, 2})
    identification_.setup.parameters[static_cast<std::size_t>(shared)].shared_by = {"soleus",
                                                                                    "gastrocnemius"};
  Judge(0, Verdict::kIdentifiable);
  Judge(1, Verdict::kIdentifiable);
  Judge(2, Verdict::kIdentifiable);
  identification_.derived = {{"soleus.C1", "1", "", {"a", "b"}, -0.5123, true, -0.52, -0.5},
                             {"soleus.C2", "1", "", {"b"}, -0.6, false, 0, 0}};
  EXPECT_THAT(Facts(), ElementsAre("identifiable a", "identifiable b", "identifiable c",
                                   "shared_parameter a c", "derived soleus.C1", "derived soleus.C2"));
  EXPECT_THAT(
      TextsOf(Found()),
      testing::IsSupersetOf({"a and c: shared by soleus and gastrocnemius.",
                             "soleus.C1 = -0.512 (95 % interval -0.520 to -0.500): derived from a and b.",
                             "soleus.C2 = -0.600 (no interval): derived from b."}));
}

// An unconverged search: the interval belongs to the minimum near by, and the value does not.
TEST_F(FindingsTest, AValueOutsideItsIntervalIsNotCalledIdentifiable) {
  Judge(0, Verdict::kIdentifiable);
  identification_.uncertainty.parameters[0].value = 20;
  EXPECT_THAT(Facts(), ElementsAre("off_minimum a"));
}

TEST_F(FindingsTest, ParametersOfOneReasonShareASentence) {
  Judge(0, Verdict::kNotIdentifiable, no_response_);
  Judge(1, Verdict::kIdentifiable);
  Judge(2, Verdict::kNotIdentifiable, no_response_);
  Judge(3, Verdict::kNotIdentifiable, ReasonOf(ReasonKind::kWeakExcitation));
  Judge(4, Verdict::kNotIdentifiable, no_response_);
  EXPECT_THAT(Facts(), ElementsAre("identifiable b", "not_identifiable a c e", "not_identifiable d"));
}

// Standard errors differ from parameter to parameter; the sentence that they share leaves them to the table.
TEST_F(FindingsTest, RemediesThatDifferInFiguresOnlyAreToldOnce) {
  const auto measuring = [](const char* channel, double error) {
    return Remedy{RemedyKind::kAdditions, {Option(AdditionKind::kChannel, channel, error)}};
  };
  Judge(1, Verdict::kNotIdentifiable, no_response_, measuring("y", 0.1));
  Judge(2, Verdict::kNotIdentifiable, no_response_, measuring("y", 0.3));
  const std::string once = Found()[0].text;
  identification_.uncertainty.parameters[1].remedy = measuring("z", 0.3);
  const std::string both = Found()[0].text;
  EXPECT_LT(once.size(), both.size()) << both;
  identification_.uncertainty.parameters[1].remedy = measuring("y", 0.4);
  EXPECT_EQ(Found()[0].text, once);
}

TEST_F(FindingsTest, OpenDirectionsNameTheirParameters) {
  identification_.uncertainty.directions = {{true, {{"a", "N/m", 1, 0.1}, {"b", "1", -2, -0.2}}}};
  EXPECT_THAT(Facts(), ElementsAre("open_direction a b"));
}

TEST_F(FindingsTest, TrainingAndValidationAreOneSentencePerQuantity) {
  identification_.pooled_fit = {{"", BlockRole::kTrain, "force", "N", 0.9, 0.9991, 100},
                                {"", BlockRole::kTrain, "angle", "rad", 0.01, 0.5, 100},
                                {"", BlockRole::kValidate, "force", "N", 1.2, 0.998, 50},
                                {"", BlockRole::kPredicted, "moment", "N*m", 3, 0, 50}};
  EXPECT_THAT(Facts(), ElementsAre("prediction force", "prediction angle"));
}

TEST_F(FindingsTest, DigitsTellTheEndsOfANarrowIntervalApart) {
  Judge(0, Verdict::kIdentifiable);
  ParameterVerdict& verdict = identification_.uncertainty.parameters[0];
  verdict.value = 1.00012;
  verdict.ci95_lower = 1.00010;
  verdict.ci95_upper = 1.00014;
  EXPECT_THAT(Found()[0].text, testing::HasSubstr("1.00010 to 1.00014"));
}

TEST_F(FindingsTest, SeveralHeldOutTrialsAreListed) {
  identification_.pooled_fit = {{"", BlockRole::kTrain, "force", "N", 0.9, 0.9991, 100},
                                {"", BlockRole::kValidate, "force", "N", 1.2, 0.998, 50}};
  identification_.prediction.quality = {{"slow", BlockRole::kValidate, "force", "N", 1.1, 0.998, 25}};
  EXPECT_THAT(Found()[0].text, testing::Not(testing::HasSubstr("slow")));
  identification_.prediction.quality.push_back({"fast", BlockRole::kValidate, "force", "N", 1.3, 0.998, 25});
  EXPECT_THAT(Found()[0].text, testing::HasSubstr("slow 1.1, fast 1.3"));
}

TEST_F(FindingsTest, EarlierStepsComeFirst) {
  Judge(1, Verdict::kIdentifiable);
  FinishedStep step;
  step.name = "step 1 (a)";
  step.setup = identification_.setup;
  step.uncertainty.parameters = {Judged(0, Verdict::kIdentifiable, {})};
  identification_.steps = {step};
  EXPECT_THAT(Facts(), ElementsAre("identifiable a", "identifiable b"));
  EXPECT_EQ(Found()[0].step, "step 1 (a)");
  EXPECT_EQ(Found()[1].step, "") << "the last one";
}

}  // namespace
}  // namespace sinew::text
