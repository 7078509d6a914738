#include "base/column_space.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace sinew {
namespace {

constexpr double kThreshold = 1e-8;

// Four columns without zero rows, then pairs that are not zero in ten rows each.
Matrix Arrow(int groups) {
  Random random(1);
  const Eigen::Index rows = 60 * groups;
  Matrix columns = Matrix::Zero(rows, 4 + 2 * groups);
  for (Eigen::Index r = 0; r < rows; ++r) {
    for (Eigen::Index c = 0; c < 4; ++c) columns(r, c) = random.Normal();
  }
  for (int g = 0; g < groups; ++g) {
    for (Eigen::Index r = 60 * g; r < 60 * g + 10; ++r) {
      columns(r, 4 + 2 * g) = 1e-3 * random.Normal();
      columns(r, 5 + 2 * g) = 1e3 * random.Normal();
    }
  }
  return columns;
}

Matrix RandomRows(Eigen::Index rows, Eigen::Index columns) {
  Random random(2);
  Matrix made(rows, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) made(r, c) = random.Normal();
  }
  return made;
}

// The result of one decomposition of the whole matrix.
Matrix Projected(const Matrix& columns, const Matrix& rows) {
  const Matrix unit = columns * columns.colwise().norm().cwiseMax(1e-300).cwiseInverse().asDiagonal();
  Eigen::ColPivHouseholderQR<Matrix> qr(unit);
  qr.setThreshold(kThreshold);
  const Matrix q = qr.householderQ() * Matrix::Identity(columns.rows(), qr.rank());
  return q * (q.transpose() * rows);
}

TEST(ColumnSpace, AgreesWithOneDecompositionOfEverything) {
  const Matrix columns = Arrow(30);
  const Matrix rows = RandomRows(columns.rows(), 3);
  const ColumnSpace space(columns, kThreshold);
  EXPECT_EQ(space.rank(), columns.cols());
  EXPECT_LT((space.TakenFrom(rows) - (rows - Projected(columns, rows))).norm(), 1e-10);
  EXPECT_LT((columns * space.Solve(rows) - Projected(columns, rows)).norm(), 1e-9);
  const Vector leverage = Projected(columns, Matrix::Identity(columns.rows(), columns.rows())).diagonal();
  EXPECT_LT((space.Leverage() - leverage).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ColumnSpace, ZeroAndDependentColumnsCountOnce) {
  Matrix columns = Arrow(30);
  const Eigen::Index all = columns.cols();
  columns.conservativeResize(Eigen::NoChange, all + 4);
  columns.col(all).setZero();
  columns.col(all + 1) = columns.col(0) + 2 * columns.col(1);  // of wide ones
  columns.col(all + 2) = 3 * columns.col(6);                   // of a group
  columns.col(all + 3) = columns.col(2) + columns.col(8);      // of both
  const ColumnSpace space(columns, kThreshold);
  EXPECT_EQ(space.rank(), all);
  const Matrix rows = RandomRows(columns.rows(), 2);
  EXPECT_LT((space.TakenFrom(rows) - (rows - Projected(columns, rows))).norm(), 1e-9);
  EXPECT_LT((columns * space.Solve(rows) - Projected(columns, rows)).norm(), 1e-9);
}

// Three channels of twelve trials: columns of single trials, of channels, and of everything; some depend on
// each other.
TEST(ColumnSpace, TrialsAndChannelsAreTakenInTurn) {
  constexpr Eigen::Index kChannels = 3;
  constexpr Eigen::Index kTrials = 12;
  constexpr Eigen::Index kRows = 20;
  const Eigen::Index of_channel = kTrials * kRows;
  Random random(3);
  Matrix columns = Matrix::Zero(kChannels * of_channel, kChannels * (kTrials * 9 + 4) + 3);
  Eigen::Index c = 0;
  const auto add = [&](Eigen::Index first, Eigen::Index rows) {
    for (Eigen::Index r = first; r < first + rows; ++r) columns(r, c) = random.Normal();
    ++c;
  };
  for (Eigen::Index channel = 0; channel < kChannels; ++channel) {
    for (Eigen::Index trial = 0; trial < kTrials; ++trial) {
      for (int i = 0; i < 9; ++i) add(channel * of_channel + trial * kRows, kRows);
    }
    for (int i = 0; i < 4; ++i) add(channel * of_channel, of_channel);
  }
  for (int i = 0; i < 2; ++i) add(0, columns.rows());
  columns.col(c) = columns.col(0) - columns.col(kTrials * 9) + columns.col(c - 1);
  const ColumnSpace space(columns, kThreshold);
  EXPECT_EQ(space.rank(), columns.cols() - 1);
  const Matrix rows = RandomRows(columns.rows(), 3);
  EXPECT_LT((space.TakenFrom(rows) - (rows - Projected(columns, rows))).norm(), 1e-9);
  EXPECT_LT((columns * space.Solve(rows) - Projected(columns, rows)).norm(), 1e-9);
  const Vector leverage = Projected(columns, Matrix::Identity(columns.rows(), columns.rows())).diagonal();
  EXPECT_LT((space.Leverage() - leverage).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(ColumnSpace, OfNoColumnsIsEmpty) {
  const Matrix rows = RandomRows(20, 2);
  const ColumnSpace space(Matrix::Zero(20, 3), kThreshold);
  EXPECT_EQ(space.rank(), 0);
  EXPECT_EQ(space.TakenFrom(rows), rows);
  EXPECT_EQ(space.Solve(rows), Matrix::Zero(3, 2));
  EXPECT_EQ(space.Leverage(), Vector::Zero(20));
}

}  // namespace
}  // namespace sinew
