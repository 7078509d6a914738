// Step 6: what a model brings on trials that it was never fitted to.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/refit.h"

namespace sinew::diagnosis {

/// The held-out trials as one model sees them.
class HeldOut {
 public:
  explicit HeldOut(const Problem& problem);

  [[nodiscard]] bool exists() const { return !blocks_.empty(); }
  /// Indices into the layout.
  [[nodiscard]] const std::vector<int>& blocks() const { return blocks_; }

  /// Weighted residuals [held-out blocks][samples], with every held-out trial's own nuisance values fitted.
  /// Errors: the problem's own.
  [[nodiscard]] Result<std::vector<Vector>> Residuals(const Vector& point) const;

  /// Adds `term(block)` (weighted, empty: nothing) to the residuals.
  void Add(const std::function<Vector(const Block&)>& term, std::vector<Vector>& residuals) const {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const Vector more = term(block(i));
      if (more.size() > 0) residuals[i] += more;
    }
  }

  /// Noise of the blocks that have one of their own, from the base model's residuals: what a cause does to
  /// them is judged against it. Errors: those of EstimateNoiseModel.
  [[nodiscard]] Status EstimateOwnNoise(const std::vector<Vector>& base);

  /// Sum of squared innovations of such residuals in units of their variance, by a noise model that was
  /// estimated on the training trials, or by their own.
  [[nodiscard]] double Innovations(const std::vector<Vector>& residuals,
                                   const noise::NoiseModel& noise) const;

  /// The same, of every group of samples (Block::group) in an order of their own; empty: there are none.
  [[nodiscard]] std::vector<double> InnovationsOfGroups(const std::vector<Vector>& residuals,
                                                        const noise::NoiseModel& noise) const;

  /// Pooled per quantity, with an interval from a moving-block bootstrap (Kuensch 1989) of the samples.
  /// @param floor per channel: standard deviation of the noise, weighted units (NoiseModel::ProcessDeviation)
  [[nodiscard]] std::vector<Gain> Gains(const std::vector<Vector>& before, const std::vector<Vector>& after,
                                        const noise::NoiseModel& floor, std::uint64_t seed) const;

 private:
  [[nodiscard]] const Block& block(std::size_t i) const {
    return problem_.layout()[static_cast<std::size_t>(blocks_[i])];
  }
  /// Of a block; null if nothing knows.
  [[nodiscard]] const noise::ChannelNoiseModel* NoiseOf(const Block& block,
                                                        const noise::NoiseModel& trained) const;
  [[nodiscard]] Vector WhitenedBlock(std::size_t i, const Vector& residual,
                                     const noise::NoiseModel& noise) const;
  [[nodiscard]] double FloorOf(const Block& block, const noise::NoiseModel& trained) const;

  const Problem& problem_;
  std::vector<int> blocks_;
  noise::NoiseModel own_;  // of channels
};

/// Standard deviation of the noise of a block, weighted: what the data state, else what the model says of its
/// channel, or of another fitted one of the same quantity; 0 if nothing knows.
[[nodiscard]] double NoiseFloorOf(const Block& block, const noise::NoiseModel& noise, const Layout& layout);

}  // namespace sinew::diagnosis
