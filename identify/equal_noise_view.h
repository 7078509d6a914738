// A problem whose trials are weighted by their noise, whatever its own objective does.
#pragma once

#include "identify/problem_view.h"

namespace sinew {

/// The weights of a channel are inverse noise levels up to one factor: its stated levels where every fitted
/// trial has one, else the same level in all trials, because the same sensor measured them. The factor keeps
/// the sum of squared weights over the fitted samples of the channel, so that its share in the cost and that
/// of penalties remain. Blocks of a range (penalties) keep their weights.
class EqualNoiseView final : public ProblemView {
 public:
  explicit EqualNoiseView(const Problem& inner);

  [[nodiscard]] std::string objective() const override;
  [[nodiscard]] bool weights_are_noise_levels() const override { return true; }
};

}  // namespace sinew
