#include "identify/equal_noise_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

Block BlockWith(const char* trial, const char* channel, double weight, int samples) {
  Block block = toy::MakeBlock(trial, channel, samples, 1);
  block.weight = weight;
  return block;
}

toy::ToyProblem ProblemWith(Layout layout) {
  return toy::ToyProblem({}, std::move(layout),
                         [](const Block&, double, const Vector&, Vector*) -> Result<double> { return 0; });
}

TEST(EqualNoiseViewTest, TrialsOfAChannelWeighAlikeAndTheirShareOfTheCostRemains) {
  Layout layout = {BlockWith("walk", "knee", 1, 10), BlockWith("run", "knee", 3, 30),
                   BlockWith("walk", "ankle", 5, 10), BlockWith("stairs", "knee", 7, 10)};
  layout[3].role = BlockRole::kValidate;
  const toy::ToyProblem problem = ProblemWith(layout);
  const EqualNoiseView view(problem);
  const double knee = std::sqrt((10 * 1 + 30 * 9) / 40.0);
  EXPECT_DOUBLE_EQ(view.layout()[0].weight, knee);
  EXPECT_DOUBLE_EQ(view.layout()[1].weight, knee);
  EXPECT_DOUBLE_EQ(view.layout()[2].weight, 5);
  EXPECT_DOUBLE_EQ(view.layout()[3].weight, knee) << "of the held-out trial, too";
  EXPECT_TRUE(view.weights_are_noise_levels());
}

TEST(EqualNoiseViewTest, StatedNoiseIsTheMeasureWhereEveryFittedTrialHasIt) {
  Layout layout = {BlockWith("walk", "knee", 1, 10), BlockWith("run", "knee", 1, 10),
                   BlockWith("walk", "ankle", 1, 10), BlockWith("run", "ankle", 3, 10)};
  layout[0].sigma = 0.5;
  layout[1].sigma = 1.5;
  layout[2].sigma = 0.5;  // not of the other
  const toy::ToyProblem problem = ProblemWith(layout);
  const EqualNoiseView view(problem);
  EXPECT_DOUBLE_EQ(view.layout()[0].weight, 3 * view.layout()[1].weight);
  EXPECT_DOUBLE_EQ(view.layout()[2].weight, view.layout()[3].weight);
}

TEST(EqualNoiseViewTest, PenaltiesKeepTheirWeights) {
  Layout layout = {BlockWith("walk", "fibre", 2, 10), BlockWith("run", "fibre", 4, 10)};
  for (Block& block : layout) block.range = Range{0.5, 1.5};
  const toy::ToyProblem problem = ProblemWith(layout);
  const EqualNoiseView view(problem);
  EXPECT_EQ(view.layout()[0].weight, 2);
  EXPECT_EQ(view.layout()[1].weight, 4);
}

}  // namespace
}  // namespace sinew
