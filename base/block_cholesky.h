// Normal equations of many unknowns, most of which belong to one trial each.
#pragma once

#include <vector>

#include "base/linear_algebra.h"
#include "base/symmetric_view.h"

namespace sinew {

/// L L' of a symmetric positive definite matrix whose columns, but for a few that are coupled to many others,
/// fall into blocks that are not coupled to each other: the blocks are eliminated one by one, and what they
/// leave of the few (the Schur complement) is decomposed last. Blocks are full matrices.
/// Source: Golub, Van Loan (2013), Matrix Computations, ch. 4.2 and 11.5; in adjustment of networks: Helmert
/// blocking.
class BlockCholesky {
 public:
  /// Finds the blocks.
  explicit BlockCholesky(const SymmetricView& matrix);

  /// False: there are no such blocks, they are too small to pay, or the matrix is not positive definite;
  /// nothing else may be asked then.
  [[nodiscard]] bool usable() const { return usable_; }
  [[nodiscard]] Vector Solve(const Vector& right) const;
  [[nodiscard]] double LogDeterminant() const;

 private:
  struct Block {
    std::vector<int> columns;
    std::vector<int> border;  // coupled ones of the few, as indices into border_
    Matrix root;              // lower triangle
    Matrix coupling;          // root^-1 times the coupling [columns x border]
  };
  bool Decompose(const SymmetricView& matrix);

  std::vector<Block> blocks_;
  std::vector<int> border_;
  Matrix border_root_;
  bool usable_ = false;
};

}  // namespace sinew
