// Linear equations of a symmetric matrix, mostly positive definite: normal equations.
#pragma once

#include <Eigen/Cholesky>
#include <memory>
#include <variant>

#include "base/block_cholesky.h"
#include "base/linear_algebra.h"
#include "base/sparse_cholesky.h"
#include "base/symmetric_view.h"

namespace sinew {

/// The decomposition that suits the matrix: by blocks, of its entries that are not zero, or of all of it; and
/// where it is not positive definite, L D L' of all of it.
class SymmetricSolver {
 public:
  explicit SymmetricSolver(const SymmetricView& matrix);
  /// @param matrix [n x n], both triangles
  explicit SymmetricSolver(const Matrix& matrix) : SymmetricSolver(SymmetricView(matrix)) {}

  [[nodiscard]] Vector Solve(const Vector& right) const;
  /// Whether the matrix was found to be: LogDeterminant may be asked.
  [[nodiscard]] bool positive_definite() const;
  /// log det of a positive definite matrix.
  [[nodiscard]] double LogDeterminant() const;

 private:
  std::variant<BlockCholesky, SparseCholesky, Eigen::LLT<Matrix>, Eigen::LDLT<Matrix>> decomposition_;
};

}  // namespace sinew
