// One actuated joint: which inertia, friction, gravity and motor explain the measured motion? SCIENCE section
// 2. drive.h has the equations of the joint.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "identify/problem.h"
#include "identify/shooting/trajectory_plan.h"
#include "problems/drive/data/data.h"

namespace sinew {

/// Channels per trial: position, speed, torque (a linear axis: force) and, for electric drives, current. The
/// fitted ones are compared with the measurement, the others are predicted.
///
/// The step of the integrator is `step` of drive.yaml. Without it, it is at most 10 ms and halved (up to five
/// times) until halving it once more moves no predicted position at the starts by more than 1e-4 of the
/// spread of the measured positions, nor by more than 0.3 of the noise that their differences show. Steps end
/// at samples of the input.
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
  /// Noise of a recorded torque or force whose level the data state; other inputs are known exactly.
  Result<bool> PredictWithInputNoise(const Query& query, std::uint64_t draw, Workspace& workspace,
                                     Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override;
  /// Per trial: time, position, speed, torque of the drive, current.
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;
  /// position, velocity (measured, or a smoothed difference) and command.
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override;

  /// Multiple shooting, where small differences grow; else nothing.
  [[nodiscard]] std::optional<Vector> ImprovedStart(const std::vector<int>& free,
                                                    const std::vector<bool>& compared,
                                                    const Vector& parameters) const override;
  [[nodiscard]] std::vector<Warning> WarningsAt(const Vector& parameters) const override;

  [[nodiscard]] const DriveData& data() const { return data_; }

 private:
  friend class DriveWindows;
  static constexpr double kStepError = 1e-4;        ///< of the spread of the positions
  static constexpr double kStepErrorOfNoise = 0.3;  ///< of the visible noise of the positions
  struct Scratch;
  /// A stretch of a trial that is predicted as one trajectory, from a state of its own.
  struct Segment {
    std::size_t run = 0;
    std::size_t first = 0;  ///< stop where it begins
    std::size_t end = 0;    ///< stop after its last
    double position = 0;    ///< start of its state
    double speed = 0;
    int state = 0;  ///< index of its first parameter, the position; the others follow
  };
  /// Stops from `first` to before `end`, from a state; the state is that of variables 0 and 1 of `lanes`.
  struct Stretch {
    std::size_t run = 0;
    std::size_t first = 0;
    std::size_t end = 0;
    double position = 0;
    double speed = 0;
    double integral = 0;                 ///< output of the controller's integral
    std::optional<double> reading = {};  ///< of the position at its first stop, as measured
  };
  explicit DriveProblem(DriveData data);
  void ListParameters();
  /// [unit of the position] by which halving the step may move a prediction.
  [[nodiscard]] double LargestStepError() const;
  /// Halves the step until halving it again moves no predicted position by more than `enough`.
  Status ChooseStep(double enough, int max_halvings);
  /// Finds out whether small differences grow over a trial; if so, finds starts by multiple shooting and cuts
  /// the trials into trajectories (shooting::MakePlan).
  Status PlanTrajectories(bool choose_step);
  /// @param free the base parameters that the plan has found
  void TakeOver(const shooting::Plan& plan, const std::vector<int>& free);
  /// Predict with the inputs of these runs in place of its own.
  Status PredictDrivenBy(const std::vector<DriveRun>& runs, const Query& query, Scratch& scratch,
                         Prediction& prediction) const;
  [[nodiscard]] int IndexOf(int slot, const Segment& segment) const;
  Status PredictSegment(const Segment& segment, const Query& query, Scratch& scratch,
                        Prediction& prediction) const;
  /// Integrates with the derivatives of `lanes` (slot and column) from `first_lane` on, at most `lanes`.
  /// @param wants_torque torque and current are read, too.
  template <class T, class Sink>
  Status Integrate(const Stretch& stretch, const Vector& parameters, std::size_t first_lane,
                   std::size_t lanes, bool wants_torque, Scratch& scratch, std::vector<T>& history,
                   Sink&& sink) const;
  /// What a sink gets of one stop: a channel (or -1 position, -2 speed, of the joint itself), its value, and
  /// the slopes of lanes first .. first + count - 1.
  using LaneSink = std::function<void(std::size_t stop, int channel, double value, const double* slopes,
                                      std::size_t first, std::size_t count)>;
  /// All lanes, in as many passes as it takes.
  Status IntegrateLanes(const Stretch& stretch, const Vector& parameters,
                        const std::vector<std::pair<int, int>>& lanes, Workspace& workspace,
                        const LaneSink& sink) const;
  /// Calls pass(T(), first lane, lanes, history) with dual numbers of the right width for all lanes.
  template <class F>
  static Status InPasses(Scratch& scratch, F&& pass);

  DriveData data_;
  DriveParameterList list_;
  std::size_t shared_ = 0;  ///< parameters before the nuisance values
  std::size_t states_ = 2;  ///< nuisance values per segment: position, speed, and integral if it is fitted
  std::vector<std::vector<int>> blocks_of_run_;
  std::vector<Segment> segments_;           ///< in the order of the runs, then of time
  std::vector<std::size_t> first_segment_;  ///< [runs + 1] of each run
  std::vector<shooting::Arc> arcs_;  ///< [segments] with their windows; empty: nowhere does anything grow
  std::size_t history_ = 1;
};

/// The parameters of a joint driven by torque with their default ranges, without data.
[[nodiscard]] std::vector<Parameter> DefaultDriveParameters();

}  // namespace sinew
