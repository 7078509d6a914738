// Normal equations of one channel, eliminated from the inside out: regressors of single blocks (gains of the
// cycles of one trial), then those of all blocks of the channel, then those that it shares with other
// channels.
#pragma once

#include <vector>

#include "identify/noise/elimination.h"
#include "identify/noise/lagged_products.h"

namespace sinew::noise {

/// What is left of the normal equations of a channel, or of several: regressors that channels share, then the
/// residual.
struct JointEquations {
  Matrix lower;     ///< [(joint + 1)^2] only the lower triangle; the last entry is the residual's power
  Vector diagonal;  ///< [joint] of the normal equations before anything was eliminated
  double log_determinant = 0;  ///< of what was eliminated

  explicit JointEquations(Eigen::Index joint = 0) { SetZero(joint); }
  void SetZero(Eigen::Index joint);
  void operator+=(const JointEquations& other);
};

/// A direction whose squared length after whitening is below 1e-12 of its columns is treated as if it had
/// that length. A regressor without any row is left out.
class ChannelEquations {
 public:
  /// @param columns [blocks][k_b] regressors of each block of the channel @param joint_place [columns] place
  /// of a regressor among those that channels share, or -1 @param joint their number
  ChannelEquations(const std::vector<std::vector<int>>& columns, const std::vector<int>& joint_place,
                   Eigen::Index joint);

  /// Regressors of this channel, those that it shares included.
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] bool IsAlone() const { return joint_of_border_.empty(); }

  /// Eliminates all regressors that only this channel has.
  /// @param products of the blocks' filtered rows @param value [entries] their sums
  /// @return false: not positive definite
  bool Eliminate(const LaggedProducts& products, const Vector& value, JointEquations& left);

  /// Derivatives of f(left) + log determinant of what Eliminate() eliminated by the sums of the products.
  /// @param of_left [(joint + 1)^2, symmetric] by the entries of what was left @param slopes [entries]
  void CarryBack(const LaggedProducts& products, const Matrix& of_left, Vector& slopes);

 private:
  struct BlockPart {
    std::vector<Eigen::Index> place;   // [k_b + 1] of the regressors and the residual in `matrix`
    std::vector<Eigen::Index> border;  // of the columns that are not eliminated in the channel's `border_`
    Eigen::Index own = 0;              // regressors that no other block has
    Matrix matrix;
    Elimination elimination;
  };

  std::vector<BlockPart> blocks_;
  std::vector<Eigen::Index> joint_of_border_;  // for the last columns of `border_` but the residual
  Eigen::Index channels_own_ = 0;              // columns of `border_` that no other channel has
  int columns_ = 0;
  Eigen::Index joint_ = 0;
  Matrix border_;
  Vector border_diagonal_;
  Elimination elimination_;
  Matrix of_border_;  // scratch
  Matrix of_rest_;    // scratch
  Matrix of_block_;   // scratch
};

/// Eliminates what channels share. @param equations overwritten @return false: not positive definite
bool EliminateJoint(JointEquations& equations, Elimination& elimination);

}  // namespace sinew::noise
