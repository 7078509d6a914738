// Which channels of which trials a problem predicts, and how they meet the measurement: residuals come in
// blocks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/range.h"

namespace sinew {

/// Train: in the cost. Validate: predicted and compared, never fitted. Predicted: the model can tell it but
/// it is not compared (not measured, or not asked for); used to say what measuring it would bring.
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
  std::string quantity;  ///< what it measures, for people: "vertical force"; alike for both plates. Empty:
                         ///< the channel
  std::string unit;
  BlockRole role = BlockRole::kTrain;
  std::vector<double> prediction_time;  ///< [M, s, increasing]
  std::vector<int> sample;              ///< [N] indices into prediction_time, increasing; gaps are left out
  std::vector<double> measured;         ///< [N, unit], finite; empty for kPredicted without measurement
  double weight = 1;                    ///< [1/unit], > 0
  /// [N] or empty: factors > 0 on the weight of single samples, about 1, where noise is not alike everywhere
  /// (EMG is noisier while the muscle is active). Noise models are those of residuals so weighted; errors
  /// that people read are not.
  std::vector<double> relative_weight;
  std::optional<double> sigma;  ///< [unit] noise level, if known
  /// The noise is white, and no lower than `sigma` where that is known. For predictions that fit values of
  /// their own inside (states of a toss): their residual has lost what these took up, so that an
  /// autoregression or a lower level estimated from it would be one of the fit.
  bool white = false;
  /// [s, > 0] What is known of how long errors last, from how the channel was made: their correlation fades
  /// as fast as exp(-t / noise_memory), or faster. What lasts longer is no noise. (An envelope forgets as
  /// fast as its filter.)
  std::optional<double> noise_memory;
  /// kValidate, [N] or empty: samples that share an error beyond noise have one number, the same in all
  /// blocks of a trial: a cycle whose gain and timing only a fit would tell. Such a block has a noise of its
  /// own, larger and smoother than that of fitted trials.
  std::vector<int> group;
  /// kPredicted only: where its values should stay. `weight` is that of the distance from it.
  std::optional<Range> range;
  std::vector<int> columns;  ///< parameters that it may depend on, increasing

  /// Of sample i [1/unit].
  [[nodiscard]] double WeightOf(std::size_t i) const {
    return relative_weight.empty() ? weight : weight * relative_weight[i];
  }
  [[nodiscard]] int samples() const { return static_cast<int>(measured.size()); }
  [[nodiscard]] int predictions() const { return static_cast<int>(prediction_time.size()); }
};

using Layout = std::vector<Block>;

/// Sizes, order, finiteness and weights of every block; the error names the block.
[[nodiscard]] Status CheckLayout(const Layout& layout, int parameters);

/// Predicted values and derivatives of every block, in one allocation that is made once and used again and
/// again.
class Prediction {
 public:
  explicit Prediction(const Layout& layout);

  /// Predicted channel of block b [M].
  Eigen::Map<Vector> values(int b) { return {data_.data() + value_offset_[b], rows_[b]}; }
  [[nodiscard]] Eigen::Map<const Vector> values(int b) const {
    return {data_.data() + value_offset_[b], rows_[b]};
  }

  /// Its derivative for each parameter in the block's `columns` [M x columns, column-major].
  Eigen::Map<Matrix> derivatives(int b) {
    return {data_.data() + derivative_offset_[b], rows_[b], columns_[b]};
  }
  [[nodiscard]] Eigen::Map<const Matrix> derivatives(int b) const {
    return {data_.data() + derivative_offset_[b], rows_[b], columns_[b]};
  }

  /// Fills everything with NaN, so that what a problem forgot to set is found. A new prediction has NaN
  /// values, and derivatives that are not set.
  void Poison();

 private:
  std::vector<Eigen::Index> rows_;
  std::vector<Eigen::Index> columns_;
  std::vector<Eigen::Index> value_offset_;
  std::vector<Eigen::Index> derivative_offset_;
  Eigen::Index values_ = 0;  // of data_, before the derivatives
  Vector data_;
};

}  // namespace sinew
