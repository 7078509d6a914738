// Where a fit with motion errors begins: deviations that a weak weight of the forces brings about, and grow
// with that weight, at frictions that the measured forces suggest.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/role_view.h"
#include "identify/solvers/gradual_fit.h"
#include "identify/solvers/local_fit.h"
#include "problems/contact/plate_channels.h"
#include "problems/contact/problem.h"

namespace sinew {
namespace {

constexpr int kSearchEvaluations = 60;  // at a weight of the forces
constexpr int kFewEvaluations = 25;
constexpr double kLoaded = 0.2;     // of the greatest vertical force
constexpr double kQuantile = 0.95;  // of the ratio of horizontal to vertical force
// Static friction over that ratio, and dynamic over static friction.
constexpr double kStaticShares[] = {0.9, 1.1};
constexpr double kDynamicShare = 0.7;
constexpr double kRough = 1e-3;  // relative change of the cost

// Friction decides between slipping and sticking: its coefficients are kept while the pose is found.
bool IsFriction(const Parameter& p) {
  return p.kind == ParameterKind::kBase && p.name.find("friction") != std::string::npos;
}

}  // namespace

std::optional<Vector> ContactProblem::ImprovedStart(const std::vector<int>& free,
                                                    const std::vector<bool>& compared,
                                                    const Vector& parameters) const {
  if (!settings_.motion_errors) return {};
  std::size_t next = 0;
  const RoleView fitted(*this, [&](const Block& /*block*/) {
    return compared[next++] ? BlockRole::kTrain : BlockRole::kPredicted;
  });
  FitSetup all;
  all.parameters = list_.parameters;
  all.rest = parameters;
  all.free = free;
  FitSetup setup = all;
  setup.free.clear();
  for (const int index : free) {
    if (!IsFriction(list_.parameters[static_cast<std::size_t>(index)])) setup.free.push_back(index);
  }
  if (setup.free.empty()) return {};
  std::vector<Vector> starts;
  if (setup.free.size() < free.size()) {
    for (const double friction : SuggestedFrictions(compared)) {
      starts.push_back(parameters);
      SetFrictions(free, friction, starts.back());
    }
  }
  if (starts.empty()) starts.push_back(parameters);
  // Of several the one that is best after a few steps of all values.
  std::optional<Vector> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Vector& start : starts) {
    setup.rest = start;
    LeastSquares fit(fitted, setup);
    const Vector x = solvers::FitGradually(
        fit, fit.Variables(start), {1.0 / 64, 1.0 / 32, 1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 2, 1.0 / 1.4, 1},
        kSearchEvaluations);
    if (starts.size() == 1) return fit.Parameters(x);
    all.rest = fit.Parameters(x);
    const LeastSquares whole(fitted, all);
    const auto found =
        solvers::LocalFit(whole).Minimize(whole.Variables(all.rest), -1, {0, kRough}, kFewEvaluations);
    if (!found.failure.empty() || !(found.cost < least)) continue;
    least = found.cost;
    best = whole.Parameters(found.x);
  }
  return best;
}

std::vector<double> ContactProblem::SuggestedFrictions(const std::vector<bool>& compared) const {
  std::vector<double> ratios;
  for (const Stance& stance : data_.stances) {
    const auto block = [&](PlateChannel channel) { return static_cast<std::size_t>(stance.blocks[channel]); };
    if (!compared[block(kFx)] || !compared[block(kFy)] || !compared[block(kFz)]) continue;
    const Layout& layout = data_.layout;
    const Block& vertical = layout[block(kFy)];
    for (std::size_t i = 0; i < vertical.sample.size(); ++i) {
      if (!(vertical.measured[i] > kLoaded * stance.greatest_force)) continue;
      double squares = 0;
      bool known = true;
      for (const PlateChannel channel : {kFx, kFz}) {
        const Block& along = layout[block(channel)];
        const auto at = std::lower_bound(along.sample.begin(), along.sample.end(), vertical.sample[i]);
        known = known && at != along.sample.end() && *at == vertical.sample[i];
        if (known)
          squares += std::pow(along.measured[static_cast<std::size_t>(at - along.sample.begin())], 2);
      }
      if (known) ratios.push_back(std::sqrt(squares) / vertical.measured[i]);
    }
  }
  if (ratios.empty()) return {};
  std::sort(ratios.begin(), ratios.end());
  const double ratio = ratios[static_cast<std::size_t>(kQuantile * static_cast<double>(ratios.size() - 1))];
  std::vector<double> frictions;
  for (const double share : kStaticShares) frictions.push_back(share * ratio);
  return frictions;
}

void ContactProblem::SetFrictions(const std::vector<int>& free, double friction, Vector& parameters) const {
  for (const int index : free) {
    const Parameter& p = list_.parameters[static_cast<std::size_t>(index)];
    if (!IsFriction(p)) continue;
    const bool is_static = p.name.find("static_friction") != std::string::npos;
    const bool is_dynamic = p.name.find("dynamic_friction") != std::string::npos;
    if (!is_static && !is_dynamic) continue;
    parameters[index] = std::clamp(is_static ? friction : kDynamicShare * friction, p.lower, p.upper);
  }
}

}  // namespace sinew
