#include "base/column_space.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace sinew {
namespace {

struct Limits {
  Eigen::Index columns;  // of a group
  double rows;           // share of all rows that a group touches
};
// Gains of single cycles, then the columns of a trial, then those of a channel.
constexpr std::array<Limits, 3> kLevels{{{8, 0.05}, {1000, 0.1}, {1000, 0.5}}};

Eigen::ColPivHouseholderQR<Matrix> DecomposeColumns(const Matrix& columns, double threshold) {
  Eigen::ColPivHouseholderQR<Matrix> qr;
  qr.setThreshold(threshold);
  qr.compute(columns);
  return qr;
}

// A column within the span of what was taken from it leaves rounding errors, which would be scaled to unit
// length.
Matrix SetNegligibleToZero(Matrix columns, double threshold) {
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    if (columns.col(c).norm() <= threshold) columns.col(c).setZero();
  }
  return columns;
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
        size_(static_cast<std::size_t>(columns)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  [[nodiscard]] Eigen::Index Root(Eigen::Index column) const {
    while (parent_[static_cast<std::size_t>(column)] != column)
      column = parent_[static_cast<std::size_t>(column)];
    return column;
  }

  // Joins the column to those that own its rows, unless the group became too large.
  bool Add(Eigen::Index column, const std::vector<Eigen::Index>& rows, Eigen::Index most_columns,
           Eigen::Index most_rows) {
    std::vector<Eigen::Index> roots;
    Size together{1, 0};
    for (const Eigen::Index row : rows) {
      const Eigen::Index owner = owner_[static_cast<std::size_t>(row)];
      if (owner < 0) {
        ++together.rows;
        continue;
      }
      const Eigen::Index root = Root(owner);
      if (std::find(roots.begin(), roots.end(), root) != roots.end()) continue;
      roots.push_back(root);
      together.columns += size_[static_cast<std::size_t>(root)].columns;
      together.rows += size_[static_cast<std::size_t>(root)].rows;
    }
    if (together.columns > most_columns || together.rows > most_rows) return false;
    for (const Eigen::Index root : roots) parent_[static_cast<std::size_t>(root)] = column;
    size_[static_cast<std::size_t>(column)] = together;
    for (const Eigen::Index row : rows) owner_[static_cast<std::size_t>(row)] = column;
    return true;
  }

 private:
  struct Size {
    Eigen::Index columns = 0;
    Eigen::Index rows = 0;
  };
  std::vector<Eigen::Index> owner_;
  std::vector<Eigen::Index> parent_;
  std::vector<Size> size_;
};

}  // namespace

ColumnSpace::ColumnSpace(const Matrix& columns, double threshold)
    : height_(columns.rows()), length_(columns.colwise().norm()) {
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    if (length_[c] > 0) others_.push_back(c);
  }
  for (const Limits& limits : kLevels) {
    AddLevel(columns, limits.columns, limits.rows);
    Decompose(levels_.back(), threshold);
    for (const Group& group : levels_.back()) rank_ += group.qr.rank();
  }
  wide_.resize(height_, static_cast<Eigen::Index>(others_.size()));
  for (Eigen::Index c = 0; c < wide_.cols(); ++c) {
    const Eigen::Index column = others_[static_cast<std::size_t>(c)];
    wide_.col(c) = columns.col(column) / length_[column];
  }
  if (wide_.cols() == 0) return;
  Matrix left = wide_;
  TakeLevelsFrom(left, levels_.size());
  qr_ = DecomposeColumns(SetNegligibleToZero(std::move(left), threshold), threshold);
  basis_ = OrthonormalBasis(qr_);
  rank_ += qr_.rank();
}

// Rows that a column touches, once what is taken from it by the groups so far is included; increasing.
std::vector<Eigen::Index> ColumnSpace::Touched(const Matrix& columns, Eigen::Index column) const {
  std::vector<bool> touched(static_cast<std::size_t>(height_), false);
  for (Eigen::Index r = 0; r < height_; ++r) touched[static_cast<std::size_t>(r)] = columns(r, column) != 0;
  for (const Level& level : levels_) {
    for (const Group& group : level) {
      const bool any = std::any_of(group.rows.begin(), group.rows.end(),
                                   [&](Eigen::Index r) { return touched[static_cast<std::size_t>(r)]; });
      if (!any) continue;
      for (const Eigen::Index r : group.rows) touched[static_cast<std::size_t>(r)] = true;
    }
  }
  std::vector<Eigen::Index> rows;
  for (Eigen::Index r = 0; r < height_; ++r) {
    if (touched[static_cast<std::size_t>(r)]) rows.push_back(r);
  }
  return rows;
}

void ColumnSpace::AddLevel(const Matrix& columns, Eigen::Index most_columns, double most_rows) {
  const auto most = static_cast<Eigen::Index>(most_rows * static_cast<double>(height_));
  std::vector<std::pair<std::size_t, Eigen::Index>> sparse;  // rows touched, column
  std::vector<std::vector<Eigen::Index>> touched(static_cast<std::size_t>(columns.cols()));
  std::vector<Eigen::Index> left;
  for (const Eigen::Index c : others_) {
    std::vector<Eigen::Index>& rows = touched[static_cast<std::size_t>(c)];
    rows = Touched(columns, c);
    if (static_cast<Eigen::Index>(rows.size()) <= most) {
      sparse.emplace_back(rows.size(), c);
    } else {
      left.push_back(c);
    }
  }
  std::sort(sparse.begin(), sparse.end());
  Unions unions(height_, columns.cols());
  std::vector<Eigen::Index> grouped;
  for (const auto& [count, c] : sparse) {
    const bool joined = unions.Add(c, touched[static_cast<std::size_t>(c)], most_columns, most);
    (joined ? grouped : left).push_back(c);
  }
  std::sort(left.begin(), left.end());
  others_ = std::move(left);
  Level level;
  std::vector<Eigen::Index> group_of(static_cast<std::size_t>(columns.cols()), -1);
  for (const Eigen::Index c : grouped) {
    Eigen::Index& group = group_of[static_cast<std::size_t>(unions.Root(c))];
    if (group < 0) {
      group = static_cast<Eigen::Index>(level.size());
      level.emplace_back();
    }
    Group& of = level[static_cast<std::size_t>(group)];
    of.columns.push_back(c);
    const auto& rows = touched[static_cast<std::size_t>(c)];
    of.rows.insert(of.rows.end(), rows.begin(), rows.end());
  }
  for (Group& group : level) {
    std::sort(group.rows.begin(), group.rows.end());
    group.rows.erase(std::unique(group.rows.begin(), group.rows.end()), group.rows.end());
    group.unit.resize(static_cast<Eigen::Index>(group.rows.size()),
                      static_cast<Eigen::Index>(group.columns.size()));
    for (Eigen::Index c = 0; c < group.unit.cols(); ++c) {
      const Eigen::Index column = group.columns[static_cast<std::size_t>(c)];
      for (Eigen::Index r = 0; r < group.unit.rows(); ++r)
        group.unit(r, c) = columns(group.rows[static_cast<std::size_t>(r)], column) / length_[column];
    }
  }
  levels_.push_back(std::move(level));
}

// The last level.
void ColumnSpace::Decompose(Level& level, double threshold) const {
  for (Group& group : level) {
    Matrix left = group.unit;
    if (levels_.size() > 1) {
      Matrix all = Matrix::Zero(height_, left.cols());
      for (std::size_t r = 0; r < group.rows.size(); ++r)
        all.row(group.rows[r]) = left.row(static_cast<Eigen::Index>(r));
      TakeLevelsFrom(all, levels_.size() - 1);
      left = SetNegligibleToZero(RowsOf(group, all), threshold);
    }
    group.qr = DecomposeColumns(left, threshold);
    group.basis = OrthonormalBasis(group.qr);
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

// What the first `levels` levels span.
void ColumnSpace::TakeLevelsFrom(Matrix& rows, std::size_t levels) const {
  for (std::size_t level = 0; level < levels; ++level) {
    for (const Group& group : levels_[level]) {
      const Matrix own = RowsOf(group, rows);
      if (own.isZero(0)) continue;
      const Matrix taken = ProjectionOnto(group.basis, own);
      for (Eigen::Index c = 0; c < rows.cols(); ++c) {
        for (Eigen::Index r = 0; r < own.rows(); ++r)
          rows(group.rows[static_cast<std::size_t>(r)], c) -= taken(r, c);
      }
    }
  }
}

Matrix ColumnSpace::TakenFrom(Matrix rows) const {
  TakeLevelsFrom(rows, levels_.size());
  if (basis_.cols() > 0) rows -= ProjectionOnto(basis_, rows);
  return rows;
}

Matrix ColumnSpace::Solve(const Matrix& rows) const {
  Matrix answer = Matrix::Zero(length_.size(), rows.cols());
  const auto keep = [&](const std::vector<Eigen::Index>& columns, const Matrix& found) {
    for (Eigen::Index c = 0; c < found.rows(); ++c) {
      const Eigen::Index column = columns[static_cast<std::size_t>(c)];
      answer.row(column) = found.row(c) / length_[column];
    }
  };
  Matrix left = rows;
  if (wide_.cols() > 0) {
    Matrix outside = rows;
    TakeLevelsFrom(outside, levels_.size());
    const Matrix found = SolveBy(qr_, outside);
    left -= wide_ * found;
    keep(others_, found);
  }
  for (std::size_t level = levels_.size(); level-- > 0;) {
    if (levels_[level].empty()) continue;
    Matrix outside = left;
    TakeLevelsFrom(outside, level);
    for (const Group& group : levels_[level]) {
      const Matrix found = SolveBy(group.qr, RowsOf(group, outside));
      const Matrix explained = group.unit * found;
      for (std::size_t r = 0; r < group.rows.size(); ++r)
        left.row(group.rows[r]) -= explained.row(static_cast<Eigen::Index>(r));
      keep(group.columns, found);
    }
  }
  return answer;
}

Vector ColumnSpace::Leverage() const {
  Vector leverage = Vector::Zero(height_);
  if (basis_.cols() > 0) leverage = basis_.rowwise().squaredNorm();
  for (const Level& level : levels_) {
    for (const Group& group : level) {
      for (std::size_t r = 0; r < group.rows.size(); ++r)
        leverage[group.rows[r]] += group.basis.row(static_cast<Eigen::Index>(r)).squaredNorm();
    }
  }
  return leverage;
}

}  // namespace sinew
