#include "base/sparse_cholesky.h"

#include <gtest/gtest.h>

#include "base/decompositions.h"
#include "base/random.h"

namespace sinew {
namespace {

// Ones on the diagonal, a border of `wide` full rows.
Matrix Arrow(Eigen::Index n, Eigen::Index wide) {
  Random random(3);
  Matrix matrix = 10 * Matrix::Identity(n, n);
  for (Eigen::Index r = n - wide; r < n; ++r) {
    for (Eigen::Index c = 0; c < r; ++c) matrix(r, c) = matrix(c, r) = 0.3 * random.Normal();
  }
  return matrix;
}

TEST(SparseCholesky, SolvesAsTheDenseOne) {
  const Matrix matrix = Arrow(200, 8);
  const SparseCholesky sparse(matrix.triangularView<Eigen::Lower>());
  ASSERT_TRUE(sparse.usable());
  const Vector right = Vector::LinSpaced(200, -1, 2);
  const Eigen::LLT<Matrix> dense(matrix);
  EXPECT_LT((sparse.Solve(right) - dense.solve(right)).norm(), 1e-12);
  EXPECT_NEAR(sparse.LogDeterminant(), 2 * Matrix(dense.matrixL()).diagonal().array().log().sum(), 1e-9);
}

TEST(SparseCholesky, LeavesSmallFullAndIndefiniteMatricesAlone) {
  EXPECT_FALSE(SparseCholesky(Arrow(20, 2)).usable()) << "small";
  EXPECT_FALSE(SparseCholesky(Arrow(200, 120)).usable()) << "full";
  Matrix indefinite = Arrow(200, 8);
  indefinite(50, 50) = -1;
  EXPECT_FALSE(SparseCholesky(indefinite).usable());
  indefinite.row(50).setZero();
  indefinite.col(50).setZero();
  EXPECT_FALSE(SparseCholesky(indefinite).usable()) << "singular";
}

}  // namespace
}  // namespace sinew
