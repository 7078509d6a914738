// The linear-algebra types of sinew: Eigen, double, column-major.
#pragma once

#include <Eigen/Core>

namespace sinew {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using VectorRef = Eigen::Ref<const Eigen::VectorXd>;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

}  // namespace sinew
