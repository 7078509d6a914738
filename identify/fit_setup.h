// Which parameters of a problem are free in one fit, and where all others stand.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/problem.h"

namespace sinew {

/// What a user asks for on top of what the problem declares. Names, not indices: it comes from a command
/// line.
struct FitRequest {
  std::vector<std::string> free;                                          ///< only these base parameters
  std::vector<std::pair<std::string, double>> fix;                        ///< held at a value
  std::vector<std::pair<std::string, std::pair<double, double>>> bounds;  ///< other bounds
  std::vector<std::pair<std::string, double>> start;                      ///< other starts
  std::vector<std::string> release;                                       ///< effects to release
};

/// A problem with bounds, starts and the choice of free parameters settled.
struct FitSetup {
  std::vector<Parameter> parameters;  ///< as the problem's, with the requested bounds and starts
  std::vector<int> free;              ///< indices, increasing
  Vector rest;  ///< [P] value of every parameter that is not free; start of those that are

  [[nodiscard]] bool IsFree(int parameter) const;
};

/// By default all base parameters, and the nuisance parameters of training trials, are free, and all effects
/// rest at their null. A released effect whose parameters all have probes has no slope at its null; it starts
/// at its middle probe, unless bounds or a start say otherwise. Errors: unknown names (with a suggestion),
/// bounds that exclude the start, a fixed value outside the bounds, a parameter both free and fixed.
Result<FitSetup> MakeFitSetup(const Problem& problem, const FitRequest& request);

}  // namespace sinew
