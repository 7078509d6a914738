// Where a fit with motion errors begins: deviations that a weak weight of the forces brings about, and grow
// with that weight.
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/role_view.h"
#include "identify/solvers/gradual_fit.h"
#include "problems/contact/problem.h"

namespace sinew {
namespace {

constexpr int kSearchEvaluations = 60;

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
  FitSetup setup;
  setup.parameters = list_.parameters;
  setup.rest = parameters;
  for (const int index : free) {
    if (!IsFriction(list_.parameters[static_cast<std::size_t>(index)])) setup.free.push_back(index);
  }
  if (setup.free.empty()) return {};
  LeastSquares fit(fitted, setup);
  const Vector x = solvers::FitGradually(
      fit, fit.Variables(parameters), {1.0 / 64, 1.0 / 32, 1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 2, 1.0 / 1.4, 1},
      kSearchEvaluations);
  return fit.Parameters(x);
}

}  // namespace sinew
