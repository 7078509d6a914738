// A local search from one start, as part of a larger search, that has come to its end: it need not be done
// again.
#pragma once

#include <string>

#include "base/linear_algebra.h"

namespace sinew {

/// What it was asked, which is all that its answer follows from, and what became of it.
struct FinishedSearch {
  std::string solver;
  Vector start;              ///< [n, in 0..1]
  long max_evaluations = 0;  ///< its own limit

  long first = 0;        ///< its first evaluation in the record of the whole search, from 0
  long evaluations = 0;  ///< in a row from there
  long failures = 0;
  long infeasible = 0;
  std::string first_failure;
  std::string stop_kind;  ///< name of a Termination
  std::string stop_test;
  double cost = 0;
  Vector x;  ///< [n]
  int iterations = 0;
};

}  // namespace sinew
