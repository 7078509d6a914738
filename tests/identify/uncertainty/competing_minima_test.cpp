// Minima that the data do not distinguish: found, taken into the intervals, and told.
#include "identify/uncertainty/competing_minima.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/random.h"
#include "identify/uncertainty/uncertainty.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;

constexpr double kTruth = 2;
constexpr double kNoise = 0.3;

// a^2 + tilt a t + b t: without tilt a and -a fit equally well; with it one of them is worse.
ToyProblem TwoMinima(double tilt, double start) {
  const auto formula = [tilt](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
    if (gradient != nullptr) *gradient << 2 * p[0] + tilt * t * t, t;
    return p[0] * p[0] + tilt * p[0] * t * t + p[1] * t;
  };
  ToyProblem problem({MakeParameter("a", -4, 4, start), MakeParameter("b", -5, 5, 1)},
                     {MakeBlock("one", "height", 80, 1)}, formula);
  Random random(7);
  problem.Measure(Values({kTruth, 1}), [&](const Block&, int) { return kNoise * random.Normal(); });
  return problem;
}

// What a search evaluated: a point in the neighbourhood of each minimum.
std::vector<TraceEntry> Points(const ToyFit& fit) {
  std::vector<TraceEntry> points;
  LeastSquares::Workspace workspace = fit.view.NewWorkspace();
  for (const double a : {1.99, -2.01}) {
    const Vector x = fit.view.Variables(Values({a, 1}));
    points.push_back({0, *fit.view.Cost(x, workspace), x});
  }
  // The search has used more evaluations than the two that matter.
  points.resize(2000, points.front());
  return points;
}

Uncertainty Analyse(const ToyFit& fit, const std::vector<TraceEntry>* points, int threads = 1) {
  UncertaintyOptions options;
  options.points = points;
  options.threads = threads;
  const Result<Uncertainty> found = AnalyseUncertainty(fit.view, fit.view.Start(), {});
  EXPECT_TRUE(found);
  if (!found) return {};
  const Vector minimum = fit.view.Variables(found->minimum);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, minimum, options);
  EXPECT_TRUE(answer);
  return answer ? *answer : Uncertainty{};
}

const Warning* NoteOf(const Uncertainty& answer, WarningKind kind) {
  const auto found = std::find_if(answer.notes.begin(), answer.notes.end(),
                                  [&](const Warning& note) { return note.kind == kind; });
  return found == answer.notes.end() ? nullptr : &*found;
}

TEST(CompetingMinima, IntervalsHoldAllOfThem) {
  const ToyProblem problem = TwoMinima(1e-9, kTruth);
  const ToyFit fit(problem);
  const Uncertainty one = Analyse(fit, nullptr);
  EXPECT_GT(one.parameters[0].ci95_lower, 0);
  EXPECT_EQ(NoteOf(one, WarningKind::kCompetingMinima), nullptr);

  const auto points = Points(fit);
  const Uncertainty both = Analyse(fit, &points);
  ASSERT_EQ(both.minima.size(), 2u);
  // The mirror image of the interval about the other minimum is part of it now; b is the same at both.
  EXPECT_NEAR(both.parameters[0].ci95_lower, -one.parameters[0].ci95_upper, 1e-3);
  EXPECT_NEAR(both.parameters[0].ci95_upper, one.parameters[0].ci95_upper, 1e-3);
  EXPECT_NEAR(both.parameters[1].ci95_lower, one.parameters[1].ci95_lower, 1e-3);
  EXPECT_EQ(both.parameters[0].verdict, Verdict::kWeak);

  const Warning* note = NoteOf(both, WarningKind::kCompetingMinima);
  ASSERT_NE(note, nullptr);
  EXPECT_EQ(note->names, std::vector<std::string>{"a"});
  ASSERT_EQ(note->numbers.size(), 3u);
  EXPECT_EQ(note->numbers[0], 2);
  EXPECT_LT(note->numbers[1], 1e-6);
  EXPECT_GT(note->numbers[2], 0.9);
}

TEST(CompetingMinima, LowestIsTheBetterPoint) {
  // The data are of +2, so that with a tilt -2 is worse, by less than noise tells.
  const ToyProblem problem = TwoMinima(1e-3, -kTruth);
  const ToyFit fit(problem);
  const auto points = Points(fit);
  const Uncertainty answer = Analyse(fit, &points);
  ASSERT_GT(answer.better_point.size(), 0);
  EXPECT_NEAR(fit.view.Parameters(answer.better_point)[0], answer.minima.size() == 2 ? kTruth : 0, 0.2);
}

TEST(CompetingMinima, ThoseThatTheDataExcludeAreNone) {
  const ToyProblem problem = TwoMinima(1, kTruth);
  const ToyFit fit(problem);
  const auto points = Points(fit);
  const Uncertainty answer = Analyse(fit, &points);
  EXPECT_EQ(answer.minima.size(), 1u);
  EXPECT_GT(answer.parameters[0].ci95_lower, 0);
  EXPECT_EQ(NoteOf(answer, WarningKind::kCompetingMinima), nullptr);
}

TEST(CompetingMinima, ThreadsChangeNothing) {
  const ToyProblem problem = TwoMinima(1e-9, kTruth);
  const ToyFit fit(problem);
  const auto points = Points(fit);
  const Uncertainty one = Analyse(fit, &points, 1);
  const Uncertainty four = Analyse(fit, &points, 4);
  EXPECT_EQ(one.parameters[0].ci95_lower, four.parameters[0].ci95_lower);
  EXPECT_EQ(one.parameters[0].ci95_upper, four.parameters[0].ci95_upper);
  EXPECT_EQ(one.evaluations, four.evaluations);
}

}  // namespace
}  // namespace sinew
