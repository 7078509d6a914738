// The base fit of a diagnosis in the record of what was done: a search that ended is not repeated.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "identify/execution/fit_record.h"
#include "identify/least_squares.h"
#include "identify/solvers/solver.h"

namespace sinew::diagnosis {

class BaseFitRecord {
 public:
  /// @param fit with the record of its setup, which may be null
  BaseFitRecord(const LeastSquares& fit, const std::string& solver, std::uint64_t seed);

  /// How it ended, without the stages of a search from many starts. Nothing if the record has another shape:
  /// it comes from a file.
  [[nodiscard]] std::optional<SolverResult> Find() const;
  /// A search that was interrupted is not kept.
  void Keep(const SolverResult& result) const;

 private:
  FitRecord* record_;
  std::size_t variables_;
  Digest question_;
};

}  // namespace sinew::diagnosis
