#include "base/sparse_cholesky.h"

#include <Eigen/SparseCholesky>
#include <vector>

namespace sinew {
namespace {

constexpr Eigen::Index kFewColumns = 64;
constexpr double kFull = 0.3;  // share of entries that are not zero

}  // namespace

struct SparseCholesky::Decomposition {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> of;
};

SparseCholesky::SparseCholesky(const Matrix& lower) {
  const Eigen::Index n = lower.rows();
  if (n < kFewColumns) return;
  const auto most = static_cast<std::size_t>(0.5 * kFull * static_cast<double>(n) * static_cast<double>(n));
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index c = 0; c < n; ++c) {
    for (Eigen::Index r = c; r < n; ++r) {
      if (lower(r, c) != 0) entries.emplace_back(static_cast<int>(r), static_cast<int>(c), lower(r, c));
    }
    if (entries.size() > most) return;
  }
  Eigen::SparseMatrix<double> sparse(n, n);
  sparse.setFromTriplets(entries.begin(), entries.end());
  auto made = std::make_unique<Decomposition>();
  made->of.compute(sparse);
  if (made->of.info() != Eigen::Success || !(made->of.vectorD().minCoeff() > 0)) return;
  decomposition_ = std::move(made);
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

bool SparseCholesky::usable() const {
  return decomposition_ != nullptr;
}

Vector SparseCholesky::Solve(const Vector& right) const {
  return decomposition_->of.solve(right);
}

double SparseCholesky::LogDeterminant() const {
  return decomposition_->of.vectorD().array().log().sum();
}

}  // namespace sinew
