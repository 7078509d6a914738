#include "base/column_space.h"

#include <algorithm>
#include <numeric>

namespace sinew {
namespace {

constexpr Eigen::Index kLargestGroup = 8;  // columns
constexpr double kSparse = 0.05;           // share of the rows that a column of a group touches at most

Eigen::ColPivHouseholderQR<Matrix> Decompose(const Matrix& columns, double threshold) {
  Eigen::ColPivHouseholderQR<Matrix> qr;
  qr.setThreshold(threshold);
  qr.compute(columns);
  return qr;
}

// Solved for the independent columns alone: Eigen's own solve would divide by the rounding errors of the
// dependent ones.
Matrix SolveBy(const Eigen::ColPivHouseholderQR<Matrix>& qr, const Matrix& rows) {
  const Eigen::Index rank = qr.rank();
  Matrix pivoted = Matrix::Zero(qr.cols(), rows.cols());
  const Matrix turned = qr.householderQ().adjoint() * rows;
  pivoted.topRows(rank) =
      qr.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(turned.topRows(rank));
  return qr.colsPermutation() * pivoted;
}

// Which columns touch common rows.
class Unions {
 public:
  Unions(Eigen::Index rows, Eigen::Index columns)
      : owner_(static_cast<std::size_t>(rows), -1),
        parent_(static_cast<std::size_t>(columns)),
        size_(static_cast<std::size_t>(columns), 1) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  [[nodiscard]] Eigen::Index Root(Eigen::Index column) const {
    while (parent_[static_cast<std::size_t>(column)] != column)
      column = parent_[static_cast<std::size_t>(column)];
    return column;
  }

  // Joins the column to those that own its rows, unless the group became too large.
  bool Add(Eigen::Index column, const std::vector<Eigen::Index>& rows) {
    std::vector<Eigen::Index> roots;
    Eigen::Index together = 1;
    for (const Eigen::Index row : rows) {
      const Eigen::Index owner = owner_[static_cast<std::size_t>(row)];
      if (owner < 0) continue;
      const Eigen::Index root = Root(owner);
      if (std::find(roots.begin(), roots.end(), root) != roots.end()) continue;
      roots.push_back(root);
      together += size_[static_cast<std::size_t>(root)];
      if (together > kLargestGroup) return false;
    }
    for (const Eigen::Index root : roots) parent_[static_cast<std::size_t>(root)] = column;
    size_[static_cast<std::size_t>(column)] = together;
    for (const Eigen::Index row : rows) owner_[static_cast<std::size_t>(row)] = column;
    return true;
  }

 private:
  std::vector<Eigen::Index> owner_;
  std::vector<Eigen::Index> parent_;
  std::vector<Eigen::Index> size_;
};

}  // namespace

ColumnSpace::ColumnSpace(const Matrix& columns, double threshold)
    : height_(columns.rows()), length_(columns.colwise().norm()) {
  FindGroups(columns);
  for (Group& group : groups_) {
    Matrix scaled(static_cast<Eigen::Index>(group.rows.size()),
                  static_cast<Eigen::Index>(group.columns.size()));
    for (Eigen::Index c = 0; c < scaled.cols(); ++c) {
      const Eigen::Index column = group.columns[static_cast<std::size_t>(c)];
      for (Eigen::Index r = 0; r < scaled.rows(); ++r)
        scaled(r, c) = columns(group.rows[static_cast<std::size_t>(r)], column) / length_[column];
    }
    group.qr = Decompose(scaled, threshold);
    group.basis = OrthonormalBasis(group.qr);
    rank_ += group.qr.rank();
  }
  wide_.resize(height_, static_cast<Eigen::Index>(others_.size()));
  for (Eigen::Index c = 0; c < wide_.cols(); ++c) {
    const Eigen::Index column = others_[static_cast<std::size_t>(c)];
    wide_.col(c) = columns.col(column) / length_[column];
  }
  if (wide_.cols() == 0) return;
  Matrix left = wide_;
  TakeGroupsFrom(left);
  // A column within the span of the groups leaves rounding errors, which would be scaled to unit length.
  for (Eigen::Index c = 0; c < left.cols(); ++c) {
    if (left.col(c).norm() <= threshold) left.col(c).setZero();
  }
  qr_ = Decompose(left, threshold);
  basis_ = OrthonormalBasis(qr_);
  rank_ += qr_.rank();
}

void ColumnSpace::FindGroups(const Matrix& columns) {
  const auto most = static_cast<std::size_t>(kSparse * static_cast<double>(height_));
  std::vector<std::pair<std::size_t, Eigen::Index>> sparse;  // rows touched, column
  std::vector<std::vector<Eigen::Index>> touched(static_cast<std::size_t>(columns.cols()));
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    if (!(length_[c] > 0)) continue;
    std::vector<Eigen::Index>& rows = touched[static_cast<std::size_t>(c)];
    for (Eigen::Index r = 0; r < height_ && rows.size() <= most; ++r) {
      if (columns(r, c) != 0) rows.push_back(r);
    }
    if (rows.size() <= most) {
      sparse.emplace_back(rows.size(), c);
    } else {
      others_.push_back(c);
    }
  }
  std::sort(sparse.begin(), sparse.end());
  Unions unions(height_, columns.cols());
  std::vector<Eigen::Index> grouped;
  for (const auto& [count, c] : sparse)
    (unions.Add(c, touched[static_cast<std::size_t>(c)]) ? grouped : others_).push_back(c);
  std::sort(others_.begin(), others_.end());
  std::vector<Eigen::Index> group_of(static_cast<std::size_t>(columns.cols()), -1);
  for (const Eigen::Index c : grouped) {
    Eigen::Index& group = group_of[static_cast<std::size_t>(unions.Root(c))];
    if (group < 0) {
      group = static_cast<Eigen::Index>(groups_.size());
      groups_.emplace_back();
    }
    Group& of = groups_[static_cast<std::size_t>(group)];
    of.columns.push_back(c);
    const auto& rows = touched[static_cast<std::size_t>(c)];
    of.rows.insert(of.rows.end(), rows.begin(), rows.end());
  }
  for (Group& group : groups_) {
    std::sort(group.rows.begin(), group.rows.end());
    group.rows.erase(std::unique(group.rows.begin(), group.rows.end()), group.rows.end());
  }
}

Matrix ColumnSpace::RowsOf(const Group& group, const Matrix& all) {
  Matrix rows(static_cast<Eigen::Index>(group.rows.size()), all.cols());
  for (Eigen::Index c = 0; c < all.cols(); ++c) {
    for (Eigen::Index r = 0; r < rows.rows(); ++r)
      rows(r, c) = all(group.rows[static_cast<std::size_t>(r)], c);
  }
  return rows;
}

void ColumnSpace::TakeGroupsFrom(Matrix& rows) const {
  for (const Group& group : groups_) {
    const Matrix own = RowsOf(group, rows);
    const Matrix taken = ProjectionOnto(group.basis, own);
    for (Eigen::Index c = 0; c < rows.cols(); ++c) {
      for (Eigen::Index r = 0; r < own.rows(); ++r)
        rows(group.rows[static_cast<std::size_t>(r)], c) -= taken(r, c);
    }
  }
}

Matrix ColumnSpace::TakenFrom(Matrix rows) const {
  TakeGroupsFrom(rows);
  if (basis_.cols() > 0) rows -= ProjectionOnto(basis_, rows);
  return rows;
}

Matrix ColumnSpace::Solve(const Matrix& rows) const {
  Matrix answer = Matrix::Zero(length_.size(), rows.cols());
  Matrix left = rows;
  if (wide_.cols() > 0) {
    TakeGroupsFrom(left);
    const Matrix found = SolveBy(qr_, left);
    left = rows - wide_ * found;
    for (Eigen::Index c = 0; c < found.rows(); ++c) {
      const Eigen::Index column = others_[static_cast<std::size_t>(c)];
      answer.row(column) = found.row(c) / length_[column];
    }
  }
  for (const Group& group : groups_) {
    const Matrix own = RowsOf(group, left);
    const Matrix found = SolveBy(group.qr, own);
    for (Eigen::Index c = 0; c < found.rows(); ++c) {
      const Eigen::Index column = group.columns[static_cast<std::size_t>(c)];
      answer.row(column) = found.row(c) / length_[column];
    }
  }
  return answer;
}

Vector ColumnSpace::Leverage() const {
  Vector leverage = Vector::Zero(height_);
  if (basis_.cols() > 0) leverage = basis_.rowwise().squaredNorm();
  for (const Group& group : groups_) {
    for (std::size_t r = 0; r < group.rows.size(); ++r)
      leverage[group.rows[r]] += group.basis.row(static_cast<Eigen::Index>(r)).squaredNorm();
  }
  return leverage;
}

}  // namespace sinew
