// A part of a symmetric matrix, scaled, without a copy: the normal equations of the unknowns that move.
#pragma once

#include <algorithm>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// scale_a m(columns_a, columns_b) scale_b + added [a = b], of a symmetric matrix m of which entries on and
/// below the diagonal are read. Keeps references.
class SymmetricView {
 public:
  /// The matrix as it is.
  explicit SymmetricView(const Matrix& lower) : matrix_(lower) {}
  /// @param columns [n] @param scale [n] @param added to the diagonal
  SymmetricView(const Matrix& lower, const std::vector<int>& columns, const Vector& scale, double added)
      : matrix_(lower), columns_(&columns), scale_(&scale), added_(added) {}

  [[nodiscard]] Eigen::Index size() const {
    return columns_ == nullptr ? matrix_.rows() : static_cast<Eigen::Index>(columns_->size());
  }
  [[nodiscard]] bool IsZero(Eigen::Index a, Eigen::Index b) const { return Unscaled(a, b) == 0; }
  [[nodiscard]] double operator()(Eigen::Index a, Eigen::Index b) const {
    const double scaled = scale_ == nullptr ? Unscaled(a, b) : Unscaled(a, b) * (*scale_)[a] * (*scale_)[b];
    return a == b ? scaled + added_ : scaled;
  }
  /// A copy [n x n], both triangles.
  [[nodiscard]] Matrix Full() const {
    Matrix full(size(), size());
    for (Eigen::Index b = 0; b < size(); ++b) {
      for (Eigen::Index a = b; a < size(); ++a) full(a, b) = full(b, a) = (*this)(a, b);
    }
    return full;
  }

 private:
  [[nodiscard]] double Unscaled(Eigen::Index a, Eigen::Index b) const {
    if (columns_ != nullptr) {
      a = (*columns_)[static_cast<std::size_t>(a)];
      b = (*columns_)[static_cast<std::size_t>(b)];
    }
    return matrix_(std::max(a, b), std::min(a, b));
  }

  const Matrix& matrix_;
  const std::vector<int>* columns_ = nullptr;
  const Vector* scale_ = nullptr;
  double added_ = 0;
};

}  // namespace sinew
