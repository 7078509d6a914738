// Certified non-linear regression problems of NIST, read from their files.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "tests/identify/support/function_problem.h"

namespace sinew {

/// NIST/ITL Statistical Reference Datasets, nonlinear regression, www.itl.nist.gov/div898/strd.
struct NistDataset {
  std::string name;
  std::array<std::vector<double>, 2> starts;  ///< [P]
  std::vector<double> certified;              ///< [P]
  double residual_sum_of_squares = 0;         ///< certified
  std::vector<double> y;                      ///< [N]
  std::vector<double> x;                      ///< [N]
};

Result<NistDataset> ReadNist(const std::string& folder, const std::string& name);

/// The names of the models of MakeNist, easiest first.
const std::vector<std::string>& NistNames();

/// The dataset as a problem, from start 0 or 1. Each parameter's box reaches twice the span of both starts
/// and the certified value beyond them.
void MakeNist(const NistDataset& data, int start, FunctionProblem& problem);

/// Digits in which a parameter agrees with its certified value, at most 11: -log10 of the relative
/// difference.
double CertifiedDigits(double value, double certified);

}  // namespace sinew
