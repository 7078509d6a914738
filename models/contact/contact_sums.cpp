#include "models/contact/contact_sums.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/assert.h"

namespace sinew {
namespace {

// Columns of the prepared sums: what multiplies mu_s, mu_d, mu_v in the friction along x, along z, and in its
// moment about y; then the point of application.
enum Column { kAlongX = 0, kAlongZ = 3, kAboutY = 6, kPointX = 9, kPointZ = 10, kColumns = 11 };

int ColumnsFor(WrenchParts parts) {
  switch (parts) {
    case WrenchParts::kVertical:
      return 0;
    case WrenchParts::kForce:
      return kAboutY;
    case WrenchParts::kAll:
      return kColumns;
  }
  return kColumns;
}

// Friction per unit of normal force for mu_s, mu_d, mu_v = 1 (eq 5.2 is linear in them).
std::array<double, 3> FrictionLaw(double slip, double transition_velocity) {
  const double ratio = slip / transition_velocity;
  const double onset = std::min(ratio, 1.0);
  const double peak = 2 / (1 + ratio * ratio);
  return {onset * peak, onset * (1 - peak), slip};
}

}  // namespace

ContactSums::ContactSums(const std::vector<const ContactKinematics*>& regions, double transition_velocity) {
  SINEW_ASSERT(!regions.empty(), "a group without a contact region");
  const int instants = regions.front()->instants;
  // Counted before anything is kept: of a fine mesh there are millions.
  first_.push_back(0);
  for (int t = 0; t < instants; ++t) {
    Eigen::Index touching = 0;
    for (const ContactKinematics* region : regions) {
      SINEW_ASSERT(region->instants == instants, "regions of one group with different instants");
      const auto faces = static_cast<std::size_t>(region->faces);
      const double* depth = region->depth.data() + static_cast<std::size_t>(t) * faces;
      touching += std::count_if(depth, depth + faces, [](double one) { return one > 0; });
    }
    first_.push_back(first_.back() + touching);
    most_touching_ = std::max(most_touching_, static_cast<int>(touching));
  }

  area_depth_.resize(first_.back());
  rate_.resize(first_.back());
  columns_.setZero(first_.back(), kColumns);
  Eigen::Index row = 0;
  for (int t = 0; t < instants; ++t) {
    for (const ContactKinematics* region : regions) {
      for (int f = 0; f < region->faces; ++f) {
        const auto i = static_cast<std::size_t>(t) * static_cast<std::size_t>(region->faces) +
                       static_cast<std::size_t>(f);
        if (!(region->depth[i] > 0)) continue;
        area_depth_[row] = region->area[static_cast<std::size_t>(f)] * region->depth[i];
        rate_[row] = region->rate[i];
        columns_(row, kPointX) = region->point_x[i];
        columns_(row, kPointZ) = region->point_z[i];
        const double slip = std::hypot(region->slip_x[i], region->slip_z[i]);
        if (slip > 0) {
          const auto law = FrictionLaw(slip, transition_velocity);
          const double along_x = -region->slip_x[i] / slip;
          const double along_z = -region->slip_z[i] / slip;
          for (int j = 0; j < 3; ++j) {
            const double friction = law[static_cast<std::size_t>(j)];
            columns_(row, kAlongX + j) = friction * along_x;
            columns_(row, kAlongZ + j) = friction * along_z;
            columns_(row, kAboutY + j) =
                friction * (region->point_z[i] * along_x - region->point_x[i] * along_z);
          }
        }
        ++row;
      }
    }
  }
}

void ContactSums::Add(int instant, const ElasticFoundation& p, WrenchParts parts, Workspace& workspace,
                      ContactLoad& load, ContactLoadJacobian* jacobian) const {
  const Eigen::Index first = first_[static_cast<std::size_t>(instant)];
  const Eigen::Index count = first_[static_cast<std::size_t>(instant) + 1] - first;
  if (jacobian != nullptr) jacobian->setZero();
  if (count == 0) return;

  // Weights of the faces, and their derivative for the dissipation; a face that would pull weighs nothing.
  const double* area_depth = area_depth_.data() + first;
  const double* rate = rate_.data() + first;
  double* weight = workspace.weight.data();
  double* slope = workspace.weight_by_dissipation.data();
  double total = 0;
  double total_slope = 0;
#pragma omp simd reduction(+ : total, total_slope)
  for (Eigen::Index i = 0; i < count; ++i) {
    const double damping = 1 + p.dissipation * rate[i];
    const double pressing = damping > 0 ? area_depth[i] : 0;
    weight[i] = pressing * damping;
    slope[i] = pressing * rate[i];
    total += weight[i];
    total_slope += slope[i];
  }

  const double k = p.stiffness;
  load[kForceY] += k * total;
  if (jacobian != nullptr) {
    (*jacobian)(kForceY, 0) = total;
    (*jacobian)(kForceY, 1) = k * total_slope;
  }
  const int columns = ColumnsFor(parts);
  if (columns == 0) return;

  std::array<double, kColumns> sum{};
  std::array<double, kColumns> sum_slope{};
  for (int j = 0; j < columns; ++j) {
    const double* column = columns_.col(j).data() + first;
    double s = 0;
    double ds = 0;
    if (jacobian == nullptr) {
#pragma omp simd reduction(+ : s)
      for (Eigen::Index i = 0; i < count; ++i) s += weight[i] * column[i];
    } else {
#pragma omp simd reduction(+ : s, ds)
      for (Eigen::Index i = 0; i < count; ++i) {
        s += weight[i] * column[i];
        ds += slope[i] * column[i];
      }
    }
    sum[static_cast<std::size_t>(j)] = s;
    sum_slope[static_cast<std::size_t>(j)] = ds;
  }

  const std::array<double, 3> mu{p.static_friction, p.dynamic_friction, p.viscous_friction};
  const auto add_friction = [&](ContactLoadRow row, std::size_t column) {
    double value = 0;
    double value_slope = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      value += mu[j] * sum[column + j];
      value_slope += mu[j] * sum_slope[column + j];
      if (jacobian != nullptr) (*jacobian)(row, 2 + static_cast<Eigen::Index>(j)) = k * sum[column + j];
    }
    load[row] += k * value;
    if (jacobian != nullptr) {
      (*jacobian)(row, 0) = value;
      (*jacobian)(row, 1) = k * value_slope;
    }
  };
  add_friction(kForceX, kAlongX);
  add_friction(kForceZ, kAlongZ);
  if (parts != WrenchParts::kAll) return;

  add_friction(kMomentY, kAboutY);
  const auto add_first_moment = [&](ContactLoadRow row, std::size_t column) {
    load[row] += k * sum[column];
    if (jacobian != nullptr) {
      (*jacobian)(row, 0) = sum[column];
      (*jacobian)(row, 1) = k * sum_slope[column];
    }
  };
  add_first_moment(kFirstMomentX, kPointX);
  add_first_moment(kFirstMomentZ, kPointZ);
}

}  // namespace sinew
