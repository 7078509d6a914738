// The load of a foot that agrees best with what is known of it, without a model of the contact.
#pragma once

#include <vector>

#include "problems/contact/steps/step_estimate.h"

namespace sinew {

struct LoadEstimate {
  std::vector<ContactLoad> load;                          ///< [T]; zero where nothing is known
  std::vector<Eigen::Matrix<double, 6, 6>> covariance{};  ///< [T]
};

/// Linear least squares of independent rows.
/// @param rows at every instant that any of them names, they determine all six components
/// @param instants T
[[nodiscard]] LoadEstimate EstimateLoad(const std::vector<LoadRow>& rows, std::size_t instants);

}  // namespace sinew
