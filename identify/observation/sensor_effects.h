// What a sensor does to a predicted signal: any problem gets these effects for every channel it is compared
// on, free of charge, by being wrapped.
//
//   smooth(t)   = first-order low-pass of predicted(t), time constant low_pass
//   delayed(t)  = smooth(t - time_offset)
//   reading(t)  = gain * delayed(t) + offset + drift * (t - middle of the trial) + unknown terms of the port
//   observed(t) = reading(t), held within +-1/saturation, then rounded to a multiple of quantisation
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/observation/delay_line.h"
#include "identify/observation/reading_port.h"
#include "identify/observation/sensor_parameters.h"
#include "identify/problem.h"

namespace sinew {

/// A problem seen through its sensors. Adds to every channel that is compared
///  - effects shared by all trials: CHANNEL.offset, .drift, .gain, .time_offset, .low_pass, .saturation,
///    .quantisation;
///  - if at least two trials are fitted, for each of these CHANNEL.offset@TRIAL, .drift@TRIAL, .gain@TRIAL,
///    .time_offset@TRIAL, which add to (gains: multiply) the shared ones;
///  - a port CHANNEL, after those of the wrapped problem, see ReadingPort.
/// At their null the wrapped problem's answer passes unchanged, to the last bit.
///
/// A time offset interpolates the prediction by a natural cubic spline over its prediction times; what it
/// would need beyond them continues as a straight line, so the wrapped problem should predict a margin around
/// its samples (those of all trials and of one alone add up to twice the reach of each). A low-pass starts as
/// if the prediction had run straight before its first sample.
///
/// Derivatives are exact but for quantisation, whose true ones are zero or infinite: the rounding is passed
/// over (that of the reading is taken, that for the step is zero). A fit can thus follow the other parameters
/// under a given step but cannot find the step, which is read off the measured values (QuantisationStep) and
/// offered as probe. Quantisation the prediction explains rounded data as long as noise and the error of the
/// rest of the model are well below the step: then a residual is zero but near the edges of the steps. Noise
/// larger than the step hides the rounding, which then is nothing but more noise.
class SensorEffects final : public Problem {
 public:
  explicit SensorEffects(std::unique_ptr<Problem> inner);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return ports_; }
  [[nodiscard]] const std::vector<Constraint>& constraints() const override { return constraints_; }
  [[nodiscard]] const std::vector<FitStep>& steps() const override { return inner_->steps(); }
  [[nodiscard]] std::vector<std::string> WarningsAt(const Vector& parameters) const override {
    return inner_->WarningsAt(parameters.head(inner_parameters_));
  }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override { return inner_->objective(); }
  [[nodiscard]] double cost_noise_level() const override { return inner_->cost_noise_level(); }
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override {
    return inner_->ResidualCovariates(block);
  }

 private:
  /// One channel's sensor.
  struct Sensor {
    int first = 0;  ///< index of its first shared parameter, see SensorEffect
    std::vector<ReadingPort::Term> terms;
  };
  /// A block as its sensor sees it.
  struct ObservedBlock {
    int sensor = -1;               ///< index into sensors_; -1: passes as it is
    int first_of_trial = -1;       ///< index of the first parameter of its trial alone; -1: none
    Eigen::Index of_inner = 0;     ///< columns of the wrapped problem
    double middle = 0;             ///< [s]
    std::vector<DelayLine> delay;  ///< one, if seen through a sensor
  };
  struct SensorWorkspace;
  struct Observation;
  void AddSensor(const std::string& channel);
  void Observe(const Query& query, int block, SensorWorkspace& scratch, Prediction& observed) const;
  void ObserveValues(const Query& query, int block, Observation& o, SensorWorkspace& scratch,
                     Eigen::Ref<Vector> values) const;
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
  Eigen::Index longest_ = 0;             ///< most prediction times of a block
};

}  // namespace sinew
