#include "identify/identification/stepwise.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "identify/identification/carried_uncertainty.h"
#include "identify/role_view.h"

namespace sinew {
namespace {

// The problem as a step sees it: what it does not compare is predicted.
std::unique_ptr<RoleView> ViewOf(const Problem& problem, const FitStep& step) {
  std::size_t at = 0;
  return std::make_unique<RoleView>(problem, [&](const Block& block) {
    const int b = static_cast<int>(at++);
    return std::binary_search(step.blocks.begin(), step.blocks.end(), b) ? block.role : BlockRole::kPredicted;
  });
}

using Found = std::vector<std::pair<std::string, double>>;

Result<FitSetup> SetupOf(const Problem& view, const FitStep& step, FitRequest request, const Found& found) {
  SINEW_ASSIGN(const FitSetup whole, MakeFitSetup(view, request));
  request.free.clear();
  for (const int index : step.parameters) {
    if (whole.IsFree(index)) request.free.push_back(whole.parameters[static_cast<std::size_t>(index)].name);
  }
  if (request.free.empty()) return Fail("{}: nothing is left to fit", step.name);
  for (const auto& [name, value] : found) {
    const auto same = [&, &n = name](const auto& entry) { return entry.first == n; };
    auto& start = request.start;
    start.erase(std::remove_if(start.begin(), start.end(), same), start.end());
    start.emplace_back(name, value);
  }
  return MakeFitSetup(view, request);
}

void TakeOver(Found& found, const Identification& from) {
  for (const int index : from.setup.free) {
    const std::string& name = from.setup.parameters[static_cast<std::size_t>(index)].name;
    const auto known =
        std::find_if(found.begin(), found.end(), [&](const auto& entry) { return entry.first == name; });
    if (known != found.end()) {
      known->second = from.parameters[index];
    } else {
      found.emplace_back(name, from.parameters[index]);
    }
  }
}

// That every step has something to fit is known before the first has written anything.
Status CheckSteps(const Problem& problem, const FitRequest& request) {
  for (const FitStep& step : problem.steps()) {
    const auto view = ViewOf(problem, step);
    SINEW_TRY(SetupOf(*view, step, request, {}));
  }
  return {};
}

// Of whose errors the last step's intervals hold a part.
std::vector<std::string> HeldAsKnown(const Found& found, const Identification& last) {
  std::vector<std::string> held;
  for (const auto& [name, value] : found) {
    const auto same = [&, &n = name](int index) {
      return last.setup.parameters[static_cast<std::size_t>(index)].name == n;
    };
    if (std::none_of(last.setup.free.begin(), last.setup.free.end(), same)) held.push_back(name);
  }
  return held;
}

}  // namespace

Result<Identification> IdentifyStepwise(const Problem& problem, const FitRequest& request,
                                        const IdentificationOptions& options) {
  if (problem.steps().empty()) return Fail("the settings of this problem list no steps");
  if (!request.release.empty())
    return Fail("effect '{}': a step frees base parameters; release it in a fit of everything",
                request.release.front());
  SINEW_TRY(CheckSteps(problem, request));
  Found found;
  std::vector<FinishedStep> steps;
  std::vector<Warning> warnings;
  CarriedErrors carried;
  for (std::size_t s = 0; s < problem.steps().size(); ++s) {
    const FitStep& step = problem.steps()[s];
    const auto view = ViewOf(problem, step);
    SINEW_ASSIGN(FitSetup setup, SetupOf(*view, step, request, found));
    SINEW_ASSIGN(Identification fit, Identify(*view, std::move(setup), options));
    const bool last = s + 1 == problem.steps().size();
    const bool usable = fit.result.stop.usable();
    if (usable && !fit.uncertainty.parameters.empty()) SINEW_TRY(CarryErrors(*view, fit, carried));
    for (Warning& warning : fit.warnings) {
      if (!last) warning.step = step.name;
      warnings.push_back(std::move(warning));
    }
    if (usable && last) {
      if (auto held = HeldAsKnown(found, fit); !held.empty())
        warnings.push_back({WarningKind::kHeldFromSteps, std::move(held), {}, {}});
    }
    if (usable) TakeOver(found, fit);
    if (usable && !last) {
      steps.push_back({step.name, std::move(fit.setup), std::move(fit.uncertainty), std::move(fit.pooled_fit),
                       std::move(fit.derived), static_cast<std::size_t>(fit.record.evaluations()),
                       fit.seconds, fit.interval_seconds});
      continue;
    }
    if (!usable && !last) fit.result.stop.test = step.name + ": " + fit.result.stop.test;
    if (usable) {
      SINEW_ASSIGN(fit.prediction, PredictAll(problem, fit.parameters));
      if (const auto unmeasured = problem.EstimateUnmeasured(fit.parameters))
        TakeOver(*unmeasured, fit.prediction.values);
      fit.figures = problem.FiguresOfMerit(fit.parameters, fit.prediction.values);
      fit.alternatives = CompareAlternatives(problem, fit.parameters);
    }
    fit.steps = std::move(steps);
    fit.warnings = std::move(warnings);
    return fit;
  }
  return Fail("the settings of this problem list no steps");
}

}  // namespace sinew
