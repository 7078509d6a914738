// Sensor effects on predicted channels: a wrapper that adds them to every compared channel of any problem.
//
//   smooth(t)   = first-order low-pass of predicted(t), time constant low_pass
//   delayed(t)  = smooth(t - time_offset)
//   reading(t)  = gain * delayed(t) + offset + drift * (t - middle of the trial) + discrepancy terms
//   observed(t) = reading(t), clipped at +-1/saturation, then rounded to a multiple of quantisation
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/alternative_prediction.h"
#include "identify/observation/delay_line.h"
#include "identify/observation/later_readings.h"
#include "identify/observation/reading_port.h"
#include "identify/observation/sensor_parameters.h"
#include "identify/problem.h"

namespace sinew {

/// A problem with the sensors of its channels. It adds to every channel that is compared
///  - effects shared by all trials: CHANNEL.offset, .drift, .gain, .time_offset, .low_pass, .saturation,
///    .quantisation;
///  - if at least two trials are fitted, for each of these CHANNEL.offset@TRIAL, .drift@TRIAL, .gain@TRIAL,
///    .time_offset@TRIAL, which add to (gains: multiply) the shared ones;
///  - a port CHANNEL, after those of the wrapped problem, see ReadingPort.
/// At their null the prediction of the wrapped problem is unchanged, to the last bit.
///
/// A time offset interpolates the prediction by a natural cubic spline over its prediction times and
/// extrapolates it linearly, so the wrapped problem should predict a margin around its samples (shared and
/// per-trial offsets together reach twice the bound of each). Where Block::later is known, the record is read
/// later instead: reading(t) and what was measured change by the same, which is exact as far as the record is
/// finer than the signal. A low-pass starts as if the prediction had been linear before its first sample.
///
/// Derivatives are exact except for quantisation, where they are zero or infinite: the derivatives of the
/// reading before rounding are used, and that for the step is zero. A fit can thus estimate the other
/// parameters with a given step but not the step, which is computed from the measured values
/// (QuantisationStep) and used as a probe value. A rounded prediction explains quantised data as long as the
/// noise and the error of the rest of the model are well below the step: the residual is then zero except
/// near the edges of the steps. With noise above the step, quantisation is only additional noise.
class SensorEffects final : public Problem {
 public:
  explicit SensorEffects(std::unique_ptr<Problem> inner);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return ports_; }
  [[nodiscard]] const std::vector<Constraint>& constraints() const override { return constraints_; }
  [[nodiscard]] const std::vector<FitStep>& steps() const override { return inner_->steps(); }
  [[nodiscard]] std::vector<Warning> WarningsAt(const Vector& parameters) const override {
    return inner_->WarningsAt(parameters.head(inner_parameters_));
  }
  /// Of the wrapped problem: parameters of sensors come after its own.
  [[nodiscard]] std::vector<DerivedQuantity> DerivedQuantities() const override {
    return inner_->DerivedQuantities();
  }
  [[nodiscard]] std::vector<AlternativePrediction> Alternatives(const Vector& parameters) const override;
  [[nodiscard]] Vector AtPriors(const Vector& parameters, const Vector& priors, CarryOver how) const override;
  [[nodiscard]] std::optional<UnmeasuredEstimate> EstimateUnmeasured(const Vector& parameters) const override;
  [[nodiscard]] std::vector<FigureOfMerit> FiguresOfMerit(
      const Vector& parameters, const std::vector<Vector>& predicted) const override {
    return inner_->FiguresOfMerit(parameters.head(inner_parameters_), predicted);
  }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  Result<bool> PredictWithInputNoise(const Query& query, std::uint64_t draw, Workspace& workspace,
                                     Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override { return inner_->objective(); }
  [[nodiscard]] bool weights_are_noise_levels() const override { return inner_->weights_are_noise_levels(); }
  [[nodiscard]] double cost_noise_level() const override { return inner_->cost_noise_level(); }
  /// Of the wrapped problem, as if the readings were what it predicts.
  [[nodiscard]] std::optional<Vector> ImprovedStart(const std::vector<int>& free,
                                                    const std::vector<bool>& compared,
                                                    const Vector& parameters) const override;
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override {
    return inner_->ResidualCovariates(block);
  }

 private:
  /// The sensor of one channel.
  struct Sensor {
    int first = 0;  ///< index of its first shared parameter, see SensorEffect
    std::vector<ReadingPort::Term> terms;
  };
  /// How a block passes through its sensor.
  struct ObservedBlock {
    int sensor = -1;               ///< index into sensors_; -1: unchanged
    int first_of_trial = -1;       ///< index of the first parameter of its trial's own effects; -1: none
    Eigen::Index of_inner = 0;     ///< number of columns in the wrapped problem
    double middle = 0;             ///< [s] middle of the trial
    std::vector<DelayLine> delay;  ///< one if it has a sensor, else empty
  };
  struct SensorWorkspace;
  struct Observation;
  void AddSensor(const std::string& channel);
  /// The same request to the wrapped problem.
  [[nodiscard]] Query InnerQuery(const Query& query, SensorWorkspace& scratch) const;
  void ObserveAll(const Query& query, SensorWorkspace& scratch, Prediction& observed) const;
  void Observe(const Query& query, int block, SensorWorkspace& scratch, Prediction& observed) const;
  void ObserveValues(const Query& query, int block, Observation& o, SensorWorkspace& scratch,
                     Eigen::Ref<Vector> values) const;
  /// Interpolates, but for what is read later. @param signal, slope [predictions of the block] set
  void Delay(int block, double delay, SensorWorkspace& scratch, Eigen::Ref<Vector> signal,
             Eigen::Ref<Vector> slope) const;
  /// None of a block without Block::later.
  [[nodiscard]] const std::vector<LaterReadings::Sum>& LaterSums(int block) const;
  void ReadLater(int block, double delay, SensorWorkspace& scratch) const;
  void ObserveDerivatives(const Query& query, int block, const Observation& o, SensorWorkspace& scratch,
                          Eigen::Ref<Matrix> derivatives) const;

  std::unique_ptr<Problem> inner_;
  Eigen::Index inner_parameters_ = 0;
  std::vector<Parameter> parameters_;
  std::vector<Effect> effects_;
  std::vector<DiscrepancyPort> ports_;
  std::vector<Constraint> constraints_;
  Layout layout_;
  std::vector<Sensor> sensors_;
  std::vector<ObservedBlock> observed_;  ///< per block
  Eigen::Index longest_ = 0;             ///< largest number of prediction times of a block
};

}  // namespace sinew
