#include "identify/distinct_effects.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <vector>

#include "base/random.h"

namespace sinew {
namespace {

constexpr double kSame = 1e-6;  // difference of two columns over their length: what differences can resolve
constexpr int kPoints = 3;
constexpr double kReach = 0.05;  // of a parameter's range, from its start or null

// The start, with every effect present; other points differ in all parameters.
Vector PointWithEffects(const Problem& problem, Random& random, bool move) {
  Vector point = RestPoint(problem);
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const Parameter& p = problem.parameters()[i];
    double& value = point[static_cast<Eigen::Index>(i)];
    const bool up = p.upper - value >= value - p.lower;
    const double room = up ? p.upper - value : p.lower - value;
    if (p.kind == ParameterKind::kEffect) {
      value =
          p.probes.empty() ? value + kReach * random.Uniform(0.5, 1) * room : p.probes[p.probes.size() / 2];
    } else if (move) {
      value += kReach * random.Uniform(0, 1) * room;
    }
  }
  return point;
}

// Derivatives of all predictions by every parameter of an effect [m x P]; no columns if there is no
// prediction.
Matrix DerivativesAt(const Problem& problem, const Vector& point) {
  const Layout& layout = problem.layout();
  Eigen::Index rows = 0;
  for (const Block& block : layout) rows += block.predictions();
  std::vector<bool> differentiate;
  for (const Parameter& p : problem.parameters()) differentiate.push_back(p.kind == ParameterKind::kEffect);
  const std::vector<bool> blocks(layout.size(), true);
  Prediction prediction(layout);
  const auto workspace = problem.NewWorkspace();
  try {
    if (!problem.Predict({point, blocks, true, &differentiate}, *workspace, prediction)) return {};
  } catch (const std::exception&) {
    return {};
  }
  Matrix all = Matrix::Zero(rows, static_cast<Eigen::Index>(differentiate.size()));
  Eigen::Index row = 0;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    for (std::size_t c = 0; c < layout[b].columns.size(); ++c) {
      const int index = layout[b].columns[c];
      if (!differentiate[static_cast<std::size_t>(index)]) continue;
      all.col(index).segment(row, layout[b].predictions()) =
          prediction.derivatives(static_cast<int>(b)).col(static_cast<Eigen::Index>(c));
    }
    row += layout[b].predictions();
  }
  return all.allFinite() ? all : Matrix();
}

// One column below the other, for every point.
Vector Stacked(const std::vector<Matrix>& points, int parameter) {
  Vector all(static_cast<Eigen::Index>(points.size()) * points.front().rows());
  for (std::size_t k = 0; k < points.size(); ++k)
    all.segment(static_cast<Eigen::Index>(k) * points[k].rows(), points[k].rows()) = points[k].col(parameter);
  return all;
}

bool AreOne(const std::vector<Matrix>& points, const Effect& a, const Effect& b) {
  if (a.parameters.size() != b.parameters.size()) return false;
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    const Vector first = Stacked(points, a.parameters[i]);
    const Vector second = Stacked(points, b.parameters[i]);
    if (!(first.norm() > 0 && second.norm() > 0)) return false;
    const double factor = first.dot(second) / second.squaredNorm();
    if ((first - factor * second).norm() > kSame * first.norm()) return false;
  }
  return true;
}

}  // namespace

Status CheckDistinctEffects(const Problem& problem) {
  const auto& effects = problem.effects();
  if (effects.size() < 2) return {};
  Random random(1);
  std::vector<Matrix> points;
  for (int k = 0; k < kPoints; ++k) {
    Matrix at = DerivativesAt(problem, PointWithEffects(problem, random, k > 0));
    if (at.cols() > 0) points.push_back(std::move(at));
  }
  if (points.size() < 2) return {};
  for (std::size_t a = 0; a < effects.size(); ++a) {
    for (std::size_t b = a + 1; b < effects.size(); ++b) {
      if (!AreOne(points, effects[a], effects[b])) continue;
      return Fail(
          "effects '{}' and '{}' are one: both change every prediction in the same way, whatever the "
          "parameters; "
          "declare one of them, or bring data that tell them apart",
          effects[a].name, effects[b].name);
    }
  }
  return {};
}

}  // namespace sinew
