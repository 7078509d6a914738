#include "problems/contact/steps/step_estimate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "problems/contact/load/plate_channels.h"
#include "problems/contact/steps/shared_deviation.h"

namespace sinew {
namespace {

constexpr std::size_t kChannels = ContactProblem::kChannels;
using ByChannel = Eigen::Matrix<double, 6, 6>;  // of a load, for the channels

std::array<double, kChannels> At(const ChannelValues& values, int instant) {
  std::array<double, kChannels> at{};
  for (std::size_t c = 0; c < kChannels; ++c) at[c] = values[c][instant];
  return at;
}

ByChannel Slopes(const std::array<double, kChannels>& v) {
  ByChannel slopes = ByChannel::Zero();
  slopes(kForceX, kFx) = slopes(kForceY, kFy) = slopes(kForceZ, kFz) = 1;
  slopes(kFirstMomentX, kCopX) = v[kFy];
  slopes(kFirstMomentX, kFy) = v[kCopX];
  slopes(kFirstMomentZ, kCopZ) = v[kFy];
  slopes(kFirstMomentZ, kFy) = v[kCopZ];
  slopes(kMomentY, kFreeMoment) = 1;
  slopes(kMomentY, kCopZ) = v[kFx];
  slopes(kMomentY, kFx) = v[kCopZ];
  slopes(kMomentY, kCopX) = -v[kFz];
  slopes(kMomentY, kFz) = -v[kCopX];
  return slopes;
}

// Channels of the stance at some weights, and their derivatives for these.
class StepModel {
 public:
  StepModel(const ContactProblem& problem, const Stance& stance)
      : problem_(problem),
        stance_(stance),
        workspace_(problem.NewWorkspace()),
        prediction_(problem.layout()),
        wanted_(problem.layout().size(), false),
        differentiate_(problem.parameters().size(), false) {
    for (const int block : stance.blocks) wanted_[static_cast<std::size_t>(block)] = true;
    const auto [from, to] = stance.motion_errors.OwnRange();
    for (int i = from; i < to; ++i) differentiate_[static_cast<std::size_t>(i)] = true;
    weights_ = to - from;
  }

  [[nodiscard]] int weights() const { return weights_; }

  Status Predict(const Vector& parameters) {
    SINEW_TRY(problem_.Predict({parameters, wanted_, true, &differentiate_}, *workspace_, prediction_));
    for (std::size_t c = 0; c < kChannels; ++c) {
      values[c] = prediction_.values(stance_.blocks[c]);
      if (!values[c].allFinite()) return Fail("the prediction of a step is not finite");
    }
    return {};
  }
  // Derivatives of a channel [T x weights]; the stance's own weights are the last columns.
  [[nodiscard]] auto Derivatives(std::size_t channel) const {
    const auto all = prediction_.derivatives(stance_.blocks[channel]);
    return all.rightCols(weights_);
  }

  ChannelValues values;

 private:
  const ContactProblem& problem_;
  const Stance& stance_;
  std::unique_ptr<Problem::Workspace> workspace_;
  Prediction prediction_;
  std::vector<bool> wanted_;
  std::vector<bool> differentiate_;
  int weights_ = 0;
};

struct Linear {
  Vector residual;
  Matrix jacobian;
};

Linear Linearised(const StepModel& model, const std::vector<LoadRow>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  Linear linear{Vector(count), Matrix::Zero(count, model.weights())};
  for (Eigen::Index r = 0; r < count; ++r) {
    const LoadRow& row = rows[static_cast<std::size_t>(r)];
    for (const LoadRow::Term& term : row.terms) {
      const auto channels = At(model.values, term.instant);
      const Eigen::Matrix<double, 1, 6> slope = term.factors.transpose() * Slopes(channels) / row.deviation;
      for (std::size_t c = 0; c < kChannels; ++c) {
        const double by_channel = slope[static_cast<Eigen::Index>(c)];
        if (by_channel != 0) linear.jacobian.row(r) += by_channel * model.Derivatives(c).row(term.instant);
      }
    }
    linear.residual[r] = (row.ValueAt(model.values) - row.measured) / row.deviation;
  }
  return linear;
}

double CostOf(const Vector& residual, const Vector& moved, double share, double spread) {
  return 0.5 * share * share * residual.squaredNorm() + 0.5 * moved.squaredNorm() / (spread * spread);
}

// Of the variance that the prior gives a stance's own curves, in units of each and summed over curves and
// instants, the part that its fitted channels determine.
double DeterminedVariance(const ContactProblem& problem, const Stance& stance, const Vector& parameters,
                          const StepModel& model) {
  Matrix precision = Matrix::Identity(model.weights(), model.weights());
  for (std::size_t c = 0; c < kChannels; ++c) {
    const Block& block = problem.layout()[static_cast<std::size_t>(stance.blocks[c])];
    if (block.role != BlockRole::kTrain) continue;
    Matrix rows(block.samples(), model.weights());
    for (std::size_t i = 0; i < block.sample.size(); ++i)
      rows.row(static_cast<Eigen::Index>(i)) = block.WeightOf(i) * model.Derivatives(c).row(block.sample[i]);
    precision += rows.transpose() * rows;
  }
  const Matrix known = Matrix::Identity(model.weights(), model.weights()) -
                       precision.llt().solve(Matrix::Identity(model.weights(), model.weights()));
  double determined = 0;
  const StanceMotionErrors& errors = stance.motion_errors;
  const DeviationBases bases = errors.BasesAt(parameters);
  for (std::size_t i = static_cast<std::size_t>(errors.own); i < errors.terms.size(); ++i) {
    const PoseTerm& term = errors.terms[i];
    const Eigen::Index first = term.first - errors.OwnRange()[0];
    const Matrix of_curve = known.block(first, first, term.weights, term.weights);
    const Matrix& basis = bases.Of(term).value;
    determined += (basis * of_curve).cwiseProduct(basis).sum();
  }
  return determined;
}

}  // namespace

double LoadRow::ValueAt(const ChannelValues& channels) const {
  double value = 0;
  for (const Term& term : terms) value += term.factors.dot(LoadOf(At(channels, term.instant)));
  return value;
}

ContactLoad LoadOf(const std::array<double, kChannels>& v) {
  ContactLoad load;
  load[kForceX] = v[kFx];
  load[kForceY] = v[kFy];
  load[kForceZ] = v[kFz];
  load[kMomentY] = v[kFreeMoment] + v[kCopZ] * v[kFx] - v[kCopX] * v[kFz];
  load[kFirstMomentX] = v[kCopX] * v[kFy];
  load[kFirstMomentZ] = v[kCopZ] * v[kFy];
  return load;
}

Result<StepEstimate> EstimateStep(const ContactProblem& problem, const Stance& stance,
                                  const Vector& parameters, double spread, const std::vector<LoadRow>& rows) {
  constexpr std::array<double, 6> kShares{1.0 / 32, 1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 2, 1};
  constexpr int kSteps = 60;  // of each share
  constexpr double kLeastDamping = 1e-6;
  constexpr double kGreatestDamping = 1e8;
  constexpr double kSettled = 1e-6;   // relative change of the cost
  constexpr double kOnTheWay = 1e-3;  // the same before the last share
  const auto [from, to] = stance.motion_errors.OwnRange();
  const int count = to - from;
  const Vector prior = parameters.segment(from, count);
  const Matrix identity = Matrix::Identity(count, count);
  StepModel model(problem, stance);
  StepModel trial(problem, stance);
  Vector at = parameters;
  SINEW_TRY(model.Predict(at));
  double damping = 1e-3;
  for (const double share : kShares) {
    if (rows.empty()) break;
    for (int step = 0; step < kSteps; ++step) {
      const Linear linear = Linearised(model, rows);
      const Vector moved = at.segment(from, count) - prior;
      const double cost = CostOf(linear.residual, moved, share, spread);
      const Matrix normal =
          share * share * linear.jacobian.transpose() * linear.jacobian + identity / (spread * spread);
      const Vector pull =
          -share * share * linear.jacobian.transpose() * linear.residual - moved / (spread * spread);
      bool lower = false;
      bool settled = false;
      while (!lower && damping < kGreatestDamping) {
        const Vector change = (normal + damping / (spread * spread) * identity).llt().solve(pull);
        Vector there = at;
        for (int i = 0; i < count; ++i) {
          const Parameter& p = problem.parameters()[static_cast<std::size_t>(from + i)];
          there[from + i] = std::clamp(at[from + i] + change[i], p.lower, p.upper);
        }
        if (trial.Predict(there)) {
          const Linear tried = Linearised(trial, rows);
          const double next = CostOf(tried.residual, there.segment(from, count) - prior, share, spread);
          if (next < cost) {
            lower = true;
            settled = cost - next < (share < 1 ? kOnTheWay : kSettled) * cost;
            at = there;
            std::swap(model.values, trial.values);
          }
        }
        damping = lower ? std::max(damping / 5, kLeastDamping) : 8 * damping;
      }
      if (lower) SINEW_TRY(model.Predict(at));
      if (!lower || settled) break;
    }
    damping = std::min(damping, 1.0);
  }

  const Linear linear = Linearised(model, rows);
  StepEstimate estimate{at, model.values, {}};
  estimate.precision.compute(linear.jacobian.transpose() * linear.jacobian + identity / (spread * spread));
  for (std::size_t c = 0; c < kChannels; ++c) {
    const Matrix whitened = estimate.precision.matrixL().solve(Matrix(model.Derivatives(c).transpose()));
    estimate.deviation[c] = whitened.colwise().norm().transpose();
  }
  return estimate;
}

double SpreadOfSteps(const ContactProblem& problem, const std::vector<const Stance*>& fitted,
                     const Vector& parameters) {
  constexpr double kLeast = 0.05;
  const auto steps = static_cast<double>(fitted.size());
  const double of_new_step = 1 + 1 / steps;
  if (fitted.size() < 2) return std::sqrt(of_new_step);
  double squares = 0;
  double determined = 0;
  for (const Stance* stance : fitted) {
    StepModel model(problem, *stance);
    if (!model.Predict(parameters)) continue;
    determined += DeterminedVariance(problem, *stance, parameters, model);
    std::vector<const Stance*> others;
    for (const Stance* other : fitted) {
      if (other != stance) others.push_back(other);
    }
    Vector mean = parameters;
    SetMeanDeviation(others, *stance, mean);
    const StanceMotionErrors& errors = stance->motion_errors;
    const DeviationBases bases = errors.BasesAt(parameters);
    for (std::size_t i = static_cast<std::size_t>(errors.own); i < errors.terms.size(); ++i) {
      const PoseTerm& term = errors.terms[i];
      const Vector apart = (parameters - mean).segment(term.first, term.weights);
      squares += (bases.Of(term).value * apart).squaredNorm();
    }
  }
  if (!(determined > 0)) return std::sqrt(of_new_step);
  const double left_out = 1 + 1 / (steps - 1);  // what a step and the mean of the others vary together
  return std::sqrt(std::max(kLeast * kLeast, squares / determined / left_out) * of_new_step);
}

}  // namespace sinew
