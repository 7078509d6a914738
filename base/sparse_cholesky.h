// Sparse normal equations of many unknowns: gains of single cycles beside a shape that all share.
#pragma once

#include <memory>

#include "base/linear_algebra.h"

namespace sinew {

/// L D L' of a symmetric positive definite matrix, its columns ordered so that few zeros fill in (Amestoy,
/// Davis, Duff 1996). Only where that pays: a matrix of many columns, most of whose entries are zero.
class SparseCholesky {
 public:
  /// @param lower [n x n] entries on and below the diagonal count
  explicit SparseCholesky(const Matrix& lower);
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// False: the matrix is small or full, or not positive definite; nothing else may be asked then.
  [[nodiscard]] bool usable() const;
  [[nodiscard]] Vector Solve(const Vector& right) const;
  [[nodiscard]] double LogDeterminant() const;

 private:
  struct Decomposition;
  std::unique_ptr<Decomposition> decomposition_;
};

}  // namespace sinew
