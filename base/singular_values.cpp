// The part of decompositions.h that costs a compiler most, apart so that two cores share the work.
#include "base/decompositions.h"

namespace Eigen {  // NOLINT(readability-identifier-naming): Eigen's

template class EigenSolver<MatrixXd>;
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);

template class JacobiSVD<MatrixXd>;

}  // namespace Eigen
