// Test functions with known minima, as problems.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "tests/identify/support/function_problem.h"

namespace sinew {

/// Residuals 10 (x2 - x1^2) and 1 - x1: cost 0 at (1, 1). Rosenbrock (1960), Comput. J. 3:175-184; as least
/// squares More, Garbow, Hillstrom (1981), problem 1.
/// @param fails_below no prediction where x1 is below it (or not a number)
inline void MakeRosenbrock(FunctionProblem& problem, double fails_below = -1e9, double fails_above = 1e9) {
  problem.Add("x1", -5, 10, -1.2).Add("x2", -5, 10, 1);
  problem.AddBlock("t", {0, 0}, {0, 1},
                   [=](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     if (p[0] < fails_below || p[0] > fails_above)
                       return Fail("x1 = {} is out of reach", p[0]);
                     values << 10 * (p[1] - p[0] * p[0]), 1 - p[0];
                     if (derivatives != nullptr) *derivatives << -20 * p[0], 10, -1, 0;
                     return {};
                   });
}

/// The example of simann.f: two minima, F(0.864, 1.23) = 16.0817 and F(2.35, -0.319) = 20.9805, where it
/// starts. Judge et al. (1985), The Theory and Practice of Econometrics, 2nd ed., p. 956.
struct Judge {
  // The published program holds these in single precision.
  static constexpr float kY[20] = {4.284f, 4.149f, 3.877f, 0.533f, 2.211f, 2.389f, 2.145f,
                                   3.231f, 1.998f, 1.379f, 2.106f, 1.428f, 1.011f, 2.179f,
                                   2.858f, 1.388f, 1.651f, 1.593f, 1.046f, 2.152f};
  static constexpr float kX2[20] = {.286f, .973f, .384f, .276f, .973f, .543f, .957f, .948f, .543f, .797f,
                                    .936f, .889f, .006f, .828f, .399f, .617f, .939f, .784f, .072f, .889f};
  static constexpr float kX3[20] = {.645f, .585f, .310f, .058f, .455f, .779f, .259f, .202f, .028f, .099f,
                                    .142f, .296f, .175f, .180f, .842f, .039f, .103f, .620f, .158f, .704f};
  static constexpr double kStart[2] = {2.354471f, -0.319186f};
  static constexpr double kOptimum = 16.0817307;

  static double Residual(double a, double b, int i) { return a + b * kX2[i] + b * b * kX3[i] - kY[i]; }

  /// Sum of squares; the problem's cost is half of it.
  static double Value(const Vector& x) {
    double sum = 0;
    for (int i = 0; i < 20; ++i) sum = std::pow(Residual(x[0], x[1], i), 2) + sum;
    return sum;
  }

  static void MakeProblem(FunctionProblem& problem) {
    problem.Add("a", -10, 10, kStart[0]).Add("b", -10, 10, kStart[1]);
    problem.AddBlock("t", std::vector<double>(20, 0.0), {0, 1},
                     [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                       for (int i = 0; i < 20; ++i) {
                         values[i] = Residual(p[0], p[1], i);
                         if (derivatives != nullptr) derivatives->row(i) << 1, kX2[i] + 2 * p[1] * kX3[i];
                       }
                       return {};
                     });
  }
};

}  // namespace sinew
