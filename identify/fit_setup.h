// Which parameters of a problem are free in one fit, and the values of all others.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/execution/fit_record.h"
#include "identify/problem.h"

namespace sinew {

/// What a user requests beyond what the problem declares. Parameters are given by name because the request
/// comes from a command line.
struct FitRequest {
  std::vector<std::string> free;                                          ///< fit only these base parameters
  std::vector<std::pair<std::string, double>> fix;                        ///< hold these at a value
  std::vector<std::pair<std::string, std::pair<double, double>>> bounds;  ///< replace these bounds
  std::vector<std::pair<std::string, double>> start;                      ///< replace these starts
  std::vector<std::string> release;                                       ///< effects to release
};

/// The parameters of one fit: their bounds, their starts, and which of them are free.
struct FitSetup {
  std::vector<Parameter> parameters;  ///< as the problem's, with the requested bounds and starts
  std::vector<int> free;              ///< indices, increasing
  std::vector<int> held;              ///< indices that the request fixes at a value, increasing
  std::vector<int> stated_starts;     ///< indices for which the request states a start, in its order
  Vector rest;                        ///< [P] start of every free parameter, value of every other one
  /// Local fits that have been done, of this setup and of all that are made from it; may be null. No part of
  /// what is asked: the answers are the same without it.
  FitRecord* record = nullptr;
  /// Local fits do not follow curved valleys (solvers::LocalFit): of many short fits most are given up.
  bool straight_steps = false;

  [[nodiscard]] bool IsFree(int parameter) const;
  [[nodiscard]] bool IsHeld(int parameter) const;
  /// Whether nuisance parameters with priors are free: hundreds of values that may follow the data as far as
  /// their priors let them.
  [[nodiscard]] bool HasNuisancePriors() const;
};

/// By default all base parameters, and the nuisance parameters of training trials, are free, and all effects
/// are held at their null. A released effect whose parameters all have probe values has no slope at its null,
/// so it starts at its middle probe value unless the request gives bounds or a start; searches begin at the
/// best of all probe values (solvers::BestStart). Errors: unknown names (with a suggestion), bounds that
/// exclude the start, a fixed value outside the bounds, a parameter both free and fixed.
Result<FitSetup> MakeFitSetup(const Problem& problem, const FitRequest& request);

}  // namespace sinew
