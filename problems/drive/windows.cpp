#include "problems/drive/windows.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "identify/shooting/multiple_shooting.h"
#include "problems/drive/data/trial.h"

namespace sinew {
namespace {

constexpr std::size_t kSamples = 8;     // of the shortest window
constexpr std::size_t kMostJoined = 8;  // of these in one window
constexpr double kGrowthOfWindow = 2;
/// Small differences that grow by less over a trial leave no search lost.
constexpr double kGrowthThatMatters = 30;
/// Of one trajectory. Rounding, 1e-16, and what is left of gaps stay far below any noise.
constexpr double kMostGrowth = 1e7;
constexpr double kLeastGrowth = 10;
/// A trajectory whose residual is so large a share of the typical state has lost the measurement.
constexpr double kLost = 0.03;
constexpr double kStepErrorOfNoise = 0.03;  // of the residual's root mean square
constexpr int kFineHalvings = 9;

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

std::optional<shooting::Solution> DriveProblem::SolveWindows(const std::vector<int>& free,
                                                             const std::vector<bool>& compared,
                                                             const Vector& parameters) const {
  std::vector<DriveWindows::Arc> arcs;
  for (const std::size_t s : SegmentsOf(compared)) arcs.push_back({s, nodes_[s]});
  if (arcs.empty()) return {};
  const DriveWindows windows(*this, arcs, compared);
  std::vector<int> shared;
  std::copy_if(free.begin(), free.end(), std::back_inserter(shared),
               [this](int index) { return index < static_cast<int>(shared_); });
  auto solved = shooting::Solve(windows, list_.parameters, shared, parameters);
  if (!solved) return {};
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    const int state = segments_[arcs[a].segment].state;
    for (int k = 0; k < 2; ++k) {
      const Parameter& p = list_.parameters[static_cast<std::size_t>(state + k)];
      solved->parameters[state + k] = std::clamp(solved->states[a](k, 0), p.lower, p.upper);
    }
  }
  return std::move(*solved);
}

std::optional<Vector> DriveProblem::ImprovedStart(const std::vector<int>& free,
                                                  const std::vector<bool>& compared,
                                                  const Vector& parameters) const {
  if (nodes_.empty()) return {};
  auto solved = SolveWindows(free, compared, parameters);
  if (!solved) return {};
  return std::move(solved->parameters);
}

// Starts of the parameters from the training trials, then states of the others.
Status DriveProblem::ShootForStarts(std::vector<Trajectory>& found) {
  found.assign(segments_.size(), {});
  for (const bool train : {true, false}) {
    std::vector<int> free;
    for (std::size_t i = 0; train && i < shared_; ++i) {
      if (list_.parameters[i].kind == ParameterKind::kBase) free.push_back(static_cast<int>(i));
    }
    const std::vector<bool> compared = Compared(data_.layout, train, !train);
    const auto segments = SegmentsOf(compared);
    if (segments.empty()) continue;
    const auto solved = SolveWindows(free, compared, RestPoint(*this));
    if (!solved) return Fail("multiple shooting: the windows cannot be integrated");
    for (std::size_t a = 0; a < segments.size(); ++a) {
      found[segments[a]] = {solved->states[a], solved->misfit[a]};
      segments_[segments[a]].position = solved->states[a](0, 0);
      segments_[segments[a]].speed = solved->states[a](1, 0);
    }
    if (!train) continue;
    residual_rms_ = solved->residual_rms;
    for (const int index : free) {
      const auto slot = std::find(list_.index.begin(), list_.index.end(), index) - list_.index.begin();
      data_.starts[static_cast<std::size_t>(slot)] = solved->parameters[index];
    }
    ListParameters();
  }
  ListParameters();
  return {};
}

// Cuts a segment where small differences have grown by `growth` since its begin. @return whether it was cut
bool DriveProblem::Cut(const std::vector<double>& growth, const std::vector<Trajectory>& found) {
  const std::vector<bool> all = Compared(data_.layout, true, true);
  std::vector<DriveWindows::Arc> arcs;
  std::vector<Matrix> states;
  for (const std::size_t s : SegmentsOf(all)) {
    arcs.push_back({s, nodes_[s]});
    states.push_back(found[s].states);
  }
  const DriveWindows windows(*this, arcs, all);
  const auto transitions = shooting::Transitions(windows, RestPoint(*this), states);
  if (!transitions) return false;
  std::vector<Segment> segments;
  std::vector<std::vector<std::size_t>> nodes;
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    const std::size_t s = arcs[a].segment;
    const auto begins = shooting::Join((*transitions)[a], growth[s], nodes_[s].size());
    for (std::size_t k = 0; k < begins.size(); ++k) {
      const bool last = k + 1 == begins.size();
      const std::size_t end = last ? nodes_[s].size() : begins[k + 1];
      Segment part = segments_[s];
      part.first = nodes_[s][begins[k]];
      part.end = last ? segments_[s].end : nodes_[s][end];
      part.position = states[a](0, static_cast<Eigen::Index>(begins[k]));
      part.speed = states[a](1, static_cast<Eigen::Index>(begins[k]));
      segments.push_back(part);
      nodes.emplace_back(nodes_[s].begin() + static_cast<std::ptrdiff_t>(begins[k]),
                         nodes_[s].begin() + static_cast<std::ptrdiff_t>(end));
    }
  }
  const bool cut = segments.size() > segments_.size();
  segments_ = std::move(segments);
  nodes_ = std::move(nodes);
  ListParameters();
  return cut;
}

Status DriveProblem::PlanSegments(bool choose_step) {
  if (data_.command.sampled()) return {};  // its controller has a memory, and keeps the joint from diverging
  for (const DriveMotion& motion : data_.motions) {
    if (motion.speed_measured) return {};  // positions are not known from the measurement
  }
  const std::vector<bool> all = Compared(data_.layout, true, true);
  const auto every = SegmentsOf(all);
  if (every.size() != segments_.size()) return {};
  const DriveWindows regular(*this, DriveWindows::Regular(*this, every, all, kSamples), all);
  const auto transitions = shooting::Transitions(regular, RestPoint(*this), {});
  if (!transitions) return {};
  double growth = 0;
  for (const auto& of_arc : *transitions) growth = std::max(growth, shooting::LargestGrowth(of_arc));
  if (growth < kGrowthThatMatters) return {};
  nodes_.resize(segments_.size());
  for (std::size_t a = 0; a < regular.arcs(); ++a) {
    const DriveWindows::Arc& arc = regular.all()[a];
    for (const std::size_t w : shooting::Join((*transitions)[a], kGrowthOfWindow, kMostJoined))
      nodes_[arc.segment].push_back(arc.begins[w]);
  }
  std::vector<Trajectory> found;
  if (!ShootForStarts(found)) {
    nodes_.clear();
    return {};
  }
  // As long a trajectory as numbers of 16 digits can follow; shorter where the model does not follow the
  // measurement over such a length.
  std::vector<double> limit(segments_.size(), kMostGrowth);
  if (Cut(limit, found)) SINEW_TRY(ShootForStarts(found));
  for (double shorter = 0.01 * kMostGrowth; shorter >= kLeastGrowth; shorter *= 0.1) {
    limit.assign(segments_.size(), kMostGrowth);
    bool lost = false;
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      if (found[s].misfit < kLost) continue;
      limit[s] = shorter;
      lost = true;
    }
    if (!lost) break;
    if (Cut(limit, found)) SINEW_TRY(ShootForStarts(found));
  }
  if (!choose_step) return {};
  double enough = kStepError * data_.scales.position;
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    const Block& block = data_.layout[b];
    if (data_.blocks[b].channel == 0 && block.role == BlockRole::kTrain)
      enough = std::min(enough, kStepErrorOfNoise * residual_rms_ / block.weight);
  }
  const double before = data_.command.step;
  SINEW_TRY(ChooseStep(enough, kFineHalvings));
  if (data_.command.step < before) SINEW_TRY(ShootForStarts(found));
  return {};
}

std::vector<std::string> DriveProblem::WarningsAt(const Vector& /*parameters*/) const {
  std::vector<std::string> warnings;
  for (std::size_t r = 0; r < data_.runs.size(); ++r) {
    const std::size_t count = first_segment_[r + 1] - first_segment_[r];
    if (count == 1) continue;
    const DriveRun& run = data_.runs[r];
    std::vector<std::string> times;
    for (std::size_t s = first_segment_[r] + 1; s < first_segment_[r + 1]; ++s)
      times.push_back(fmt::format("{:.4g}", run.begin + run.stops[segments_[s].first]));
    warnings.push_back(fmt::format(
        "trial '{}' is not predicted as one trajectory but as {}, which begin anew at t = {} s: small differences "
        "grow so much that one would not stay near the measurement",
        run.trial, count, Join(times, ", ")));
  }
  return warnings;
}

}  // namespace sinew
