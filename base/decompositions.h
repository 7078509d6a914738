// Eigen's decompositions of a Matrix. Each costs a compiler seconds; here they are compiled once, in
// decompositions.cpp. For other types of matrices (an expression, a Ref) include Eigen's own header.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "base/linear_algebra.h"

namespace Eigen {  // NOLINT(readability-identifier-naming): Eigen's

extern template class LDLT<MatrixXd>;
extern template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

extern template class ColPivHouseholderQR<MatrixXd>;
extern template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

extern template class SelfAdjointEigenSolver<MatrixXd>;
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);

}  // namespace Eigen
