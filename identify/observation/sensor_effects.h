// What a sensor does to a predicted signal: any problem gets these effects for every channel it is compared
// on, free of charge, by being wrapped.
//
//   observed(t) = gain * predicted(t - time_offset) + offset + drift * (t - middle of the trial)
#pragma once

#include <memory>
#include <vector>

#include "identify/problem.h"

namespace sinew {

/// A problem seen through its sensors. Adds four effects per fitted channel, shared by all trials:
/// CHANNEL.offset, CHANNEL.drift, CHANNEL.gain, CHANNEL.time_offset. At their null the wrapped problem's
/// answer passes unchanged, to the last bit.
///
/// A time offset interpolates the prediction by a natural cubic spline over its prediction times; what it
/// would need beyond them continues as a straight line, so the wrapped problem should predict a margin around
/// its samples.
class SensorEffects final : public Problem {
 public:
  explicit SensorEffects(std::unique_ptr<Problem> inner);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }
  [[nodiscard]] const std::vector<Port>& ports() const override { return inner_->ports(); }
  [[nodiscard]] const std::vector<Constraint>& constraints() const override { return constraints_; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override { return inner_->objective(); }
  Status Describe(const Vector& parameters, Hdf5Node& details) const override;

 private:
  /// Parameter indices of one channel's sensor.
  struct Sensor {
    int offset = 0;
    int drift = 0;
    int gain = 0;
    int time_offset = 0;
  };
  void AddSensor(const std::string& channel);
  Status Observe(const Query& query, int block, const Sensor& sensor, const Prediction& inner,
                 Prediction& observed) const;

  std::unique_ptr<Problem> inner_;
  Eigen::Index inner_parameters_ = 0;
  std::vector<Parameter> parameters_;
  std::vector<Effect> effects_;
  std::vector<Constraint> constraints_;
  Layout layout_;
  std::vector<Sensor> sensors_;
  std::vector<int> sensor_of_;  ///< per block: index into sensors_, -1 for channels that are not compared
};

}  // namespace sinew
