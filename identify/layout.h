// Which channels of which trials a problem predicts, and how predictions and measurements form residual
// blocks.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/range.h"

namespace sinew {

class LaterReadings;

/// kTrain: in the cost. kValidate: predicted and compared, never fitted (held out). kPredicted: predicted but
/// not compared, because the channel was not measured or not requested; used to compute what measuring it
/// would add.
enum class BlockRole { kTrain, kValidate, kPredicted };

[[nodiscard]] const char* ToString(BlockRole role);

/// One channel of one trial.
///
/// The problem predicts it on `prediction_time`, which may be denser and longer than the measurement so that
/// a sensor effect (a delay, a low-pass) can look beyond it. The residual of sample i is `weight *
/// (prediction[sample[i]] - measured[i])`.
struct Block {
  std::string trial;
  std::string channel;
  std::string quantity;  ///< readable name: "vertical force", the same for both plates. Empty: use
                         ///< the channel
  std::string unit;
  BlockRole role = BlockRole::kTrain;
  std::vector<double> prediction_time;  ///< [M, s, increasing]
  std::vector<int> sample;              ///< [N] indices into prediction_time, increasing; gaps are left out
  std::vector<double> measured;         ///< [N, unit], finite; empty for kPredicted without measurement
  double weight = 1;                    ///< [1/unit], > 0
  /// [N] or empty: factors > 0 on the weight of single samples, about 1, for noise whose level varies (EMG is
  /// noisier while the muscle is active). Noise models describe the residuals weighted in this way; errors in
  /// reports are not weighted by it.
  std::vector<double> relative_weight;
  std::optional<double> sigma;  ///< [unit] noise level, if known
  /// The noise is white, and its level is not below `sigma` where that is known. For predictions that
  /// estimate values of their own internally (the states of a toss): these estimates reduce and correlate the
  /// residual, so that an autoregression or a lower level estimated from it would describe the fit, not the
  /// noise.
  bool white = false;
  /// [s, > 0] Known bound on the correlation time of the noise, from how the channel was made: its
  /// autocorrelation decays at least as fast as exp(-t / noise_memory). Errors that last longer are not
  /// noise. (For an envelope it is the memory of its low-pass filter.)
  std::optional<double> noise_memory;
  /// kValidate, [N] or empty: group number of each sample, the same in all blocks of a trial. Samples of one
  /// group share an error beyond noise, such as a cycle whose gain and timing are not fitted. The noise model
  /// of such a block is estimated separately, because its errors are larger and smoother than those of fitted
  /// trials.
  std::vector<int> group;
  /// kPredicted only: range that the predicted values should stay in. `weight` then multiplies their distance
  /// from it.
  std::optional<Range> range;
  /// Where the measured values are sums over a finer record: what they read later, for the time offset of
  /// its sensor. nullptr: predictions are interpolated.
  std::shared_ptr<const LaterReadings> later;
  std::vector<int> columns;  ///< indices of the parameters that it can depend on, increasing

  /// Weight of sample i [1/unit].
  [[nodiscard]] double WeightOf(std::size_t i) const {
    return relative_weight.empty() ? weight : weight * relative_weight[i];
  }
  [[nodiscard]] int samples() const { return static_cast<int>(measured.size()); }
  [[nodiscard]] int predictions() const { return static_cast<int>(prediction_time.size()); }
};

using Layout = std::vector<Block>;

/// Checks sizes, order, finiteness and weights of every block; the error names the block.
[[nodiscard]] Status CheckLayout(const Layout& layout, int parameters);

/// Predicted values and derivatives of every block, in one allocation that is reused by all evaluations.
class Prediction {
 public:
  explicit Prediction(const Layout& layout);

  /// Predicted channel of block b [M].
  Eigen::Map<Vector> values(int b) { return {data_.data() + value_offset_[b], rows_[b]}; }
  [[nodiscard]] Eigen::Map<const Vector> values(int b) const {
    return {data_.data() + value_offset_[b], rows_[b]};
  }

  /// Derivatives of block b [M x columns, column-major]: column k is the derivative of its values with
  /// respect to parameter Block::columns[k].
  Eigen::Map<Matrix> derivatives(int b) {
    return {data_.data() + derivative_offset_[b], rows_[b], columns_[b]};
  }
  [[nodiscard]] Eigen::Map<const Matrix> derivatives(int b) const {
    return {data_.data() + derivative_offset_[b], rows_[b], columns_[b]};
  }

  /// Fills everything with NaN, so that entries which Predict did not set are found. A new prediction has NaN
  /// values and uninitialised derivatives.
  void Poison();

 private:
  std::vector<Eigen::Index> rows_;
  std::vector<Eigen::Index> columns_;
  std::vector<Eigen::Index> value_offset_;
  std::vector<Eigen::Index> derivative_offset_;
  Eigen::Index values_ = 0;  // number of predicted values in data_, before the derivatives
  Vector data_;
};

}  // namespace sinew
