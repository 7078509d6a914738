// How DriveProblem cuts its trials into trajectories, and finds starts by multiple shooting.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "identify/fit_quality.h"
#include "identify/shooting/trajectory_plan.h"
#include "problems/drive/open_loop_drift.h"
#include "problems/drive/problem.h"
#include "problems/drive/windows.h"

namespace sinew {
namespace {

constexpr double kStepErrorOfResidual = 0.03;  // of the residual's root mean square
constexpr int kFineHalvings = 9;

}  // namespace

Status DriveProblem::PlanTrajectories(bool choose_step) {
  if (data_.command.sampled()) return {};  // its controller has a memory, and keeps the joint from diverging
  for (const DriveMotion& motion : data_.motions) {
    if (motion.speed_measured) return {};  // positions are not known from the measurement
  }
  std::vector<bool> compared;
  std::vector<bool> train(data_.runs.size(), false);
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    const BlockRole role = data_.layout[b].role;
    compared.push_back(role != BlockRole::kPredicted);
    if (role == BlockRole::kTrain) train[static_cast<std::size_t>(data_.blocks[b].run)] = true;
  }
  std::vector<int> free;
  for (std::size_t i = 0; i < shared_; ++i) {
    if (list_.parameters[i].kind == ParameterKind::kBase) free.push_back(static_cast<int>(i));
  }
  shooting::Plan plan =
      shooting::MakePlan(DriveWindows(*this, compared), train, list_.parameters, free, RestPoint(*this), {});
  if (!plan.needed) return {};
  TakeOver(plan, free);
  if (!choose_step) return {};
  double enough = LargestStepError();
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    const Block& block = data_.layout[b];
    if (data_.blocks[b].channel == 0 && block.role == BlockRole::kTrain)
      enough = std::min(enough, kStepErrorOfResidual * plan.residual_rms / block.weight);
  }
  const double before = data_.command.step;
  SINEW_TRY(ChooseStep(enough, kFineHalvings));
  if (data_.command.step == before) return {};
  plan.parameters = RestPoint(*this);
  SINEW_TRY(shooting::Refine(DriveWindows(*this, compared), train, list_.parameters, free, plan));
  TakeOver(plan, free);
  return {};
}

void DriveProblem::TakeOver(const shooting::Plan& plan, const std::vector<int>& free) {
  segments_.clear();
  for (std::size_t a = 0; a < plan.arcs.size(); ++a) {
    const shooting::Arc& arc = plan.arcs[a];
    segments_.push_back(
        {arc.trial, arc.begins.front(), arc.end, plan.states[a](0, 0), plan.states[a](1, 0), 0});
  }
  arcs_ = plan.arcs;
  for (const int index : free) {
    const auto slot = std::find(list_.index.begin(), list_.index.end(), index) - list_.index.begin();
    data_.starts[static_cast<std::size_t>(slot)] = plan.parameters[index];
  }
  ListParameters();
}

std::optional<Vector> DriveProblem::ImprovedStart(const std::vector<int>& free,
                                                  const std::vector<bool>& compared,
                                                  const Vector& parameters) const {
  std::vector<shooting::Arc> arcs;
  std::vector<int> states;
  for (std::size_t a = 0; a < arcs_.size(); ++a) {
    const auto& blocks = blocks_of_run_[arcs_[a].trial];
    if (std::none_of(blocks.begin(), blocks.end(),
                     [&](int b) { return compared[static_cast<std::size_t>(b)]; }))
      continue;
    arcs.push_back(arcs_[a]);
    states.push_back(segments_[a].state);
  }
  if (arcs.empty()) return {};
  std::vector<int> shared;
  std::copy_if(free.begin(), free.end(), std::back_inserter(shared),
               [this](int index) { return index < static_cast<int>(shared_); });
  const auto solved =
      shooting::Solve(DriveWindows(*this, compared), arcs, list_.parameters, shared, parameters);
  if (!solved) return {};
  Vector improved = solved->parameters;
  for (std::size_t a = 0; a < arcs.size(); ++a) improved.segment(states[a], 2) = solved->states[a].col(0);
  for (const int index : free) {
    const Parameter& p = list_.parameters[static_cast<std::size_t>(index)];
    improved[index] = std::clamp(improved[index], p.lower, p.upper);
  }
  return improved;
}

std::vector<Warning> DriveProblem::WarningsAt(const Vector& parameters) const {
  std::vector<Warning> warnings;
  if (const auto predicted = PredictAll(*this, parameters)) {
    if (auto drift = OpenLoopDrift(data_, predicted->values)) warnings.push_back(std::move(*drift));
  }
  for (std::size_t r = 0; r < data_.runs.size(); ++r) {
    const std::size_t count = first_segment_[r + 1] - first_segment_[r];
    if (count == 1) continue;
    const DriveRun& run = data_.runs[r];
    std::vector<double> times;
    for (std::size_t s = first_segment_[r] + 1; s < first_segment_[r + 1]; ++s)
      times.push_back(run.begin + run.stops[segments_[s].first]);
    warnings.push_back(shooting::CutWarning(run.trial, times));
  }
  return warnings;
}

}  // namespace sinew
