#include "identify/noise/noise_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "base/decompositions.h"
#include "identify/noise/autoregression.h"
#include "identify/noise/channel_equations.h"
#include "identify/noise/lagged_products.h"
#include "identify/noise/quasi_newton.h"
#include "identify/noise/restricted_likelihood.h"
#include "identify/noise/white_levels.h"

namespace sinew::noise {
namespace {

constexpr double kLargestArgument = 7;  // tanh: partial autocorrelations stay below 1 - 2e-6
constexpr double kLargestBurg = 0.999;  // of the initial estimate
// Search range about the initial estimate: a channel can be 4e-6 times as noisy as its ordinary residual.
// Below that, rounding errors of the other channels' part would be taken for noise.
constexpr double kLogVarianceRange = 25;
constexpr double kSmallestDeviation = 1e-100;  // of a channel that is zero throughout
constexpr double kRowsPerCoefficient = 10;     // degrees of freedom per coefficient
constexpr double kMinimumTolerance = 1e-8;     // of the deviance; the sweeps stop at 1e-6
constexpr double kOrderTolerance = 1e-5;       // while orders are compared, whose penalties are at least 2
constexpr int kOrdersWithoutGain = 4;          // successive orders without gain that end the search
constexpr double kSweepTolerance = 1e-6;
constexpr int kMaxSweeps = 50;
constexpr double kExcessOverStated = 1.5;  // times the stated level: above it the residual is more than noise
// For the derivatives of the filter's coefficients: the error is step^2 times a third derivative of the
// deviance, far below the noise.
constexpr double kDifference = 1e-4;
constexpr int kOrderSweeps = 2;  // with several channels the order of each depends on the others

int RowsWithPast(const std::vector<const LaggedBlock*>& blocks, int past) {
  int rows = 0;
  for (const LaggedBlock* block : blocks) {
    for (std::size_t s = 0; s < block->starts.size(); ++s) {
      const int end =
          s + 1 < block->starts.size() ? block->starts[s + 1] : static_cast<int>(block->rows.rows());
      rows += std::max(0, end - block->starts[s] - past);
    }
  }
  return rows;
}

// The process x_t r^-t of a stationary autoregression x_t has roots r times as large.
std::vector<double> WithRootsTimes(double factor, std::vector<double> coefficients) {
  double power = 1;
  for (double& coefficient : coefficients) coefficient *= power *= factor;
  return PartialFromCoefficients(coefficients);
}

AutoregressiveFilter FilterOf(const Vector& shape, double largest_root) {
  std::vector<double> partial;
  for (Eigen::Index i = 0; i < shape.size(); ++i) {
    partial.push_back(std::tanh(std::clamp(shape[i], -kLargestArgument, kLargestArgument)));
  }
  if (largest_root < 1) partial = WithRootsTimes(largest_root, CoefficientsFromPartial(partial));
  return AutoregressiveFilter(partial);
}

// The inverse of FilterOf.
Vector ShapeOf(const std::vector<double>& coefficients, double largest_root) {
  const std::vector<double> partial = WithRootsTimes(1 / largest_root, coefficients);
  Vector shape(static_cast<Eigen::Index>(partial.size()));
  for (std::size_t i = 0; i < partial.size(); ++i)
    shape[static_cast<Eigen::Index>(i)] = std::atanh(std::clamp(partial[i], -kLargestBurg, kLargestBurg));
  return shape;
}

struct Channel {
  std::string name;
  std::vector<const LaggedBlock*> blocks;
  std::vector<double> burg;    // partial autocorrelations of the ordinary residual: initial estimate
  int largest_order = 0;       // limit by the number of rows
  bool silent = false;         // zero throughout
  bool white = false;          // prescribed by the data
  double least_deviation = 0;  // prescribed by the data
  double largest_root = 0;     // prescribed by the data
  std::optional<LaggedProducts> products;
  std::optional<ChannelEquations> equations;
  bool alone = false;       // shares no regressor with other channels, and has more rows than regressors
  JointEquations joint;     // at `shape` and `log_variance`
  double covariance = 0;    // logarithm of its determinant, for an innovation of variance 1, there
  Vector shape;             // partial autocorrelations = tanh(shape)
  double log_variance = 0;  // of the innovation
  double first_log_variance = 0;  // of the ordinary residual
  double power = 0;               // of the ordinary residual
  double excess_power = 0;        // limit of `power` above which it is more than the stated noise
};

class Estimator {
 public:
  Estimator(const ReducedBlocks& reduced, const std::vector<NoiseBlock>& blocks,
            const NoiseModelOptions& options)
      : options_(options), columns_(reduced.columns), samples_(reduced.samples) {
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      auto found = std::find_if(channels_.begin(), channels_.end(),
                                [&](const Channel& c) { return c.name == blocks[b].channel; });
      if (found == channels_.end()) {
        channels_.emplace_back();
        found = std::prev(channels_.end());
        found->name = blocks[b].channel;
      }
      found->blocks.push_back(&reduced.blocks[b]);
      const auto samples = static_cast<double>(blocks[b].residual.size());
      const double stated = blocks[b].stated.value_or(std::numeric_limits<double>::infinity());
      found->power += blocks[b].residual.squaredNorm();
      found->excess_power += samples * std::pow(kExcessOverStated * stated, 2);
      found->white = found->white || blocks[b].white;
      found->largest_root = std::max(found->largest_root, blocks[b].largest_root);
      if (blocks[b].white)
        found->least_deviation = std::max(found->least_deviation, blocks[b].stated.value_or(0));
      model_.channel_of.push_back(static_cast<int>(found - channels_.begin()));
    }
    for (Channel& channel : channels_) Start(channel);
    Connect();
  }

  NoiseModel Estimate() {
    if (options_.like != nullptr) {
      KeepOrders(*options_.like);
    } else if (!options_.white) {
      ChooseOrders();
    }
    const auto coupled =
        std::count_if(channels_.begin(), channels_.end(), [](const Channel& c) { return !c.alone; });
    double last = std::numeric_limits<double>::infinity();
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      double deviance = last;
      for (std::size_t c = 0; c < channels_.size(); ++c) {
        if (sweep > 0 && channels_[c].alone) continue;
        const double reached = Refine(c, channels_[c].shape, kMinimumTolerance);
        if (!channels_[c].alone) deviance = reached;
      }
      if (coupled <= 1 || !(last - deviance > kSweepTolerance)) break;
      last = deviance;
    }
    for (const Channel& channel : channels_) {
      const double estimated = channel.silent ? kSmallestDeviation : std::exp(0.5 * channel.log_variance);
      const double deviation = std::max(estimated, channel.least_deviation);
      model_.channels.push_back({channel.name, FilterOf(channel.shape, channel.largest_root).coefficients(),
                                 deviation, channel.least_deviation});
    }
    return std::move(model_);
  }

 private:
  // The order of one channel depends on those of the others, which are all known from the second sweep on.
  void ChooseOrders() {
    bool changed = true;
    const int sweeps = channels_.size() > 1 ? kOrderSweeps : 1;
    for (int sweep = 0; sweep < sweeps && changed; ++sweep) {
      changed = sweep == 0;
      for (std::size_t c = 0; c < channels_.size(); ++c) {
        if (sweep > 0 && (channels_[c].alone || (c + 1 == channels_.size() && !changed))) continue;
        const Eigen::Index before = channels_[c].shape.size();
        ChooseOrder(c);
        changed = changed || channels_[c].shape.size() != before;
      }
    }
  }

  void KeepOrders(const NoiseModel& like) {
    for (Channel& channel : channels_) {
      for (const ChannelNoiseModel& known : like.channels) {
        if (known.channel != channel.name || options_.white || channel.silent ||
            static_cast<int>(known.coefficients.size()) > channel.largest_order)
          continue;
        channel.shape = ShapeOf(known.coefficients, channel.largest_root);
        channel.log_variance = 2 * std::log(known.deviation);
        Settle(channel);
      }
    }
  }

  void Start(Channel& channel) const {
    std::vector<Vector> stretches;
    double power = 0;
    for (const LaggedBlock* block : channel.blocks) {
      const auto residual = block->rows.rightCols(1);
      power += residual.squaredNorm();
      for (std::size_t s = 0; s < block->starts.size(); ++s) {
        const auto end = s + 1 < block->starts.size() ? block->starts[s + 1] : residual.rows();
        stretches.emplace_back(residual.middleRows(block->starts[s], end - block->starts[s]));
      }
    }
    const int rows = RowsWithPast(channel.blocks, 0);
    channel.silent = !(power > 0);
    channel.log_variance =
        channel.silent ? 2 * std::log(kSmallestDeviation) : std::log(power / std::max(rows, 1));
    channel.first_log_variance = channel.log_variance;
    channel.shape.resize(0);
    if (!options_.white && !channel.white && !channel.silent && channel.power <= channel.excess_power) {
      // The channel's share of the degrees of freedom of the regressors.
      const double spent = static_cast<double>(columns_) * rows / samples_;
      for (int order = 1; order <= options_.largest_order; ++order) {
        const int left = RowsWithPast(channel.blocks, order);
        if (left - spent < kRowsPerCoefficient * order) break;
        channel.largest_order = order;
      }
    }
    channel.burg = BurgPartial(stretches, channel.largest_order);
    channel.products.emplace(channel.blocks, channel.largest_order);
  }

  // Which regressors channels share.
  void Connect() {
    std::vector<int> place(static_cast<std::size_t>(columns_), -1);
    std::vector<std::size_t> owner(static_cast<std::size_t>(columns_), channels_.size());
    joint_ = 0;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      for (const auto& of_block : channels_[c].products->columns()) {
        for (const int column : of_block) {
          const auto at = static_cast<std::size_t>(column);
          if (owner[at] == channels_.size()) owner[at] = c;
          if (owner[at] != c && place[at] < 0) place[at] = joint_++;
        }
      }
    }
    for (Channel& channel : channels_) {
      channel.equations.emplace(channel.products->columns(), place, joint_);
      channel.alone = channel.equations->IsAlone() && channel.products->rows() > channel.equations->columns();
    }
    for (Channel& channel : channels_) Settle(channel);
  }

  // What the deviances of other channels need of this one at its current estimate.
  void Settle(Channel& channel) {
    if (channel.alone || channels_.size() == 1) return;
    const AutoregressiveFilter filter = FilterOf(channel.shape, channel.largest_root);
    channel.products->Filter(filter, std::exp(-channel.log_variance), sums_);
    if (!channel.equations->Eliminate(*channel.products, sums_, channel.joint))
      channel.joint.lower.setConstant(std::numeric_limits<double>::quiet_NaN());
    channel.covariance = channel.products->LogDeterminant(filter);
  }

  /// Sums the normal equations and log variances of all channels that share regressors, but one, at their
  /// current estimates.
  void GatherOthers(std::size_t c) {
    others_.SetZero(joint_);
    others_deviance_ = 0;
    if (channels_[c].alone) return;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (i == c || channels_[i].alone) continue;
      const Channel& other = channels_[i];
      others_ += other.joint;
      others_deviance_ += other.products->rows() * other.log_variance + other.covariance;
    }
  }

  /// Deviance as a function of one channel's x: its shape and, unless it is alone, its log variance. The
  /// variance of a channel alone has a closed form.
  /// @param gradient [n] if not null
  double Deviance(Channel& channel, const Vector& x, double* log_variance, Vector* gradient) {
    const Eigen::Index order = channel.alone ? x.size() : x.size() - 1;
    const AutoregressiveFilter filter = FilterOf(x.head(order), channel.largest_root);
    const int rows = channel.products->rows();
    double scale = 1;
    if (!channel.alone) {
      *log_variance = std::clamp(x[order], channel.first_log_variance - kLogVarianceRange,
                                 channel.first_log_variance + kLogVarianceRange);
      scale = std::exp(-*log_variance);
    }
    channel.products->Filter(filter, scale, sums_);
    if (!channel.equations->Eliminate(*channel.products, sums_, left_))
      return std::numeric_limits<double>::infinity();
    const double covariance = channel.products->LogDeterminant(filter);
    left_ += others_;
    const double of_own = left_.log_determinant;
    if (!EliminateJoint(left_, elimination_)) return std::numeric_limits<double>::infinity();
    const double log_determinant = of_own + elimination_.log_determinant();
    const double power = left_.lower(joint_, joint_);
    double deviance = 0;
    double per_power = 1;
    if (channel.alone) {
      const double degrees = rows - channel.equations->columns();
      const double variance = power / degrees;
      if (!(variance > 0)) return std::numeric_limits<double>::infinity();
      *log_variance = std::log(variance);
      deviance = degrees * (*log_variance + 1) + covariance + log_determinant;
      per_power = 1 / variance;
    } else {
      deviance = others_deviance_ + rows * *log_variance + covariance + power + log_determinant;
    }
    if (!std::isfinite(deviance)) return std::numeric_limits<double>::infinity();
    if (gradient != nullptr) Differentiate(channel, x.head(order), filter, scale, per_power, *gradient);
    return deviance;
  }

  // Of the deviance that was computed last. @param per_power its slope for the power that is left
  void Differentiate(Channel& channel, const Vector& shape, const AutoregressiveFilter& filter, double scale,
                     double per_power, Vector& gradient) {
    elimination_.CarryBack(left_.lower, Matrix::Constant(1, 1, per_power), of_left_);
    channel.equations->CarryBack(*channel.products, of_left_, slopes_);
    std::vector<std::array<AutoregressiveFilter, 2>> neighbours;
    gradient.resize(shape.size() + (channel.alone ? 0 : 1));
    for (Eigen::Index i = 0; i < shape.size(); ++i) {
      Vector below = shape;
      Vector above = shape;
      below[i] -= kDifference;
      above[i] += kDifference;
      neighbours.push_back({FilterOf(below, channel.largest_root), FilterOf(above, channel.largest_root)});
      gradient[i] = (channel.products->LogDeterminant(neighbours.back()[1]) -
                     channel.products->LogDeterminant(neighbours.back()[0])) /
                    (2 * kDifference);
    }
    Vector along;
    const double sum = channel.products->Differentiate(slopes_, filter, neighbours, kDifference, along);
    gradient.head(shape.size()) += scale * along;
    if (!channel.alone) gradient[shape.size()] = channel.products->rows() - scale * sum;
  }

  /// Minimises over one channel with the others fixed. @return the deviance, of a channel that is not alone
  /// that of all channels that are not
  double Refine(std::size_t c, const Vector& shape, double tolerance) {
    Channel& channel = channels_[c];
    GatherOthers(c);
    const Eigen::Index order = shape.size();
    Vector x(order + (channel.alone ? 0 : 1));
    x.head(order) = shape;
    Vector curvature(x.size());
    const double rows = channel.products->rows();
    for (Eigen::Index i = 0; i < order; ++i) {
      // From the exact information of the last partial autocorrelation, rows / (1 - partial^2).
      curvature[i] = 1 + 2 * rows / std::pow(std::cosh(shape[i]), 2);
    }
    if (!channel.alone) {
      x[order] = channel.log_variance;
      curvature[order] = 1 + rows;
    }
    double log_variance = channel.log_variance;
    if (!channel.silent) {
      MinimizeSmooth(
          [&](const Vector& at, Vector* gradient) { return Deviance(channel, at, &log_variance, gradient); },
          curvature, tolerance, x);
    }
    const double deviance = Deviance(channel, x, &log_variance, nullptr);
    channel.shape = x.head(order);
    if (!channel.silent) channel.log_variance = log_variance;
    Settle(channel);
    return deviance;
  }

  void ChooseOrder(std::size_t c) {
    Channel& channel = channels_[c];
    const double rows = channel.products->rows();
    const double price = options_.criterion == OrderCriterion::kBic ? std::log(std::max(rows, 2.0)) : 2;
    double best = std::numeric_limits<double>::infinity();
    Vector best_shape;
    double best_log_variance = channel.log_variance;
    Vector shape(0);
    int without_gain = 0;
    for (int order = 0; order <= channel.largest_order && without_gain < kOrdersWithoutGain; ++order) {
      ++without_gain;
      if (order > 0) {
        // Initial estimate: the optimum of the next lower order, and the ordinary residual's partial
        // autocorrelation at one more lag.
        shape.conservativeResize(order);
        shape[order - 1] = std::atanh(
            std::clamp(channel.burg[static_cast<std::size_t>(order - 1)], -kLargestBurg, kLargestBurg));
      }
      const double deviance = Refine(c, shape, kOrderTolerance);
      shape = channel.shape;
      if (deviance + price * order < best) {
        best = deviance + price * order;
        best_shape = shape;
        best_log_variance = channel.log_variance;
        without_gain = 0;
      }
    }
    channel.shape = best_shape;
    channel.log_variance = best_log_variance;
    Settle(channel);
  }

  const NoiseModelOptions& options_;
  std::vector<Channel> channels_;
  NoiseModel model_;
  int columns_ = 0;
  int samples_ = 0;
  int joint_ = 0;  // regressors that channels share
  JointEquations others_;
  double others_deviance_ = 0;
  JointEquations left_;
  Elimination elimination_;
  Vector sums_;     // scratch
  Vector slopes_;   // scratch
  Matrix of_left_;  // scratch
};

// Whether only levels are to be estimated, beside regressors with priors.
bool OnlyLevels(const std::vector<NoiseBlock>& blocks, const NoiseModelOptions& options) {
  if (options.priors.empty()) return false;
  return options.white || std::all_of(blocks.begin(), blocks.end(), [&](const NoiseBlock& block) {
           return std::any_of(blocks.begin(), blocks.end(), [&](const NoiseBlock& other) {
             return other.white && other.channel == block.channel;
           });
         });
}

}  // namespace

double ChannelNoiseModel::ProcessDeviation() const {
  double factor = 1;
  for (const double partial : PartialFromCoefficients(coefficients)) {
    if (!(std::abs(partial) < 1)) return std::numeric_limits<double>::infinity();
    factor *= 1 - partial * partial;
  }
  return deviation / std::sqrt(factor);
}

double ChannelNoiseModel::LargestRoot() const {
  const auto order = static_cast<Eigen::Index>(coefficients.size());
  if (order == 0) return 0;
  Matrix companion = Matrix::Zero(order, order);
  companion.row(0) = Eigen::Map<const Vector>(coefficients.data(), order);
  for (Eigen::Index i = 1; i < order; ++i) companion(i, i - 1) = 1;
  return Eigen::EigenSolver<Matrix>(companion, false).eigenvalues().cwiseAbs().maxCoeff();
}

bool NoiseModel::IsColoured() const {
  return std::any_of(channels.begin(), channels.end(),
                     [](const ChannelNoiseModel& c) { return !c.coefficients.empty(); });
}

bool NoiseModel::CountsPriors() const {
  return std::any_of(channels.begin(), channels.end(),
                     [](const ChannelNoiseModel& c) { return c.spent > 0; });
}

Result<NoiseModel> EstimateNoiseModel(const std::vector<NoiseBlock>& blocks,
                                      const NoiseModelOptions& options) {
  if (OnlyLevels(blocks, options)) return WhiteLevels(blocks, options.priors).Estimate(options.like);
  const ReducedBlocks reduced = Reduce(blocks);
  if (reduced.samples <= reduced.columns) {
    return Fail("{} residuals cannot tell their noise besides {} fitted values: add samples", reduced.samples,
                reduced.columns);
  }
  return Estimator(reduced, blocks, options).Estimate();
}

double RestrictedDeviance(const std::vector<NoiseBlock>& blocks, const NoiseModel& model,
                          const NoiseModelOptions& options) {
  if (OnlyLevels(blocks, options)) return WhiteLevels(blocks, options.priors).Deviance(model);
  const ReducedBlocks reduced = Reduce(blocks);
  // Every regressor is treated as one that channels share: one evaluation need not be fast.
  std::vector<int> place(static_cast<std::size_t>(reduced.columns));
  std::iota(place.begin(), place.end(), 0);
  JointEquations all(reduced.columns);
  JointEquations own;
  Vector sums;
  double deviance = 0;
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    const ChannelNoiseModel& channel = model.channels[c];
    std::vector<const LaggedBlock*> of_channel;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      if (model.channel_of[b] == static_cast<int>(c)) of_channel.push_back(&reduced.blocks[b]);
    }
    const AutoregressiveFilter filter(PartialFromCoefficients(channel.coefficients));
    LaggedProducts products(of_channel, filter.order());
    ChannelEquations equations(products.columns(), place, reduced.columns);
    const double log_variance = 2 * std::log(channel.deviation);
    products.Filter(filter, std::exp(-log_variance), sums);
    equations.Eliminate(products, sums, own);
    all += own;
    deviance += products.rows() * log_variance + products.LogDeterminant(filter);
  }
  Elimination elimination;
  if (!EliminateJoint(all, elimination)) return std::numeric_limits<double>::quiet_NaN();
  return deviance + all.lower(reduced.columns, reduced.columns) + elimination.log_determinant();
}

}  // namespace sinew::noise
