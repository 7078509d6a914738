#include "identify/files/diagnosis_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/text/diagnosis_sentences.h"
#include "tests/identify/support/error_of.h"
#include "tests/identify/support/made_up_diagnosis.h"
#include "tests/identify/support/temporary_file.h"

namespace sinew {
namespace {

using testing::ElementsAre;

const Provenance kProvenance{"joint", "data.h5", "0123456789abcdef", "a joint", "joint: {}\n", true};

class DiagnosisFileTest : public testing::Test {
 protected:
  [[nodiscard]] Hdf5Node Tree() const {
    return DiagnosisTree(problem_, diagnosis_, kProvenance, options_).value();
  }
  /// As it comes back from the disk.
  [[nodiscard]] Hdf5Node Reread() const {
    EXPECT_EQ(ErrorOf(WriteHdf5(file_.path(), Tree())), "");
    return ReadHdf5(file_.path()).value();
  }
  static std::vector<double> Numbers(const Hdf5Node& tree, const char* path) {
    const Hdf5Node* node = tree.Find(path);
    return node == nullptr || node->array() == nullptr ? std::vector<double>{NAN} : node->array()->values;
  }
  static std::vector<std::string> Texts(const Hdf5Node& tree, const char* path) {
    const Hdf5Node* node = tree.Find(path);
    return node == nullptr || node->texts() == nullptr ? std::vector<std::string>{"absent"} : *node->texts();
  }

  const TemporaryFile file_;
  const toy::ToyProblem problem_ = toy::JointProblem();
  Diagnosis diagnosis_ = toy::JointDiagnosis(problem_);
  DiagnosisOptions options_;
};

// `simulate --from` and `diagnose --from` read it like any run file and find the extended model.
TEST_F(DiagnosisFileTest, IsARunFileOfTheExtendedModel) {
  ASSERT_EQ(ErrorOf(WriteHdf5(file_.path(), Tree())), "");
  const auto run = ReadRun(file_.path());
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->problem, "joint");
  EXPECT_EQ(run->data_hash, "0123456789abcdef");
  EXPECT_TRUE(run->finished);
  EXPECT_THAT(run->variables, ElementsAre("rate", "friction_level"));
  EXPECT_THAT(run->values,
              ElementsAre(std::pair("rate", 1.2), std::pair("friction_level", 0.7), std::pair("y.delay", 0)));
}

TEST_F(DiagnosisFileTest, PredictionsAreThoseOfTheExtendedModel) {
  const Hdf5Node tree = Reread();
  EXPECT_THAT(Numbers(tree, "parameters/free"), ElementsAre(1, 1, 0));
  EXPECT_THAT(Numbers(tree, "parameters/before"), ElementsAre(1.5, 0, 0));
  const std::vector<double> simulated = Numbers(tree, "prediction/check/y/simulated");
  ASSERT_EQ(simulated.size(), 4U);
  EXPECT_EQ(simulated[0], 0.7);
  EXPECT_EQ(simulated[3], 1.2 + 0.7);
  EXPECT_EQ(tree.Find("prediction/check/y")->Text("role"), "validate");
}

TEST_F(DiagnosisFileTest, EveryFindingIsInItsTable) {
  diagnosis_.ladder = {{{}, 1}, {{"friction"}, 0.3}, {{"friction", "y.delay"}, 0.29}};
  diagnosis_.chosen_shares = {{"friction", 0.98}, {"y.delay", 0.04}};
  const Hdf5Node tree = Reread();
  const Hdf5Node* diagnosis = tree.Find("diagnosis");
  ASSERT_NE(diagnosis, nullptr);
  EXPECT_EQ(diagnosis->Text("sinew_schema"), "diagnosis/1");
  EXPECT_EQ(diagnosis->Text("verdict"), "ambiguous");
  EXPECT_EQ(diagnosis->Number("threshold", 0), 2.9);
  EXPECT_EQ(Texts(tree, "diagnosis/sentences"), text::TextsOf(text::Sentences(diagnosis_)));
  EXPECT_THAT(Texts(tree, "diagnosis/sentence_kinds"),
              ElementsAre("withdrawn", "verdict", "level", "cause", "alternative", "unknown_term",
                          "parameter_change", "gain"));
  EXPECT_EQ(Texts(tree, "run/finding_kinds"), Texts(tree, "diagnosis/sentence_kinds"));
  EXPECT_THAT(Texts(tree, "diagnosis/warning_kinds"), ElementsAre("other"));
  EXPECT_THAT(Texts(tree, "diagnosis/scores/finding"),
              ElementsAre("cause", "alternative", "withdrawn", "unknown_term", "ruled_out", "not_judged"));
  EXPECT_THAT(Numbers(tree, "diagnosis/scores/judged"), ElementsAre(1, 1, 1, 1, 1, 0));
  EXPECT_TRUE(std::isnan(Numbers(tree, "diagnosis/scores/delta_lr")[1])) << "it was not refitted";
  EXPECT_THAT(Texts(tree, "diagnosis/levels/standing"), ElementsAre("blamed", "possible"));
  EXPECT_THAT(Texts(tree, "diagnosis/levels/effects"), ElementsAre("friction", "y.delay"));
  EXPECT_THAT(Numbers(tree, "diagnosis/levels/behind"), ElementsAre(0, 3.1));
  EXPECT_THAT(Texts(tree, "diagnosis/causes/effect"), ElementsAre("friction"));
  EXPECT_THAT(Texts(tree, "diagnosis/cause_parameters/name"), ElementsAre("friction_level"));
  EXPECT_THAT(Texts(tree, "diagnosis/alternatives/separated_by"), ElementsAre("a trial at two speeds"));
  EXPECT_THAT(Numbers(tree, "diagnosis/alternative_parameters/value"), ElementsAre(0.01));
  EXPECT_THAT(Texts(tree, "diagnosis/withdrawn/effect"), ElementsAre("y.gain"));
  EXPECT_THAT(Texts(tree, "diagnosis/ladder/effects"), ElementsAre("", "friction", "friction,y.delay"));
  EXPECT_THAT(Numbers(tree, "diagnosis/ladder/error"), ElementsAre(1, 0.3, 0.29));
  EXPECT_THAT(Texts(tree, "diagnosis/chosen_shares/effect"), ElementsAre("friction", "y.delay"));
  EXPECT_THAT(Numbers(tree, "diagnosis/chosen_shares/share"), ElementsAre(0.98, 0.04));
  EXPECT_THAT(Numbers(tree, "diagnosis/gain/after"), ElementsAre(0.15));
  EXPECT_THAT(Numbers(tree, "diagnosis/extended_parameters/before"), ElementsAre(1.5, 0));
  EXPECT_THAT(Texts(tree, "diagnosis/noise/basis_kind"), ElementsAre("stated_by_data"));
  EXPECT_THAT(Texts(tree, "diagnosis/scores/why_not_kind"),
              ElementsAre("", "", "", "", "", "no_distinct_change"));
  EXPECT_EQ(tree.Find("diagnosis/structure/1")->Text("shape_kind"), "step");
  EXPECT_EQ(tree.Find("diagnosis/unknown_terms/1")->Text("shape_kind"), "step");
  EXPECT_THAT(Numbers(tree, "diagnosis/structure/1/curve"), ElementsAre(-0.2, 0, 0.2));
  EXPECT_THAT(Numbers(tree, "diagnosis/unknown_terms/1/deviation"), ElementsAre(0.01, 0.02));
  EXPECT_THAT(Numbers(tree, "diagnosis/traces/check/y/before"), ElementsAre(0, 1.5));
}

// Empty lists must be written and read like full ones.
TEST_F(DiagnosisFileTest, AnAdequateDiagnosisCanBeWritten) {
  Diagnosis nothing;
  nothing.setup = diagnosis_.setup;
  nothing.base.stop = diagnosis_.base.stop;
  nothing.base_point = nothing.extended_point = toy::Values({1.5, 0, 0});
  diagnosis_ = nothing;
  const Hdf5Node tree = Reread();
  EXPECT_THAT(Texts(tree, "diagnosis/causes/effect"), ElementsAre());
  EXPECT_THAT(Numbers(tree, "diagnosis/scores/statistic"), ElementsAre());
  EXPECT_THAT(Numbers(tree, "parameters/value"), ElementsAre(1.5, 0, 0));
}

TEST_F(DiagnosisFileTest, WithoutABaseFitThereAreNoParameters) {
  diagnosis_ = {};
  diagnosis_.base.stop = {Termination::kNoPrediction, "no force at t = 0"};
  diagnosis_.inconclusive = Inconclusive::kBaseFitNotConverged;
  const Hdf5Node tree = Reread();
  EXPECT_EQ(tree.Find("run")->Number("usable", -1), 0);
  EXPECT_EQ(tree.Find("diagnosis")->Text("inconclusive_kind"), "base_fit_not_converged");
  EXPECT_THAT(Texts(tree, "diagnosis/sentence_kinds"), ElementsAre("inconclusive", "advice"));
  EXPECT_EQ(tree.Find("parameters"), nullptr);
  EXPECT_TRUE(ReadRun(file_.path())) << "it is still a run file";
}

TEST_F(DiagnosisFileTest, AnInterruptedDiagnosisIsMarked) {
  std::atomic<bool> interrupt{true};
  options_.interrupt = &interrupt;
  EXPECT_EQ(Tree().Find("run")->Number("finished", -1), 0);
}

}  // namespace
}  // namespace sinew
