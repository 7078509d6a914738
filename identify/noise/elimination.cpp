#include "identify/noise/elimination.h"

#include <cmath>

namespace sinew::noise {

// The matrices have ten to a hundred columns: plain loops over columns, which the compiler vectorises.
bool Elimination::Eliminate(Matrix& lower, Eigen::Index eliminated) {
  eliminated_ = eliminated;
  log_determinant_ = 0;
  const Eigen::Index n = lower.rows();
  for (Eigen::Index k = 0; k < eliminated; ++k) {
    const double pivot = lower(k, k);
    if (!(pivot > 0)) return false;
    log_determinant_ += std::log(pivot);
    const double root = std::sqrt(pivot);
    const double scale = 1 / root;
    double* own = &lower(0, k);
    own[k] = root;
    for (Eigen::Index r = k + 1; r < n; ++r) own[r] *= scale;
    for (Eigen::Index c = k + 1; c < n; ++c) {
      const double factor = own[c];
      if (factor == 0) continue;
      double* other = &lower(0, c);
      for (Eigen::Index r = c; r < n; ++r) other[r] -= factor * own[r];
    }
  }
  return true;
}

void Elimination::CarryBack(const Matrix& lower, const Matrix& of_rest, Matrix& slopes) {
  const Eigen::Index n = lower.rows();
  const Eigen::Index e = eliminated_;
  const Eigen::Index left = n - e;
  slopes.resize(n, n);
  slopes.bottomRightCorner(left, left) = of_rest;
  if (e == 0) return;
  // L^-1, column by column, and B A^-1 = (B L^-T) L^-1.
  inverse_.setZero(e, e);
  for (Eigen::Index c = 0; c < e; ++c) {
    double* column = &inverse_(0, c);
    column[c] = 1;
    for (Eigen::Index k = c; k < e; ++k) {
      const double* own = &lower(0, k);
      column[k] /= own[k];
      const double factor = column[k];
      if (factor == 0) continue;
      for (Eigen::Index r = k + 1; r < e; ++r) column[r] -= factor * own[r];
    }
  }
  solved_.noalias() = lower.bottomLeftCorner(left, e) * inverse_;
  slopes.bottomLeftCorner(left, e).noalias() = of_rest * solved_;
  slopes.topLeftCorner(e, e).noalias() = solved_.transpose() * slopes.bottomLeftCorner(left, e);
  slopes.topLeftCorner(e, e).noalias() += inverse_.transpose() * inverse_;
  slopes.bottomLeftCorner(left, e) *= -1;
  slopes.topRightCorner(e, left) = slopes.bottomLeftCorner(left, e).transpose();
}

}  // namespace sinew::noise
