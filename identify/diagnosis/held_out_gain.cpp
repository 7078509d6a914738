#include "identify/diagnosis/held_out_gain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "base/random.h"
#include "identify/role_view.h"
#include "identify/solvers/held_out_nuisance.h"

namespace sinew::diagnosis {
namespace {

constexpr int kDraws = 400;
constexpr double kBlockShare = 0.05;  // bootstrap block as a share of the trial: longer than the noise
                                      // correlation, shorter than the trial
constexpr int kShortestBlock = 5;
constexpr double kTolerance = 1e-3;  // of half the deviance, for values fitted under a noise model
constexpr long kEvaluations = 80;

const noise::ChannelNoiseModel* ChannelOf(const noise::NoiseModel& noise, const std::string& channel) {
  for (const noise::ChannelNoiseModel& model : noise.channels) {
    if (model.channel == channel) return &model;
  }
  return nullptr;
}

// Noise model of the block's channel. A channel that is only held out (the plate of the other foot) gets that
// of a fitted one of the same quantity. Null if there is none.
const noise::ChannelNoiseModel* TrainedNoiseOf(const Block& block, const noise::NoiseModel& noise,
                                               const Layout& layout) {
  if (const noise::ChannelNoiseModel* model = ChannelOf(noise, block.channel)) return model;
  for (const Block& other : layout) {
    if (block.quantity.empty() || other.quantity != block.quantity || other.role != BlockRole::kTrain)
      continue;
    if (const noise::ChannelNoiseModel* model = ChannelOf(noise, other.channel)) return model;
  }
  return nullptr;
}

double Quantile(std::vector<double>& sorted, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5);
  return sorted[at];
}

}  // namespace

double NoiseFloorOf(const Block& block, const noise::NoiseModel& noise, const Layout& layout) {
  if (block.sigma) return block.weight * *block.sigma;
  const noise::ChannelNoiseModel* model = TrainedNoiseOf(block, noise, layout);
  return model == nullptr ? 0 : model->ProcessDeviation();
}

HeldOut::HeldOut(const Problem& problem, FitRecord* record, int threads)
    : problem_(problem), record_(record), threads_(threads) {
  for (std::size_t b = 0; b < problem.layout().size(); ++b) {
    const Block& block = problem.layout()[b];
    if (block.role == BlockRole::kValidate && block.samples() > 0) blocks_.push_back(static_cast<int>(b));
  }
  std::set<std::string> all;
  std::set<std::string> trials;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    all.insert(block(i).trial);
    if (block(i).group.empty()) trials.insert(block(i).trial);
  }
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const Parameter& p = problem.parameters()[i];
    if (p.kind != ParameterKind::kNuisance || !p.prior) continue;
    many_minima_ = many_minima_ || all.count(p.trial) > 0;
    if (trials.count(p.trial) > 0) priors_.push_back(static_cast<int>(i));
  }
}

Vector HeldOut::Fitted(const Vector& point) const {
  constexpr std::size_t kKept = 4;
  for (const auto& [known, answer] : fitted_) {
    if (known == point) return answer;
  }
  solvers::HeldOutSearch search;
  search.in_windows = fitted_.empty();
  for (const auto& one : fitted_) search.earlier.push_back(one.second);
  search.threads = threads_;
  Vector answer = solvers::FitHeldOutNuisance(problem_, point, record_, search);
  if (under_) answer = FittedUnder(*under_, answer);
  if (fitted_.size() == kKept) fitted_.erase(fitted_.begin() + 1);
  fitted_.emplace_back(point, answer);
  return answer;
}

void HeldOut::FitUnder(const noise::NoiseModel* noise) {
  under_.reset();
  if (noise != nullptr) under_ = *noise;
  fitted_.clear();
}

// A fit that fails leaves the parameters as they are.
Vector HeldOut::FittedUnder(const noise::NoiseModel& noise, const Vector& fitted) const {
  const RoleView view(problem_, [](const Block& block) {
    return block.role == BlockRole::kValidate ? BlockRole::kTrain : BlockRole::kPredicted;
  });
  FitSetup setup;
  setup.parameters = problem_.parameters();
  setup.rest = fitted;
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    const bool of_held_out = std::any_of(blocks_.begin(), blocks_.end(), [&](int b) {
      return problem_.layout()[static_cast<std::size_t>(b)].trial == p.trial;
    });
    if (p.kind == ParameterKind::kNuisance && of_held_out) setup.free.push_back(static_cast<int>(i));
  }
  LeastSquares fit(view, setup);
  noise::NoiseModel own = noise;
  own.channel_of.clear();
  std::vector<std::vector<int>> stretches;
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const Block& block = problem_.layout()[static_cast<std::size_t>(train.block)];
    const noise::ChannelNoiseModel* model = NoiseOf(block, noise);
    if (model == nullptr) return fitted;
    own.channels.push_back(*model);
    own.channel_of.push_back(static_cast<int>(own.channels.size()) - 1);
    stretches.push_back(noise::Stretches(block));
  }
  const noise::Whitening whitening(std::move(own), std::move(stretches));
  fit.set_transform(&whitening);
  const auto outcome = solvers::LocalFit(fit).Minimize(fit.Start(), -1, {kTolerance, 0}, kEvaluations);
  return outcome.failure.empty() ? fit.Parameters(outcome.x) : fitted;
}

void HeldOut::Align(const Vector& one, const Vector& other) const {
  if (!many_minima_ || one == other) return;
  Vector answers[] = {Fitted(one), Fitted(other)};
  for (int i = 0; i < 2; ++i) {
    solvers::HeldOutSearch search;
    search.earlier = {answers[1 - i]};
    search.fitted = true;
    search.threads = threads_;
    answers[i] = solvers::FitHeldOutNuisance(problem_, answers[i], record_, search);
    for (auto& [point, answer] : fitted_) {
      if (point == (i == 0 ? one : other)) answer = answers[i];
    }
  }
}

Result<std::vector<Vector>> HeldOut::Residuals(const Vector& point) const {
  const Vector parameters = Fitted(point);
  std::vector<bool> wanted(problem_.layout().size(), false);
  for (const int b : blocks_) wanted[static_cast<std::size_t>(b)] = true;
  Prediction prediction(problem_.layout());
  const auto workspace = problem_.NewWorkspace();
  SINEW_TRY(problem_.Predict({parameters, wanted, false, nullptr}, *workspace, prediction));
  std::vector<Vector> residuals;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Block& b = block(i);
    const auto values = prediction.values(blocks_[i]);
    Vector residual(b.samples());
    for (int k = 0; k < b.samples(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      residual[k] = b.WeightOf(at) * (values[b.sample[at]] - b.measured[at]);
    }
    if (!residual.allFinite())
      return Fail("trial '{}', {}: a predicted value is not finite", b.trial, b.channel);
    residuals.push_back(std::move(residual));
  }
  return residuals;
}

Result<std::vector<Vector>> HeldOut::ResidualsWithPriors(const Vector& point) const {
  SINEW_ASSIGN(auto residuals, Residuals(point));
  if (priors_.empty()) return residuals;
  const Vector parameters = Fitted(point);
  Vector deviations(static_cast<Eigen::Index>(priors_.size()));
  for (std::size_t i = 0; i < priors_.size(); ++i) {
    const Parameter& p = problem_.parameters()[static_cast<std::size_t>(priors_[i])];
    const double value = parameters[priors_[i]];
    deviations[static_cast<Eigen::Index>(i)] =
        ((p.scale == Scale::kLog ? std::log(value) : value) - p.prior->mean) / p.prior->standard_deviation;
  }
  residuals.push_back(std::move(deviations));
  return residuals;
}

Status HeldOut::EstimateOwnNoise(const std::vector<Vector>& base) {
  std::vector<noise::NoiseBlock> blocks;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (block(i).group.empty()) continue;
    noise::NoiseBlock noise;
    noise.channel = block(i).channel;
    noise.residual = base[i];
    noise.regressors = Matrix(base[i].size(), 0);
    noise.stretches = noise::Stretches(block(i));
    blocks.push_back(std::move(noise));
  }
  if (blocks.empty()) return {};
  SINEW_ASSIGN(own_, noise::EstimateNoiseModel(blocks, {}));
  return {};
}

const noise::ChannelNoiseModel* HeldOut::NoiseOf(const Block& block, const noise::NoiseModel& trained) const {
  const noise::ChannelNoiseModel* own = block.group.empty() ? nullptr : ChannelOf(own_, block.channel);
  return own != nullptr ? own : TrainedNoiseOf(block, trained, problem_.layout());
}

double HeldOut::FloorOf(const Block& block, const noise::NoiseModel& trained) const {
  const noise::ChannelNoiseModel* own = block.group.empty() ? nullptr : ChannelOf(own_, block.channel);
  return own != nullptr ? own->ProcessDeviation() : NoiseFloorOf(block, trained, problem_.layout());
}

Matrix HeldOut::WhitenedBlock(std::size_t i, const Matrix& given, const noise::NoiseModel& noise) const {
  const noise::ChannelNoiseModel* model = NoiseOf(block(i), noise);
  if (model == nullptr) return Matrix::Zero(given.rows(), given.cols());
  noise::NoiseModel one;
  one.channels = {*model};
  one.channel_of = {0};
  Matrix rows = given;
  noise::Whitening(one, {noise::Stretches(block(i))}).Apply(0, rows);
  return rows;
}

double HeldOut::Innovations(const std::vector<Vector>& residuals, const noise::NoiseModel& noise) const {
  double sum = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i) sum += WhitenedBlock(i, residuals[i], noise).squaredNorm();
  for (std::size_t i = blocks_.size(); i < residuals.size(); ++i) sum += residuals[i].squaredNorm();
  return sum;
}

Matrix HeldOut::Whitened(const Matrix& rows, const noise::NoiseModel& noise) const {
  Matrix white(rows.rows(), rows.cols());
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Eigen::Index count = block(i).samples();
    white.middleRows(first, count) = WhitenedBlock(i, rows.middleRows(first, count), noise);
    first += count;
  }
  white.bottomRows(rows.rows() - first) = rows.bottomRows(rows.rows() - first);
  return white;
}

std::vector<double> HeldOut::InnovationsOfGroups(const std::vector<Vector>& residuals,
                                                 const noise::NoiseModel& noise) const {
  std::map<std::pair<std::string, int>, double> sums;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (block(i).group.empty()) continue;
    const Vector white = WhitenedBlock(i, residuals[i], noise);
    for (Eigen::Index k = 0; k < white.size(); ++k)
      sums[{block(i).trial, block(i).group[static_cast<std::size_t>(k)]}] += white[k] * white[k];
  }
  std::vector<double> of_groups;
  for (const auto& [group, sum] : sums) of_groups.push_back(sum);
  return of_groups;
}

std::vector<Gain> HeldOut::Gains(const std::vector<Vector>& before, const std::vector<Vector>& after,
                                 const noise::NoiseModel& floor, std::uint64_t seed) const {
  std::vector<std::string> order;
  std::map<std::string, std::vector<std::size_t>> blocks_of;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Block& b = block(i);
    const std::string& quantity = b.quantity.empty() ? b.channel : b.quantity;
    if (blocks_of.count(quantity) == 0) order.push_back(quantity);
    blocks_of[quantity].push_back(i);
  }
  std::vector<Gain> gains;
  for (const std::string& quantity : order) {
    Gain gain;
    gain.channel = quantity;
    double sum_before = 0;
    double sum_after = 0;
    double sum_floor = 0;
    double count = 0;
    for (const std::size_t i : blocks_of[quantity]) {
      const double weight = block(i).weight;
      gain.unit = block(i).unit;
      sum_before += before[i].squaredNorm() / (weight * weight);
      sum_after += after[i].squaredNorm() / (weight * weight);
      const double noise = FloorOf(block(i), floor) / weight;
      sum_floor += static_cast<double>(before[i].size()) * noise * noise;
      count += static_cast<double>(before[i].size());
    }
    if (count == 0) continue;
    gain.before = std::sqrt(sum_before / count);
    gain.after = std::sqrt(sum_after / count);
    gain.reduction = sum_before > 0 ? 1 - gain.after / gain.before : 0;
    const double gap = sum_before - sum_floor;
    gain.gap_closed =
        gap > 0 ? std::min(1.0, (sum_before - sum_after) / gap) : std::numeric_limits<double>::quiet_NaN();

    Random random(Random::StreamSeed(seed, gains.size()));
    std::vector<double> reductions;
    for (int draw = 0; draw < kDraws; ++draw) {
      double drawn_before = 0;
      double drawn_after = 0;
      for (const std::size_t i : blocks_of[quantity]) {
        const auto n = before[i].size();
        const auto length = std::min<Eigen::Index>(
            n, std::max<Eigen::Index>(kShortestBlock,
                                      static_cast<Eigen::Index>(kBlockShare * static_cast<double>(n))));
        for (Eigen::Index filled = 0; filled < n; filled += length) {
          const auto at = static_cast<Eigen::Index>(random.Index(static_cast<std::uint64_t>(n - length + 1)));
          const double weight = block(i).weight;
          drawn_before += before[i].segment(at, length).squaredNorm() / (weight * weight);
          drawn_after += after[i].segment(at, length).squaredNorm() / (weight * weight);
        }
      }
      reductions.push_back(drawn_before > 0 ? 1 - std::sqrt(drawn_after / drawn_before) : 0);
    }
    std::sort(reductions.begin(), reductions.end());
    gain.ci95 = {Quantile(reductions, 0.025), Quantile(reductions, 0.975)};
    gains.push_back(std::move(gain));
  }
  return gains;
}

}  // namespace sinew::diagnosis
