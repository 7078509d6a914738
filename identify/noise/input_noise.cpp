#include "identify/noise/input_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/decompositions.h"
#include "base/random.h"
#include "identify/noise/autoregression.h"
#include "identify/noise/difference_noise.h"

namespace sinew::noise {
namespace {

constexpr std::uint64_t kDraws = 8;
constexpr std::uint64_t kWhiteStream = 1000;  // of the random numbers, beside those of the inputs
constexpr int kLargestOrder = 200;
constexpr int kSamplesPerCoefficient = 10;
constexpr double kStandsOut = 4;  // standard errors of a partial autocorrelation of white noise
constexpr int kHalvings = 2;      // and doublings of the level of the inputs' noise that are compared
constexpr double kOfOrdinary = 4;
constexpr double kOfWhole = 2;

const Block& BlockOf(const LeastSquares& fit, const LeastSquares::TrainBlock& train) {
  return fit.problem().layout()[static_cast<std::size_t>(train.block)];
}

// Weighted predictions of the training blocks, one after the other [data rows].
Vector TrainingRows(const LeastSquares& fit, const Prediction& prediction) {
  Vector rows(fit.data_rows());
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const Block& block = BlockOf(fit, train);
    const auto values = prediction.values(train.block);
    for (std::size_t i = 0; i < block.sample.size(); ++i)
      rows[train.first_row + static_cast<Eigen::Index>(i)] = block.WeightOf(i) * values[block.sample[i]];
  }
  return rows;
}

// Changes of the training rows by the draws that can be predicted [data rows x draws].
Result<Matrix> Changes(const LeastSquares& fit, const Vector& parameters) {
  const Problem& problem = fit.problem();
  std::vector<bool> wanted(problem.layout().size(), false);
  for (const LeastSquares::TrainBlock& train : fit.train_blocks())
    wanted[static_cast<std::size_t>(train.block)] = true;
  const auto workspace = problem.NewWorkspace();
  Prediction prediction(problem.layout());
  const Query query{parameters, wanted, false, nullptr};
  std::vector<Vector> drawn;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const Result<bool> noisy = problem.PredictWithInputNoise(query, draw, *workspace, prediction);
    if (!noisy) continue;
    if (!*noisy) break;
    drawn.push_back(TrainingRows(fit, prediction));
  }
  if (drawn.empty()) return Matrix();
  SINEW_TRY(problem.Predict(query, *workspace, prediction));
  const Vector without = TrainingRows(fit, prediction);
  Matrix changes(without.size(), static_cast<Eigen::Index>(drawn.size()));
  for (std::size_t d = 0; d < drawn.size(); ++d)
    changes.col(static_cast<Eigen::Index>(d)) = drawn[d] - without;
  return changes;
}

// White noise of a block's residual [unit of the weighted residual].
double WhiteLevel(const Block& block, const Vector& residual) {
  Block weighted;
  weighted.prediction_time = block.prediction_time;
  weighted.sample = block.sample;
  weighted.measured.assign(residual.data(), residual.data() + residual.size());
  const auto shown = DifferenceNoise(weighted);
  return shown ? shown->deviation : 0;
}

// Stretches of simulated noise of one channel: `factor` times what the draws move its rows by, and white
// noise.
std::vector<Vector> SimulatedNoise(const LeastSquares& fit, const std::string& channel, const Matrix& changes,
                                   double factor, const Vector& residual) {
  std::vector<Vector> stretches;
  std::uint64_t stream = kWhiteStream;
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const Block& block = BlockOf(fit, train);
    if (block.channel != channel) continue;
    const double white = WhiteLevel(block, residual.segment(train.first_row, block.samples()));
    const std::vector<int> begins = Stretches(block);
    for (std::size_t s = 0; s < begins.size(); ++s) {
      const int end = s + 1 < begins.size() ? begins[s + 1] : block.samples();
      for (Eigen::Index draw = 0; draw < changes.cols(); ++draw) {
        Random random(Random::StreamSeed(stream++, 0));
        Vector noise = factor * changes.col(draw).segment(train.first_row + begins[s], end - begins[s]);
        for (double& value : noise) value += white * random.Normal();
        stretches.push_back(std::move(noise));
      }
    }
  }
  return stretches;
}

std::vector<double> CoefficientsOf(const std::vector<Vector>& stretches) {
  if (stretches.empty()) return {};
  Eigen::Index samples = 0;
  Eigen::Index shortest = stretches.front().size();
  double squares = 0;
  for (const Vector& stretch : stretches) {
    samples += stretch.size();
    shortest = std::min(shortest, stretch.size());
    squares += stretch.squaredNorm();
  }
  if (squares == 0) return {};
  const auto most =
      static_cast<int>(std::min<Eigen::Index>(kLargestOrder, shortest / kSamplesPerCoefficient));
  std::vector<double> partial = BurgPartial(stretches, most);
  const double least = kStandsOut / std::sqrt(static_cast<double>(samples));
  while (!partial.empty() && std::abs(partial.back()) < least) partial.pop_back();
  return CoefficientsFromPartial(partial);
}

// Innovations of unit deviation. @param factor on the noise of the inputs
NoiseModel ModelOf(const LeastSquares& fit, const Matrix& changes, double factor, const Vector& residual) {
  NoiseModel model;
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const std::string& channel = BlockOf(fit, train).channel;
    auto own = std::find_if(model.channels.begin(), model.channels.end(),
                            [&](const ChannelNoiseModel& one) { return one.channel == channel; });
    if (own == model.channels.end()) {
      ChannelNoiseModel made;
      made.channel = channel;
      if (changes.cols() > 0)
        made.coefficients = CoefficientsOf(SimulatedNoise(fit, channel, changes, factor, residual));
      model.channels.push_back(std::move(made));
      own = model.channels.end() - 1;
    }
    model.channel_of.push_back(static_cast<int>(own - model.channels.begin()));
  }
  return model;
}

// The training rows, whitened.
Matrix WhitenedRows(const LeastSquares& fit, const NoiseModel& model, Matrix rows) {
  std::vector<std::vector<int>> stretches;
  for (const LeastSquares::TrainBlock& train : fit.train_blocks())
    stretches.push_back(Stretches(BlockOf(fit, train)));
  const Whitening whitening(model, stretches);
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const LeastSquares::TrainBlock& train = fit.train_blocks()[t];
    Matrix block = rows.middleRows(train.first_row, BlockOf(fit, train).samples());
    whitening.Apply(static_cast<int>(t), block);
    rows.middleRows(train.first_row, block.rows()) = block;
  }
  return rows;
}

// -2 log-likelihood of the linearised fit with the levels of the innovations profiled out, without constants.
double LinearDeviance(const LeastSquares& fit, const Vector& residual, const Matrix& slopes,
                      const NoiseModel& model) {
  Matrix rows(slopes.rows(), slopes.cols() + 1);
  rows << slopes, residual.head(slopes.rows());
  rows = WhitenedRows(fit, model, std::move(rows));
  Vector left = rows.rightCols(1);
  const Matrix white = rows.leftCols(slopes.cols());
  if (white.allFinite()) {
    const Matrix basis = OrthonormalBasis(Eigen::ColPivHouseholderQR<Matrix>(white));
    left -= basis * (basis.transpose() * left).eval();
  }
  std::vector<double> squares(model.channels.size(), 0);
  std::vector<double> samples(model.channels.size(), 0);
  std::vector<AutoregressiveFilter> filters;
  for (const ChannelNoiseModel& channel : model.channels)
    filters.emplace_back(PartialFromCoefficients(channel.coefficients));
  double deviance = 0;
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const LeastSquares::TrainBlock& train = fit.train_blocks()[t];
    const Block& block = BlockOf(fit, train);
    const auto channel = static_cast<std::size_t>(model.channel_of[t]);
    squares[channel] += left.segment(train.first_row, block.samples()).squaredNorm();
    samples[channel] += block.samples();
    const std::vector<int> begins = Stretches(block);
    for (std::size_t s = 0; s < begins.size(); ++s) {
      const int end = s + 1 < begins.size() ? begins[s + 1] : block.samples();
      deviance += filters[channel].LogDeterminant(end - begins[s]);
    }
  }
  for (std::size_t c = 0; c < squares.size(); ++c) {
    if (samples[c] == 0) continue;
    deviance += samples[c] * std::log(std::max(squares[c] / samples[c], std::numeric_limits<double>::min()));
  }
  return deviance;
}

}  // namespace

Result<std::vector<PropagatedNoise>> PropagateInputNoise(const LeastSquares& fit, const Vector& x) {
  SINEW_ASSIGN(const Matrix changes, Changes(fit, fit.Parameters(x)));
  if (changes.cols() == 0) return std::vector<PropagatedNoise>();
  auto workspace = fit.NewWorkspace();
  Vector residual;
  SparseJacobian jacobian = fit.NewJacobian();
  SINEW_TRY(fit.Evaluate(x, workspace, residual, &jacobian));
  // Priors hold some values back: their rows are part of the least squares, and of no channel.
  const Matrix slopes = jacobian.Dense(fit.residuals(), fit.variables());
  Matrix left = Matrix::Zero(slopes.rows(), changes.cols());
  left.topRows(changes.rows()) = changes;
  if (slopes.allFinite()) {
    const Matrix basis = OrthonormalBasis(Eigen::ColPivHouseholderQR<Matrix>(slopes));
    left -= basis * (basis.transpose() * left).eval();
  }

  std::vector<PropagatedNoise> channels;
  std::vector<double> samples;
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const Block& block = BlockOf(fit, train);
    auto channel = std::find_if(channels.begin(), channels.end(),
                                [&](const PropagatedNoise& one) { return one.channel == block.channel; });
    if (channel == channels.end()) {
      channels.push_back({block.channel, 0, 0, 0});
      samples.push_back(0);
      channel = channels.end() - 1;
    }
    const auto draws = static_cast<double>(changes.cols());
    channel->whole += changes.middleRows(train.first_row, block.samples()).squaredNorm() / draws;
    channel->after_fit += left.middleRows(train.first_row, block.samples()).squaredNorm() / draws;
    channel->residual += residual.segment(train.first_row, block.samples()).squaredNorm();
    samples[static_cast<std::size_t>(channel - channels.begin())] += block.samples();
  }
  for (std::size_t c = 0; c < channels.size(); ++c) {
    for (double* sum : {&channels[c].whole, &channels[c].after_fit, &channels[c].residual})
      *sum = std::sqrt(*sum / std::max(samples[c], 1.0));
  }
  return channels;
}

bool MayBeInputNoise(const LeastSquares& fit, const Vector& x, bool ordinary) {
  const auto channels = PropagateInputNoise(fit, x);
  if (!channels || channels->empty()) return false;
  return std::all_of(channels->begin(), channels->end(), [&](const PropagatedNoise& one) {
    return one.residual <= (ordinary ? kOfOrdinary * one.after_fit : kOfWhole * one.whole);
  });
}

Result<NoiseModel> InputNoiseModel(const LeastSquares& fit, const Vector& x) {
  SINEW_ASSIGN(const Matrix changes, Changes(fit, fit.Parameters(x)));
  auto workspace = fit.NewWorkspace();
  Vector residual;
  SparseJacobian jacobian = fit.NewJacobian();
  SINEW_TRY(fit.Evaluate(x, workspace, residual, &jacobian));
  const Matrix slopes = jacobian.Dense(fit.residuals(), fit.variables()).topRows(fit.data_rows());
  NoiseModel best;
  double least = std::numeric_limits<double>::infinity();
  for (int step = -kHalvings; step <= kHalvings; ++step) {
    NoiseModel model = ModelOf(fit, changes, std::exp2(step), residual);
    const double deviance = LinearDeviance(fit, residual, slopes, model);
    if (!(deviance < least)) continue;
    least = deviance;
    best = std::move(model);
  }
  return WithLevelsOf(fit, residual, std::move(best));
}

NoiseModel WithLevelsOf(const LeastSquares& fit, const Vector& residual, NoiseModel model) {
  for (ChannelNoiseModel& channel : model.channels) channel.deviation = 1;
  const Matrix white = WhitenedRows(fit, model, residual.head(fit.data_rows()));
  std::vector<double> squares(model.channels.size(), 0);
  std::vector<double> samples(model.channels.size(), 0);
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const LeastSquares::TrainBlock& train = fit.train_blocks()[t];
    const auto channel = static_cast<std::size_t>(model.channel_of[t]);
    const int count = BlockOf(fit, train).samples();
    squares[channel] += white.middleRows(train.first_row, count).squaredNorm();
    samples[channel] += count;
  }
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    const double variance = squares[c] / std::max(samples[c], 1.0);
    if (variance > 0) model.channels[c].deviation = std::sqrt(kInputNoiseDispersion * variance);
  }
  return model;
}

}  // namespace sinew::noise
