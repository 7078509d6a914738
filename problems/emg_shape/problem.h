// The EMG of a person in a cyclic movement, from the angle and the speed alone. Thesis ch. 6; SCIENCE section
// 5, model (b).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/problem.h"
#include "problems/emg_shape/data.h"
#include "problems/emg_shape/parameters.h"
#include "problems/emg_shape/prediction/block.h"

namespace sinew {

/// Channels MUSCLE [1], one per muscle and trial; parameters as in parameters.h.
class EmgShapeProblem final : public Problem {
 public:
  /// Errors: those of PrepareEmgShapeData.
  static Result<std::unique_ptr<EmgShapeProblem>> Make(const Dataset& data, EmgShapeSettings settings);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return list_.parameters; }
  [[nodiscard]] const Layout& layout() const override { return data_.layout; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return list_.effects; }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return list_.ports; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  /// Minima lie along the lead, which moves bursts over the cuts between them.
  [[nodiscard]] const char* default_solver() const override { return "starts"; }
  /// Angle, phase and number of the cycle.
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override;
  /// Timing jitter; speeds that lie outside of the measured ones.
  [[nodiscard]] std::vector<Warning> WarningsAt(const Vector& parameters) const override;
  /// emg_shape/shapes/MUSCLE/{phase, shape}; emg_shape/trials/TRIAL/{time, begin, end} and, per muscle,
  /// TRIAL/MUSCLE/{predicted, deviation} (prediction_band.h).
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;

  [[nodiscard]] const EmgShapeData& data() const { return data_; }
  [[nodiscard]] const EmgShapeSettings& settings() const { return settings_; }

 private:
  EmgShapeProblem(EmgShapeSettings settings, EmgShapeData data);

  EmgShapeSettings settings_;
  EmgShapeData data_;
  EmgShapeParameters list_;
  std::vector<EmgBlock> blocks_;  // of the layout
};

}  // namespace sinew
