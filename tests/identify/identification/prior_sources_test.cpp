// What an identification says of the parameters of priors, which no least squares fits.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/random.h"
#include "identify/identification/identification.h"
#include "identify/text/findings.h"
#include "tests/identify/support/function_problem.h"

namespace sinew {
namespace {

constexpr int kScattered = 60;

// y = scale * b + noise, with a standard normal b for each sample, and a line whose slope is fitted.
class ScaledErrors final : public FunctionProblem {
 public:
  // @param off of one measurement that nothing explains, in standard deviations of the noise
  ScaledErrors(std::vector<double> other_starts, double off) {
    Parameter scale;
    scale.name = "scale";
    scale.unit = "1";
    scale.lower = 1e-2;
    scale.upper = 100;
    scale.start = 5;
    scale.scale = Scale::kLog;
    scale.kind = ParameterKind::kPrior;
    scale.other_starts = std::move(other_starts);
    Add(std::move(scale));
    Add("slope", -10, 10, 0);

    Random random(5);
    std::vector<double> measured;
    std::vector<int> columns{1};
    for (int i = 0; i < kScattered; ++i) {
      Parameter b = BaseParameter("b" + std::to_string(i), "1", "", -8, 8, 0);
      b.kind = ParameterKind::kNuisance;
      b.trial = "t";
      b.prior = GaussianPrior{0, 1};
      Add(std::move(b));
      columns.push_back(i + 2);
      measured.push_back(2 * random.Normal() + 0.1 * random.Normal() + 3.0 * i / kScattered);
    }
    AddBlock("t", measured, columns,
             [](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
               const Vector times = Vector::LinSpaced(kScattered, 0, 1 - 1.0 / kScattered);
               predicted = (p[1] * times + p[0] * p.tail(kScattered)) / 0.1;
               if (derivatives == nullptr) return {};
               derivatives->setZero();
               derivatives->col(1) = times / 0.1;
               derivatives->diagonal(2).setConstant(p[0] / 0.1);
               return {};
             });
    AddBlock("t", {off}, {1}, [](const Vector&, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
      predicted.setZero();
      if (derivatives != nullptr) derivatives->setZero();
      return {};
    });
  }
  std::vector<FigureOfMerit> FiguresOfMerit(const Vector& parameters,
                                            const std::vector<Vector>& /*predicted*/) const override {
    return {{"scale of the errors", "m", parameters[0], 0}, {"slope", "1", parameters[1]}};
  }
};

std::vector<FigureOfMerit> FiguresOf(const ScaledErrors& problem, const FitRequest& request = {}) {
  IdentificationOptions options;
  options.solver = "lm";
  const auto found = Identify(problem, MakeFitSetup(problem, request).value(), options);
  EXPECT_TRUE(found) << found.error().message;
  return found ? found->figures : std::vector<FigureOfMerit>(2);
}

TEST(PriorSources, TheDataChoose) {
  const auto figures = FiguresOf({{2.5}, 0});
  EXPECT_EQ(figures[0].source, PriorSource::kChosen);
  EXPECT_NE(figures[0].value, 5);
  EXPECT_NE(text::Meaning(figures[0]).find("chosen by the marginal likelihood"), std::string::npos);
  EXPECT_EQ(figures[1].source, PriorSource::kNone);
  EXPECT_EQ(text::Meaning(figures[1]), "1");
}

TEST(PriorSources, WhatIsHeldWasNotChosen) {
  FitRequest request;
  request.fix.emplace_back("scale", 3);
  const auto figures = FiguresOf({{2.5}, 0}, request);
  EXPECT_EQ(figures[0].source, PriorSource::kHeld);
  EXPECT_EQ(figures[0].value, 3);
  EXPECT_EQ(text::Meaning(figures[0]), "m; held as requested");
}

TEST(PriorSources, NoDataWereAsked) {
  const auto figures = FiguresOf({{}, 0});
  EXPECT_EQ(figures[0].source, PriorSource::kNone);
  EXPECT_EQ(text::Meaning(figures[0]), "m");
}

TEST(PriorSources, NothingIsChosenByAFitFarFromTheNoise) {
  const auto figures = FiguresOf({{2.5, 10}, 1e3});
  EXPECT_EQ(figures[0].source, PriorSource::kUndetermined);
  EXPECT_EQ(figures[0].value, 10) << "what allows most";
  EXPECT_NE(text::Meaning(figures[0]).find("not chosen by the data"), std::string::npos);
}

}  // namespace
}  // namespace sinew
