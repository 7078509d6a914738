// How OdeProblem cuts its trials into trajectories, and finds starts by multiple shooting. Included by
// ode_problem.h, at its end.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "identify/shooting/trajectory_plan.h"
#include "problems/ode/ode_problem.h"
#include "problems/ode/ode_windows.h"

namespace sinew {

template <class Derived, int N>
Status OdeProblem<Derived, N>::Prepare() {
  if (N == 0 || layout().empty()) return {};
  std::vector<bool> compared;
  for (const Block& block : layout()) compared.push_back(block.role != BlockRole::kPredicted);
  std::vector<bool> train;
  for (const DeclaredTrial& trial : trials()) {
    if (trial.blocks.empty()) return {};
    train.push_back(layout()[static_cast<std::size_t>(trial.blocks.front())].role == BlockRole::kTrain);
  }
  std::vector<int> free;
  for (std::size_t i = 0; i < parameters().size(); ++i) {
    const Parameter& p = parameters()[i];
    const bool state = std::any_of(start_.begin(), start_.end(), [&](const Start& start) {
      return start.slot >= 0 && !p.trial.empty() && p.name.rfind(NameOf(start.slot), 0) == 0;
    });
    const bool fitted = p.kind == ParameterKind::kBase || p.kind == ParameterKind::kNuisance;
    if (fitted && !state) free.push_back(static_cast<int>(i));
  }
  shooting::PlanOptions how;
  how.max_growth = kMaxGrowth;
  const Vector rest = RestPoint(*this);
  typical_ = TypicalStates(compared, rest);
  const double accuracy = accuracy_.relative;
  auto plan = shooting::MakePlan(Windows(*this, compared, typical_), train, parameters(), free, rest, how);
  if (!plan.needed) return {};
  accuracy_.relative = std::min(accuracy, kFine);
  if (!shooting::Refine(Windows(*this, compared, typical_), train, parameters(), free, plan)) {
    accuracy_.relative = accuracy;
    return {};
  }
  TakeOver(plan, free);
  return {};
}

template <class Derived, int N>
std::optional<Vector> OdeProblem<Derived, N>::ImprovedStart(const std::vector<int>& free,
                                                            const std::vector<bool>& compared,
                                                            const Vector& parameters) const {
  std::vector<shooting::Arc> arcs;
  std::vector<const Trajectory*> of;
  std::size_t a = 0;
  for (std::size_t t = 0; t < stretches_.size(); ++t) {
    const auto& blocks = trials()[t].blocks;
    const bool wanted = std::any_of(blocks.begin(), blocks.end(),
                                    [&](int b) { return compared[static_cast<std::size_t>(b)]; });
    for (const Trajectory& trajectory : stretches_[t].trajectories) {
      if (a >= arcs_.size()) return {};
      const shooting::Arc& arc = arcs_[a++];
      if (!wanted) continue;
      arcs.push_back(arc);
      of.push_back(&trajectory);
    }
  }
  if (arcs.empty()) return {};
  std::vector<int> shared;
  for (const int index : free) {
    if (!IsState(index)) shared.push_back(index);
  }
  const auto solved =
      shooting::Solve(Windows(*this, compared, typical_), arcs, this->parameters(), shared, parameters);
  if (!solved) return {};
  Vector improved = solved->parameters;
  for (std::size_t k = 0; k < arcs.size(); ++k) {
    for (std::size_t i = 0; i < start_.size(); ++i) {
      const int slot = of[k]->slot[i];
      if (slot < 0) continue;
      const int index = trials()[arcs[k].trial].parameter_of[static_cast<std::size_t>(slot)];
      improved[index] = solved->states[k](static_cast<Eigen::Index>(i), 0);
    }
  }
  for (const int index : free) {
    const Parameter& p = this->parameters()[static_cast<std::size_t>(index)];
    improved[index] = std::clamp(improved[index], p.lower, p.upper);
  }
  return improved;
}

template <class Derived, int N>
std::vector<Warning> OdeProblem<Derived, N>::WarningsAt(const Vector& /*parameters*/) const {
  std::vector<Warning> warnings;
  for (std::size_t t = 0; t < stretches_.size(); ++t) {
    std::vector<double> times;
    for (const Trajectory& trajectory : stretches_[t].trajectories) {
      if (trajectory.first > 0) times.push_back(stretches_[t].stops[trajectory.first]);
    }
    if (!times.empty()) warnings.push_back(shooting::CutWarning(trials()[t].name, times));
  }
  return warnings;
}

template <class Derived, int N>
double OdeProblem<Derived, N>::MeasuredState(std::size_t trial, std::size_t stop, int state) const {
  constexpr int kAbout = 2;  // samples on each side
  const Start& start = start_[Index(state)];
  if (stop == 0) {
    if (start.known) return start.value;
    const int index = trials()[trial].parameter_of[static_cast<std::size_t>(start.slot)];
    return parameters()[static_cast<std::size_t>(index)].start;
  }
  for (const int b : trials()[trial].blocks) {
    if (start.observation < 0 || ObservationOf(b) != start.observation) continue;
    const Block& block = layout()[static_cast<std::size_t>(b)];
    const double t = stretches_[trial].stops[stop];
    const auto time = [&](int i) {
      return block.prediction_time[static_cast<std::size_t>(block.sample[static_cast<std::size_t>(i)])];
    };
    int after = 0;
    while (after < block.samples() && time(after) < t) ++after;
    const int first = std::max(0, std::min(after - kAbout, block.samples() - 2 * kAbout - 1));
    const int last = std::min(block.samples() - 1, first + 2 * kAbout);
    double mean_time = 0;
    double mean = 0;
    for (int i = first; i <= last; ++i) {
      mean_time += (time(i) - t) / (last - first + 1);
      mean += block.measured[static_cast<std::size_t>(i)] / (last - first + 1);
    }
    double up = 0;
    double down = 0;
    for (int i = first; i <= last; ++i) {
      up += (time(i) - t - mean_time) * (block.measured[static_cast<std::size_t>(i)] - mean);
      down += (time(i) - t - mean_time) * (time(i) - t - mean_time);
    }
    return down > 0 ? mean - mean_time * up / down : mean;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

template <class Derived, int N>
Vector OdeProblem<Derived, N>::TypicalStates(const std::vector<bool>& compared, const Vector& rest) const {
  Vector typical = Vector::Ones(N);
  for (int i = 0; i < N; ++i) {
    const Start& start = start_[Index(i)];
    if (start.slot >= 0) {
      const int index = trials().front().parameter_of[static_cast<std::size_t>(start.slot)];
      const Parameter& p = parameters()[static_cast<std::size_t>(index)];
      typical[i] = 0.25 * (p.upper - p.lower);
    } else if (start.value != 0) {
      typical[i] = std::abs(start.value);
    }
  }
  const Windows windows(*this, compared, typical);
  std::vector<shooting::Arc> arcs;
  for (std::size_t t = 0; t < stretches_.size(); ++t) {
    const auto stops = windows.ComparedStops(t);
    arcs.push_back({t, {0}, stretches_[t].stops.size()});
    for (std::size_t i = 4 * N; i + 4 * N < stops.size(); i += 4 * N) arcs.back().begins.push_back(stops[i]);
  }
  const auto tracked = shooting::TrackedStates(windows, arcs, rest);
  if (!tracked) return typical;
  for (int i = 0; i < N; ++i) {
    double squares = 0;
    double count = 0;
    for (const Matrix& states : *tracked) {
      squares += (states.row(i).array() - states.row(i).mean()).square().sum();
      count += static_cast<double>(states.cols());
    }
    if (squares > 0 && std::isfinite(squares)) typical[i] = std::sqrt(squares / count);
  }
  return typical;
}

template <class Derived, int N>
void OdeProblem<Derived, N>::TakeOver(const shooting::Plan& plan, const std::vector<int>& free) {
  for (const int index : free) SetStart(index, plan.parameters[index]);
  std::vector<int> count(trials().size(), 0);
  for (Stretch& stretch : stretches_) stretch.trajectories.clear();
  for (std::size_t a = 0; a < plan.arcs.size(); ++a) {
    const shooting::Arc& arc = plan.arcs[a];
    Trajectory trajectory{arc.begins.front(), arc.end, {}};
    const int number = ++count[arc.trial];
    for (std::size_t i = 0; i < start_.size(); ++i) {
      const double value = plan.states[a](static_cast<Eigen::Index>(i), 0);
      const double reach = 3 * typical_[static_cast<Eigen::Index>(i)];
      trajectory.slot[i] = start_[i].slot;
      if (number > 1) {
        Parameter p;
        const std::string state =
            start_[i].slot < 0 ? fmt::format("state_{}", i) : NameOf(start_[i].slot).substr(8);
        p.name = fmt::format("trajectory_{}_{}", number,
                             start_[i].slot < 0 ? state : state.substr(0, state.size() - 1));
        p.unit = start_[i].slot < 0 ? "1" : UnitOf(start_[i].slot);
        p.meaning = fmt::format("state where a new trajectory begins, at t = {:.6g} s",
                                stretches_[arc.trial].stops[trajectory.first]);
        p.kind = ParameterKind::kNuisance;
        p.start = value;
        p.lower = value - reach;
        p.upper = value + reach;
        trajectory.slot[i] = AddTrialSlot(std::move(p), arc.trial);
      } else if (start_[i].slot >= 0) {
        SetStart(trials()[arc.trial].parameter_of[static_cast<std::size_t>(start_[i].slot)], value);
      }
    }
    stretches_[arc.trial].trajectories.push_back(trajectory);
  }
  arcs_ = plan.arcs;
  for (std::size_t t = 0; t < trials().size(); ++t) {
    for (const Trajectory& trajectory : stretches_[t].trajectories) {
      for (const int slot : trajectory.slot) {
        if (slot >= 0) state_parameters_.push_back(trials()[t].parameter_of[static_cast<std::size_t>(slot)]);
      }
    }
  }
  std::sort(state_parameters_.begin(), state_parameters_.end());
}

}  // namespace sinew
