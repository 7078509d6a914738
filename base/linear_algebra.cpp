#include "base/linear_algebra.h"

namespace sinew {

Matrix Gram(const Matrix& a) {
  return a.transpose() * a;
}

Matrix ProjectionOnto(const Matrix& basis, const Matrix& rows) {
  const Matrix coefficients = basis.transpose() * rows;
  return basis * coefficients;
}

}  // namespace sinew
