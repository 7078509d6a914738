#include "identify/files/run_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>

#include "tests/identify/support/error_of.h"
#include "tests/identify/support/line_fit.h"
#include "tests/identify/support/temporary_file.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Provenance kRunProvenance{"line", "data.h5", "0123456789abcdef", "a line", "line: {}\n", true};

class RunFileTest : public testing::Test {
 protected:
  RunFileTest()
      : line_(toy::IdentifyLine(problem_)), tree_(RunTree(problem_, line_, kRunProvenance).value()) {}

  Result<RecordedRun> Reread(const Hdf5Node& tree) const {
    EXPECT_EQ(ErrorOf(WriteHdf5(file_.path(), tree)), "");
    return ReadRun(file_.path());
  }
  /// The error of ReadRun for the damaged tree.
  [[nodiscard]] std::string ErrorAfter(const std::function<void(Hdf5Node&)>& damage) const {
    Hdf5Node tree = tree_;
    damage(tree);
    return ErrorOf(Reread(tree));
  }

  const TemporaryFile file_;
  const toy::ToyProblem problem_ = toy::LineProblem();
  const Identification line_;
  const Hdf5Node tree_;
};

TEST_F(RunFileTest, WhatIsWrittenIsRead) {
  const auto read = Reread(tree_);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->problem, "line");
  EXPECT_EQ(read->solver, "restarts");
  EXPECT_EQ(read->data_hash, "0123456789abcdef");
  EXPECT_EQ(read->seed, 1U);
  EXPECT_TRUE(read->finished);
  EXPECT_THAT(read->variables, ElementsAre("offset", "slope"));
  ASSERT_EQ(read->values.size(), 2U);
  EXPECT_EQ(read->values[1].first, "slope");
  EXPECT_EQ(read->values[1].second, line_.parameters[1]);
  ASSERT_EQ(read->record.trace().size(), line_.record.trace().size());
  for (std::size_t i = 0; i < line_.record.trace().size(); ++i) {
    EXPECT_EQ(read->record.trace()[i].x, line_.record.trace()[i].x);
    EXPECT_EQ(read->record.trace()[i].cost, line_.record.trace()[i].cost);
    EXPECT_EQ(read->record.trace()[i].seconds, line_.record.trace()[i].seconds);
  }
}

TEST_F(RunFileTest, EverySeedSurvives) {
  for (const std::uint64_t seed : {std::uint64_t{0}, (std::uint64_t{1} << 53) + 1, ~std::uint64_t{0}}) {
    Identification line = line_;
    line.solver_options.seed = seed;
    const auto read = Reread(RunTree(problem_, line, kRunProvenance).value());
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->seed, seed);
  }
}

TEST_F(RunFileTest, AFailedEvaluationSurvives) {
  Identification line = line_;
  line.record.Add({1.5, std::numeric_limits<double>::infinity(), toy::Values({0.25, 0.75})}, false);
  const auto read = Reread(RunTree(problem_, line, kRunProvenance).value());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(std::isinf(read->record.trace().back().cost));
}

// 300 evaluations, of which 16 points and those of improvements are kept.
SearchRecord ThinnedRecord() {
  SearchRecord record(16);
  for (int i = 0; i < 300; ++i) {
    const bool fails = i % 7 == 3;
    const double cost = fails ? std::numeric_limits<double>::infinity() : 1000.0 - i;
    record.Add({0.5 * i, cost, toy::Values({0.001 * i, 0.5}), fails ? fmt::format("no end at {}", i) : ""},
               !fails);
  }
  return record;
}

TEST_F(RunFileTest, OutcomesOfAllEvaluationsSurviveWhereNotAllPointsAreKept) {
  Identification line = line_;
  line.record = ThinnedRecord();
  ASSERT_TRUE(line.record.thinned());
  const auto read = Reread(RunTree(problem_, line, kRunProvenance).value());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->record.evaluations(), 300);
  ASSERT_EQ(read->record.trace().size(), line.record.trace().size());
  for (std::size_t i = 0; i < line.record.trace().size(); ++i) {
    EXPECT_EQ(read->record.trace()[i].evaluation, line.record.trace()[i].evaluation);
    EXPECT_EQ(read->record.trace()[i].level, line.record.trace()[i].level);
    EXPECT_EQ(read->record.trace()[i].failure, line.record.trace()[i].failure);
  }
  for (int i = 0; i < 300; ++i) {
    const EvaluationOutcome* found = read->record.Find(i, toy::Values({0.001 * i, 0.5}));
    ASSERT_NE(found, nullptr) << i;
    EXPECT_EQ(found->cost, line.record.outcomes()[static_cast<std::size_t>(i)].cost) << i;
  }
  EXPECT_EQ(read->record.reasons().MostFrequentFirst()[0].count, 43);
  EXPECT_EQ(read->record.FailureOf(10), "no end at 3") << "of those whose words are not kept, the first's";
}

TEST_F(RunFileTest, DamagedOutcomesAreAnError) {
  Identification line = line_;
  line.record = ThinnedRecord();
  const Hdf5Node tree = RunTree(problem_, line, kRunProvenance).value();
  const auto error_after = [&](const std::function<void(Hdf5Node&)>& damage) {
    Hdf5Node damaged = tree;
    damage(damaged);
    return ErrorOf(Reread(damaged));
  };
  const std::string strangers = file_.path() + ": /resume/outcomes and /trace do not belong together";
  EXPECT_EQ(error_after([](Hdf5Node& t) { t.At("resume").children.erase("outcomes"); }), strangers);
  EXPECT_EQ(
      error_after([](Hdf5Node& t) { t.At("resume/outcomes").attributes["evaluations"] = std::int64_t{100}; }),
      strangers);
  EXPECT_EQ(error_after([](Hdf5Node& t) {
              std::get<Hdf5Array>(t.At("resume/outcomes/cost").data).values[17] = 1e-9;
            }),
            strangers)
      << "a cost below that of the best point, which is looked at";
  EXPECT_EQ(error_after(
                [](Hdf5Node& t) { std::get<Hdf5Array>(t.At("resume/outcomes/reason").data).values[2] = 9; }),
            strangers);
  EXPECT_EQ(error_after([](Hdf5Node& t) { t.At("resume/outcomes").children.erase("mark"); }),
            file_.path() + ": /resume/outcomes is not complete");
  EXPECT_THAT(
      error_after([](Hdf5Node& t) { std::get<Hdf5Array>(t.At("trace/evaluation").data).values[2] = 0; }),
      testing::HasSubstr("/trace: evaluation and level 2 are no numbers"));
  EXPECT_THAT(error_after([](Hdf5Node& t) { t.At("trace").children.erase("level"); }),
              testing::HasSubstr("expected evaluation [E] and level [E]"));
}

// Of a version that had all evaluations in its trace, and did not number them.
TEST_F(RunFileTest, ATraceWithoutNumbersHasAllEvaluations) {
  Hdf5Node tree = tree_;
  tree.At("trace").children.erase("evaluation");
  tree.At("trace").children.erase("level");
  const auto read = Reread(tree);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->record.evaluations(), line_.record.evaluations());
  EXPECT_EQ(read->record.recorded(), line_.record.evaluations());
}

TEST_F(RunFileTest, PredictionsHoldMeasuredAndSimulatedSamples) {
  const Hdf5Node* y = tree_.Find("prediction/train/y");
  ASSERT_NE(y, nullptr);
  EXPECT_EQ(y->Text("role"), "train");
  EXPECT_EQ(y->Number("n", -1), 30);
  EXPECT_EQ(y->Number("rmse", -1), line_.prediction.quality[0].rmse);
  EXPECT_EQ(y->Find("measured")->array()->values, problem_.layout()[0].measured);
  EXPECT_EQ(y->Find("simulated")->array()->values[3], line_.prediction.values[0][3]);
  const Hdf5Node* residual = tree_.Find("residual/check/y/residual");
  ASSERT_NE(residual, nullptr);
  EXPECT_EQ(residual->array()->values[2], line_.prediction.values[2][2] - problem_.layout()[2].measured[2]);

  const Hdf5Node* z = tree_.Find("prediction/train/z");
  ASSERT_NE(z, nullptr);
  EXPECT_TRUE(std::isnan(z->Find("measured")->array()->values[0]));
  EXPECT_EQ(tree_.Find("residual/train/z"), nullptr);
}

TEST_F(RunFileTest, ParametersAndUncertaintyHaveTheirNames) {
  EXPECT_THAT(*tree_.Find("parameters/name")->texts(), ElementsAre("offset", "slope"));
  EXPECT_THAT(tree_.Find("parameters/free")->array()->values, ElementsAre(1, 1));
  EXPECT_THAT(*tree_.Find("uncertainty/verdict")->texts(), ElementsAre("identifiable", "identifiable"));
  EXPECT_THAT(*tree_.Find("uncertainty/reason_kind")->texts(), ElementsAre("determined", "determined"));
  EXPECT_THAT(*tree_.Find("uncertainty/remedy_kind")->texts(), ElementsAre("none", "none"));
  EXPECT_THAT(*tree_.Find("run/finding_kinds")->texts(),
              ElementsAre("identifiable", "identifiable", "prediction"));
  EXPECT_THAT(tree_.Find("uncertainty/covariance")->array()->shape, ElementsAre(2, 2));
  EXPECT_EQ(tree_.Find("uncertainty/std_error")->array()->values[1],
            line_.uncertainty.parameters[1].std_error);
  EXPECT_EQ(tree_.Find("run")->Number("finished", -1), 1);
  EXPECT_EQ(*tree_.Find("run/config")->text(), kRunProvenance.config);
}

TEST_F(RunFileTest, ARunningSearchIsUnfinishedAndHasItsTrace) {
  const FitSetup setup = MakeFitSetup(problem_, {}).value();
  const LeastSquares least_squares(problem_, setup);
  Evaluator evaluator(least_squares, {});
  const auto at_once = Reread(UnfinishedRunTree(least_squares, "lm", 1, kRunProvenance, evaluator));
  ASSERT_TRUE(at_once) << at_once.error().message;
  EXPECT_TRUE(at_once->record.trace().empty());
  EXPECT_EQ(at_once->values[1].second, 0) << "nothing was evaluated: the start";

  double cost = 0;
  evaluator.Cost(least_squares.Variables(toy::Values({1, 3})), cost);
  evaluator.Cost(least_squares.Variables(toy::Values({2, 3})), cost);
  const auto read = Reread(UnfinishedRunTree(least_squares, "lm", 1, kRunProvenance, evaluator));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read->finished);
  ASSERT_EQ(read->record.trace().size(), 2U);
  EXPECT_EQ(read->record.trace()[1].x, evaluator.trace()[1].x);
  EXPECT_EQ(read->values[0].second, least_squares.Parameters(evaluator.best().x)[0]);
}

TEST_F(RunFileTest, AnUnfinishedRunKeepsItsFitsAndResiduals) {
  FitRecord record;
  record.Keep(Digest().Add(1.0), {{1.5, std::nan("")}, "why"});
  record.Keep(Digest().Add(2.0), {{}, ""});
  FitSetup setup = MakeFitSetup(problem_, {}).value();
  setup.record = &record;
  const LeastSquares least_squares(problem_, setup);
  Evaluator::Options options;
  options.most_kept = 1000;
  Evaluator evaluator(least_squares, options);
  double cost = 0;
  Vector residuals;
  evaluator.Cost(least_squares.Variables(toy::Values({1, 3})), cost);
  evaluator.Residuals(least_squares.Variables(toy::Values({2, 3})), residuals, nullptr);
  Hdf5Node tree = UnfinishedRunTree(least_squares, "lm", 1, kRunProvenance, evaluator);
  const auto read = Reread(tree);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->fits.size(), 2U);
  const auto& answer = read->fits.at(Digest().Add(1.0).value());
  EXPECT_EQ(answer.text, "why");
  ASSERT_EQ(answer.numbers.size(), 2U);
  EXPECT_EQ(answer.numbers[0], 1.5);
  ASSERT_EQ(read->kept_residuals.size(), 1U);
  EXPECT_EQ(read->kept_residuals[0].evaluation, 1);
  EXPECT_EQ(read->kept_residuals[0].numbers,
            std::vector<double>(residuals.data(), residuals.data() + residuals.size()));

  tree.At("resume/fits/question").data = std::vector<std::string>{"nothing", "of the kind"};
  EXPECT_THAT(Reread(tree).error().message, testing::HasSubstr("/resume/fits/question 'nothing' is none"));
  tree.At("resume").children.erase("fits");
  tree.At("resume/residuals/evaluation").SetVector({2});
  EXPECT_THAT(Reread(tree).error().message, testing::HasSubstr("do not belong together"));
}

TEST_F(RunFileTest, ARunWithoutAnAnswerHasItsReason) {
  const toy::ToyProblem hopeless(
      {toy::MakeParameter("a", 0, 1, 0.5)}, {toy::MakeBlock("t", "y", 3, 1)},
      [](const Block&, double, const Vector&, Vector*) -> Result<double> { return Fail("no way"); });
  const Identification none = toy::IdentifyLine(hopeless);
  const Hdf5Node tree = RunTree(hopeless, none, kRunProvenance).value();
  EXPECT_EQ(tree.Find("run")->Number("usable", -1), 0);
  EXPECT_EQ(tree.Find("run")->Text("stop_reason"), "no_prediction");
  EXPECT_EQ(tree.Find("parameters"), nullptr);
  const auto read = Reread(tree);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->record.trace().size(), none.record.trace().size());
}

TEST_F(RunFileTest, ParametersThatOtherDataMayLackAreMarked) {
  std::vector<Parameter> parameters;
  for (const char* name : {"slope", "control", "scatter", "initial"}) {
    parameters.push_back(toy::MakeParameter(name, -1, 1, 0));
    if (parameters.size() > 1) parameters.back().kind = ParameterKind::kNuisance;
  }
  parameters[0].prior = parameters[2].prior = GaussianPrior{0.25, 0.5};
  parameters[3].trial = "train";
  const toy::ToyProblem problem(
      parameters, {toy::MakeBlock("train", "y", 8, 1)},
      [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
        if (gradient != nullptr) gradient->setConstant(t);
        return p.sum() * t;
      });
  const auto fit = Identify(problem, MakeFitSetup(problem, {}).value(), {}).value();
  const Hdf5Node tree = RunTree(problem, fit, kRunProvenance).value();
  EXPECT_EQ(tree.Find("parameters/prior_mean")->array()->values[2], 0.25);
  EXPECT_EQ(tree.Find("parameters/prior_deviation")->array()->values[2], 0.5);
  EXPECT_TRUE(std::isnan(tree.Find("parameters/prior_deviation")->array()->values[1]));
  const auto read = Reread(tree);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_THAT(read->incidental, ElementsAre("initial", "scatter"));
}

TEST_F(RunFileTest, NothingFreeCanBeWrittenAndRead) {
  FitRequest request;
  request.fix = {{"offset", 1}, {"slope", 3}};
  const auto fixed = Identify(problem_, MakeFitSetup(problem_, request).value(), {}).value();
  const auto read = Reread(RunTree(problem_, fixed, kRunProvenance).value());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->variables.empty());
  ASSERT_EQ(read->record.trace().size(), 1U);
  EXPECT_EQ(read->record.trace()[0].x.size(), 0);
}

TEST_F(RunFileTest, AFileThatIsNoRunIsAnError) {
  EXPECT_THAT(ErrorOf(ReadRun(file_.path())), HasSubstr(file_.path()));
  const std::string message =
      file_.path() + ": is not a run file: expected /run with attribute sinew_schema = run/1";
  EXPECT_EQ(ErrorAfter([](Hdf5Node& tree) { tree.children.erase("run"); }), message);
  EXPECT_EQ(
      ErrorAfter([](Hdf5Node& tree) { tree.At("run").attributes["sinew_schema"] = std::string("run/9"); }),
      message);
}

TEST_F(RunFileTest, DamagedParametersAreAnError) {
  const std::string message =
      file_.path() + ": /parameters/name and /parameters/value do not belong together";
  EXPECT_EQ(ErrorAfter([](Hdf5Node& tree) { tree.At("parameters/value").SetVector({1}); }), message);
  EXPECT_EQ(ErrorAfter([](Hdf5Node& tree) { tree.At("parameters/name").SetVector({1, 2}); }), message);
  EXPECT_EQ(ErrorAfter([](Hdf5Node& tree) { tree.At("parameters/value").data = std::string("1 2"); }),
            message);
}

TEST_F(RunFileTest, ADamagedTraceIsAnError) {
  const std::string message =
      file_.path() + ": /trace is not complete: expected seconds [E], cost [E] and x [E, n]";
  for (const std::string part : {"seconds", "cost", "x"}) {
    EXPECT_EQ(ErrorAfter([&](Hdf5Node& tree) { tree.At("trace").children.erase(part); }), message) << part;
    EXPECT_EQ(ErrorAfter([&](Hdf5Node& tree) { tree.At("trace/" + part).SetVector({1}); }), message) << part;
    EXPECT_EQ(ErrorAfter([&](Hdf5Node& tree) { tree.At("trace/" + part).data = std::string("?"); }), message)
        << part;
  }
  EXPECT_EQ(ErrorAfter([](Hdf5Node& tree) { tree.children.erase("trace"); }), message);
  EXPECT_EQ(
      ErrorAfter([](Hdf5Node& tree) { tree.At("trace").attributes["variables"] = std::string("offset"); }),
      file_.path() + ": /trace/x has 2 columns but names 1 variables");
}

TEST_F(RunFileTest, ATruncatedFileIsAnErrorAndNeverACrash) {
  ASSERT_EQ(ErrorOf(WriteHdf5(file_.path(), tree_)), "");
  std::ifstream stream(file_.path(), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  for (std::size_t tenth = 0; tenth < 10; ++tenth) {
    std::ofstream(file_.path(), std::ios::binary) << bytes.substr(0, bytes.size() * tenth / 10);
    EXPECT_NE(ErrorOf(ReadRun(file_.path())), "") << tenth;
  }
}

}  // namespace
}  // namespace sinew
