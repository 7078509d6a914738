// The fast path of the elastic foundation: forces, moments and their exact derivatives for any parameters,
// from sums over the touching faces that are computed once.
//
// With the geometry given, the wrench is linear in all parameters but the dissipation:
//   w_i = a_i x_i max(0, 1 + c v_i),  F_y = k sum w_i,
//   F_x = -k sum w_i (mu_s S_i + mu_d D_i + mu_v V_i) e_x,i
// where S, D, V are the slip's part of the friction law and e its direction. So one instant takes a few dot
// products over contiguous arrays. A parameter that changes the geometry (floor height, tilt) uses
// ContactKinematics instead, which keeps every face, touching or not.
#pragma once

#include <vector>

#include "base/linear_algebra.h"
#include "models/contact/elastic_foundation.h"

namespace sinew {

/// How much of the wrench is wanted; less is faster.
enum class WrenchParts {
  kVertical,  ///< F_y
  kForce,     ///< F_x, F_y, F_z
  kAll        ///< and M_y, and the first moments of the normal force that give the centre of pressure
};

/// F_x, F_y, F_z [N]; M_y about the origin of the floor [N m]; sum of x n and sum of z n over the normal
/// forces n [N m].
using ContactLoad = Eigen::Matrix<double, 6, 1>;
enum ContactLoadRow { kForceX, kForceY, kForceZ, kMomentY, kFirstMomentX, kFirstMomentZ };
/// Derivatives of a ContactLoad with respect to k, c, mu_s, mu_d, mu_v.
using ContactLoadJacobian = Eigen::Matrix<double, 6, 5>;

class ContactSums {
 public:
  /// Scratch of one thread.
  struct Workspace {
    Vector weight;
    Vector weight_by_dissipation;
  };

  /// @param regions that share their parameters, all with the same instants.
  ContactSums(const std::vector<const ContactKinematics*>& regions, double transition_velocity);

  [[nodiscard]] int instants() const { return static_cast<int>(first_.size()) - 1; }
  /// Largest number of faces that touch at one instant.
  [[nodiscard]] int most_touching() const { return most_touching_; }
  [[nodiscard]] Workspace NewWorkspace() const { return {Vector(most_touching_), Vector(most_touching_)}; }

  /// Adds the load of this group at one instant, and its derivatives if jacobian is not null (that is set,
  /// not added). Allocates nothing. Rows that `parts` does not ask for are left alone (load) or zero
  /// (jacobian).
  void Add(int instant, const ElasticFoundation& parameters, WrenchParts parts, Workspace& workspace,
           ContactLoad& load, ContactLoadJacobian* jacobian) const;

 private:
  std::vector<Eigen::Index> first_;  // [instants + 1] first touching face of each instant
  Vector area_depth_;                // [touching]
  Vector rate_;                      // [touching]
  Matrix columns_;                   // [touching x 11], see the .cpp
  int most_touching_ = 0;
};

}  // namespace sinew
