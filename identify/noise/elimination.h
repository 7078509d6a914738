// Partial Cholesky decomposition: the first columns of a symmetric matrix are eliminated, and derivatives of
// a function of what is left are carried back to the whole matrix.
#pragma once

#include "base/linear_algebra.h"

namespace sinew::noise {

/// Of G = [A B'; B C] the columns of A are eliminated: S = C - B A^-1 B' is left.
class Elimination {
 public:
  /// @param lower [n x n] of G, the lower triangle counts; overwritten, its lower right block by the lower
  /// triangle of S @param eliminated size of A, 0 .. n
  /// @return false: A is not positive definite to rounding
  bool Eliminate(Matrix& lower, Eigen::Index eliminated);

  /// Logarithm of the determinant of A.
  [[nodiscard]] double log_determinant() const { return log_determinant_; }
  /// Derivatives of f(S) + log det A by the entries of G: df = sum over i, j of slopes_ij dG_ij.
  /// @param lower as Eliminate() left it @param of_rest [(n - eliminated)^2, symmetric] df = sum of
  /// of_rest_ij dS_ij @param slopes [n x n, symmetric]
  void CarryBack(const Matrix& lower, const Matrix& of_rest, Matrix& slopes);

 private:
  Eigen::Index eliminated_ = 0;
  double log_determinant_ = 0;
  Matrix solved_;   // B A^-1
  Matrix inverse_;  // L^-1
};

}  // namespace sinew::noise
