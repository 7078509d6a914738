// The column space of a matrix whose columns are mostly sparse: a gain of one cycle of one muscle has fifty
// rows of ten thousand that are not zero.
#pragma once

#include <vector>

#include "base/decompositions.h"

namespace sinew {

/// Small groups of columns without common rows with other groups are projected out of all others first, then
/// larger groups (of one trial, of one channel) without common rows; only the remaining columns are
/// decomposed as a whole. Columns may have any length, be zero or linear combinations of each other.
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
    Matrix unit;                            // its columns, of unit length, on its rows
    Eigen::ColPivHouseholderQR<Matrix> qr;  // of what the groups of earlier levels leave of them
    Matrix basis;                           // [rows x rank]
  };
  // Groups without common rows, not even after earlier levels have been projected out.
  using Level = std::vector<Group>;

  void AddLevel(const Matrix& columns, Eigen::Index most_columns, double most_rows);
  void Decompose(Level& level, double threshold) const;
  [[nodiscard]] std::vector<Eigen::Index> Touched(const Matrix& columns, Eigen::Index column) const;
  [[nodiscard]] static Matrix RowsOf(const Group& group, const Matrix& all);
  void TakeLevelsFrom(Matrix& rows, std::size_t levels) const;

  Eigen::Index height_ = 0;
  Eigen::Index rank_ = 0;
  Vector length_;  // [n]; 0 of a zero column
  std::vector<Level> levels_;
  std::vector<Eigen::Index> others_;       // columns that are in no group
  Matrix wide_;                            // [m x others] of unit length
  Eigen::ColPivHouseholderQR<Matrix> qr_;  // of what the groups leave of them
  Matrix basis_;
};

}  // namespace sinew
