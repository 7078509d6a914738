#include "identify/files/study_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "identify/files/origin.h"
#include "identify/files/study_resume.h"
#include "identify/solvers/study.h"
#include "tests/identify/support/error_of.h"
#include "tests/identify/support/line_fit.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Provenance kStudyProvenance{"line", "data.h5", "0123456789abcdef", "a line", "line: {}\n", true};

class SolverStudy : public testing::Test {
 protected:
  [[nodiscard]] Study Compared(const std::vector<std::string>& solvers, int repeats) const {
    StudyOptions options;
    options.solvers = solvers;
    options.repeats = repeats;
    return CompareSolvers(fit_, options).value();
  }

  const toy::ToyProblem problem_ = toy::LineProblem();
  const FitSetup setup_ = MakeFitSetup(problem_, {}).value();
  const LeastSquares fit_{problem_, setup_};
};

StudyRun MadeUp(const std::string& solver, std::vector<double> costs, double parameter) {
  StudyRun run;
  run.solver = solver;
  run.stop.kind = Termination::kCostChange;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (costs[i] < lowest)
      run.improvements.push_back({static_cast<long>(i + 1), costs[i], 0.5 * static_cast<double>(i + 1)});
    lowest = std::min(lowest, costs[i]);
  }
  run.cost = costs.back();
  run.evaluations = static_cast<long>(costs.size());
  run.seconds = 0.5 * static_cast<double>(costs.size());
  run.parameters = toy::Values({parameter});
  return run;
}

TEST_F(SolverStudy, EverySolverUsesTheSameStartsBeginningWithTheProblemsOwn) {
  const Study study = Compared({"ceres", "lm"}, 3);
  ASSERT_EQ(study.runs.size(), 6U);
  EXPECT_EQ(study.runs[0].start, fit_.Start());
  EXPECT_NE(study.runs[1].start, fit_.Start());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(study.runs[i].solver, "ceres");
    EXPECT_EQ(study.runs[i + 3].solver, "lm");
    EXPECT_EQ(study.runs[i].start, study.runs[i + 3].start);
    EXPECT_EQ(study.runs[i].seed, 1 + i);
  }
}

TEST_F(SolverStudy, TheTargetIsOnePercentAboveTheBestCost) {
  const Study study = Compared({"lm"}, 2);
  EXPECT_EQ(study.best, std::min(study.runs[0].cost, study.runs[1].cost));
  EXPECT_DOUBLE_EQ(study.target, 1.01 * study.best);
}

TEST_F(SolverStudy, AnInterruptedOneHoldsTheRunsSoFar) {
  std::atomic<bool> interrupt{false};
  StudyOptions options;
  options.solvers = {"lm", "ceres"};
  options.interrupt = &interrupt;
  options.progress = [&](int done, int all) {
    EXPECT_EQ(all, 10);
    if (done == 2) interrupt = true;
  };
  const auto study = CompareSolvers(fit_, options);
  ASSERT_TRUE(study);
  EXPECT_EQ(study->runs.size(), 2U);
}

TEST_F(SolverStudy, AWrongNameIsAnErrorBeforeAnyRun) {
  StudyOptions options;
  options.solvers = {"lm", "cerez"};
  options.progress = [](int, int) { FAIL() << "ran"; };
  EXPECT_THAT(ErrorOf(CompareSolvers(fit_, options)), HasSubstr("'cerez' does not exist"));
  options.solvers = {"lm", "ceres", "lm"};
  EXPECT_EQ(ErrorOf(CompareSolvers(fit_, options)), "solver 'lm' is named twice");
}

TEST(SolverSummaries, AreMediansOverTheRunsThatHaveTheNumber) {
  Study study;
  study.free = {0};
  study.target = 2;
  study.runs = {MadeUp("a", {9, 2, 1}, 1), MadeUp("a", {9, 8, 7, 6, 5}, 3), MadeUp("b", {3}, 5),
                MadeUp("a", {2}, 2)};
  const auto summaries = Summarise(study);
  ASSERT_EQ(summaries.size(), 2U);
  const SolverSummary& a = summaries[0];
  EXPECT_EQ(a.solver, "a");
  EXPECT_EQ(a.repeats, 3);
  EXPECT_EQ(a.successes, 2);
  EXPECT_EQ(a.cost_median, 2);
  EXPECT_EQ(a.cost_worst, 5);
  EXPECT_EQ(a.evaluations, 3);
  EXPECT_EQ(a.evaluations_to_target, 1.5);  // of the two that reached it: 2 and 1
  EXPECT_EQ(a.seconds_to_target, 0.75);
  EXPECT_THAT(a.mean, ElementsAre(2));
  EXPECT_THAT(a.deviation, ElementsAre(1));
  EXPECT_EQ(summaries[1].deviation[0], 0) << "of a single run";
  EXPECT_TRUE(std::isnan(summaries[1].evaluations_to_target));
}

TEST_F(SolverStudy, FileAndJsonHoldTheSameNumbers) {
  const Study study = Compared({"lm"}, 2);
  const Hdf5Node tree =
      files::StudyTree(problem_, study, kStudyProvenance, files::OriginTree(kStudyProvenance, setup_, {}));
  const auto json = nlohmann::json::parse(files::StudyJson(problem_, study, kStudyProvenance));
  EXPECT_EQ(json["schema"], "sinew.study/1");
  EXPECT_EQ(tree.Find("study")->Text("sinew_schema"), "study/1");
  EXPECT_EQ(json["best_cost"].get<double>(), tree.Find("study")->Number("best_cost", 0));
  EXPECT_EQ(json["target"].get<double>(), tree.Find("study")->Number("target", 0));
  EXPECT_THAT(*tree.Find("study/runs/solver")->texts(), ElementsAre("lm", "lm"));
  const auto& values = tree.Find("study/runs/values")->array()->values;
  ASSERT_EQ(values.size(), 4U);
  EXPECT_DOUBLE_EQ(json["solvers"][0]["parameters"][1]["mean"].get<double>(), 0.5 * (values[1] + values[3]));
}

class ResumedStudy : public SolverStudy {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  Result<std::vector<StudyRun>> Read(const Hdf5Node& origin) {
    return files::ReadStudyRuns(path_, setup_, origin);
  }

  const std::string path_ =
      (std::filesystem::temp_directory_path() / ("sinew_study_" + std::to_string(getpid()) + ".h5")).string();
};

TEST_F(ResumedStudy, DoesNotRunAgainWhatHadEnded) {
  StudyOptions options;
  options.solvers = {"ceres", "lm"};
  options.repeats = 3;
  std::atomic<bool> interrupt = false;
  options.interrupt = &interrupt;
  int runs = 0;
  options.after_run = [&](const StudyRun&) { interrupt = ++runs == 4; };
  const Study part = CompareSolvers(fit_, options).value();
  EXPECT_FALSE(part.finished);
  ASSERT_EQ(part.runs.size(), 4U);
  const Hdf5Node origin = files::OriginTree(kStudyProvenance, setup_, {{"--seed", "1"}});
  ASSERT_TRUE(WriteHdf5(path_, files::StudyTree(problem_, part, kStudyProvenance, origin)));

  interrupt = false;
  runs = 10;
  options.done = Read(origin).value();
  const Study rest = CompareSolvers(fit_, options).value();
  EXPECT_TRUE(rest.finished);
  EXPECT_EQ(runs, 12) << "two were new";
  options.done.clear();
  const Study whole = CompareSolvers(fit_, options).value();
  ASSERT_EQ(rest.runs.size(), whole.runs.size());
  EXPECT_EQ(rest.target, whole.target);
  for (std::size_t r = 0; r < whole.runs.size(); ++r) {
    EXPECT_EQ(rest.runs[r].solver, whole.runs[r].solver);
    EXPECT_EQ(rest.runs[r].cost, whole.runs[r].cost);
    EXPECT_EQ(rest.runs[r].parameters, whole.runs[r].parameters);
    EXPECT_EQ(rest.runs[r].evaluations, whole.runs[r].evaluations);
    EXPECT_EQ(rest.runs[r].stop.test, whole.runs[r].stop.test);
    EXPECT_EQ(rest.runs[r].ToTarget(rest.target).evaluations,
              whole.runs[r].ToTarget(whole.target).evaluations);
  }
}

TEST_F(SolverStudy, InterruptedBeforeItsFirstAnswerARunIsNone) {
  std::atomic<bool> interrupt = false;
  const toy::ToyProblem problem({toy::MakeParameter("slope", 0, 1, 0.5)}, {toy::MakeBlock("a", "y", 5, 1)},
                                [&](const Block&, double, const Vector&, Vector*) -> Result<double> {
                                  interrupt = true;
                                  return Fail("no prediction");
                                });
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  StudyOptions options;
  options.solvers = {"lm", "sa"};
  options.repeats = 2;
  options.interrupt = &interrupt;
  const Study study = CompareSolvers(LeastSquares(problem, setup), options).value();
  EXPECT_FALSE(study.finished);
  EXPECT_TRUE(study.runs.empty());
}

TEST_F(ResumedStudy, NeedsTheSameOrigin) {
  const Study study = Compared({"lm"}, 2);
  const Hdf5Node origin = files::OriginTree(kStudyProvenance, setup_, {{"--seed", "1"}});
  ASSERT_TRUE(WriteHdf5(path_, files::StudyTree(problem_, study, kStudyProvenance, origin)));
  ASSERT_TRUE(Read(origin));
  const auto refused = [&](const Provenance& provenance, const FitSetup& setup, const char* seed) {
    return Read(files::OriginTree(provenance, setup, {{"--seed", seed}})).error().message;
  };
  EXPECT_THAT(refused(kStudyProvenance, setup_, "2"), HasSubstr("was made with --seed 1, not 2"));
  Provenance other = kStudyProvenance;
  other.data_hash = "other";
  EXPECT_THAT(refused(other, setup_, "1"), HasSubstr("not other"));
  other = kStudyProvenance;
  other.config = "a: 1";
  EXPECT_THAT(refused(other, setup_, "1"), HasSubstr("other settings"));
  FitSetup bounds = setup_;
  bounds.parameters[0].upper += 1;
  EXPECT_THAT(refused(kStudyProvenance, bounds, "1"), HasSubstr("they differ in their upper"));
}

}  // namespace
}  // namespace sinew
