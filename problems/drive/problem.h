// One actuated joint: which inertia, friction, gravity and motor explain the measured motion? SCIENCE section
// 2. drive.h has the equations of the joint.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "identify/problem.h"
#include "problems/drive/data/data.h"

namespace sinew {

/// Channels per trial: position, speed, torque (a linear axis: force) and, for electric drives, current. The
/// fitted ones are compared with the measurement, the others are predicted.
///
/// The step of the integrator is `step` of drive.yaml. Without it, it is at most 10 ms and halved (up to five
/// times) until halving it once more moves no predicted position at the starts by more than 1e-4 of the
/// spread of the measured positions, which is below what sensors resolve. Steps end at samples of the input.
class DriveProblem final : public Problem {
 public:
  /// Errors: those of PrepareDriveData.
  static Result<std::unique_ptr<DriveProblem>> Make(const Dataset& data, const DriveSettings& settings,
                                                    double margin = 0);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return list_.parameters; }
  [[nodiscard]] const Layout& layout() const override { return data_.layout; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return list_.effects; }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return list_.ports; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override;
  /// Per trial: time, position, speed, torque of the drive, current.
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;
  /// position, velocity (measured, or a smoothed difference) and command.
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override;

  [[nodiscard]] const DriveData& data() const { return data_; }

 private:
  struct Scratch;
  explicit DriveProblem(DriveData data);
  void ListParameters();
  Status ChooseStep();
  [[nodiscard]] int IndexOf(int slot, std::size_t run) const;
  Status PredictRun(std::size_t run, const Query& query, Scratch& scratch, Prediction& prediction) const;
  template <class T>
  Status Pass(std::size_t run, const Query& query, std::size_t first_lane, std::size_t lanes,
              Scratch& scratch, std::vector<T>& history, Prediction& prediction) const;

  DriveData data_;
  DriveParameterList list_;
  std::size_t shared_ = 0;  ///< parameters before the nuisance values
  std::vector<std::vector<int>> blocks_of_run_;
  std::size_t history_ = 1;
};

/// The parameters of a joint driven by torque with their default ranges, without data.
[[nodiscard]] std::vector<Parameter> DefaultDriveParameters();

}  // namespace sinew
