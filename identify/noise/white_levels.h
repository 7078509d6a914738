// Levels of white noise beside values with priors: hundreds of nuisance values that follow the data as far as
// their priors let them.
#pragma once

#include <vector>

#include "base/linear_algebra.h"
#include "identify/noise/noise_model.h"

namespace sinew::noise {

/// Restricted maximum likelihood (Patterson, Thompson 1971) of one level per channel, where the regressors
/// with a prior are random effects of known variance (Henderson 1975; Harville 1977). With residuals e of a
/// channel of n rows, and the degrees of freedom d that all values together take from it (the trace of its
/// part of the projection onto the regressors and priors), its level is sqrt(e'e / (n - d)).
class WhiteLevels {
 public:
  /// @param blocks as for EstimateNoiseModel @param priors of some regressors
  WhiteLevels(const std::vector<NoiseBlock>& blocks, const std::vector<PriorRow>& priors);

  /// Levels no lower than the largest stated one of a channel. @param like where to begin, may be null
  [[nodiscard]] NoiseModel Estimate(const NoiseModel* like) const;

  /// -2 log restricted likelihood of the levels of `model`, up to a constant.
  [[nodiscard]] double Deviance(const NoiseModel& model) const;

 private:
  struct Part {
    std::size_t channel = 0;
    std::vector<int> columns;
    Matrix gram;  // of the regressors
    Vector pull;  // regressors' residual
    double squares = 0;
  };
  struct Channel {
    std::string name;
    double rows = 0;
    double squares = 0;
    double least = 0;  // level
  };
  struct Solution {
    std::vector<double> squares;  // [channels] of what is left
    std::vector<double> spent;    // [channels] degrees of freedom
    double deviance = 0;
  };

  [[nodiscard]] Solution Solve(const std::vector<double>& variance, bool degrees) const;

  std::vector<Part> parts_;  // per block
  std::vector<Channel> channels_;
  std::vector<int> channel_of_;
  int columns_ = 0;
  Vector prior_precision_;  // [columns]
  Vector prior_pull_;       // [columns]
  double prior_squares_ = 0;
};

}  // namespace sinew::noise
