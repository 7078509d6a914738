#include "identify/derivative_comparison.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/random.h"
#include "identify/guarded.h"

namespace sinew {
namespace {

constexpr double kStep = 1e-4;     // of the range, or of its logarithm
constexpr double kShorter = 0.25;  // of a step, to see whether it matters
// Where a derivative disagrees: a model that sticks, or that switches, may do something else a little further
// on, at both sides and over both steps alike.
constexpr double kFineStep = 1e-6;
// What changes the prediction by less than this share of its size, over the whole range, is rounding.
constexpr double kNegligible = 1e-7;
constexpr double kSmoothShare = 0.8;  // of the samples, for a column to be compared
constexpr double kKink = 0.05;        // of a column's size: one-sided differences that are no kink
constexpr double kRounding = 1e-12;   // of the predictions' size: what differences do not resolve

double SlopeOf(const Parameter& p, double value) {
  return p.scale == Scale::kLog ? value * std::log(p.upper / p.lower) : p.upper - p.lower;
}

double Moved(const Parameter& p, double value, double step) {
  return p.scale == Scale::kLog ? value * std::exp(step * std::log(p.upper / p.lower))
                                : value + step * (p.upper - p.lower);
}

// The slope that a problem returns is no derivative where it is a secant (Parameter::null_step), nor by a
// rounding step.
bool HasNoDerivative(const Parameter& p, double value) {
  return p.is_rounding_step || (p.null_step > 0 && std::abs(value - p.null_value) <= p.null_step);
}

// So far inside of the bounds that a step to either side stays there; without rounding, as the derivatives.
Vector Inside(const Problem& problem, const DerivativeQuery& query) {
  Vector point = query.point;
  for (Eigen::Index i = 0; i < point.size(); ++i) {
    const Parameter& p = problem.parameters()[static_cast<std::size_t>(i)];
    if (p.is_rounding_step) {
      point[i] = p.null_value;
      continue;
    }
    if (!query.parameters[static_cast<std::size_t>(i)]) continue;
    point[i] = std::clamp(point[i], Moved(p, p.lower, 1.01 * kStep), Moved(p, p.upper, -1.01 * kStep));
  }
  return point;
}

// One column of one block, all over the parameter's range.
struct Sides {
  double step = kStep;  // of the range, or of its logarithm
  Vector left, right, left_short, right_short, here;
};

class Comparison {
 public:
  Comparison(const Problem& problem, const DerivativeQuery& query)
      : problem_(problem),
        query_(query),
        point_(Inside(problem, query)),
        workspace_(problem.NewWorkspace()),
        at_(problem.layout()),
        beside_(problem.layout()) {}

  Status Evaluate() {
    return PredictGuarded(problem_, {point_, query_.blocks, true, &query_.parameters}, *workspace_, at_);
  }

  [[nodiscard]] const Vector& point() const { return point_; }
  [[nodiscard]] const Prediction& at() const { return at_; }

  /// Values of the wanted blocks at `step` times `direction` [P, of the range] from the point, one below the
  /// other. Errors: no prediction there.
  Result<Vector> Beside(const Vector& direction, double step) {
    Vector moved = point_;
    for (Eigen::Index i = 0; i < moved.size(); ++i) {
      if (direction[i] != 0)
        moved[i] = Moved(problem_.parameters()[static_cast<std::size_t>(i)], moved[i], step * direction[i]);
    }
    SINEW_TRY(PredictGuarded(problem_, {moved, query_.blocks, false, nullptr}, *workspace_, beside_));
    return Stacked(beside_);
  }

  /// Values at both sides of the point in one parameter; nothing if there is no prediction at one of them.
  /// @param here [rows] at the point
  std::optional<Sides> Around(int p, double step, const Vector& here) {
    Vector direction = Vector::Zero(point_.size());
    direction[p] = 1;
    auto right = Beside(direction, step);
    auto left = Beside(direction, -step);
    auto right_short = Beside(direction, kShorter * step);
    auto left_short = Beside(direction, -kShorter * step);
    if (!right || !left || !right_short || !left_short) return {};
    return Sides{step, std::move(*left), std::move(*right), std::move(*left_short), std::move(*right_short),
                 here};
  }

  [[nodiscard]] Vector Stacked(const Prediction& prediction) const {
    Vector stacked(Rows());
    Eigen::Index row = 0;
    for (std::size_t b = 0; b < query_.blocks.size(); ++b) {
      if (!query_.blocks[b]) continue;
      const auto values = prediction.values(static_cast<int>(b));
      const double weight = problem_.layout()[b].weight;
      stacked.segment(row, values.size()) = weight * values;
      row += values.size();
    }
    return stacked;
  }

  /// Weighted derivative by parameter p over its range, stacked alike.
  [[nodiscard]] Vector Column(int p) const {
    Vector stacked = Vector::Zero(Rows());
    const Parameter& parameter = problem_.parameters()[static_cast<std::size_t>(p)];
    Eigen::Index row = 0;
    for (std::size_t b = 0; b < query_.blocks.size(); ++b) {
      if (!query_.blocks[b]) continue;
      const Block& block = problem_.layout()[b];
      const auto at = std::lower_bound(block.columns.begin(), block.columns.end(), p);
      if (at != block.columns.end() && *at == p) {
        stacked.segment(row, block.predictions()) =
            block.weight * SlopeOf(parameter, point_[p]) *
            at_.derivatives(static_cast<int>(b)).col(at - block.columns.begin());
      }
      row += block.predictions();
    }
    return stacked;
  }

 private:
  [[nodiscard]] Eigen::Index Rows() const {
    Eigen::Index rows = 0;
    for (std::size_t b = 0; b < query_.blocks.size(); ++b)
      rows += query_.blocks[b] ? problem_.layout()[b].predictions() : 0;
    return rows;
  }

  const Problem& problem_;
  const DerivativeQuery& query_;
  Vector point_;
  std::unique_ptr<Problem::Workspace> workspace_;
  Prediction at_;
  Prediction beside_;
};

enum class Outcome { kNotCompared, kAgrees, kOff };

// @param wrong set if it is wrong @param deviation set if it was compared
Outcome CompareColumn(const Problem& problem, std::size_t b, int p, const Sides& sides, Eigen::Index first,
                      const Vector& column, const Vector& point, double tolerance, WrongDerivative& wrong,
                      double& deviation) {
  const Block& block = problem.layout()[b];
  const Eigen::Index n = block.predictions();
  const auto part = [&](const Vector& v) { return v.segment(first, n); };
  const Vector central = (part(sides.right) - part(sides.left)) / (2 * sides.step);
  const Vector finer = (part(sides.right_short) - part(sides.left_short)) / (2 * kShorter * sides.step);
  const Vector ahead = (part(sides.right) - part(sides.here)) / sides.step;
  const Vector behind = (part(sides.here) - part(sides.left)) / sides.step;
  const Vector got = part(column);
  const double count = std::sqrt(static_cast<double>(n));
  const double size = std::max(got.norm(), finer.norm()) / count;
  deviation = 0;
  if (size <= kNegligible * (part(sides.here).norm() / count + 1e-300)) {
    return Outcome::kAgrees;  // neither moves the prediction
  }
  // Differences of two steps must agree with each other to be a reference, whatever the derivative says: near
  // an unstable trajectory they do not.
  const double resolved =
      std::max(finer.cwiseAbs().maxCoeff(),
               kRounding * part(sides.here).cwiseAbs().maxCoeff() / (kShorter * sides.step));
  double smooth = 0;
  double squares = 0;
  double farthest = -1;
  Eigen::Index worst = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool bends = std::abs(ahead[i] - behind[i]) > kKink * resolved ||
                       std::abs(central[i] - finer[i]) > 0.5 * tolerance * resolved;
    if (bends || !std::isfinite(finer[i])) continue;
    ++smooth;
    const double off = std::abs(got[i] - finer[i]);
    squares += off * off;
    if (off > farthest) {
      farthest = off;
      worst = i;
    }
  }
  if (smooth < kSmoothShare * static_cast<double>(n)) return Outcome::kNotCompared;
  deviation = std::sqrt(squares / smooth) / size;
  if (deviation <= tolerance) return Outcome::kAgrees;
  const Parameter& parameter = problem.parameters()[static_cast<std::size_t>(p)];
  const double scale = block.weight * SlopeOf(parameter, point[p]);
  wrong.block = static_cast<int>(b);
  wrong.trial = block.trial;
  wrong.channel = block.channel;
  wrong.parameter = p;
  wrong.name = parameter.name;
  wrong.row = static_cast<int>(worst);
  wrong.time = block.prediction_time[static_cast<std::size_t>(worst)];
  wrong.expected = finer[worst] / scale;
  wrong.got = got[worst] / scale;
  wrong.deviation = deviation;
  wrong.point = point;
  return Outcome::kOff;
}

void Report(WrongDerivative wrong, JacobianReport& report) {
  for (WrongDerivative& known : report.wrong) {
    if (known.block != wrong.block || known.parameter != wrong.parameter) continue;
    if (known.deviation < wrong.deviation) known = std::move(wrong);
    return;
  }
  report.wrong.push_back(std::move(wrong));
}

}  // namespace

Status CompareDerivatives(const Problem& problem, const DerivativeQuery& query, double tolerance,
                          JacobianReport& report) {
  Comparison comparison(problem, query);
  SINEW_TRY(comparison.Evaluate());
  const Layout& layout = problem.layout();
  const Vector here = comparison.Stacked(comparison.at());
  if (!here.allFinite()) return Fail("a predicted value is not finite");
  for (int p = 0; p < static_cast<int>(query.parameters.size()); ++p) {
    if (!query.parameters[static_cast<std::size_t>(p)]) continue;
    if (HasNoDerivative(problem.parameters()[static_cast<std::size_t>(p)], comparison.point()[p])) continue;
    const Vector column = comparison.Column(p);
    if (!column.allFinite())
      return Fail("a derivative by '{}' is not finite",
                  problem.parameters()[static_cast<std::size_t>(p)].name);
    const std::optional<Sides> sides = comparison.Around(p, kStep, here);
    if (!sides) continue;
    std::optional<Sides> fine;  // made if it is needed
    Eigen::Index first = 0;
    for (std::size_t b = 0; b < layout.size(); ++b) {
      if (!query.blocks[b]) continue;
      // Also where the block says that it does not depend on it: the derivative is then taken for 0.
      const auto compare = [&](const Sides& of, WrongDerivative& wrong, double& deviation) {
        return CompareColumn(problem, b, p, of, first, column, comparison.point(), tolerance, wrong,
                             deviation);
      };
      WrongDerivative wrong;
      double deviation = 0;
      Outcome verdict = compare(*sides, wrong, deviation);
      if (verdict == Outcome::kOff) {
        if (!fine) fine = comparison.Around(p, kFineStep, here);
        WrongDerivative again;
        double of_fine = 0;
        if (fine && compare(*fine, again, of_fine) == Outcome::kAgrees) {
          verdict = Outcome::kAgrees;
          deviation = of_fine;
        }
      }
      ++report.columns;
      if (verdict != Outcome::kNotCompared) {
        ++report.compared;
        report.worst = std::max(report.worst, deviation);
      }
      if (verdict == Outcome::kOff) Report(std::move(wrong), report);
      first += layout[b].predictions();
    }
  }
  return {};
}

Result<bool> DirectionsAgree(const Problem& problem, const DerivativeQuery& query, double tolerance) {
  Comparison comparison(problem, query);
  if (!comparison.Evaluate()) return true;
  const Vector here = comparison.Stacked(comparison.at());
  const auto parameters = static_cast<Eigen::Index>(query.parameters.size());
  std::vector<Vector> columns(query.parameters.size());
  double largest = 0;
  for (std::size_t p = 0; p < columns.size(); ++p) {
    if (!query.parameters[p]) continue;
    if (HasNoDerivative(problem.parameters()[p], comparison.point()[static_cast<Eigen::Index>(p)])) continue;
    columns[p] = comparison.Column(static_cast<int>(p));
    largest = std::max(largest, columns[p].norm());
  }
  // The smallest derivative that is no rounding sets the scale of all others.
  const double negligible = kNegligible * here.norm();
  double smallest = largest;
  for (const Vector& column : columns) {
    if (column.size() > 0 && column.norm() > std::max(negligible, 1e-6 * largest))
      smallest = std::min(smallest, column.norm());
  }
  Vector with = Vector::Zero(parameters);
  Vector without = Vector::Zero(parameters);
  Vector expected = Vector::Zero(here.size());
  for (std::size_t p = 0; p < columns.size(); ++p) {
    if (columns[p].size() == 0) continue;
    const auto i = static_cast<Eigen::Index>(p);
    const double norm = columns[p].norm();
    if (norm > negligible) {
      with[i] = std::min(1.0, smallest / norm);
      expected += with[i] * columns[p];
    } else {
      without[i] = 1;
    }
  }
  for (const Vector* direction : {&with, &without}) {
    if (direction->isZero()) continue;
    const auto right = comparison.Beside(*direction, kStep);
    const auto left = comparison.Beside(*direction, -kStep);
    if (!right || !left) continue;
    const Vector found = (*right - *left) / (2 * kStep);
    const bool flat = direction == &without;
    const double off = flat ? found.norm() : (found - expected).norm();
    // Each column may be off by the tolerance: with n of them, their sum hides one in n.
    const double count = std::max(1.0, direction->cwiseSign().cwiseAbs().sum());
    const double size = flat ? 10 * negligible / tolerance
                             : std::max(smallest, 10 * negligible / tolerance) / std::sqrt(count);
    if (!(off <= tolerance * size)) return false;
  }
  return true;
}

Result<JacobianReport> CheckJacobian(const Problem& problem, const JacobianOptions& options) {
  SINEW_TRY(CheckStructure(problem));
  const auto& parameters = problem.parameters();
  JacobianReport report;
  DerivativeQuery query;
  query.blocks.assign(problem.layout().size(), true);
  query.parameters.assign(parameters.size(), true);
  Random random(options.seed);
  std::vector<bool> compared(parameters.size(), false);
  for (int i = 0; i < options.points; ++i) {
    query.point = RestPoint(problem);
    if (i > 0) {
      for (std::size_t p = 0; p < parameters.size(); ++p)
        query.point[static_cast<Eigen::Index>(p)] =
            Moved(parameters[p], parameters[p].lower, random.Uniform(0.02, 0.98));
    }
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      DerivativeQuery one = query;
      one.parameters.assign(parameters.size(), false);
      one.parameters[p] = true;
      const int before = report.compared;
      const Status status = CompareDerivatives(problem, one, options.tolerance, report);
      if (!status && i == 0) return tl::unexpected(status.error());
      compared[p] = compared[p] || report.compared > before;
    }
  }
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!compared[p]) report.never.push_back(static_cast<int>(p));
  }
  std::stable_sort(
      report.wrong.begin(), report.wrong.end(),
      [](const WrongDerivative& a, const WrongDerivative& b) { return a.deviation > b.deviation; });
  return report;
}

}  // namespace sinew
