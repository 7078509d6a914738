// The noise model of a fit: per channel an autoregression, estimated without the bias that fitted parameters
// cause, and the whitening filter that follows from it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/least_squares.h"
#include "identify/noise/autoregression.h"

namespace sinew::noise {

/// x_t = sum of coefficients[i] x_{t-1-i} + innovation, stationary; the innovation has `deviation`.
struct ChannelNoiseModel {
  std::string channel;
  std::vector<double> coefficients;  ///< [order]; empty: white
  double deviation = 1;  ///< standard deviation of the innovation, in units of the weighted residual, > 0
  double least_deviation = 0;  ///< white channels: lower limit of `deviation`
  /// Degrees of freedom that fitted values with priors take from the channel's rows: its residual is smaller
  /// than the noise by as much. 0: there are none, or they are not counted.
  double spent = 0;

  /// Standard deviation of the process itself, in units of the weighted residual; infinite if not stationary.
  [[nodiscard]] double ProcessDeviation() const;
  /// Largest modulus of the roots of the characteristic polynomial, in [0, 1); near 1 the process is close to
  /// a random walk.
  [[nodiscard]] double LargestRoot() const;
};

struct NoiseModel {
  std::vector<ChannelNoiseModel> channels;
  std::vector<int> channel_of;  ///< [train blocks] index into channels

  [[nodiscard]] bool IsColoured() const;
  /// Whether the levels were estimated beside values with priors (WhiteLevels).
  [[nodiscard]] bool CountsPriors() const;
};

/// Residual and regressors of one training block, one row per sample.
struct NoiseBlock {
  std::string channel;
  Vector residual;           ///< [n]
  Matrix regressors;         ///< [n x k_b] derivatives for the variables that this block depends on
  std::vector<int> columns;  ///< [k_b] global index of each regressor, increasing
  /// First row of every stretch without a gap, increasing, starts with 0. Whitening does not predict across a
  /// gap.
  std::vector<int> stretches;
  std::optional<double> stated;  ///< noise level stated by the data [unit of `residual`], > 0
  bool white = false;            ///< order 0, and a level of at least `stated`; see Block::white
  double largest_root = 1;       ///< in (0, 1]: limit for the autoregression, from Block::noise_memory
};

/// The row of a prior: residual + slope x change of the variable, in standard deviations of the prior.
struct PriorRow {
  int column = 0;  ///< global index of the regressor, as in NoiseBlock::columns
  double slope = 0;
  double residual = 0;
};

/// Penalty of one coefficient in the deviance: log(rows) (Schwarz 1978) or 2 (Akaike 1974).
enum class OrderCriterion { kBic, kAic };

/// The default order keeps the level of score tests when the noise is no autoregression. Variance of the
/// standardised score of a smooth column (should be 1) and mean order, 200 cases of 6 columns, 11 smooth
/// regressors; 2 standard errors are 0.08:
///
///     4 x 1000 samples        BIC, to 6    BIC, to 10   AIC, to 6    AIC, to 10   AIC, to 15
///     white                   0.96  0.0    0.96  0.0    0.96  0.7    0.96  0.9    0.96  0.9
///     AR(1) 0.9               0.99  1.0    0.99  1.0    0.99  1.6    0.99  1.9    0.99  1.9
///     and as much white       1.03  3.2    1.03  3.2    1.00  4.2    1.00  4.7    1.00  5.0
///     and 3 x as much white   1.11  5.4    1.09  5.6    1.08  5.9    1.02  7.8    1.02  8.4
///     AR(1) 0.98 + 5 x white  0.67  6.0    0.72  9.1    0.67  6.0    0.74  9.9    0.87 13.2
///     mean of six (MA(5))     1.59  6.0    0.99  9.8    1.59  6.0    0.99 10.0    0.96 14.9
///     4 x 250 samples
///     AR(1) 0.9 + 3 x white   1.29  3.8    1.29  3.8    1.09  5.2    1.04  6.2    1.03  6.5
///     mean of six (MA(5))     1.65  5.9    0.85  7.6    1.67  6.0    0.97  9.4    0.95 13.9
///
/// (White levels are in units of the innovation.) An effect of the size that is detected with probability 95
/// % under known noise is found as often with AIC to 10 as with BIC to 6 (75 % of 100; white 74 %). Larger
/// effects are partly absorbed by the noise model, to a similar degree by all of these: of the score under
/// known noise, 0.4 remains at 10 times that size and 0.15 at 30 times.
struct NoiseModelOptions {
  int largest_order = 10;
  OrderCriterion criterion = OrderCriterion::kAic;
  bool white = false;  ///< order 0 for every channel
  /// Noise model of similar residuals: its orders are used, which takes a fifth of the time of choosing them.
  /// May be null.
  const NoiseModel* like = nullptr;
  /// Priors of regressors. They count where every channel is white (WhiteLevels); elsewhere all regressors
  /// are treated as free.
  std::vector<PriorRow> priors;
};

/// Restricted maximum likelihood (Patterson, Thompson 1971; Harville 1974) of the autoregressions of all
/// channels, with the regressors profiled out; order per channel by the criterion, at most one coefficient
/// per ten residual degrees of freedom of the channel. Coefficients are stationary by construction (partial
/// autocorrelations within (-1, 1), Barndorff-Nielsen, Schou 1973).
///
/// The likelihood is the exact one of stationary stretches, not conditional on their first samples: a free
/// decay from the initial state solves a difference equation, so that the conditional likelihood is unbounded
/// where the coefficients are those of that equation, and its estimates are biased towards them.
///
/// A channel with a stated noise level whose residual exceeds 1.5 times that level gets order 0, because an
/// autoregression would describe misfit as noise. (With stances of 32 samples it absorbs a plate's offset of
/// eleven times the stated noise.) By chance a white residual of 60 samples exceeds the limit once in a
/// million cases.
///
/// A channel with a white block gets order 0, and a level of at least the largest stated one of its white
/// blocks.
///
/// Roots stay below the largest `largest_root` of a channel's blocks. (Otherwise a trial whose floor is
/// higher by half the noise level is described by a root of 0.998, and the fit under this noise ignores the
/// trial's mean.)
///
/// Where all channels are white and some regressors have priors, their number may exceed that of the samples:
/// see WhiteLevels.
///
/// Regressors that are linear combinations of others count once. Several channels are estimated in turn with
/// the others fixed until the likelihood no longer changes. After one pass over the samples the cost does not
/// depend on their number (lagged cross products). Errors: not more samples than regressors in all.
Result<NoiseModel> EstimateNoiseModel(const std::vector<NoiseBlock>& blocks,
                                      const NoiseModelOptions& options);

/// -2 log restricted likelihood of `model` for these blocks, regressors profiled out (exact, without the
/// constants that do not depend on the model). Comparable between noise models of any order with the same
/// regressors. @param options the priors that the models were estimated with
[[nodiscard]] double RestrictedDeviance(const std::vector<NoiseBlock>& blocks, const NoiseModel& model,
                                        const NoiseModelOptions& options = {});

/// The whitening filter of a noise model: (x_t - sum a_i x_{t-1-i}) / deviation. The first samples of each
/// stretch are predicted from those before them and divided by the deviation of that prediction, so that no
/// row is lost.
class Whitening final : public RowTransform {
 public:
  /// @param stretches [train blocks] as in NoiseBlock.
  Whitening(NoiseModel model, std::vector<std::vector<int>> stretches);
  void Apply(int train_block, Eigen::Ref<Matrix> rows) const override;
  void AddTo(Digest& digest) const override;

  [[nodiscard]] const NoiseModel& model() const { return model_; }

 private:
  NoiseModel model_;
  std::vector<AutoregressiveFilter> filters_;  // [channels]
  std::vector<std::vector<int>> stretches_;
};

/// First samples of the stretches of a block: a new one starts after a gap longer than 2.5 times the median
/// interval. (Intervals between samples reach 1.9 times the median in recordings of a servo without missing
/// samples.)
[[nodiscard]] std::vector<int> Stretches(const Block& block);

/// NoiseBlock::largest_root for the block's noise_memory.
[[nodiscard]] double LargestRoot(const Block& block);

}  // namespace sinew::noise
