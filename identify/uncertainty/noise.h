// How much the measurements scatter: stated by the data, or estimated once per channel from the residuals.
#pragma once

#include <string>
#include <vector>

#include "identify/least_squares.h"
#include "identify/uncertainty/linearization.h"

namespace sinew::uncertainty {

struct ChannelNoise {
  std::string channel;
  std::string unit;
  double sigma = 0;        ///< [unit] standard deviation of one sample
  bool known = false;      ///< every block of the channel states its sigma (then the largest is shown)
  double relative = 0;     ///< root mean square residual over root mean square measurement
  double correlation = 0;  ///< lag-one autocorrelation of the residuals
};

struct Noise {
  std::vector<ChannelNoise> channels;
  Vector deviation;               ///< [m] standard deviation of each weighted residual; 1 for priors
  double degrees_of_freedom = 0;  ///< of the estimated levels; infinite if all are known
  double residual_scale = 0;      ///< root of the weighted sum of squares over its degrees of freedom

  [[nodiscard]] const ChannelNoise* Find(const std::string& channel) const;
};

/// Known levels are taken as stated. All other blocks of one channel share one level: root of their sum of
/// squared residuals over (samples - leverage), where the leverage is what the fit has spent on them. A
/// channel on which the fit has spent everything takes the level of all channels together.
/// @param leverage [m] of every row, as in Information.
/// Errors: a level must be estimated, but there are not more residuals than fitted values.
Result<Noise> EstimateNoise(const LeastSquares& problem, const Linearization& at, const Vector& leverage);

}  // namespace sinew::uncertainty
