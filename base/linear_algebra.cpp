#include "base/linear_algebra.h"

namespace sinew {

Matrix Gram(const Matrix& a) {
  // Of many columns half of the products are saved; of few the loops of a plain product are faster.
  constexpr Eigen::Index kMany = 96;
  if (a.cols() < kMany) return a.transpose() * a;
  Matrix gram = Matrix::Zero(a.cols(), a.cols());
  gram.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}

Matrix ProjectionOnto(const Matrix& basis, const Matrix& rows) {
  const Matrix coefficients = basis.transpose() * rows;
  return basis * coefficients;
}

}  // namespace sinew
