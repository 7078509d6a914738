// Eigen's decompositions of a Matrix. Each costs a compiler seconds; here they are compiled once, in
// decompositions.cpp and singular_values.cpp. An expression (a product, a block) must become a Matrix first,
// or the decomposition is compiled again for it. For other types of matrices (a Ref) include Eigen's own
// header.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "base/linear_algebra.h"

namespace Eigen {  // NOLINT(readability-identifier-naming): Eigen's

extern template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template void LLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

extern template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
extern template void LDLT<MatrixXd>::_solve_impl(const MatrixXd::IdentityReturnType&, MatrixXd&) const;

extern template void ColPivHouseholderQR<MatrixXd>::computeInPlace();
extern template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);

extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);

extern template JacobiSVD<MatrixXd>& JacobiSVD<MatrixXd>::compute(const MatrixXd&, unsigned int);

}  // namespace Eigen

namespace sinew {

/// Orthonormal basis [m x rank] of the columns that were decomposed.
Matrix OrthonormalBasis(const Eigen::ColPivHouseholderQR<Matrix>& qr);

/// The shortest of the least-squares solutions of a x = b, whatever the rank of a [m x n].
Vector MinimumNormSolution(const Matrix& a, const Vector& b);

}  // namespace sinew
