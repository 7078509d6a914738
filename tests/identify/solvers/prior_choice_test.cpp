// Parameters of priors, against the marginal likelihood in closed form.
#include "identify/solvers/prior_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/identify/support/classic_problems.h"

namespace sinew {
namespace {

constexpr int kNormals = 400;
constexpr double kNoise = 0.5;

// y = scale * b + noise, with a standard normal b for each sample: y is normal with variance
// scale^2 + noise^2.
struct ScaledNormals {
  FunctionProblem problem;
  double mean_square = 0;  // of y

  ScaledNormals(double truth, double start, std::vector<double> other_starts) {
    Parameter scale;
    scale.name = "scale";
    scale.unit = "1";
    scale.lower = 1e-3;
    scale.upper = 1e3;
    scale.start = start;
    scale.scale = Scale::kLog;
    scale.kind = ParameterKind::kPrior;
    scale.other_starts = std::move(other_starts);
    problem.Add(std::move(scale));
    Random random(5);
    std::vector<double> measured;
    std::vector<int> columns;
    for (int i = 0; i < kNormals; ++i) {
      Parameter b = BaseParameter("b" + std::to_string(i), "1", "", -100, 100, 0);
      b.kind = ParameterKind::kNuisance;
      b.trial = "t";
      b.prior = GaussianPrior{0, 1};
      problem.Add(std::move(b));
      columns.push_back(i + 1);
      const double y = truth * random.Normal() + kNoise * random.Normal();
      mean_square += y * y / kNormals;
      measured.push_back(y / kNoise);
    }
    problem.AddBlock("t", measured, columns,
                     [](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
                       predicted = p[0] / kNoise * p.tail(kNormals);
                       if (derivatives != nullptr) derivatives->diagonal(1).setConstant(p[0] / kNoise);
                       return {};
                     });
  }
  [[nodiscard]] double MostProbable() const { return std::sqrt(mean_square - kNoise * kNoise); }
};

double Chosen(const ScaledNormals& normals, const FitRequest& request = {}) {
  return solvers::ChoosePriors(normals.problem, MakeFitSetup(normals.problem, request).value(), {})
      .setup.rest[0];
}

TEST(PriorChoice, IsTheMostProbableScale) {
  for (const double truth : {0.3, 1.0, 40.0}) {
    const ScaledNormals normals(truth, 2, {1});
    const double step = std::pow(2, 1.0 / 4);  // the last one
    const double off = Chosen(normals) / normals.MostProbable();
    EXPECT_GT(off, 1 / step) << truth;
    EXPECT_LT(off, step) << truth;
  }
}

TEST(PriorChoice, StatesWhatWasGained) {
  const ScaledNormals normals(1, 8, {4});
  const auto choice = solvers::ChoosePriors(normals.problem, MakeFitSetup(normals.problem, {}).value(), {});
  EXPECT_TRUE(choice.any_chosen);
  const auto marginal = [&](double scale) {
    const double variance = scale * scale + kNoise * kNoise;
    return 0.5 * kNormals * (normals.mean_square / variance + std::log(variance));
  };
  EXPECT_NEAR(choice.at_start - choice.marginal, marginal(8) - marginal(choice.setup.rest[0]), 0.1);
  EXPECT_GT(choice.evaluations, 0);
}

TEST(PriorChoice, KeepsWhatIsHeldOrHasNoOtherStart) {
  EXPECT_EQ(Chosen(ScaledNormals(1, 8, {})), 8);
  FitRequest held;
  held.fix.emplace_back("scale", 6);
  EXPECT_EQ(Chosen(ScaledNormals(1, 8, {4}), held), 6);
}

TEST(PriorChoice, OtherValuesCanStayAtTheirStarts) {
  const ScaledNormals normals(1, 8, {4});
  const FitSetup setup = MakeFitSetup(normals.problem, {}).value();
  const FitSetup chosen = solvers::ChoosePriors(normals.problem, setup, {}).setup;
  EXPECT_NE(chosen.rest.tail(kNormals), setup.rest.tail(kNormals));
  const FitSetup both = solvers::WithPriorsOf(chosen, setup);
  EXPECT_EQ(both.rest[0], chosen.rest[0]);
  EXPECT_EQ(both.rest.tail(kNormals), setup.rest.tail(kNormals));
}

TEST(PriorChoice, EndsWhenInterrupted) {
  const ScaledNormals normals(1, 8, {4});
  const std::atomic<bool> interrupt(true);
  const auto choice =
      solvers::ChoosePriors(normals.problem, MakeFitSetup(normals.problem, {}).value(), {&interrupt});
  EXPECT_EQ(choice.setup.rest.size(), kNormals + 1);
  EXPECT_EQ(choice.setup.rest[0], 8);
}

TEST(PriorChoice, NoLeastSquaresFitsAParameterOfAPrior) {
  const ScaledNormals normals(1, 8, {4});
  FitRequest request;
  request.free = {"scale"};
  const auto setup = MakeFitSetup(normals.problem, request);
  ASSERT_FALSE(setup);
  EXPECT_EQ(setup.error().message,
            "parameter 'scale' belongs to a prior: it is chosen before the search, or held by --fix");
}

}  // namespace
}  // namespace sinew
