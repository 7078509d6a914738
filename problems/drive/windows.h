// The trials of a drive as multiple shooting sees them: an arc per predicted trajectory, cut into windows
// that begin at measured samples.
#pragma once

#include <vector>

#include "identify/shooting/shooting_model.h"
#include "problems/drive/problem.h"

namespace sinew {

/// State: position and speed of the joint. What else a trial remembers (play, a sampled controller) is not
/// carried from window to window.
class DriveWindows final : public shooting::Model {
 public:
  /// One arc: a segment of the problem and the stops at which its windows begin, increasing, its own begin
  /// first.
  struct Arc {
    std::size_t segment = 0;
    std::vector<std::size_t> begins;
  };

  /// @param problem must outlive this. @param compared [layout size] the blocks that are measured against
  DriveWindows(const DriveProblem& problem, std::vector<Arc> arcs, const std::vector<bool>& compared);

  /// Windows of `samples` compared samples each.
  static std::vector<Arc> Regular(const DriveProblem& problem, const std::vector<std::size_t>& segments,
                                  const std::vector<bool>& compared, std::size_t samples);

  [[nodiscard]] int states() const override { return 2; }
  [[nodiscard]] std::size_t arcs() const override { return arcs_.size(); }
  [[nodiscard]] std::size_t windows(std::size_t arc) const override { return arcs_[arc].begins.size(); }
  [[nodiscard]] Vector MeasuredState(std::size_t arc, std::size_t window) const override;
  /// The root mean square of the measured speeds, and what it covers in the time in which speeds change by as
  /// much.
  [[nodiscard]] Vector TypicalState() const override { return typical_; }
  Status Shoot(std::size_t arc, std::size_t window, const Vector& parameters, const Vector& state,
               const std::vector<int>& free, bool derivatives, shooting::Shot& shot) const override;

  [[nodiscard]] const std::vector<Arc>& all() const { return arcs_; }

 private:
  const DriveProblem& problem_;
  std::vector<Arc> arcs_;
  std::vector<bool> compared_;
  std::vector<std::vector<int>> sample_of_row_;  // [blocks][rows] sample, or -1
  std::vector<int> slot_of_;                     // [shared parameters] or -1
  Vector typical_;
  std::unique_ptr<Problem::Workspace> workspace_;
};

}  // namespace sinew
