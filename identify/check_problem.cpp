#include "identify/check_problem.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "base/random.h"
#include "base/text.h"
#include "identify/derivative_comparison.h"
#include "identify/distinct_effects.h"
#include "identify/guarded.h"

namespace sinew {
namespace {

// Derivatives that differ by more than this share of their size are wrong, not inaccurate.
constexpr double kWrong = 0.1;
// Share of a range by which start values are moved.
constexpr double kBeside = 1e-3;
// Predictions that are no smoother than this are not compared with differences.
constexpr double kSmoothEnough = 1e-6;

std::string Place(const Block& block, Eigen::Index row) {
  return fmt::format("block {}/{}, prediction {} (t = {:.6g} s)", block.trial, block.channel, row,
                     block.prediction_time[static_cast<std::size_t>(row)]);
}

Status CheckTerms(const Problem& problem) {
  const auto parameters = static_cast<int>(problem.parameters().size());
  for (const DiscrepancyPort& port : problem.ports()) {
    for (const DiscrepancyTerm& term : port.terms) {
      if (term.knots.size() != term.parameters.size() || term.knots.empty())
        return Fail("term '{}': {} knots but {} weights", term.name, term.knots.size(),
                    term.parameters.size());
      for (const int index : term.parameters) {
        if (index < 0 || index >= parameters)
          return Fail("term '{}': parameter index {} is out of range, expected 0 .. {}", term.name, index,
                      parameters - 1);
      }
    }
  }
  for (const Constraint& constraint : problem.constraints()) {
    if (constraint.coefficients.size() != parameters)
      return Fail("constraint '{}': {} coefficients, expected one for each of {} parameters", constraint.name,
                  constraint.coefficients.size(), parameters);
  }
  return {};
}

// Derivatives of the wanted parameters in the wanted blocks are NaN: what is not set is found.
void Poison(const Layout& layout, const DerivativeQuery& query, Prediction& prediction) {
  for (std::size_t b = 0; b < layout.size(); ++b) {
    if (!query.blocks[b]) continue;
    const int block = static_cast<int>(b);
    prediction.values(block).setConstant(std::numeric_limits<double>::quiet_NaN());
    for (std::size_t c = 0; c < layout[b].columns.size(); ++c) {
      if (query.parameters[static_cast<std::size_t>(layout[b].columns[c])])
        prediction.derivatives(block)
            .col(static_cast<Eigen::Index>(c))
            .setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
}

Status CheckFinite(const Problem& problem, const DerivativeQuery& query, const Prediction& prediction) {
  const Layout& layout = problem.layout();
  for (std::size_t b = 0; b < layout.size(); ++b) {
    if (!query.blocks[b]) continue;
    const int block = static_cast<int>(b);
    const auto values = prediction.values(block);
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i]))
        return Fail("{}: the predicted value is {}: not set, or not finite, at the start values",
                    Place(layout[b], i), values[i]);
    }
    for (std::size_t c = 0; c < layout[b].columns.size(); ++c) {
      const auto parameter = static_cast<std::size_t>(layout[b].columns[c]);
      if (!query.parameters[parameter]) continue;
      const auto column = prediction.derivatives(block).col(static_cast<Eigen::Index>(c));
      for (Eigen::Index i = 0; i < column.size(); ++i) {
        if (!std::isfinite(column[i]))
          return Fail(
              "{}: the derivative by '{}' is {}: not set, or not finite, at the start values; a problem "
              "without derivatives derives from DifferencedProblem",
              Place(layout[b], i), problem.parameters()[parameter].name, column[i]);
      }
    }
  }
  return {};
}

Status CheckDerivatives(const Problem& problem, const DerivativeQuery& query) {
  SINEW_ASSIGN(const bool agrees, DirectionsAgree(problem, query, kWrong));
  if (agrees) return {};
  JacobianReport report;
  SINEW_TRY(CompareDerivatives(problem, query, kWrong, report));
  if (report.wrong.empty()) return {};
  const WrongDerivative& worst = *std::max_element(
      report.wrong.begin(), report.wrong.end(),
      [](const WrongDerivative& a, const WrongDerivative& b) { return a.deviation < b.deviation; });
  return Fail("{}: the derivative by '{}' is {:.6g}, but differences of the predictions give {:.6g}{}",
              Place(problem.layout()[static_cast<std::size_t>(worst.block)], worst.row), worst.name,
              worst.got, worst.expected,
              report.wrong.size() > 1 ? fmt::format(" ({} derivatives are wrong)", report.wrong.size()) : "");
}

// The start values with those that are asked for moved a little into their ranges.
DerivativeQuery BesideStart(const Problem& problem, DerivativeQuery query) {
  Random random(1);
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    if (!query.parameters[i]) continue;
    const Parameter& p = problem.parameters()[i];
    double& value = query.point[static_cast<Eigen::Index>(i)];
    const double share = kBeside * random.Uniform(0.5, 1);
    if (p.scale == Scale::kLog) {
      const double factor = std::pow(p.upper / p.lower, share);
      value = value * factor <= p.upper ? value * factor : value / factor;
    } else {
      const double step = share * (p.upper - p.lower);
      value = value + step <= p.upper ? value + step : value - step;
    }
  }
  return query;
}

// @param refused_is_error what becomes of a start that the problem itself refuses
Status CheckAt(const Problem& problem, const DerivativeQuery& query, bool refused_is_error) {
  const auto workspace = problem.NewWorkspace();
  Prediction prediction(problem.layout());
  Poison(problem.layout(), query, prediction);
  Status status;
  try {
    status = problem.Predict({query.point, query.blocks, true, &query.parameters}, *workspace, prediction);
  } catch (const std::exception& exception) {
    return Fail("the model threw at the start values: {}", OneLine(exception.what()));
  }
  if (!status) {
    if (!refused_is_error) return {};
    return Fail("no prediction at the start values: {}", status.error().message);
  }
  SINEW_TRY(CheckFinite(problem, query, prediction));
  if (problem.cost_noise_level() > kSmoothEnough) return {};
  auto at_start = CheckDerivatives(problem, query);
  // A start may lie on a kink (a joint at rest, held by friction); a wrong derivative is wrong beside it too.
  if (!at_start && CheckDerivatives(problem, BesideStart(problem, query))) return {};
  return at_start;
}

}  // namespace

Status CheckEffects(const Problem& problem) {
  const auto& parameters = problem.parameters();
  const auto count = static_cast<int>(parameters.size());
  for (const Effect& effect : problem.effects()) {
    if (effect.parameters.empty()) return Fail("effect '{}' has no parameter", effect.name);
    for (const int index : effect.parameters) {
      if (index < 0 || index >= count)
        return Fail("effect '{}': parameter index {} is out of range, expected 0 .. {}", effect.name, index,
                    count - 1);
      const Parameter& p = parameters[static_cast<std::size_t>(index)];
      if (p.kind != ParameterKind::kEffect || p.effect != effect.name)
        return Fail("effect '{}': its parameter '{}' (index {}) belongs to {}", effect.name, p.name, index,
                    p.effect.empty() ? "no effect" : "effect '" + p.effect + "'");
    }
  }
  return {};
}

Status CheckSomethingToFit(const Problem& problem) {
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kTrain && block.samples() > 0) return {};
  }
  return Fail("no trial with the role train has a channel that is compared: nothing to fit");
}

Status CheckStructure(const Problem& problem) {
  if (problem.parameters().empty()) return Fail("the problem has no parameter");
  if (problem.layout().empty()) return Fail("the problem has no block: it compares nothing");
  SINEW_TRY(CheckParameters(problem.parameters()));
  SINEW_TRY(CheckLayout(problem.layout(), static_cast<int>(problem.parameters().size())));
  SINEW_TRY(CheckEffects(problem));
  return CheckTerms(problem);
}

Status CheckProblem(const Problem& problem) {
  SINEW_TRY(CheckStructure(problem));
  FitRequest request;
  for (const Effect& effect : problem.effects()) request.release.push_back(effect.name);
  SINEW_ASSIGN(const FitSetup setup, MakeFitSetup(problem, request));
  const std::vector<bool> blocks(problem.layout().size(), true);
  const std::vector<bool> parameters(problem.parameters().size(), true);
  SINEW_TRY(CheckAt(problem, {setup.rest, blocks, parameters}, true));
  return CheckDistinctEffects(problem);
}

Status CheckProblem(const Problem& problem, const FitSetup& setup) {
  SINEW_TRY(CheckStructure(problem));
  SINEW_TRY(CheckSomethingToFit(problem));
  if (setup.parameters.size() != problem.parameters().size())
    return Fail("the setup has {} parameters, the problem {}: it was made for another problem",
                setup.parameters.size(), problem.parameters().size());
  std::vector<bool> blocks;
  for (const Block& block : problem.layout()) blocks.push_back(block.role == BlockRole::kTrain);
  std::vector<bool> parameters(problem.parameters().size(), false);
  for (const int index : setup.free) parameters[static_cast<std::size_t>(index)] = true;
  return CheckAt(problem, {setup.rest, blocks, parameters}, false);
}

}  // namespace sinew
