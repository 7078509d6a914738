// The linear-algebra types of sinew: Eigen, double, column-major.
#pragma once

#include <Eigen/Core>

#include "base/matrix_products.h"

namespace sinew {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using VectorRef = Eigen::Ref<const Eigen::VectorXd>;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

// Products that many files need: every file that writes them out costs a compiler a second.
/// a' a [n x n] of a [m x n].
Matrix Gram(const Matrix& a);
/// basis basis' rows [m x k], for an orthonormal basis [m x n] and rows [m x k].
Matrix ProjectionOnto(const Matrix& basis, const Matrix& rows);

}  // namespace sinew
