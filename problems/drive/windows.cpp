#include "problems/drive/windows.h"

#include <algorithm>
#include <cmath>

#include "identify/shooting/multiple_shooting.h"
#include "problems/drive/data/trial.h"

namespace sinew {
namespace {

constexpr std::size_t kSamples = 8;     // of the shortest window
constexpr std::size_t kMostJoined = 8;  // of these in one window
constexpr double kGrowthOfWindow = 2;
/// Small differences that grow by less over a trial leave no search lost.
constexpr double kGrowthThatMatters = 30;

}  // namespace

DriveWindows::DriveWindows(const DriveProblem& problem, std::vector<Arc> arcs,
                           const std::vector<bool>& compared)
    : problem_(problem), arcs_(std::move(arcs)), compared_(compared), workspace_(problem.NewWorkspace()) {
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
  for (const DriveMotion& motion : problem.data_.motions) {
    for (std::size_t i = 1; i < motion.time.size(); ++i) {
      const double length = motion.time[i] - motion.time[i - 1];
      speed += motion.speed[i] * motion.speed[i] * length;
      acceleration += std::pow(motion.speed[i] - motion.speed[i - 1], 2) / length;
    }
  }
  typical_ = Vector::Constant(2, std::sqrt(std::max(speed, 1e-30)));
  typical_[0] = speed > 0 && acceleration > 0 ? speed / std::sqrt(acceleration) : 1;
  double duration = 0;
  for (const DriveMotion& motion : problem.data_.motions)
    duration += motion.time.back() - motion.time.front();
  typical_ /= std::sqrt(duration);
}

std::vector<DriveWindows::Arc> DriveWindows::Regular(const DriveProblem& problem,
                                                     const std::vector<std::size_t>& segments,
                                                     const std::vector<bool>& compared, std::size_t samples) {
  const DriveWindows none(problem, {}, compared);
  std::vector<Arc> arcs;
  for (const std::size_t s : segments) {
    const auto& segment = problem.segments_[s];
    Arc arc{s, {segment.first}};
    std::size_t since = 0;
    for (std::size_t stop = segment.first; stop < segment.end; ++stop) {
      bool sampled = false;
      for (const int block : problem.blocks_of_run_[segment.run]) {
        const auto b = static_cast<std::size_t>(block);
        const int row = problem.data_.blocks[b].rows[stop];
        sampled = sampled || (compared[b] && row >= 0 && none.sample_of_row_[b][static_cast<std::size_t>(row)] >= 0);
      }
      if (!sampled) continue;
      if (since >= samples) {
        arc.begins.push_back(stop);
        since = 0;
      }
      ++since;
    }
    // The last window is no shorter than the others.
    if (arc.begins.size() > 1 && since < samples) arc.begins.pop_back();
    arcs.push_back(std::move(arc));
  }
  return arcs;
}

Vector DriveWindows::MeasuredState(std::size_t arc, std::size_t window) const {
  const auto& segment = problem_.segments_[arcs_[arc].segment];
  const DriveRun& run = problem_.data_.runs[segment.run];
  const DriveMotion& motion = problem_.data_.motions[segment.run];
  const std::size_t stop = arcs_[arc].begins[window];
  Vector state(2);
  if (stop == 0) {
    state << run.initial_position, run.initial_speed;
  } else {
    state << At(motion.time, motion.position, run.stops[stop]), At(motion.time, motion.speed, run.stops[stop]);
  }
  return state;
}

Status DriveWindows::Shoot(std::size_t arc, std::size_t window, const Vector& parameters, const Vector& state,
                           const std::vector<int>& free, bool derivatives, shooting::Shot& shot) const {
  const Arc& of = arcs_[arc];
  const auto& segment = problem_.segments_[of.segment];
  const bool last = window + 1 == of.begins.size();
  const std::size_t end = last ? segment.end : of.begins[window + 1];
  const auto p = static_cast<Eigen::Index>(free.size());
  std::vector<std::pair<int, int>> lanes;
  if (derivatives) {
    lanes = {{kInitialPosition, 0}, {kInitialSpeed, 1}};
    for (std::size_t k = 0; k < free.size(); ++k) {
      const auto index = static_cast<std::size_t>(free[k]);
      if (index < slot_of_.size() && slot_of_[index] >= 0)
        lanes.emplace_back(slot_of_[index], static_cast<int>(k) + 2);
    }
  }
  std::vector<std::vector<std::pair<int, int>>> rows_of_stop(end - of.begins[window]);
  int m = 0;
  for (std::size_t stop = of.begins[window]; stop < end; ++stop) {
    for (const int block : problem_.blocks_of_run_[segment.run]) {
      const auto b = static_cast<std::size_t>(block);
      const int row = problem_.data_.blocks[b].rows[stop];
      if (!compared_[b] || row < 0 || sample_of_row_[b][static_cast<std::size_t>(row)] < 0) continue;
      rows_of_stop[stop - of.begins[window]].emplace_back(block, m++);
    }
  }
  shot.residual.resize(m);
  if (derivatives) {
    shot.by_state.setZero(m, 2);
    shot.by_parameter.setZero(m, p);
    shot.end_by_state.setZero(last ? 0 : 2, 2);
    shot.end_by_parameter.setZero(last ? 0 : 2, p);
  }
  shot.end.resize(last ? 0 : 2);
  const auto put = [&](int column, Eigen::Index row, double value, Matrix& by_state, Matrix& by_parameter) {
    if (column < 2) {
      by_state(row, column) = value;
    } else {
      by_parameter(row, column - 2) = value;
    }
  };
  const DriveProblem::Stretch stretch{segment.run, of.begins[window], last ? end : end + 1, state[0], state[1]};
  SINEW_TRY(problem_.IntegrateLanes(
      stretch, parameters, lanes, *workspace_,
      [&](std::size_t stop, int channel, double value, const double* slopes, std::size_t first,
          std::size_t count) {
        if (channel < 0) {  // the state itself
          if (last || stop != end) return;
          const Eigen::Index row = -1 - channel;
          shot.end[row] = value;
          for (std::size_t i = 0; i < count; ++i)
            put(lanes[first + i].second, row, slopes[i], shot.end_by_state, shot.end_by_parameter);
          return;
        }
        if (stop >= end) return;
        for (const auto& [block, row] : rows_of_stop[stop - of.begins[window]]) {
          const auto b = static_cast<std::size_t>(block);
          if (problem_.data_.blocks[b].channel != channel) continue;
          const Block& compared = problem_.layout()[b];
          const auto i = static_cast<std::size_t>(
              sample_of_row_[b][static_cast<std::size_t>(problem_.data_.blocks[b].rows[stop])]);
          const double weight = compared.WeightOf(i);
          shot.residual[row] = weight * (value - compared.measured[i]);
          for (std::size_t k = 0; k < count; ++k)
            put(lanes[first + k].second, row, weight * slopes[k], shot.by_state, shot.by_parameter);
        }
      }));
  const bool finite = shot.residual.allFinite() && shot.end.allFinite() &&
                      (!derivatives || (shot.by_state.allFinite() && shot.by_parameter.allFinite() &&
                                        shot.end_by_state.allFinite() && shot.end_by_parameter.allFinite()));
  if (!finite) return Fail("trial '{}': the prediction is not finite", problem_.data_.runs[segment.run].trial);
  return {};
}

namespace {

std::vector<bool> Compared(const Layout& layout, bool train, bool validate) {
  std::vector<bool> compared;
  for (const Block& block : layout) {
    compared.push_back((train && block.role == BlockRole::kTrain) ||
                       (validate && block.role == BlockRole::kValidate));
  }
  return compared;
}

}  // namespace

std::vector<std::size_t> DriveProblem::SegmentsOf(const std::vector<bool>& compared) const {
  std::vector<std::size_t> segments;
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    const auto& blocks = blocks_of_run_[segments_[s].run];
    if (std::any_of(blocks.begin(), blocks.end(), [&](int b) { return compared[static_cast<std::size_t>(b)]; }))
      segments.push_back(s);
  }
  return segments;
}

Status DriveProblem::PlanSegments(bool choose_step) {
  if (data_.command.sampled()) return {};  // its controller has a memory, and keeps the joint from diverging
  for (const DriveMotion& motion : data_.motions) {
    if (motion.speed_measured) return {};  // positions are not known from the measurement
  }
  const std::vector<bool> all = Compared(data_.layout, true, true);
  const Vector rest = RestPoint(*this);
  const DriveWindows regular(*this, DriveWindows::Regular(*this, SegmentsOf(all), all, kSamples), all);
  const auto transitions = shooting::Transitions(regular, rest, {});
  if (!transitions) return {};
  double growth = 0;
  for (const auto& of_arc : *transitions) growth = std::max(growth, shooting::LargestGrowth(of_arc));
  if (getenv("SHOOT_DEBUG")) fprintf(stderr, "growth %g typical %g %g\n", growth, regular.TypicalState()[0], regular.TypicalState()[1]);
  if (growth < kGrowthThatMatters) return {};
  nodes_.resize(segments_.size());
  for (std::size_t a = 0; a < regular.arcs(); ++a) {
    const DriveWindows::Arc& arc = regular.all()[a];
    for (const std::size_t w : shooting::Join((*transitions)[a], kGrowthOfWindow, kMostJoined))
      nodes_[arc.segment].push_back(arc.begins[w]);
  }
  (void)choose_step;
  const auto take = [&](bool train) {
    std::vector<int> free;
    for (std::size_t i = 0; train && i < shared_; ++i) {
      if (list_.parameters[i].kind == ParameterKind::kBase) free.push_back(static_cast<int>(i));
    }
    const auto improved = ImprovedStart(free, Compared(data_.layout, train, !train), RestPoint(*this));
    if (!improved) return;
    for (std::size_t i = 0; i < list_.parameters.size(); ++i) {
      if (list_.parameters[i].kind != ParameterKind::kEffect)
        list_.parameters[i].start = (*improved)[static_cast<Eigen::Index>(i)];
    }
  };
  take(true);
  take(false);
  return {};
}

std::optional<Vector> DriveProblem::ImprovedStart(const std::vector<int>& free,
                                                  const std::vector<bool>& compared,
                                                  const Vector& parameters) const {
  if (nodes_.empty()) return {};
  std::vector<DriveWindows::Arc> arcs;
  for (const std::size_t s : SegmentsOf(compared)) arcs.push_back({s, nodes_[s]});
  if (arcs.empty()) return {};
  const DriveWindows windows(*this, arcs, compared);
  std::vector<int> shared;
  std::copy_if(free.begin(), free.end(), std::back_inserter(shared),
               [this](int index) { return index < static_cast<int>(shared_); });
  const auto solved = shooting::Solve(windows, list_.parameters, shared, parameters);
  if (!solved) return {};
  if (getenv("SHOOT_DEBUG")) fprintf(stderr, "cost free %g closed %g gap %g\n", solved->free_cost, solved->cost, solved->largest_gap);
  Vector improved = solved->parameters;
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    const int state = segments_[arcs[a].segment].state;
    for (int k = 0; k < 2; ++k) {
      const Parameter& p = list_.parameters[static_cast<std::size_t>(state + k)];
      improved[state + k] = std::clamp(solved->states[a](k, 0), p.lower, p.upper);
    }
  }
  return improved;
}

std::vector<std::string> DriveProblem::WarningsAt(const Vector& /*parameters*/) const {
  return {};
}

}  // namespace sinew
