#include "base/symmetric_solver.h"

#include "base/decompositions.h"

namespace sinew {
namespace {

// The decomposition of a large matrix without square roots is not blocked, and several times slower.
constexpr Eigen::Index kLarge = 96;

using Decomposition = std::variant<BlockCholesky, SparseCholesky, Eigen::LLT<Matrix>, Eigen::LDLT<Matrix>>;

Decomposition Decompose(const SymmetricView& view) {
  if (view.size() >= kLarge) {
    if (BlockCholesky blocks(view); blocks.usable()) return blocks;
  }
  const Matrix matrix = view.Full();
  if (SparseCholesky sparse(matrix); sparse.usable()) return sparse;
  if (matrix.rows() >= kLarge) {
    if (Eigen::LLT<Matrix> root(matrix); root.info() == Eigen::Success) return root;
  }
  return Eigen::LDLT<Matrix>(matrix);
}

}  // namespace

SymmetricSolver::SymmetricSolver(const SymmetricView& matrix) : decomposition_(Decompose(matrix)) {}

Vector SymmetricSolver::Solve(const Vector& right) const {
  if (const auto* blocks = std::get_if<BlockCholesky>(&decomposition_)) return blocks->Solve(right);
  if (const auto* sparse = std::get_if<SparseCholesky>(&decomposition_)) return sparse->Solve(right);
  if (const auto* root = std::get_if<Eigen::LLT<Matrix>>(&decomposition_)) return root->solve(right);
  return std::get<Eigen::LDLT<Matrix>>(decomposition_).solve(right);
}

bool SymmetricSolver::positive_definite() const {
  const auto* full = std::get_if<Eigen::LDLT<Matrix>>(&decomposition_);
  return full == nullptr || (full->info() == Eigen::Success && full->vectorD().minCoeff() > 0);
}

double SymmetricSolver::LogDeterminant() const {
  if (const auto* blocks = std::get_if<BlockCholesky>(&decomposition_)) return blocks->LogDeterminant();
  if (const auto* sparse = std::get_if<SparseCholesky>(&decomposition_)) return sparse->LogDeterminant();
  if (const auto* root = std::get_if<Eigen::LLT<Matrix>>(&decomposition_))
    return 2 * root->matrixLLT().diagonal().array().log().sum();
  return std::get<Eigen::LDLT<Matrix>>(decomposition_).vectorD().array().log().sum();
}

}  // namespace sinew
