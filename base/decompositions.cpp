#include "base/decompositions.h"

namespace Eigen {  // NOLINT(readability-identifier-naming): Eigen's

template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template void LLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
template void LDLT<MatrixXd>::_solve_impl(const MatrixXd::IdentityReturnType&, MatrixXd&) const;

template void ColPivHouseholderQR<MatrixXd>::computeInPlace();
template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);

}  // namespace Eigen

namespace sinew {

Matrix OrthonormalBasis(const Eigen::ColPivHouseholderQR<Matrix>& qr) {
  return qr.householderQ() * Matrix::Identity(qr.rows(), qr.rank());
}

Vector MinimumNormSolution(const Matrix& a, const Vector& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

}  // namespace sinew
