// The trials of a drive as multiple shooting sees them.
#pragma once

#include <memory>
#include <vector>

#include "identify/shooting/shooting_model.h"
#include "problems/drive/problem.h"

namespace sinew {

/// State: position and speed of the joint. What else a trial remembers (play, a sampled controller) is not
/// carried from window to window.
class DriveWindows final : public shooting::Model {
 public:
  /// @param problem must outlive this. @param compared [layout size] the blocks that are measured against
  DriveWindows(const DriveProblem& problem, const std::vector<bool>& compared);

  [[nodiscard]] int states() const override { return 2; }
  [[nodiscard]] std::size_t trials() const override { return problem_.data_.runs.size(); }
  [[nodiscard]] std::size_t stops(std::size_t trial) const override {
    return problem_.data_.runs[trial].stops.size();
  }
  [[nodiscard]] std::vector<std::size_t> ComparedStops(std::size_t trial) const override;
  [[nodiscard]] Vector MeasuredState(std::size_t trial, std::size_t stop) const override;
  /// The root mean square of the measured speeds, and what it covers in the time in which speeds change by as
  /// much.
  [[nodiscard]] Vector TypicalState() const override { return typical_; }
  Status Shoot(const shooting::Window& window, const Vector& parameters, const Vector& state,
               const std::vector<int>& free, bool derivatives, shooting::Shot& shot) const override;

 private:
  const DriveProblem& problem_;
  std::vector<bool> compared_;
  std::vector<std::vector<int>> sample_of_row_;  // [blocks][rows] sample, or -1
  std::vector<int> slot_of_;                     // [shared parameters] or -1
  Vector typical_;
  std::unique_ptr<Problem::Workspace> workspace_;
};

}  // namespace sinew
