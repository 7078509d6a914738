// Converged runs of an integrator other than the default.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sinew {

struct ConvergedCurves {
  std::string source;
  double certain_to = 0;  ///< largest difference to the run of yet another integrator
  double duration = 0;    ///< [s] of samples at even distances, from 0 on
  std::size_t coordinates = 0;
  std::vector<double> values;  ///< [samples x coordinates]
};

/// nullptr: none of this name. The file is written by benchmarks/mechanisms/converge.cpp.
[[nodiscard]] const ConvergedCurves* FindConvergedCurves(const std::string& name);

}  // namespace sinew
