#include "identify/diagnosis/fit/refit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/decompositions.h"
#include "identify/diagnosis/fit/refit_record.h"
#include "identify/diagnosis/score/design.h"
#include "identify/noise/autoregression.h"
#include "identify/noise/input_noise.h"

namespace sinew::diagnosis {
namespace {

constexpr long kScoutEvaluations = 8;  // per start, before the best one is continued
constexpr long kFitEvaluations = 80;
constexpr double kOrdinaryTolerance = 1e-7;  // relative: 0.1 units of deviance in 1e6 samples
constexpr double kWhitenedTolerance = 1e-3;  // absolute, in half the deviance
// The same beside hundreds of values, where searches among kinks of the cost go on for long.
constexpr double kExpectedTolerance = 1e-2;
constexpr int kNoiseRounds = 2;
// Ratio to the least sum of squares above which a fit under coloured noise has absorbed the misfit in the
// noise. (The inefficiency of ordinary least squares costs it a few percent.)
constexpr double kNoiseAbsorbsMisfit = 2;

// Pivots of C'C, over the largest, above which the rank is not in doubt.
constexpr double kClearRank = 1e-8;
// Singular values of columns of unit length, over the largest: below, the rank is lost to rounding.
constexpr double kRankTolerance = 1e-7;
// Component from which a column takes part in a combination that is lost.
constexpr double kTakesPart = 1e-3;

// Inverse of C'C. If the rank is lost, the pseudo-inverse for the columns that take no part in a lost
// combination; all others have an infinite diagonal and zeros beside it.
// @param normal C'C @param columns C, of unit length
Matrix InverseOfNormal(const Matrix& normal, const Matrix& columns) {
  const Eigen::Index n = normal.cols();
  if (n == 0) return normal;
  const Eigen::LDLT<Matrix> ldlt(normal);
  const Vector pivots = ldlt.vectorD();
  if (pivots.minCoeff() > kClearRank * pivots.maxCoeff()) return ldlt.solve(Matrix::Identity(n, n));
  // The singular values of C are those of its R factor; C'C does not have those below 1e-8.
  Matrix rows = Matrix::Zero(std::max(columns.rows(), n), n);
  rows.topRows(columns.rows()) = columns;
  const Eigen::ColPivHouseholderQR<Matrix> qr(rows);
  const Matrix r = qr.matrixR().topRows(n).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Matrix> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector& singular = svd.singularValues();
  const Matrix directions = qr.colsPermutation() * svd.matrixV();
  Matrix inverse = Matrix::Zero(n, n);
  Vector lost = Vector::Zero(n);  // largest component in a lost direction
  for (Eigen::Index d = 0; d < n; ++d) {
    const Vector direction = directions.col(d);
    if (singular[d] > kRankTolerance * singular[0]) {
      inverse += direction * direction.transpose() / (singular[d] * singular[d]);
    } else {
      lost = lost.cwiseMax(direction.cwiseAbs());
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (lost[i] <= kTakesPart) continue;
    inverse.row(i).setZero();
    inverse.col(i).setZero();
    inverse(i, i) = std::numeric_limits<double>::infinity();
  }
  return inverse;
}

// Levels that differ by less weigh the residuals alike.
constexpr double kSameLevel = 0.01;

// Whether whitening leaves the least squares as they are: white noise of one channel, or, beside priors, of
// the levels by which the residuals are weighted already.
bool LeavesTheFit(const noise::NoiseModel& noise, bool priors) {
  if (noise.IsColoured()) return false;
  if (!priors) return noise.channels.size() == 1;
  return std::all_of(noise.channels.begin(), noise.channels.end(),
                     [](const auto& channel) { return std::abs(channel.deviation - 1) < kSameLevel; });
}

// Whether both are white with the same levels.
bool AreAlike(const noise::NoiseModel& a, const noise::NoiseModel& b) {
  if (a.IsColoured() || b.IsColoured() || a.channels.size() != b.channels.size()) return false;
  for (std::size_t c = 0; c < a.channels.size(); ++c) {
    if (!(std::abs(a.channels[c].deviation / b.channels[c].deviation - 1) < kSameLevel)) return false;
  }
  return true;
}

}  // namespace

double IndependentDifference(const Refit& refit, const Refit& reference) {
  const double least = std::numeric_limits<double>::min();
  return reference.rows * std::log(std::max(refit.cost, least) / std::max(reference.cost, least));
}

double LikelihoodDifference(const Refit& refit, const Refit& reference) {
  if (refit.holds_input_noise != reference.holds_input_noise) return IndependentDifference(refit, reference);
  const double difference = refit.deviance - reference.deviance;
  return refit.holds_input_noise ? difference / noise::kInputNoiseDispersion : difference;
}

std::vector<std::vector<int>> TrainStretches(const LeastSquares& fit) {
  std::vector<std::vector<int>> stretches;
  for (const auto& train : fit.train_blocks())
    stretches.push_back(noise::Stretches(fit.problem().layout()[static_cast<std::size_t>(train.block)]));
  return stretches;
}

double Deviance(const LeastSquares& fit, const Vector& residual, const noise::NoiseModel& noise,
                int* counted) {
  std::vector<noise::AutoregressiveFilter> filters;
  for (const noise::ChannelNoiseModel& channel : noise.channels)
    filters.emplace_back(noise::PartialFromCoefficients(channel.coefficients));
  std::vector<double> sum(noise.channels.size(), 0);
  std::vector<double> count(noise.channels.size(), 0);
  double deviance = 0;
  Vector innovations = residual;
  const auto& blocks = fit.train_blocks();
  for (std::size_t t = 0; t < blocks.size(); ++t) {
    const auto channel = static_cast<std::size_t>(noise.channel_of[t]);
    const Block& block = fit.problem().layout()[static_cast<std::size_t>(blocks[t].block)];
    const std::vector<int> stretches = noise::Stretches(block);
    for (std::size_t s = 0; s < stretches.size(); ++s) {
      const int end = s + 1 < stretches.size() ? stretches[s + 1] : block.samples();
      auto rows = innovations.segment(blocks[t].first_row + stretches[s], end - stretches[s]);
      filters[channel].Apply(rows.data(), rows.size());
      sum[channel] += rows.squaredNorm();
      count[channel] += static_cast<double>(rows.size());
      deviance += filters[channel].LogDeterminant(rows.size());
    }
  }
  // The priors are part of the likelihood: a cause that makes an unlikely nuisance value unnecessary is
  // favoured.
  if (!blocks.empty()) {
    const Block& last = fit.problem().layout()[static_cast<std::size_t>(blocks.back().block)];
    deviance += residual.tail(residual.size() - blocks.back().first_row - last.samples()).squaredNorm();
  }
  if (counted != nullptr) *counted = 0;
  for (std::size_t c = 0; c < sum.size(); ++c) {
    if (count[c] == 0) continue;
    if (counted != nullptr) *counted += static_cast<int>(count[c]);
    count[c] -= noise.channels[c].spent;
    const double least = std::pow(noise.channels[c].least_deviation, 2);
    const double variance = std::max({sum[c] / count[c], least, std::numeric_limits<double>::min()});
    // The second term is zero unless the lower limit replaces the estimate.
    deviance += count[c] * std::log(variance) + (sum[c] / variance - count[c]);
  }
  return deviance;
}

namespace {

solvers::LocalFit::Outcome FitFrom(const LeastSquares& fit, const std::vector<Vector>& starts,
                                   const solvers::LocalFit::Tolerance& tolerance) {
  solvers::LocalFit search(fit);
  solvers::LocalFit::Outcome best;
  best.cost = std::numeric_limits<double>::infinity();
  const bool only = starts.size() == 1;
  for (const Vector& start : starts) {
    auto outcome =
        search.Minimize(fit.Variables(start), -1, tolerance, only ? kFitEvaluations : kScoutEvaluations);
    if (outcome.cost < best.cost) {
      best = std::move(outcome);
    } else if (!std::isfinite(best.cost) && !outcome.failure.empty()) {
      best.failure = outcome.failure;
    }
  }
  if (!std::isfinite(best.cost)) return best;
  best.failure.clear();
  if (!best.converged && !only) best = search.Minimize(best.x, -1, tolerance, kFitEvaluations);
  return best;
}

}  // namespace

solvers::LocalFit::Outcome FitFromStarts(const LeastSquares& fit, const std::vector<Vector>& starts,
                                         double tolerance) {
  return FitFrom(fit, starts, {0, tolerance});
}

FitSetup Refitter::SetupWith(const std::vector<int>& released) const {
  FitSetup setup = base_;
  for (const int c : released) {
    const auto& parameters = candidates_[static_cast<std::size_t>(c)].parameters;
    setup.free.insert(setup.free.end(), parameters.begin(), parameters.end());
  }
  std::sort(setup.free.begin(), setup.free.end());
  return setup;
}

Status Refitter::EstimateNoise(LeastSquares& fit, bool white, const noise::NoiseModel* like,
                               Refit& refit) const {
  fit.set_transform(nullptr);
  noise::NoiseModelOptions how;
  how.white = white;
  how.like = like;
  SINEW_ASSIGN(auto rows, NoiseRowsAt(fit, refit.x));
  how.priors = std::move(rows.priors);
  SINEW_ASSIGN(refit.noise, noise::EstimateNoiseModel(rows.blocks, how));
  return {};
}

Status Refitter::Finish(const LeastSquares& fit, Refit& refit) const {
  auto workspace = fit.NewWorkspace();
  Vector residual;
  SINEW_TRY(fit.Evaluate(refit.x, workspace, residual, nullptr));
  refit.point = fit.Parameters(refit.x);
  refit.deviance = Deviance(fit, residual, refit.noise, &refit.rows);
  return {};
}

Refit Refitter::Asked(std::vector<int> released, const std::vector<Vector>& starts) const {
  Refit refit;
  std::sort(released.begin(), released.end());
  refit.released = std::move(released);
  auto setup = std::make_shared<FitSetup>(SetupWith(refit.released));
  setup->rest = starts.front();
  refit.setup = std::move(setup);
  return refit;
}

Refit Refitter::FitOrdinary(std::vector<int> released, const std::vector<Vector>& starts,
                            double tolerance) const {
  return RecordedRefit(problem_, Asked(std::move(released), starts), RefitKind::kOrdinary, starts, tolerance,
                       [&](Refit asked) { return MakeOrdinary(std::move(asked), starts, tolerance); });
}

Refit Refitter::MakeOrdinary(Refit refit, const std::vector<Vector>& starts, double tolerance) const {
  if (interrupt_ != nullptr && interrupt_->load()) {
    refit.failure = "interrupted";
    refit.interrupted = true;
    return refit;
  }
  LeastSquares fit(problem_, *refit.setup);
  const auto found = FitFromStarts(fit, starts, tolerance);
  refit.failure = found.failure;
  if (!refit.usable()) return refit;
  refit.x = found.x;
  refit.cost = found.cost;
  refit.converged = found.converged;
  Status status = EstimateNoise(fit, false, nullptr, refit);
  if (status) status = Finish(fit, refit);
  if (!status) refit.failure = status.error().message;
  return refit;
}

bool Refitter::Expects(const LeastSquares& fit) const {
  return expected_ && expected_->CountsPriors() && !fit.PriorVariables().empty() && !independent_;
}

Refit Refitter::FitUnderExpectedNoise(std::vector<int> released, const std::vector<Vector>& starts) const {
  return RecordedRefit(
      problem_, Asked(std::move(released), starts), RefitKind::kUnderExpectedNoise, starts,
      kExpectedTolerance, [&](Refit asked) { return MakeUnderExpectedNoise(std::move(asked), starts); },
      &*expected_);
}

Refit Refitter::MakeUnderExpectedNoise(Refit refit, const std::vector<Vector>& starts) const {
  if (interrupt_ != nullptr && interrupt_->load()) {
    refit.failure = "interrupted";
    refit.interrupted = true;
    return refit;
  }
  LeastSquares fit(problem_, *refit.setup);
  const auto stretches = TrainStretches(fit);
  noise::NoiseModel under = *expected_;
  std::vector<Vector> from = starts;
  Status status;
  for (int round = 0; round < kNoiseRounds && status; ++round) {
    const noise::Whitening whitening(under, stretches);
    fit.set_transform(&whitening);
    const auto found = FitFrom(fit, from, {kExpectedTolerance, kOrdinaryTolerance});
    fit.set_transform(nullptr);
    refit.failure = found.failure;
    if (!refit.usable()) return refit;
    refit.x = found.x;
    refit.converged = found.converged;
    from = {fit.Parameters(found.x)};
    status = EstimateNoise(fit, false, &under, refit);
    if (!status || AreAlike(under, refit.noise)) break;
    under = refit.noise;
  }
  if (status) {
    auto workspace = fit.NewWorkspace();
    const auto cost = fit.Cost(refit.x, workspace);
    if (cost) refit.cost = *cost;
    status = Finish(fit, refit);
  }
  if (!status) refit.failure = status.error().message;
  return refit;
}

Refit Refitter::Fit(std::vector<int> released, const std::vector<Vector>& starts) const {
  if (expected_) {
    const FitSetup setup = SetupWith(released);
    if (Expects(LeastSquares(problem_, setup))) return FitUnderExpectedNoise(std::move(released), starts);
  }
  const RefitKind kind = independent_ ? RefitKind::kIndependent : RefitKind::kGeneralised;
  return RecordedRefit(
      problem_, Asked(std::move(released), starts), kind, starts, kOrdinaryTolerance,
      [&](Refit asked) { return MakeGeneralised(std::move(asked), starts); },
      input_noise_ ? &*input_noise_ : nullptr);
}

Refit Refitter::MakeGeneralised(Refit refit, const std::vector<Vector>& starts) const {
  refit = MakeOrdinary(std::move(refit), starts, kOrdinaryTolerance);
  if (!refit.usable()) return refit;
  LeastSquares fit(problem_, *refit.setup);
  const Vector ordinary = refit.x;
  if (input_noise_ && noise::MayBeInputNoise(fit, ordinary, true))
    return MakeUnderInputNoise(std::move(refit));
  Status status = independent_ ? Status() : FitGeneralised(fit, refit);
  if (status && !independent_) {
    auto workspace = fit.NewWorkspace();
    Vector residual;
    status = fit.Evaluate(refit.x, workspace, residual, nullptr);
    refit.noise_absorbs_misfit = residual.squaredNorm() > kNoiseAbsorbsMisfit * 2 * refit.cost;
  }
  if (status && (independent_ || refit.noise_absorbs_misfit)) {
    refit.x = ordinary;
    refit.noise_absorbs_misfit = true;
    status = EstimateNoise(fit, true, nullptr, refit);
  }
  if (status) status = Finish(fit, refit);
  if (!status) refit.failure = status.error().message;
  return refit;
}

void Refitter::ExpectInputNoise(const std::vector<int>& released, const Vector& point) {
  const FitSetup setup = SetupWith(released);
  const LeastSquares fit(problem_, setup);
  const Vector x = fit.Variables(point);
  if (!noise::MayBeInputNoise(fit, x, true)) return;
  if (auto model = noise::InputNoiseModel(fit, x)) input_noise_ = std::move(*model);
}

// Generalised least squares from the ordinary fit on, under the noise of the inputs.
Refit Refitter::MakeUnderInputNoise(Refit refit) const {
  LeastSquares fit(problem_, *refit.setup);
  const noise::Whitening whitening(*input_noise_, TrainStretches(fit));
  fit.set_transform(&whitening);
  solvers::LocalFit whitened(fit);
  const auto outcome = whitened.Minimize(refit.x, -1, {kWhitenedTolerance, 0}, kFitEvaluations);
  fit.set_transform(nullptr);
  if (outcome.failure.empty()) {
    refit.x = outcome.x;
    refit.converged = outcome.converged;
  }
  auto workspace = fit.NewWorkspace();
  Vector residual;
  Status status = fit.Evaluate(refit.x, workspace, residual, nullptr);
  if (status) {
    refit.noise = noise::WithLevelsOf(fit, residual, *input_noise_);
    refit.holds_input_noise = true;
    status = Finish(fit, refit);
  }
  if (!status) refit.failure = status.error().message;
  return refit;
}

// Generalised least squares with the noise model of its own residual.
Status Refitter::FitGeneralised(LeastSquares& fit, Refit& refit) const {
  const auto stretches = TrainStretches(fit);
  for (int round = 0; round < kNoiseRounds; ++round) {
    if (round > 0) {
      const noise::NoiseModel before = refit.noise;
      SINEW_TRY(EstimateNoise(fit, false, &before, refit));
      if (AreAlike(before, refit.noise)) break;
    }
    if (LeavesTheFit(refit.noise, !fit.PriorVariables().empty())) break;
    const noise::Whitening whitening(refit.noise, stretches);
    fit.set_transform(&whitening);
    solvers::LocalFit whitened(fit);
    const auto outcome = whitened.Minimize(refit.x, -1, {kWhitenedTolerance, 0}, kFitEvaluations);
    fit.set_transform(nullptr);
    if (!outcome.failure.empty()) break;
    refit.x = outcome.x;
    refit.converged = outcome.converged;
  }
  return {};
}

Result<Matrix> Refitter::Covariance(const Refit& refit, const std::vector<int>& held) const {
  LeastSquares fit(problem_, *refit.setup);
  const noise::Whitening whitening(refit.noise, TrainStretches(fit));
  fit.set_transform(&whitening);
  auto workspace = fit.NewWorkspace();
  SparseJacobian jacobian = fit.NewJacobian();
  Vector residuals;
  SINEW_TRY(fit.Evaluate(refit.x, workspace, residuals, &jacobian));
  const Matrix dense = jacobian.Dense(fit.residuals(), fit.variables());
  const Vector gradient = dense.transpose() * residuals;
  std::vector<Eigen::Index> inside;
  for (Eigen::Index v = 0; v < refit.x.size(); ++v) {
    const bool at_bound = (refit.x[v] <= 0 && gradient[v] >= 0) || (refit.x[v] >= 1 && gradient[v] <= 0);
    const int parameter = refit.setup->free[static_cast<std::size_t>(v)];
    const bool known = std::find(held.begin(), held.end(), parameter) != held.end();
    if (!at_bound && !known && dense.col(v).norm() > 0) inside.push_back(v);
  }
  const auto n = static_cast<Eigen::Index>(inside.size());
  Matrix normal(n, n);
  Vector scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale[i] = dense.col(inside[static_cast<std::size_t>(i)]).norm();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      normal(i, j) =
          dense.col(inside[static_cast<std::size_t>(i)]).dot(dense.col(inside[static_cast<std::size_t>(j)])) /
          (scale[i] * scale[j]);
  }
  Matrix columns(dense.rows(), n);
  for (Eigen::Index i = 0; i < n; ++i)
    columns.col(i) = dense.col(inside[static_cast<std::size_t>(i)]) / scale[i];
  const Matrix inverse = InverseOfNormal(normal, columns);
  Matrix covariance = Matrix::Zero(refit.x.size(), refit.x.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      covariance(inside[static_cast<std::size_t>(i)], inside[static_cast<std::size_t>(j)]) =
          inverse(i, j) / (scale[i] * scale[j]);
  }
  return covariance;
}

}  // namespace sinew::diagnosis
