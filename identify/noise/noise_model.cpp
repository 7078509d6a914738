#include "identify/noise/noise_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/decompositions.h"
#include "identify/noise/autoregression.h"
#include "identify/noise/lagged_products.h"
#include "identify/noise/quasi_newton.h"
#include "identify/noise/restricted_likelihood.h"

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
constexpr int kOrderSweeps = 2;            // with several channels the order of each depends on the others

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
  std::optional<LaggedProducts> products;  // of the current rows
  Vector shape;                            // partial autocorrelations = tanh(shape)
  double log_variance = 0;                 // of the innovation
  double first_log_variance = 0;           // of the ordinary residual
  double power = 0;                        // of the ordinary residual
  double excess_power = 0;                 // limit of `power` above which it is more than the stated noise
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
  }

  NoiseModel Estimate() {
    if (options_.like != nullptr) {
      KeepOrders(*options_.like);
    } else if (!options_.white) {
      ChooseOrders();
    }
    double last = std::numeric_limits<double>::infinity();
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      double deviance = last;
      for (std::size_t c = 0; c < channels_.size(); ++c)
        deviance = Refine(c, channels_[c].shape, kMinimumTolerance);
      if (channels_.size() == 1 || !(last - deviance > kSweepTolerance)) break;
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
        if (sweep > 0 && c + 1 == channels_.size() && !changed) break;
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

  /// Sums the normal equations and log variances of all channels but one at their current estimates.
  void GatherOthers(std::size_t c) {
    others_ = WhitenedNormalEquations(columns_);
    others_deviance_ = 0;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (i == c) continue;
      Channel& other = channels_[i];
      others_deviance_ += other.products->rows() * other.log_variance;
      others_deviance_ += other.products->AddFiltered(FilterOf(other.shape, other.largest_root),
                                                      std::exp(-other.log_variance), others_);
    }
  }

  /// Deviance as a function of one channel's x: its shape and, if there are other channels, its log variance.
  /// The variance of a single channel has a closed form.
  double Deviance(Channel& channel, const Vector& x, double* log_variance) {
    const bool single = channels_.size() == 1;
    work_ = others_;
    const int rows = channel.products->rows();
    if (single) {
      const double covariance = channel.products->AddFiltered(FilterOf(x, channel.largest_root), 1, work_);
      const ProfiledOut left = ProfileOut(work_);
      const double degrees = rows - columns_;
      const double variance = left.power / degrees;
      if (!(variance > 0)) return std::numeric_limits<double>::infinity();
      *log_variance = std::log(variance);
      return degrees * (*log_variance + 1) + covariance + left.log_determinant;
    }
    *log_variance = std::clamp(x[x.size() - 1], channel.first_log_variance - kLogVarianceRange,
                               channel.first_log_variance + kLogVarianceRange);
    const double covariance = channel.products->AddFiltered(
        FilterOf(x.head(x.size() - 1), channel.largest_root), std::exp(-*log_variance), work_);
    const ProfiledOut left = ProfileOut(work_);
    const double deviance =
        others_deviance_ + rows * *log_variance + covariance + left.power + left.log_determinant;
    return std::isfinite(deviance) ? deviance : std::numeric_limits<double>::infinity();
  }

  /// Minimises over one channel with the others fixed. @return the deviance
  double Refine(std::size_t c, const Vector& shape, double tolerance) {
    Channel& channel = channels_[c];
    GatherOthers(c);
    const bool single = channels_.size() == 1;
    const Eigen::Index order = shape.size();
    Vector x(order + (single ? 0 : 1));
    x.head(order) = shape;
    Vector curvature(x.size());
    const double rows = channel.products->rows();
    for (Eigen::Index i = 0; i < order; ++i) {
      // From the exact information of the last partial autocorrelation, rows / (1 - partial^2).
      curvature[i] = 1 + 2 * rows / std::pow(std::cosh(shape[i]), 2);
    }
    if (!single) {
      x[order] = channel.log_variance;
      curvature[order] = 1 + rows;
    }
    double log_variance = channel.log_variance;
    double deviance = Deviance(channel, x, &log_variance);
    if (!channel.silent) {
      const auto function = [&](const Vector& at) { return Deviance(channel, at, &log_variance); };
      MinimizeSmooth(function, curvature, tolerance, x);
      deviance = Deviance(channel, x, &log_variance);
    }
    channel.shape = x.head(order);
    if (!channel.silent) channel.log_variance = log_variance;
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
  }

  const NoiseModelOptions& options_;
  std::vector<Channel> channels_;
  NoiseModel model_;
  int columns_ = 0;
  int samples_ = 0;
  WhitenedNormalEquations others_{0};
  double others_deviance_ = 0;
  WhitenedNormalEquations work_{0};
};

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

Result<NoiseModel> EstimateNoiseModel(const std::vector<NoiseBlock>& blocks,
                                      const NoiseModelOptions& options) {
  const ReducedBlocks reduced = Reduce(blocks);
  if (reduced.samples <= reduced.columns) {
    return Fail("{} residuals cannot tell their noise besides {} fitted values: add samples", reduced.samples,
                reduced.columns);
  }
  return Estimator(reduced, blocks, options).Estimate();
}

double RestrictedDeviance(const std::vector<NoiseBlock>& blocks, const NoiseModel& model) {
  const ReducedBlocks reduced = Reduce(blocks);
  WhitenedNormalEquations equations(reduced.columns);
  double deviance = 0;
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    const ChannelNoiseModel& channel = model.channels[c];
    std::vector<const LaggedBlock*> of_channel;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      if (model.channel_of[b] == static_cast<int>(c)) of_channel.push_back(&reduced.blocks[b]);
    }
    const AutoregressiveFilter filter(PartialFromCoefficients(channel.coefficients));
    LaggedProducts products(of_channel, filter.order());
    const double log_variance = 2 * std::log(channel.deviation);
    deviance += products.rows() * log_variance;
    deviance += products.AddFiltered(filter, std::exp(-log_variance), equations);
  }
  const ProfiledOut left = ProfileOut(equations);
  return deviance + left.power + left.log_determinant;
}

}  // namespace sinew::noise
