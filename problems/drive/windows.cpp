#include "problems/drive/windows.h"

#include <algorithm>
#include <cmath>

#include "problems/drive/data/trial.h"

namespace sinew {

DriveWindows::DriveWindows(const DriveProblem& problem, const std::vector<bool>& compared)
    : problem_(problem), compared_(compared), workspace_(problem.NewWorkspace()) {
  for (const Block& block : problem.layout()) {
    std::vector<int> samples(block.prediction_time.size(), -1);
    for (std::size_t i = 0; i < block.sample.size(); ++i)
      samples[static_cast<std::size_t>(block.sample[i])] = static_cast<int>(i);
    sample_of_row_.push_back(std::move(samples));
  }
  slot_of_.assign(problem.shared_, -1);
  for (int slot = 0; slot < kDriveSlots; ++slot) {
    const int index = problem.list_.index[static_cast<std::size_t>(slot)];
    if (index >= 0) slot_of_[static_cast<std::size_t>(index)] = slot;
  }
  double speed = 0;
  double acceleration = 0;
  double duration = 0;
  for (const DriveMotion& motion : problem.data_.motions) {
    for (std::size_t i = 1; i < motion.time.size(); ++i) {
      const double length = motion.time[i] - motion.time[i - 1];
      speed += motion.speed[i] * motion.speed[i] * length;
      acceleration += std::pow(motion.speed[i] - motion.speed[i - 1], 2) / length;
      duration += length;
    }
  }
  typical_ = Vector::Ones(2);
  if (!(speed > 0 && acceleration > 0)) return;
  typical_ << speed / std::sqrt(acceleration * duration), std::sqrt(speed / duration);
}

std::vector<std::size_t> DriveWindows::ComparedStops(std::size_t trial) const {
  std::vector<std::size_t> stops;
  for (std::size_t stop = 0; stop < problem_.data_.runs[trial].stops.size(); ++stop) {
    const auto& blocks = problem_.blocks_of_run_[trial];
    const bool compared = std::any_of(blocks.begin(), blocks.end(), [&](int block) {
      const auto b = static_cast<std::size_t>(block);
      const int row = problem_.data_.blocks[b].rows[stop];
      return compared_[b] && row >= 0 && sample_of_row_[b][static_cast<std::size_t>(row)] >= 0;
    });
    if (compared) stops.push_back(stop);
  }
  return stops;
}

Vector DriveWindows::MeasuredState(std::size_t trial, std::size_t stop) const {
  const DriveRun& run = problem_.data_.runs[trial];
  const DriveMotion& motion = problem_.data_.motions[trial];
  Vector state(2);
  if (stop == 0) {
    state << run.initial_position, run.initial_speed;
  } else {
    const double t = run.stops[stop];
    state << At(motion.time, motion.position, t), At(motion.time, motion.speed, t);
  }
  return state;
}

Status DriveWindows::Shoot(const shooting::Window& window, const Vector& parameters, const Vector& state,
                           const std::vector<int>& free, bool derivatives, shooting::Shot& shot) const {
  std::vector<std::pair<int, int>> lanes;
  if (derivatives) {
    lanes = {{kInitialPosition, 0}, {kInitialSpeed, 1}};
    for (std::size_t k = 0; k < free.size(); ++k) {
      const auto index = static_cast<std::size_t>(free[k]);
      if (index < slot_of_.size() && slot_of_[index] >= 0)
        lanes.emplace_back(slot_of_[index], static_cast<int>(k) + 2);
    }
  }
  struct Row {
    std::size_t block;
    std::size_t sample;
    Eigen::Index row;
  };
  std::vector<std::vector<Row>> rows(window.end - window.first);
  Eigen::Index count = 0;
  for (std::size_t stop = window.first; stop < window.end; ++stop) {
    for (const int block : problem_.blocks_of_run_[window.trial]) {
      const auto b = static_cast<std::size_t>(block);
      const int row = problem_.data_.blocks[b].rows[stop];
      if (!compared_[b] || row < 0) continue;
      const int sample = sample_of_row_[b][static_cast<std::size_t>(row)];
      if (sample >= 0) rows[stop - window.first].push_back({b, static_cast<std::size_t>(sample), count++});
    }
  }
  shot.Prepare(count, 2, static_cast<Eigen::Index>(free.size()), window.joined, derivatives);
  const DriveProblem::Stretch stretch{window.trial, window.first, window.joined ? window.end + 1 : window.end,
                                      state[0],     state[1],     0};
  SINEW_TRY(problem_.IntegrateLanes(
      stretch, parameters, lanes, *workspace_,
      [&](std::size_t stop, int channel, double value, const double* slopes, std::size_t first,
          std::size_t passed) {
        const auto put = [&](Eigen::Index row, double factor, Matrix& by_state, Matrix& by_parameter) {
          for (std::size_t i = 0; i < passed; ++i) {
            const int column = lanes[first + i].second;
            (column < 2 ? by_state(row, column) : by_parameter(row, column - 2)) = factor * slopes[i];
          }
        };
        if (stop == window.end) {
          if (channel >= 0) return;
          const Eigen::Index row = -1 - channel;
          shot.end[row] = value;
          put(row, 1, shot.end_by_state, shot.end_by_parameter);
          return;
        }
        for (const Row& of : rows[stop - window.first]) {
          if (problem_.data_.blocks[of.block].channel != channel) continue;
          const Block& block = problem_.layout()[of.block];
          const double weight = block.WeightOf(of.sample);
          shot.residual[of.row] = weight * (value - block.measured[of.sample]);
          put(of.row, weight, shot.by_state, shot.by_parameter);
        }
      }));
  if (!shot.IsFinite())
    return Fail("trial '{}': the prediction is not finite", problem_.data_.runs[window.trial].trial);
  return {};
}

}  // namespace sinew
