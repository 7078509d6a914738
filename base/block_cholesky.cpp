#include "base/block_cholesky.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/decompositions.h"

namespace sinew {
namespace {

// Of the multiplications of a decomposition of the full matrix.
constexpr double kMostWork = 0.8;
// Smaller blocks leave full matrices no advantage over single entries (SparseCholesky).
constexpr std::size_t kSmallestBlock = 16;
// A column that is coupled to this many times as many others as the next one may be one of the few.
constexpr double kDrop = 1.2;
constexpr std::size_t kMostBorders = 12;
constexpr double kNearlyFull = 0.9;  // share of entries that are not zero

struct Couplings {
  std::vector<std::vector<int>> below;  // of each column, the rows that are not zero
  std::vector<int> count;               // of each column, and of its row
};

// Nothing of a matrix that is nearly full.
std::optional<Couplings> CouplingsOf(const SymmetricView& matrix) {
  const auto n = static_cast<std::size_t>(matrix.size());
  const auto most = static_cast<std::size_t>(kNearlyFull * 0.5 * static_cast<double>(n * n));
  Couplings couplings{std::vector<std::vector<int>>(n), std::vector<int>(n, 0)};
  std::size_t entries = 0;
  for (std::size_t c = 0; c < n; ++c) {
    entries += couplings.below[c > 0 ? c - 1 : 0].size();
    if (entries > most) return std::nullopt;
    for (std::size_t r = c + 1; r < n; ++r) {
      if (matrix.IsZero(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c))) continue;
      couplings.below[c].push_back(static_cast<int>(r));
      ++couplings.count[c];
      ++couplings.count[r];
    }
  }
  return couplings;
}

struct Partition {
  std::vector<int> border;
  std::vector<std::vector<int>> blocks;
  double work = 0;  // multiplications
};

// The connected parts of what is left without the border.
Partition PartitionBy(const Couplings& couplings, std::vector<int> border) {
  const std::size_t n = couplings.below.size();
  std::vector<bool> in_border(n, false);
  for (const int column : border) in_border[static_cast<std::size_t>(column)] = true;
  std::vector<int> parent(n);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int column) {
    while (parent[static_cast<std::size_t>(column)] != column) {
      int& up = parent[static_cast<std::size_t>(column)];
      up = parent[static_cast<std::size_t>(up)];
      column = up;
    }
    return column;
  };
  for (std::size_t c = 0; c < n; ++c) {
    if (in_border[c]) continue;
    for (const int r : couplings.below[c]) {
      if (!in_border[static_cast<std::size_t>(r)])
        parent[static_cast<std::size_t>(root(r))] = root(static_cast<int>(c));
    }
  }
  Partition partition;
  partition.border = std::move(border);
  std::vector<int> block_of(n, -1);
  for (std::size_t c = 0; c < n; ++c) {
    if (in_border[c]) continue;
    int& block = block_of[static_cast<std::size_t>(root(static_cast<int>(c)))];
    if (block < 0) {
      block = static_cast<int>(partition.blocks.size());
      partition.blocks.emplace_back();
    }
    partition.blocks[static_cast<std::size_t>(block)].push_back(static_cast<int>(c));
  }
  const auto few = static_cast<double>(partition.border.size());
  partition.work = few * few * few / 6;
  for (const auto& block : partition.blocks) {
    const auto size = static_cast<double>(block.size());
    partition.work += size * size * size / 6 + size * size * few / 2 + size * few * few / 2;
  }
  return partition;
}

// The border is where the counts of couplings drop: of what many trials share.
std::optional<Partition> FindBlocks(const SymmetricView& matrix) {
  const std::optional<Couplings> found = CouplingsOf(matrix);
  if (!found) return std::nullopt;
  const Couplings& couplings = *found;
  const std::size_t n = couplings.below.size();
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  const auto count = [&](std::size_t place) {
    return couplings.count[static_cast<std::size_t>(order[place])];
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return couplings.count[static_cast<std::size_t>(a)] > couplings.count[static_cast<std::size_t>(b)];
  });
  const auto columns = static_cast<double>(n);
  double least = kMostWork * columns * columns * columns / 6;
  std::optional<Partition> best;
  std::size_t tries = 0;
  for (std::size_t wide = 0; wide < n && tries < kMostBorders; ++wide) {
    if (wide > 0 && count(wide - 1) < kDrop * (1 + count(wide))) continue;
    ++tries;
    std::vector<int> border(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(wide));
    std::sort(border.begin(), border.end());
    Partition partition = PartitionBy(couplings, std::move(border));
    if (partition.work >= least) continue;
    least = partition.work;
    best = std::move(partition);
  }
  if (!best) return std::nullopt;
  std::size_t largest = 0;
  for (const auto& block : best->blocks) largest = std::max(largest, block.size());
  if (largest < kSmallestBlock) return std::nullopt;
  return best;
}

}  // namespace

BlockCholesky::BlockCholesky(const SymmetricView& matrix) {
  std::optional<Partition> partition = FindBlocks(matrix);
  if (!partition) return;
  border_ = std::move(partition->border);
  for (std::vector<int>& columns : partition->blocks) blocks_.push_back({std::move(columns), {}, {}, {}});
  usable_ = Decompose(matrix);
}

bool BlockCholesky::Decompose(const SymmetricView& matrix) {
  const auto few = static_cast<Eigen::Index>(border_.size());
  border_root_.resize(few, few);
  for (Eigen::Index c = 0; c < few; ++c) {
    for (Eigen::Index r = 0; r < few; ++r)
      border_root_(r, c) = matrix(border_[static_cast<std::size_t>(r)], border_[static_cast<std::size_t>(c)]);
  }
  Eigen::LLT<Matrix> llt;
  for (Block& block : blocks_) {
    const auto size = static_cast<Eigen::Index>(block.columns.size());
    Matrix own(size, size);
    for (Eigen::Index c = 0; c < size; ++c) {
      for (Eigen::Index r = c; r < size; ++r)
        own(r, c) =
            matrix(block.columns[static_cast<std::size_t>(r)], block.columns[static_cast<std::size_t>(c)]);
    }
    llt.compute(own);
    if (llt.info() != Eigen::Success) return false;
    block.root = llt.matrixLLT();
    for (std::size_t b = 0; b < border_.size(); ++b) {
      const bool coupled = std::any_of(block.columns.begin(), block.columns.end(),
                                       [&](int column) { return matrix(column, border_[b]) != 0; });
      if (coupled) block.border.push_back(static_cast<int>(b));
    }
    const auto wide = static_cast<Eigen::Index>(block.border.size());
    block.coupling.resize(size, wide);
    if (wide == 0) continue;
    for (Eigen::Index b = 0; b < wide; ++b) {
      const int column = border_[static_cast<std::size_t>(block.border[static_cast<std::size_t>(b)])];
      for (Eigen::Index r = 0; r < size; ++r)
        block.coupling(r, b) = matrix(block.columns[static_cast<std::size_t>(r)], column);
    }
    block.root.triangularView<Eigen::Lower>().solveInPlace(block.coupling);
    const Matrix taken = Gram(block.coupling);
    for (Eigen::Index b = 0; b < wide; ++b) {
      const int to = block.border[static_cast<std::size_t>(b)];
      for (Eigen::Index a = 0; a < wide; ++a)
        border_root_(block.border[static_cast<std::size_t>(a)], to) -= taken(a, b);
    }
  }
  if (few == 0) return true;
  llt.compute(border_root_);
  if (llt.info() != Eigen::Success) return false;
  border_root_ = llt.matrixLLT();
  return true;
}

Vector BlockCholesky::Solve(const Vector& right) const {
  Vector of_border(static_cast<Eigen::Index>(border_.size()));
  for (std::size_t b = 0; b < border_.size(); ++b)
    of_border[static_cast<Eigen::Index>(b)] = right[border_[b]];
  std::vector<Vector> forward;
  for (const Block& block : blocks_) {
    Vector& own = forward.emplace_back(static_cast<Eigen::Index>(block.columns.size()));
    for (Eigen::Index i = 0; i < own.size(); ++i) own[i] = right[block.columns[static_cast<std::size_t>(i)]];
    block.root.triangularView<Eigen::Lower>().solveInPlace(own);
    if (block.border.empty()) continue;
    const Vector taken = block.coupling.transpose() * own;
    for (Eigen::Index b = 0; b < taken.size(); ++b)
      of_border[block.border[static_cast<std::size_t>(b)]] -= taken[b];
  }
  if (!border_.empty()) {
    border_root_.triangularView<Eigen::Lower>().solveInPlace(of_border);
    border_root_.triangularView<Eigen::Lower>().transpose().solveInPlace(of_border);
  }
  Vector solution(right.size());
  for (std::size_t b = 0; b < border_.size(); ++b)
    solution[border_[b]] = of_border[static_cast<Eigen::Index>(b)];
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& block = blocks_[k];
    Vector coupled(static_cast<Eigen::Index>(block.border.size()));
    for (Eigen::Index b = 0; b < coupled.size(); ++b)
      coupled[b] = of_border[block.border[static_cast<std::size_t>(b)]];
    Vector& own = forward[k];
    if (coupled.size() > 0) own -= block.coupling * coupled;
    block.root.triangularView<Eigen::Lower>().transpose().solveInPlace(own);
    for (Eigen::Index i = 0; i < own.size(); ++i)
      solution[block.columns[static_cast<std::size_t>(i)]] = own[i];
  }
  return solution;
}

double BlockCholesky::LogDeterminant() const {
  double half = 0;
  if (!border_.empty()) half += border_root_.diagonal().array().log().sum();
  for (const Block& block : blocks_) half += block.root.diagonal().array().log().sum();
  return 2 * half;
}

}  // namespace sinew
