// The column space of a matrix whose columns are mostly sparse: a gain of one cycle of one muscle has fifty
// rows of ten thousand that are not zero.
#pragma once

#include <vector>

#include "base/decompositions.h"

namespace sinew {

/// Small groups of columns without common rows with other groups are projected out of all others first; only
/// the remaining columns are decomposed as a whole. Columns may have any length, be zero or linear
/// combinations of each other.
class ColumnSpace {
 public:
  /// @param columns [m x n] @param threshold rank tolerance, of columns scaled to unit length
  ColumnSpace(const Matrix& columns, double threshold);

  [[nodiscard]] Eigen::Index rank() const { return rank_; }
  /// The component of these rows [m x any] that is orthogonal to the space.
  [[nodiscard]] Matrix TakenFrom(Matrix rows) const;
  /// Coefficients of the columns [n x any] that come closest to `rows` [m x any].
  [[nodiscard]] Matrix Solve(const Matrix& rows) const;
  /// Diagonal of the projector onto the space [m].
  [[nodiscard]] Vector Leverage() const;

 private:
  struct Group {
    std::vector<Eigen::Index> rows;
    std::vector<Eigen::Index> columns;
    Eigen::ColPivHouseholderQR<Matrix> qr;  // of its columns, unit length, on its rows
    Matrix basis;                           // [rows x rank]
  };

  void FindGroups(const Matrix& columns);
  [[nodiscard]] static Matrix RowsOf(const Group& group, const Matrix& all);
  void TakeGroupsFrom(Matrix& rows) const;

  Eigen::Index height_ = 0;
  Eigen::Index rank_ = 0;
  Vector length_;  // [n]; 0 of a zero column
  std::vector<Group> groups_;
  std::vector<Eigen::Index> others_;       // columns that are in no group
  Matrix wide_;                            // [m x others] of unit length
  Eigen::ColPivHouseholderQR<Matrix> qr_;  // of what the groups leave of them
  Matrix basis_;
};

}  // namespace sinew
