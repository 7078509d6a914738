// The thesis's subject- and task-specific EMG model as a problem: mean shapes, scaled with speed. SCIENCE
// section 5, model (a).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/problem.h"
#include "models/emg/averaged_emg.h"
#include "problems/emg_shape/data.h"

namespace sinew {

/// Channels MUSCLE [1], one per muscle and trial: factor_m(speed) shape_m(phase), shapes the mean of the
/// training cycles. Parameters MUSCLE.factor and MUSCLE.factor_slope, factor = factor + slope (speed - s0);
/// they start at the regression over the measured peaks, so that `simulate` without --set is exactly the
/// thesis's averaging, and `identify` fits the factors to the whole curves instead of the peaks.
class AveragingProblem final : public Problem {
 public:
  /// Errors: those of PrepareEmgShapeData and AveragedEmg::Build; no training trial.
  static Result<std::unique_ptr<AveragingProblem>> Make(const Dataset& data,
                                                        const EmgShapeSettings& settings);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return data_.layout; }
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  /// Speeds that lie outside of the measured ones.
  [[nodiscard]] std::vector<Warning> WarningsAt(const Vector& parameters) const override;

  [[nodiscard]] const EmgShapeData& data() const { return data_; }
  [[nodiscard]] const AveragedEmg& model() const { return model_; }

 private:
  AveragingProblem(EmgShapeData data, AveragedEmg model);

  EmgShapeData data_;
  AveragedEmg model_;
  std::vector<Parameter> parameters_;       // per muscle: factor and, with several speeds, slope
  int each_ = 2;                            // parameters per muscle
  std::vector<std::vector<double>> shape_;  // [blocks][M] the shape at every sample
};

}  // namespace sinew
