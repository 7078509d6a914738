// The deviance of a residual under a noise model, by which models are compared.
#include "identify/diagnosis/fit/refit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/decompositions.h"
#include "base/random.h"
#include "identify/noise/autoregression.h"
#include "tests/identify/support/function_problem.h"

namespace sinew::diagnosis {
namespace {

constexpr int kSamples = 40;

/// Two trials of one constant, whose residuals each test prescribes.
class Constant final : public FunctionProblem {
 public:
  Constant() {
    Add("level", -1, 1, 0);
    for (const char* trial : {"first", "second"}) {
      AddBlock(trial, std::vector<double>(kSamples, 0), {0}, [](const Vector& p, auto values, Matrix* slope) {
        values.setConstant(p[0]);
        if (slope != nullptr) slope->col(0).setOnes();
        return Status();
      });
    }
  }
};

Vector SomeResidual() {
  Random random(7);
  Vector residual(2 * kSamples);
  for (double& value : residual) value = random.Normal();
  return residual;
}

noise::NoiseModel NoiseOf(const std::vector<double>& coefficients) {
  noise::NoiseModel noise;
  noise.channels.emplace_back();
  noise.channels[0].coefficients = coefficients;
  noise.channel_of = {0, 0};
  return noise;
}

/// Covariance for unit innovations, by the sum over the impulse response.
Matrix CovarianceOf(const std::vector<double>& coefficients) {
  constexpr std::size_t kTerms = 2000;
  std::vector<double> impulse(kTerms);
  impulse[0] = 1;
  for (std::size_t t = 1; t < kTerms; ++t) {
    for (std::size_t i = 0; i < coefficients.size() && i < t; ++i)
      impulse[t] += coefficients[i] * impulse[t - 1 - i];
  }
  Matrix covariance(kSamples, kSamples);
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const auto lag = static_cast<std::size_t>(std::abs(i - j));
      covariance(i, j) = 0;
      for (std::size_t t = 0; t + lag < kTerms; ++t) covariance(i, j) += impulse[t] * impulse[t + lag];
    }
  }
  return covariance;
}

// n log(r' C^-1 r / n) + log|C| of both trials: twice the negative log-likelihood at the likeliest scale, but
// for a constant. No order may cost a sample: orders could not be compared.
TEST(Deviance, IsThatOfTheWholeRecordForAnyOrder) {
  const Constant problem;
  const Fit fit(problem);
  const Vector residual = SomeResidual();
  const std::vector<double> high =
      noise::CoefficientsFromPartial({0.7, -0.4, 0.3, 0.2, -0.3, 0.25, 0.1, -0.2, 0.15, 0.3});
  for (const auto& coefficients : std::vector<std::vector<double>>{{}, {0.8}, {1.2, -0.5}, high}) {
    int counted = 0;
    const double deviance = Deviance(fit.least_squares, residual, NoiseOf(coefficients), &counted);
    EXPECT_EQ(counted, 2 * kSamples) << coefficients.size();
    const Eigen::LLT<Matrix> cholesky(CovarianceOf(coefficients));
    const Matrix lower = cholesky.matrixL();
    double squares = 0;
    for (const int first : {0, kSamples})
      squares += cholesky.matrixL().solve(residual.segment(first, kSamples)).squaredNorm();
    const double expected =
        2 * kSamples * std::log(squares / (2 * kSamples)) + 2 * 2 * lower.diagonal().array().log().sum();
    EXPECT_NEAR(deviance, expected, 1e-8) << coefficients.size();
  }
}

TEST(Deviance, DoesNotChangeWithZeroCoefficients) {
  const Constant problem;
  const Fit fit(problem);
  const Vector residual = SomeResidual();
  const double plain = Deviance(fit.least_squares, residual, NoiseOf({}), nullptr);
  EXPECT_NEAR(Deviance(fit.least_squares, residual, NoiseOf(std::vector<double>(12, 0)), nullptr), plain,
              1e-10);
}

}  // namespace
}  // namespace sinew::diagnosis
