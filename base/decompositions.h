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

extern template class LDLT<MatrixXd>;
extern template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

extern template class ColPivHouseholderQR<MatrixXd>;
extern template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

extern template class SelfAdjointEigenSolver<MatrixXd>;
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);

extern template class EigenSolver<MatrixXd>;
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);

extern template class JacobiSVD<MatrixXd>;

}  // namespace Eigen
