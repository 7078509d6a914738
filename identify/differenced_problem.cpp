#include "identify/differenced_problem.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "base/text.h"

namespace sinew {
namespace {

// The values at up to two neighbouring points, and how much each counts in the derivative.
struct Formula {
  double at[2] = {0, 0};      // parameter values
  double weight[2] = {0, 0};  // [1/unit]
  double middle = 0;          // of the point itself
};

Formula FormulaFor(const Parameter& p, double value, double relative_step) {
  Formula f;
  if (p.null_step > 0 && std::abs(value - p.null_value) < p.null_step) {
    const double step = value + p.null_step <= p.upper ? p.null_step : -p.null_step;
    f.at[0] = f.at[1] = std::clamp(value + step, p.lower, p.upper);
    f.weight[0] = 1 / (f.at[0] - value);
    f.middle = -f.weight[0];
    return f;
  }
  const double range = p.upper - p.lower;
  const double scale = p.scale == Scale::kLog ? std::abs(value) : std::max(std::abs(value), 1e-3 * range);
  const double step = std::min(relative_step * scale, range / 4);
  const double side = value - step < p.lower ? 1 : value + step > p.upper ? -1 : 0;
  if (side == 0) {
    f.at[0] = value - step;
    f.at[1] = value + step;
    f.weight[1] = 1 / (f.at[1] - f.at[0]);
    f.weight[0] = -f.weight[1];
    return f;
  }
  f.at[0] = value + side * step;
  f.at[1] = value + side * 2 * step;
  f.weight[0] = side * 2 / step;
  f.weight[1] = -side * 0.5 / step;
  f.middle = -side * 1.5 / step;
  return f;
}

}  // namespace

struct DifferencedProblem::Scratch final : Problem::Workspace {
  struct Lane {
    std::unique_ptr<Problem::Workspace> workspace;
    std::unique_ptr<Prediction> values[2];
    Vector parameters;
    Status status;
  };
  std::unique_ptr<Problem::Workspace> own;
  std::vector<Lane> lanes;  // [P], filled when first used
};

std::unique_ptr<Problem::Workspace> DifferencedProblem::NewWorkspace() const {
  auto scratch = std::make_unique<Scratch>();
  scratch->own = NewValueWorkspace();
  scratch->lanes.resize(parameters().size());
  return scratch;
}

Status DifferencedProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<Scratch&>(workspace);
  SINEW_TRY(PredictValues(query.parameters, query.blocks, *scratch.own, prediction));
  if (!query.derivatives) return {};

  std::vector<std::size_t> wanted;
  for (std::size_t p = 0; p < scratch.lanes.size(); ++p) {
    if (!query.Differentiates(static_cast<int>(p))) continue;
    for (std::size_t b = 0; b < layout().size(); ++b) {
      const std::vector<int>& columns = layout()[b].columns;
      if (!query.blocks[b] || !std::binary_search(columns.begin(), columns.end(), static_cast<int>(p)))
        continue;
      wanted.push_back(p);
      break;
    }
  }
  Layout bare;  // values alone
  const double relative_step = std::cbrt(std::clamp(accuracy(), 1e-16, 1e-2));
  for (const std::size_t p : wanted) {
    Scratch::Lane& lane = scratch.lanes[p];
    if (lane.workspace != nullptr) continue;
    if (bare.empty()) {
      bare = layout();
      for (Block& block : bare) block.columns.clear();
    }
    lane.workspace = NewValueWorkspace();
    for (auto& values : lane.values) values = std::make_unique<Prediction>(bare);
  }
  const auto differentiate = [&](std::size_t p) -> Status {
    Scratch::Lane& lane = scratch.lanes[p];
    const auto index = static_cast<Eigen::Index>(p);
    const Formula formula = FormulaFor(parameters()[p], query.parameters[index], relative_step);
    lane.parameters = query.parameters;
    for (int side = 0; side < 2; ++side) {
      if (formula.weight[side] == 0) continue;
      lane.parameters[index] = formula.at[side];
      SINEW_TRY(PredictValues(lane.parameters, query.blocks, *lane.workspace, *lane.values[side]));
    }
    for (std::size_t b = 0; b < layout().size(); ++b) {
      const std::vector<int>& columns = layout()[b].columns;
      const auto at = std::lower_bound(columns.begin(), columns.end(), static_cast<int>(p));
      if (!query.blocks[b] || at == columns.end() || *at != static_cast<int>(p)) continue;
      const int block = static_cast<int>(b);
      auto column = prediction.derivatives(block).col(at - columns.begin());
      column.setZero();
      if (formula.middle != 0) column = formula.middle * prediction.values(block);
      for (int side = 0; side < 2; ++side) {
        if (formula.weight[side] != 0) column += formula.weight[side] * lane.values[side]->values(block);
      }
    }
    return {};
  };
  tbb::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t i) {
    Scratch::Lane& lane = scratch.lanes[wanted[i]];
    // No exception may leave a task of oneTBB half way through the others.
    try {
      lane.status = differentiate(wanted[i]);
    } catch (const std::exception& exception) {
      lane.status = Fail("the model threw: {}", OneLine(exception.what()));
    }
  });
  for (const std::size_t p : wanted) {
    const Scratch::Lane& lane = scratch.lanes[p];
    if (!lane.status)
      return Fail("beside '{}' for its derivative: {}", parameters()[p].name, lane.status.error().message);
  }
  return {};
}

}  // namespace sinew
