// A body thrown on a table: which contact, friction and geometry explain how it bounces and slides? SCIENCE
// section 4, forward case. free_body.h has the model.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "identify/problem.h"
#include "problems/free_body/data.h"
#include "problems/free_body/effects.h"
#include "problems/free_body/window.h"

namespace sinew {

/// Channels per toss: the pose. Every window of a toss is simulated from the state that fits its own frames
/// best (WindowFit), so parameters are those of contact and body alone, and a toss that was never fitted is
/// predicted window by window too. What a toss does when only its flight before the first touch is known is
/// in Describe.
class FreeBodyProblem final : public Problem {
 public:
  /// Errors: those of PrepareFreeBodyData.
  static Result<std::unique_ptr<FreeBodyProblem>> Make(const Dataset& data, const FreeBodySettings& settings);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return list_.parameters; }
  [[nodiscard]] const Layout& layout() const override { return data_.layout; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return list_.effects; }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return list_.ports; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  /// Windows are predicted in parallel, as far as oneTBB may.
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override;
  [[nodiscard]] const char* default_solver() const override { return "ceres"; }
  [[nodiscard]] double cost_noise_level() const override;
  /// Per toss, under free_body/TRIAL: time, measured and predicted [N x 7] pose of the whole toss from the
  /// state that fits its flight before the first touch; position_error [m] and rotation_error [rad] per
  /// frame.
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;
  /// height of the lowest corner and speed, as measured.
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override;

  [[nodiscard]] const FreeBodyData& data() const { return data_; }
  [[nodiscard]] FreeBodyNumbers NumbersAt(const Vector& parameters) const;

 private:
  struct Scratch;
  FreeBodyProblem(FreeBodyData data, ParameterList list);
  Status PredictWindow(std::size_t window, const Query& query, const FreeBodyNumbers& numbers,
                       const std::vector<int>& slots, Scratch& scratch, Prediction& prediction) const;

  FreeBodyData data_;
  ParameterList list_;
  std::unique_ptr<FittedStates[]> known_;  // [windows]
};

/// Poses [N] of a toss from the state that fits the frames before its first touch. Errors: the model's own.
Result<std::vector<Pose>> PredictWholeToss(const FreeBodyData& data, int toss,
                                           const FreeBodyNumbers& numbers);

/// The parameters of a cube of 0.1 m and 0.37 kg at 2 m/s with their default ranges, without data.
[[nodiscard]] std::vector<Parameter> DefaultFreeBodyParameters();

}  // namespace sinew
