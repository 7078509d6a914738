#include "problems/emg_shape/learning/shape_resolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

constexpr int kSamplesPerCycle = 30;

// A burst of this width [cycle] a cycle, whose size and errors scatter.
RecordedTrial Record(double width, int cycles, Random& random) {
  RecordedTrial recording;
  recording.trial.role = BlockRole::kTrain;
  for (int k = 0; k < cycles; ++k) {
    const double gain = std::exp(0.2 * random.Normal());
    for (int i = 0; i < kSamplesPerCycle; ++i) {
      const double phase = (i + 0.5 * (k % 2)) / kSamplesPerCycle;
      const double away = (phase - 0.4) / width;
      recording.trial.cycle.push_back(k);
      recording.trial.phase.push_back(phase);
      recording.measured["soleus"].push_back((0.02 + gain * std::exp(-0.5 * away * away)) *
                                             (1 + 0.08 * random.Normal()));
    }
  }
  return recording;
}

std::vector<EmgMuscle> Soleus() {
  EmgMuscle muscle;
  muscle.name = "soleus";
  return {muscle};
}

int KnotsFor(double width, int cycles = 20) {
  Random random(7);
  const RecordedTrial recording = Record(width, cycles, random);
  return ChooseKnots({&recording}, Soleus());
}

TEST(ShapeResolution, SlowBurstsNeedNoMoreThanIsUsual) {
  EXPECT_EQ(KnotsFor(0.12), kUsualKnots);
  EXPECT_EQ(KnotsFor(0.08), kUsualKnots);
}

TEST(ShapeResolution, BriefBurstsNeedMore) {
  EXPECT_GT(KnotsFor(0.03), kUsualKnots);
  EXPECT_GT(KnotsFor(0.02), KnotsFor(0.04));
}

TEST(ShapeResolution, TheMuscleThatNeedsMostDecides) {
  Random random(3);
  RecordedTrial recording = Record(0.12, 20, random);
  recording.measured["tib_ant"] = Record(0.03, 20, random).measured.at("soleus");
  std::vector<EmgMuscle> muscles = Soleus();
  EXPECT_EQ(ChooseKnots({&recording}, muscles), kUsualKnots);
  muscles.emplace_back();
  muscles.back().name = "tib_ant";
  EXPECT_GT(ChooseKnots({&recording}, muscles), kUsualKnots);
}

TEST(ShapeResolution, OnlyTrainingTrialsTellAndTooFewSamplesDoNot) {
  Random random(7);
  RecordedTrial brief = Record(0.02, 20, random);
  brief.trial.role = BlockRole::kValidate;
  EXPECT_EQ(ChooseKnots({&brief}, Soleus()), kUsualKnots);
  EXPECT_EQ(ChooseKnots({}, Soleus()), kUsualKnots);
  const RecordedTrial one = Record(0.02, 1, random);  // nothing is left to fit
  EXPECT_EQ(ChooseKnots({&one}, Soleus()), kUsualKnots);
  RecordedTrial gaps = Record(0.02, 20, random);
  for (std::size_t i = 0; i < gaps.trial.phase.size(); i += 2) gaps.measured.at("soleus")[i] = std::nan("");
  EXPECT_GT(ChooseKnots({&gaps}, Soleus()), kUsualKnots);
}

}  // namespace
}  // namespace sinew
