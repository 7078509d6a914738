#include "identify/noise/white_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/decompositions.h"

namespace sinew::noise {
namespace {

constexpr double kLevelRidge =
    1e-10;  // of columns of unit length: regressors may be linear combinations of others
constexpr double kLevelConverged = 1e-3;  // of the logarithm of a variance
constexpr int kMaxLevelIterations = 40;
constexpr double kFewestDegrees = 1;  // that a channel keeps

}  // namespace

WhiteLevels::WhiteLevels(const std::vector<NoiseBlock>& blocks, const std::vector<PriorRow>& priors) {
  for (const NoiseBlock& block : blocks) {
    auto found = std::find_if(channels_.begin(), channels_.end(),
                              [&](const Channel& c) { return c.name == block.channel; });
    if (found == channels_.end()) {
      channels_.push_back({block.channel, 0, 0, 0});
      found = std::prev(channels_.end());
    }
    found->rows += static_cast<double>(block.residual.size());
    found->squares += block.residual.squaredNorm();
    found->least = std::max(found->least, block.stated.value_or(0));
    channel_of_.push_back(static_cast<int>(found - channels_.begin()));
    Part part;
    part.channel = static_cast<std::size_t>(channel_of_.back());
    part.columns = block.columns;
    part.gram = Gram(block.regressors);
    part.pull = block.regressors.transpose() * block.residual;
    part.squares = block.residual.squaredNorm();
    parts_.push_back(std::move(part));
    if (!block.columns.empty()) columns_ = std::max(columns_, block.columns.back() + 1);
  }
  for (const PriorRow& prior : priors) columns_ = std::max(columns_, prior.column + 1);
  prior_precision_ = Vector::Zero(columns_);
  prior_pull_ = Vector::Zero(columns_);
  for (const PriorRow& prior : priors) {
    prior_precision_[prior.column] += prior.slope * prior.slope;
    prior_pull_[prior.column] += prior.slope * prior.residual;
    prior_squares_ += prior.residual * prior.residual;
  }
}

WhiteLevels::Solution WhiteLevels::Solve(const std::vector<double>& variance, bool degrees) const {
  Matrix normal = prior_precision_.asDiagonal();
  Vector pull = prior_pull_;
  for (const Part& part : parts_) {
    const double scale = 1 / variance[part.channel];
    for (std::size_t c = 0; c < part.columns.size(); ++c) {
      const auto at = static_cast<Eigen::Index>(c);
      pull[part.columns[c]] += scale * part.pull[at];
      for (std::size_t r = 0; r < part.columns.size(); ++r)
        normal(part.columns[r], part.columns[c]) += scale * part.gram(static_cast<Eigen::Index>(r), at);
    }
  }
  Vector unit(columns_);
  for (int i = 0; i < columns_; ++i) unit[i] = normal(i, i) > 0 ? 1 / std::sqrt(normal(i, i)) : 0;
  Matrix scaled = unit.asDiagonal() * normal * unit.asDiagonal();
  for (int i = 0; i < columns_; ++i) scaled(i, i) = 1 + kLevelRidge;
  const Eigen::LLT<Matrix> root(scaled);
  const Vector by_unit = unit.cwiseProduct(pull);
  const Vector shift = unit.cwiseProduct(Vector(root.solve(by_unit)));  // minus the change of the values

  Solution solution;
  solution.squares.assign(channels_.size(), 0);
  solution.spent.assign(channels_.size(), 0);
  Matrix inverse;
  if (degrees) {
    inverse = Matrix::Identity(columns_, columns_);
    root.matrixL().solveInPlace(inverse);
    inverse = Gram(inverse);
    inverse = unit.asDiagonal() * inverse * unit.asDiagonal();
  }
  for (const Part& part : parts_) {
    const auto n = static_cast<Eigen::Index>(part.columns.size());
    Vector own(n);
    for (Eigen::Index c = 0; c < n; ++c) own[c] = shift[part.columns[static_cast<std::size_t>(c)]];
    solution.squares[part.channel] += part.squares - 2 * own.dot(part.pull) + own.dot(part.gram * own);
    if (!degrees) continue;
    double trace = 0;
    for (Eigen::Index c = 0; c < n; ++c) {
      const int column = part.columns[static_cast<std::size_t>(c)];
      for (Eigen::Index r = 0; r < n; ++r)
        trace += inverse(part.columns[static_cast<std::size_t>(r)], column) * part.gram(r, c);
    }
    solution.spent[part.channel] += trace / variance[part.channel];
  }
  const Matrix lower = root.matrixL();
  solution.deviance = prior_squares_ - pull.dot(shift) + 2 * lower.diagonal().array().log().sum();
  for (int i = 0; i < columns_; ++i) {
    if (unit[i] > 0) solution.deviance -= 2 * std::log(unit[i]);
  }
  for (std::size_t c = 0; c < channels_.size(); ++c)
    solution.deviance += channels_[c].rows * std::log(variance[c]) + channels_[c].squares / variance[c];
  return solution;
}

NoiseModel WhiteLevels::Estimate(const NoiseModel* like) const {
  const auto lowest = [](const Channel& channel) {
    return std::max(channel.least * channel.least, std::numeric_limits<double>::min());
  };
  std::vector<double> variance;
  for (const Channel& channel : channels_) {
    double first = channel.squares / std::max(channel.rows, 1.0);
    if (like != nullptr) {
      for (const ChannelNoiseModel& known : like->channels) {
        if (known.channel == channel.name) first = known.deviation * known.deviation;
      }
    }
    variance.push_back(std::max(lowest(channel), first));
  }
  Solution solution;
  for (int i = 0; i < kMaxLevelIterations; ++i) {
    solution = Solve(variance, true);
    double changed = 0;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const double degrees = std::max(channels_[c].rows - solution.spent[c], kFewestDegrees);
      const double next = std::max(lowest(channels_[c]), solution.squares[c] / degrees);
      changed = std::max(changed, std::abs(std::log(next / variance[c])));
      variance[c] = next;
    }
    if (changed < kLevelConverged) break;
  }
  NoiseModel model;
  model.channel_of = channel_of_;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    ChannelNoiseModel channel{channels_[c].name, {}, std::sqrt(variance[c]), channels_[c].least};
    channel.spent = std::clamp(solution.spent[c], 0.0, std::max(channels_[c].rows - kFewestDegrees, 0.0));
    model.channels.push_back(std::move(channel));
  }
  return model;
}

double WhiteLevels::Deviance(const NoiseModel& model) const {
  std::vector<double> variance;
  for (const ChannelNoiseModel& channel : model.channels)
    variance.push_back(channel.deviation * channel.deviation);
  return Solve(variance, false).deviance;
}

}  // namespace sinew::noise
