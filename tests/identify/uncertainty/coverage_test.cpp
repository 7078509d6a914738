// Share of fixed seeds for which the 95 % interval contains the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/random.h"
#include "identify/statistics/distributions.h"
#include "identify/uncertainty/uncertainty.h"
#include "tests/identify/support/toy_problem.h"
#include "tests/identify/uncertainty/curves.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;

constexpr int kCoverageSeeds = 400;
// Four standard deviations of a binomial share: chance of failure below 1e-4 per figure, were seeds not
// fixed.
const double kBinomial = 4 * std::sqrt(0.95 * 0.05 / kCoverageSeeds);

struct Coverage {
  double reported = 0;  ///< share of seeds with the truth inside ci95, worst parameter
  double plain = 0;     ///< the same for value +- quantile times plain error
};

Coverage Measure(const toy::Formula& formula, const Vector& truth, double sigma, double correlation,
                 int samples) {
  std::vector<double> reported(2, 0);
  std::vector<double> plain(2, 0);
  for (int seed = 0; seed < kCoverageSeeds; ++seed) {
    ToyProblem problem({MakeParameter("a", -50, 50, truth[0]), MakeParameter("b", -50, 50, truth[1])},
                       {MakeBlock("one", "height", samples, 2)}, formula);
    Random random(Random::StreamSeed(2024, static_cast<std::uint64_t>(seed)));
    double last = 0;
    problem.Measure(truth, [&](const Block&, int i) {
      const double fresh = sigma * random.Normal();
      last = i == 0 ? fresh / std::sqrt(1 - correlation * correlation) : correlation * last + fresh;
      return last;
    });
    const ToyFit fit(problem);
    const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), {});
    EXPECT_TRUE(answer);
    if (!answer) continue;
    const double q = statistics::StudentTQuantile(0.975, answer->degrees_of_freedom);
    for (int i = 0; i < 2; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const ParameterVerdict& verdict = answer->parameters[at];
      reported[at] +=
          (verdict.ci95_lower <= truth[i] && truth[i] <= verdict.ci95_upper) ? 1.0 / kCoverageSeeds : 0;
      plain[at] +=
          std::abs(answer->minimum[i] - truth[i]) <= q * verdict.std_error ? 1.0 / kCoverageSeeds : 0;
    }
  }
  return {std::min(reported[0], reported[1]), std::min(plain[0], plain[1])};
}

TEST(Coverage, OfALineInWhiteNoise) {
  const Coverage coverage = Measure(Line, Values({1, 4}), 0.3, 0, 60);
  EXPECT_NEAR(coverage.plain, 0.95, kBinomial);
  EXPECT_NEAR(coverage.reported, 0.95, kBinomial);
  RecordProperty("reported", std::to_string(coverage.reported));
}

TEST(Coverage, OfADecayInWhiteNoise) {
  const Coverage coverage = Measure(Decay, Values({3, 1.2}), 0.3, 0, 60);
  EXPECT_NEAR(coverage.reported, 0.95, kBinomial);
  RecordProperty("reported", std::to_string(coverage.reported));
}

TEST(Coverage, OfALineInCorrelatedNoise) {
  const Coverage coverage = Measure(Line, Values({1, 4}), 0.3, 0.8, 200);
  EXPECT_LT(coverage.plain, 0.6);
  EXPECT_GT(coverage.reported, 0.85);  // a kernel estimate from 200 samples cannot do better
  RecordProperty("reported", std::to_string(coverage.reported));
}

TEST(Coverage, OfADecayInCorrelatedNoise) {
  const Coverage coverage = Measure(Decay, Values({3, 1.2}), 0.05, 0.8, 200);
  EXPECT_LT(coverage.plain, 0.75);
  EXPECT_GT(coverage.reported, 0.85);
  RecordProperty("reported", std::to_string(coverage.reported));
}

// The position of a joint that is moved by a force with noise: how finely it is sampled does not matter.
TEST(Coverage, InARandomWalkAtAnyRate) {
  for (const int samples : {500, 16000}) {
    const double correlation = 1 - 0.25 / samples;  // a memory of eight seconds, of two that are measured
    const double step = 0.3 * std::sqrt(1 - correlation * correlation);
    const Coverage coverage = Measure(Swing, Values({3, 1.2}), step, correlation, samples);
    EXPECT_LT(coverage.plain, 0.75) << samples;
    EXPECT_GT(coverage.reported, 0.9) << samples;  // by the kernel alone 0.99 and 0.82
  }
}

}  // namespace
}  // namespace sinew
