#include "identify/shooting/trajectory_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/median.h"
#include "base/text.h"

namespace sinew::shooting {
namespace {

constexpr std::size_t kSamplesPerState = 4;  // in the shortest window
constexpr std::size_t kMaxJoined = 8;        // shortest windows in one
constexpr double kGrowthOfWindow = 2;
constexpr double kGrowthThatMatters = 30;
constexpr double kMinGrowth = 10;  // of a trajectory
/// A trajectory has lost the measurement if its residual is so large a share of what a typical change does,
/// and so many times that of windows that are not joined, which is noise.
constexpr double kLost = 0.03;
constexpr double kFarAbove = 2;
/// Noise of this share of what a typical change does, in half of the training trials: states are not known
/// from the measurement, and nor is how small differences grow along them.
constexpr double kTooNoisy = 0.1;

// 1 for the identity.
double Size(const Matrix& m) {
  return m.norm() / std::sqrt(static_cast<double>(m.rows()));
}

Arc ShortestWindows(const Model& model, std::size_t trial) {
  const std::size_t samples = kSamplesPerState * static_cast<std::size_t>(model.states());
  Arc arc{trial, {0}, model.stops(trial)};
  std::size_t since = 0;
  for (const std::size_t stop : model.ComparedStops(trial)) {
    if (since >= samples) {
      arc.begins.push_back(stop);
      since = 0;
    }
    ++since;
  }
  // The last window is no shorter than the others.
  if (arc.begins.size() > 1 && since < samples) arc.begins.pop_back();
  return arc;
}

// What is found of an arc.
struct Found {
  std::vector<bool> lost;  // [arcs] the trajectory does not stay near the measurement
  double noise = 0;        // upper median of what windows that are not joined leave of the training trials
};

Status Shoot(const Model& model, const std::vector<bool>& train, const std::vector<Parameter>& all,
             const std::vector<int>& free, Plan& plan, Found& found) {
  plan.states.assign(plan.arcs.size(), {});
  found.lost.assign(plan.arcs.size(), false);
  for (const bool training : {true, false}) {
    std::vector<Arc> arcs;
    std::vector<std::size_t> of;
    for (std::size_t a = 0; a < plan.arcs.size(); ++a) {
      if (train[plan.arcs[a].trial] != training) continue;
      arcs.push_back(plan.arcs[a]);
      of.push_back(a);
    }
    if (arcs.empty()) continue;
    SINEW_ASSIGN(const Solution solution,
                 Solve(model, arcs, all, training ? free : std::vector<int>(), plan.parameters));
    for (std::size_t k = 0; k < of.size(); ++k) {
      plan.states[of[k]] = solution.states[k];
      found.lost[of[k]] = solution.misfit[k] > std::max(kLost, kFarAbove * solution.free_misfit[k]);
    }
    plan.parameters = solution.parameters;
    if (training) {
      plan.residual_rms = solution.residual_rms;
      found.noise = UpperMedian(solution.free_misfit);
    }
  }
  return {};
}

// Cuts arcs where small differences have grown by `growth` [arcs] since their begin; `cut` tells whether any.
Status Cut(const Model& model, const std::vector<double>& growth, Plan& plan, bool& cut) {
  std::vector<Arc> arcs;
  for (std::size_t a = 0; a < plan.arcs.size(); ++a) {
    const Arc& arc = plan.arcs[a];
    SINEW_ASSIGN(const auto transitions, Transitions(model, arc, plan.parameters, plan.states[a]));
    const auto begins = Join(transitions, growth[a], arc.windows());
    for (std::size_t k = 0; k < begins.size(); ++k) {
      const bool last = k + 1 == begins.size();
      const std::size_t end = last ? arc.windows() : begins[k + 1];
      arcs.push_back({arc.trial,
                      {arc.begins.begin() + static_cast<std::ptrdiff_t>(begins[k]),
                       arc.begins.begin() + static_cast<std::ptrdiff_t>(end)},
                      last ? arc.end : arc.begins[end]});
    }
  }
  cut = arcs.size() > plan.arcs.size();
  plan.arcs = std::move(arcs);
  return {};
}

Status Complete(const Model& model, const std::vector<bool>& train, const std::vector<Parameter>& all,
                const std::vector<int>& free, const PlanOptions& options, Plan& plan) {
  for (std::size_t trial = 0; trial < model.trials(); ++trial)
    plan.arcs.push_back(ShortestWindows(model, trial));
  SINEW_ASSIGN(plan.states, TrackedStates(model, plan.arcs, plan.parameters));
  std::vector<Arc> joined;
  for (std::size_t a = 0; a < plan.arcs.size(); ++a) {
    const Arc& arc = plan.arcs[a];
    SINEW_ASSIGN(const auto transitions, Transitions(model, arc, plan.parameters, plan.states[a]));
    plan.growth = std::max(plan.growth, LargestGrowth(transitions));
    joined.push_back({arc.trial, {}, arc.end});
    for (const std::size_t w : Join(transitions, kGrowthOfWindow, kMaxJoined))
      joined.back().begins.push_back(arc.begins[w]);
  }
  plan.needed = plan.growth >= kGrowthThatMatters;
  if (!plan.needed) return {};
  plan.arcs = std::move(joined);
  SINEW_ASSIGN(plan.states, TrackedStates(model, plan.arcs, plan.parameters));
  Found found;
  // Once along the measured states, and once where the solution turns out to grow faster.
  for (int round = 0; round < 2; ++round) {
    bool cut = false;
    SINEW_TRY(Cut(model, std::vector<double>(plan.arcs.size(), options.max_growth), plan, cut));
    if (cut || round == 0) SINEW_TRY(Shoot(model, train, all, free, plan, found));
    plan.needed = found.noise < kTooNoisy;
    if (!plan.needed) return {};
  }
  for (double shorter = 0.01 * options.max_growth; shorter >= kMinGrowth; shorter *= 0.1) {
    std::vector<double> limit;
    for (const bool lost : found.lost) limit.push_back(lost ? shorter : options.max_growth);
    if (*std::min_element(limit.begin(), limit.end()) == options.max_growth) break;
    bool cut = false;
    SINEW_TRY(Cut(model, limit, plan, cut));
    if (cut) SINEW_TRY(Shoot(model, train, all, free, plan, found));
  }
  return {};
}

}  // namespace

Result<std::vector<Matrix>> Transitions(const Model& model, const Arc& arc, const Vector& parameters,
                                        const Matrix& states) {
  const Vector typical = model.TypicalState();
  std::vector<Matrix> all;
  Shot shot;
  for (std::size_t w = 0; w + 1 < arc.windows(); ++w) {
    const Window window{arc.trial, arc.begins[w], arc.EndOf(w), true};
    SINEW_TRY(model.Shoot(window, parameters, states.col(static_cast<Eigen::Index>(w)), {}, true, shot));
    all.emplace_back(typical.cwiseInverse().asDiagonal() * shot.end_by_state * typical.asDiagonal());
  }
  return all;
}

double LargestGrowth(const std::vector<Matrix>& transitions) {
  double largest = 1;
  std::vector<Matrix> from;  // the begin of each window to the end of the present one
  for (const Matrix& step : transitions) {
    from.push_back(Matrix::Identity(step.rows(), step.cols()));
    for (Matrix& m : from) m = step * m;
    for (const Matrix& m : from) largest = std::max(largest, Size(m));
    // What has shrunk since its begin grows no further than what begins here.
    from.erase(std::remove_if(from.begin(), from.end(), [](const Matrix& m) { return m.norm() < 1; }),
               from.end());
  }
  return std::isfinite(largest) ? largest : std::numeric_limits<double>::infinity();
}

std::vector<std::size_t> Join(const std::vector<Matrix>& transitions, double growth, std::size_t most) {
  std::vector<std::size_t> begins{0};
  std::vector<Matrix> from;
  for (std::size_t w = 0; w < transitions.size(); ++w) {
    const Matrix& step = transitions[w];
    from.push_back(Matrix::Identity(step.rows(), step.cols()));
    double largest = 0;
    for (Matrix& m : from) {
      m = step * m;
      largest = std::max(largest, Size(m));
    }
    if (w > begins.back() && !(largest <= growth && w - begins.back() < most)) {
      begins.push_back(w);
      from.assign(1, step);
    }
  }
  // The last window of all has no transition of its own: it belongs to the one before.
  return begins;
}

Plan MakePlan(const Model& model, const std::vector<bool>& train, const std::vector<Parameter>& all,
              const std::vector<int>& free, const Vector& parameters, const PlanOptions& options) {
  Plan plan;
  plan.parameters = parameters;
  if (!Complete(model, train, all, free, options, plan)) plan.needed = false;
  return plan;
}

Warning CutWarning(const std::string& trial, const std::vector<double>& times) {
  std::string list;
  for (const double t : times) list += fmt::format("{}{:.4g}", list.empty() ? "" : ", ", t);
  std::string message = fmt::format(
      "trial '{}' is predicted as {} trajectories, not as one; a new one begins at t = {} s, without "
      "continuity "
      "to the one before: small differences grow so much that one trajectory would not stay near the "
      "measurement, or could not be computed",
      trial, times.size() + 1, list);
  return {WarningKind::kOther, std::vector<std::string>(times.size(), trial), times, std::move(message)};
}

Status Refine(const Model& model, const std::vector<bool>& train, const std::vector<Parameter>& all,
              const std::vector<int>& free, Plan& plan) {
  Found found;
  return Shoot(model, train, all, free, plan, found);
}

}  // namespace sinew::shooting
