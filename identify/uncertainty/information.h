// Information of the Jacobian about the reported parameters, after the columns of nuisance values are
// projected out: directions, rank and the inverse of the normal matrix.
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew::uncertainty {

struct Information {
  std::vector<int> variables;  ///< [k]
  std::vector<int> nuisance;   ///< [h] those with a column that is not zero
  Matrix columns;              ///< [m x k] of the Jacobian, nuisance projected out
  Vector full_norm;            ///< [k] length of the columns before the projection
  Vector norm;                 ///< [k] and after it
  Matrix nuisance_share;       ///< [h x k] length of each nuisance column's part, over full_norm
  Vector singular_values;      ///< [k, decreasing] of the columns scaled to unit length
  Matrix directions;           ///< [k x k] column i belongs to singular value i, in the scaled columns
  int rank = 0;
  std::vector<bool> lost_to_nuisance;  ///< [k] nothing is left of the column
  std::vector<bool> determined;        ///< [k] takes no part in a lost direction
  Matrix inverse;                      ///< [k x k] of columns' * columns, pseudo-inverse if rank < k
  Vector leverage;                     ///< [m] diagonal of the hat matrix of all columns

  /// Place of a variable in `variables`, -1 if it is not among them.
  [[nodiscard]] int index_of(int variable) const;
};

/// @param jacobian [m x n] @param variables, nuisance columns of it; nuisance columns that are zero are left
/// out.
[[nodiscard]] Information MakeInformation(const Matrix& jacobian, const std::vector<int>& variables,
                                          const std::vector<int>& nuisance);

}  // namespace sinew::uncertainty
