#include "problems/emg_shape/prediction/band.h"

#include <algorithm>
#include <cmath>

#include "base/decompositions.h"

namespace sinew {
namespace {

class Band {
 public:
  Band(const EmgShapeProblem& problem, const Vector& parameters)
      : problem_(problem), data_(problem.data()), prediction_(problem.layout()), point_(parameters) {
    // Held-out cycles have the mean gain and timing.
    for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
      const Parameter& p = problem.parameters()[i];
      const auto index = static_cast<Eigen::Index>(i);
      const bool of_cycle = p.kind == ParameterKind::kNuisance && !p.trial.empty();
      of_cycle_.push_back(of_cycle);
      variable_.push_back(-1);
      if (p.kind == ParameterKind::kEffect && point_[index] == p.null_value) continue;
      variable_.back() = count_++;
      if (of_cycle) point_[index] = 0;
    }
  }

  Result<std::vector<Vector>> Run(const Vector& fitted) {
    if (data_.trained_speeds() == 0) return std::vector<Vector>();
    SINEW_TRY(FindCovariance(fitted));
    const std::vector<bool> all(problem_.layout().size(), true);
    const auto workspace = problem_.NewWorkspace();
    SINEW_TRY(problem_.Predict({point_, all, true, nullptr}, *workspace, prediction_));
    FindFactors();
    std::vector<Vector> deviations;
    for (std::size_t t = 0; t < data_.trials.size(); ++t) {
      for (std::size_t m = 0; m < data_.muscles.size(); ++m) deviations.push_back(Deviation(t, m));
    }
    return deviations;
  }

 private:
  // Of all that was fitted, at the fitted point: single cycles, once known, determine the rest better.
  Status FindCovariance(const Vector& fitted) {
    const Layout& layout = problem_.layout();
    std::vector<bool> train;
    for (const Block& block : layout) train.push_back(block.role == BlockRole::kTrain);
    const auto workspace = problem_.NewWorkspace();
    SINEW_TRY(problem_.Predict({fitted, train, true, nullptr}, *workspace, prediction_));
    Matrix normal = Matrix::Zero(count_, count_);
    for (std::size_t b = 0; b < layout.size(); ++b) {
      if (!train[b]) continue;
      const Block& block = layout[b];
      const double step = block.prediction_time[1] - block.prediction_time[0];
      const double correlated = std::sqrt(std::max(1.0, kEnvelopeCorrelated_s / step));
      const auto derivatives = prediction_.derivatives(static_cast<int>(b));
      std::vector<Eigen::Index> columns;
      std::vector<int> variables;
      for (std::size_t c = 0; c < block.columns.size(); ++c) {
        const int v = variable_[static_cast<std::size_t>(block.columns[c])];
        if (v < 0) continue;
        columns.push_back(static_cast<Eigen::Index>(c));
        variables.push_back(v);
      }
      Matrix rows(block.samples(), static_cast<Eigen::Index>(columns.size()));
      for (std::size_t c = 0; c < columns.size(); ++c) {
        for (int i = 0; i < block.samples(); ++i)
          rows(i, static_cast<Eigen::Index>(c)) =
              block.WeightOf(static_cast<std::size_t>(i)) / correlated *
              derivatives(block.sample[static_cast<std::size_t>(i)], columns[c]);
      }
      const Matrix product = Gram(rows);
      for (std::size_t c = 0; c < variables.size(); ++c) {
        for (std::size_t r = 0; r < variables.size(); ++r)
          normal(variables[r], variables[c]) +=
              product(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
      }
    }
    for (std::size_t i = 0; i < problem_.parameters().size(); ++i) {
      const Parameter& p = problem_.parameters()[i];
      const int v = variable_[i];
      if (v < 0) continue;
      if (p.prior) normal(v, v) += std::pow(p.prior->standard_deviation, -2);
      // What nothing determines keeps its bounds.
      normal(v, v) += std::pow(p.upper - p.lower, -2);
    }
    covariance_ = Eigen::LDLT<Matrix>(normal).solve(Matrix::Identity(count_, count_));
    if (!covariance_.allFinite()) return Fail("the covariance of the fit is not finite");
    return {};
  }

  struct Parts {
    Vector level;  // [M] EMG above its floor
    Vector slope;  // [M] per cycle
  };

  // The EMG's answer to a gain and to a shift of timing: columns that the block has anyway, or zero.
  [[nodiscard]] Parts PartsOf(std::size_t t, std::size_t m) const {
    const EmgShapeTrial& trial = data_.trials[t];
    const int b = trial.first_block + static_cast<int>(m);
    const auto values = prediction_.values(b);
    Parts parts;
    parts.level = values.array() - values.minCoeff();
    parts.slope = Vector::Zero(values.size());
    for (Eigen::Index i = 1; i + 1 < values.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double step = trial.time[at + 1] - trial.time[at - 1];
      parts.slope[i] = (values[i + 1] - values[i - 1]) / step * trial.period;
    }
    return parts;
  }

  [[nodiscard]] Vector Scatter(std::size_t t, std::size_t m) const {
    const EmgMuscle& muscle = data_.muscles[m];
    const EmgScatterFactors& factor = data_.trials[t].scatter[m];
    const Parts parts = PartsOf(t, m);
    const auto emg = prediction_.values(data_.trials[t].first_block + static_cast<int>(m));
    return muscle.modulated.quiet * muscle.modulated.quiet +
           muscle.modulated.growth * muscle.modulated.growth * emg.array().square() +
           std::pow(factor.gain * muscle.gain.total, 2) * parts.level.array().square() +
           std::pow(factor.timing * muscle.timing.total, 2) * parts.slope.array().square();
  }

  void FindFactors() {
    std::vector<double> squares(data_.speeds.size(), 0);
    std::vector<double> counts(data_.speeds.size(), 0);
    for (std::size_t t = 0; t < data_.trials.size(); ++t) {
      const EmgShapeTrial& trial = data_.trials[t];
      for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
        const Block& block = problem_.layout()[static_cast<std::size_t>(trial.first_block) + m];
        if (block.role != BlockRole::kTrain) continue;
        const Vector variance = Scatter(t, m);
        const auto values = prediction_.values(trial.first_block + static_cast<int>(m));
        for (int i = 0; i < block.samples(); ++i) {
          const int at = block.sample[static_cast<std::size_t>(i)];
          const double r = values[at] - block.measured[static_cast<std::size_t>(i)];
          squares[static_cast<std::size_t>(trial.group)] += r * r / variance[at];
          counts[static_cast<std::size_t>(trial.group)] += 1;
        }
      }
    }
    for (std::size_t s = 0; s < squares.size(); ++s)
      factors_.push_back(counts[s] > 0 ? squares[s] / counts[s] : std::nan(""));
    // A speed that was not measured: as bad as the worse of its neighbours.
    const std::vector<double> measured = factors_;
    for (std::size_t s = 0; s < factors_.size(); ++s) {
      if (std::isfinite(measured[s])) continue;
      double worst = 0;
      for (std::size_t below = s; below-- > 0 && worst == 0;) {
        if (std::isfinite(measured[below])) worst = measured[below];
      }
      for (std::size_t above = s + 1; above < measured.size(); ++above) {
        if (!std::isfinite(measured[above])) continue;
        worst = std::max(worst, measured[above]);
        break;
      }
      factors_[s] = worst;
    }
  }

  [[nodiscard]] Vector Deviation(std::size_t t, std::size_t m) const {
    const EmgShapeTrial& trial = data_.trials[t];
    const auto group = static_cast<std::size_t>(trial.group);
    const int b = trial.first_block + static_cast<int>(m);
    const Block& block = problem_.layout()[static_cast<std::size_t>(b)];
    Vector variance = factors_[group] * Scatter(t, m);
    const auto derivatives = prediction_.derivatives(b);
    std::vector<Eigen::Index> columns;
    std::vector<int> variables;
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      const auto p = static_cast<std::size_t>(block.columns[c]);
      if (variable_[p] < 0 || of_cycle_[p]) continue;
      columns.push_back(static_cast<Eigen::Index>(c));
      variables.push_back(variable_[p]);
    }
    const auto n = static_cast<Eigen::Index>(columns.size());
    Matrix rows(variance.size(), n);
    Matrix covariance(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      rows.col(i) = derivatives.col(columns[static_cast<std::size_t>(i)]);
      for (Eigen::Index j = 0; j < n; ++j)
        covariance(i, j) =
            covariance_(variables[static_cast<std::size_t>(i)], variables[static_cast<std::size_t>(j)]);
    }
    variance += (rows * covariance).cwiseProduct(rows).rowwise().sum();
    if (!data_.speeds[group].trained && data_.trained_speeds() > 1) {
      const Parts parts = PartsOf(t, m);
      variance.array() += kSpeedGain * kSpeedGain * parts.level.array().square() +
                          (kSpeedTiming * kSpeedTiming + kSpeedMuscleTiming * kSpeedMuscleTiming) *
                              parts.slope.array().square();
    }
    return variance.cwiseMax(0).cwiseSqrt();
  }

  const EmgShapeProblem& problem_;
  const EmgShapeData& data_;
  Prediction prediction_;
  Vector point_;
  std::vector<int> variable_;  // [P] or -1
  std::vector<bool> of_cycle_;
  int count_ = 0;
  Matrix covariance_;
  std::vector<double> factors_;  // [speeds]
};

}  // namespace

Result<std::vector<Vector>> PredictionBand(const EmgShapeProblem& problem, const Vector& parameters) {
  return Band(problem, parameters).Run(parameters);
}

}  // namespace sinew
