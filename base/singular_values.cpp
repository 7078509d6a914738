// The part of decompositions.h that costs a compiler most, apart so that two cores share the work.
#include "base/decompositions.h"

namespace Eigen {  // NOLINT(readability-identifier-naming): Eigen's

template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);

template JacobiSVD<MatrixXd>& JacobiSVD<MatrixXd>::compute(const MatrixXd&, unsigned int);

}  // namespace Eigen
