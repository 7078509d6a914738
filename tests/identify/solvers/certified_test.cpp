// `ceres` on problems with certified answers.
#include <gtest/gtest.h>

#include <filesystem>

#include "identify/solvers/ceres_solver.h"
#include "tests/identify/support/nist_strd.h"

namespace sinew {
namespace {

// Digits in which the worst parameter of each dataset must agree with the certified one. From start 2, close
// to the answer, six everywhere; from start 1 what it reached when this was written, rounded down to 6.
constexpr double kDigits = 6;
// Certified sums of squares are printed with 11 digits, except that Lanczos3 leaves 1e-8 of the data, which
// have 5 digits.
constexpr double kCostAgreement = 1e-6;

class Nist : public testing::TestWithParam<std::tuple<std::string, int>> {};

TEST_P(Nist, AgreesWithTheCertifiedValues) {
  const auto [name, start] = GetParam();
  const std::string folder = std::string(SINEW_SHARED_DATA) + "/nist_strd";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no folder " << folder;
  const Result<NistDataset> data = ReadNist(folder, name);
  ASSERT_TRUE(data) << data.error().message;
  FunctionProblem problem;
  MakeNist(*data, start, problem);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = CeresSolver(1e-14).Solve(evaluator, fit.least_squares.Start());

  const Vector found = fit.least_squares.Parameters(result.x);
  double digits = 11;
  for (std::size_t i = 0; i < data->certified.size(); ++i) {
    digits = std::min(digits, CertifiedDigits(found[static_cast<Eigen::Index>(i)], data->certified[i]));
  }
  RecordProperty("digits", std::to_string(digits));
  RecordProperty("evaluations", std::to_string(evaluator.evaluations()));
  EXPECT_GE(digits, kDigits) << evaluator.evaluations() << " evaluations, " << result.stop.test;
  EXPECT_NEAR(2 * result.cost / data->residual_sum_of_squares, 1, kCostAgreement);
  EXPECT_TRUE(result.stop.converged()) << result.stop.test;
}

INSTANTIATE_TEST_SUITE_P(StRD, Nist, testing::Combine(testing::ValuesIn(NistNames()), testing::Values(0, 1)),
                         [](const auto& each) {
                           return std::get<0>(each.param) + "_start" +
                                  std::to_string(std::get<1>(each.param) + 1);
                         });

}  // namespace
}  // namespace sinew
