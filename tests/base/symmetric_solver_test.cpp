#include "base/symmetric_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "base/decompositions.h"
#include "base/random.h"

namespace sinew {
namespace {

// Residuals of `trials`, each with `own` unknowns; `shared` ones take part in all trials and `of_some` in
// every second one. Its columns are shuffled.
Matrix OfTrials(Eigen::Index trials, Eigen::Index own, Eigen::Index shared, Eigen::Index of_some) {
  Random random(5);
  const Eigen::Index n = trials * own + shared + of_some;
  Matrix normal = 0.1 * Matrix::Identity(n, n);
  for (Eigen::Index k = 0; k < trials; ++k) {
    Matrix rows = Matrix::Zero(2 * own, n);
    const auto fill = [&](Eigen::Index first, Eigen::Index columns) {
      for (Eigen::Index c = first; c < first + columns; ++c) {
        for (Eigen::Index r = 0; r < rows.rows(); ++r) rows(r, c) = random.Normal();
      }
    };
    fill(k * own, own);
    fill(trials * own, shared);
    if (k % 2 == 0) fill(trials * own + shared, of_some);
    normal += rows.transpose() * rows;
  }
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(random.Uniform() * static_cast<double>(i))]);
  return normal(order, order);
}

void ExpectSolves(const Matrix& matrix) {
  const Vector right = Vector::LinSpaced(matrix.rows(), -1, 2);
  const Eigen::LLT<Matrix> dense(matrix);
  const Vector expected = dense.solve(right);
  const SymmetricSolver solver(matrix);
  EXPECT_LT((solver.Solve(right) - expected).norm(), 1e-10 * expected.norm());
  ASSERT_TRUE(solver.positive_definite());
  EXPECT_NEAR(solver.LogDeterminant(), 2 * Matrix(dense.matrixL()).diagonal().array().log().sum(), 1e-8);
}

TEST(SymmetricSolver, SolvesSmallFullAndBlockedEquations) {
  ExpectSolves(OfTrials(1, 20, 3, 0));   // small
  ExpectSolves(OfTrials(1, 150, 3, 0));  // full
  ExpectSolves(OfTrials(2, 60, 40, 0));  // two blocks
  ExpectSolves(OfTrials(8, 40, 30, 5));  // some columns couple half of the blocks
  ExpectSolves(OfTrials(4, 40, 0, 0));   // nothing is shared
  ExpectSolves(OfTrials(100, 2, 6, 0));  // blocks of two
}

TEST(SymmetricSolver, SolvesWhatIsNotPositiveDefinite) {
  for (const Eigen::Index own : {10, 60}) {
    Matrix matrix = OfTrials(3, own, 10, 0);
    matrix(1, 1) = -5;
    const Vector right = Vector::LinSpaced(matrix.rows(), -1, 2);
    const SymmetricSolver solver(matrix);
    EXPECT_FALSE(solver.positive_definite());
    EXPECT_LT((matrix * solver.Solve(right) - right).norm(), 1e-6 * right.norm());
  }
}

TEST(SymmetricSolver, SolvesAPartThatIsScaled) {
  const Matrix matrix = OfTrials(6, 40, 30, 5);
  std::vector<int> columns;
  for (int c = 0; c < matrix.rows(); c += (c % 7 == 0 ? 2 : 1)) columns.push_back(c);
  const auto n = static_cast<Eigen::Index>(columns.size());
  const Vector scale = Vector::LinSpaced(n, 0.5, 3);
  const Vector right = Vector::LinSpaced(n, -1, 2);
  Matrix part = scale.asDiagonal() * Matrix(matrix(columns, columns)) * scale.asDiagonal();
  part.diagonal().array() += 0.3;
  const SymmetricView view(matrix, columns, scale, 0.3);
  EXPECT_LT((view.Full() - part).norm(), 1e-12 * part.norm());
  EXPECT_TRUE(BlockCholesky(view).usable());
  const Vector expected = Eigen::LLT<Matrix>(part).solve(right);
  EXPECT_LT((SymmetricSolver(view).Solve(right) - expected).norm(), 1e-10 * expected.norm());
}

TEST(BlockCholesky, FindsBlocksWhateverTheOrder) {
  EXPECT_TRUE(BlockCholesky(SymmetricView(OfTrials(2, 60, 40, 0))).usable());
  EXPECT_TRUE(BlockCholesky(SymmetricView(OfTrials(8, 40, 30, 5))).usable());
  EXPECT_TRUE(BlockCholesky(SymmetricView(OfTrials(4, 40, 0, 0))).usable());
}

TEST(BlockCholesky, LeavesFullFineAndIndefiniteMatricesAlone) {
  EXPECT_FALSE(BlockCholesky(SymmetricView(OfTrials(1, 150, 3, 0))).usable()) << "full";
  EXPECT_FALSE(BlockCholesky(SymmetricView(OfTrials(100, 2, 6, 0))).usable()) << "blocks of two";
  for (const Eigen::Index column : {0, 100, 200}) {
    Matrix indefinite = OfTrials(4, 40, 60, 0);
    indefinite(column, column) = -1;
    EXPECT_FALSE(BlockCholesky(SymmetricView(indefinite)).usable()) << column;
  }
}

TEST(BlockCholesky, ReadsTheLowerTriangleAlone) {
  const Matrix matrix = OfTrials(4, 40, 20, 0);
  const Vector right = Vector::LinSpaced(matrix.rows(), -1, 2);
  const Matrix lower = matrix.triangularView<Eigen::Lower>();
  EXPECT_EQ(BlockCholesky(SymmetricView(lower)).Solve(right),
            BlockCholesky(SymmetricView(matrix)).Solve(right));
}

}  // namespace
}  // namespace sinew
