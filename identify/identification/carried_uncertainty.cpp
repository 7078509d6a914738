#include "identify/identification/carried_uncertainty.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "identify/least_squares.h"

namespace sinew {
namespace {

// Position of a parameter in a list; -1: it is not there.
int PlaceOf(const std::vector<int>& list, int parameter) {
  const auto found = std::lower_bound(list.begin(), list.end(), parameter);
  return found != list.end() && *found == parameter ? static_cast<int>(found - list.begin()) : -1;
}

// Covariance of the step's own values in variables [free x free]; what is not determined has none.
Matrix OwnCovariance(const Uncertainty& uncertainty, const std::vector<int>& free, const Vector& slopes) {
  Matrix own = Matrix::Zero(slopes.size(), slopes.size());
  const auto deviation = [&](std::size_t i) {
    const ParameterVerdict& v = uncertainty.parameters[i];
    const double error = std::max(v.std_error, v.std_error_robust);
    return std::isfinite(error) ? error / slopes[PlaceOf(free, v.parameter)] : 0;
  };
  for (std::size_t i = 0; i < uncertainty.parameters.size(); ++i) {
    for (std::size_t k = 0; k < uncertainty.parameters.size(); ++k) {
      const double r = uncertainty.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      own(PlaceOf(free, uncertainty.parameters[i].parameter),
          PlaceOf(free, uncertainty.parameters[k].parameter)) =
          i == k ? deviation(i) * deviation(i) : (std::isfinite(r) ? r * deviation(i) * deviation(k) : 0);
    }
  }
  return own;
}

// Lets an end of an interval lie as much farther away as the added error asks for, in the parameter's scale.
double Farther(const Parameter& p, double value, double end, double added) {
  constexpr double kQuantile = 1.959964;
  if (p.scale == Scale::kLog) {
    const double way = std::log(end / value);
    const double reach = std::hypot(way, kQuantile * added / value);
    return value * std::exp(end < value ? -reach : reach);
  }
  const double reach = std::hypot(end - value, kQuantile * added);
  return end < value ? value - reach : value + reach;
}

void Widen(const Parameter& p, double added, ParameterVerdict& v) {
  if (!(added > 0) || v.interval == IntervalKind::kNone) return;
  v.std_error = std::hypot(v.std_error, added);
  v.std_error_robust = std::hypot(v.std_error_robust, added);
  const double lower = v.ci95_lower < v.value ? Farther(p, v.value, v.ci95_lower, added) : v.ci95_lower;
  const double upper = v.ci95_upper > v.value ? Farther(p, v.value, v.ci95_upper, added) : v.ci95_upper;
  v.lower_open = v.lower_open || lower < p.lower;
  v.upper_open = v.upper_open || upper > p.upper;
  v.ci95_lower = std::max(lower, p.lower);
  v.ci95_upper = std::min(upper, p.upper);
  if (v.verdict != Verdict::kIdentifiable && v.verdict != Verdict::kWeak) return;
  Interval interval;
  interval.lower = v.ci95_lower;
  interval.upper = v.ci95_upper;
  const auto place = [&](double x) {
    return p.scale == Scale::kLog ? std::log(x / p.lower) / std::log(p.upper / p.lower)
                                  : (x - p.lower) / (p.upper - p.lower);
  };
  interval.lower_x = place(v.ci95_lower);
  interval.upper_x = place(v.ci95_upper);
  interval.lower_open = v.lower_open;
  interval.upper_open = v.upper_open;
  if (uncertainty::IsWide(p, v.value, interval)) v.verdict = Verdict::kWeak;
}

}  // namespace

Status CarryErrors(const Problem& view, Identification& fit, CarriedErrors& carried) {
  const std::vector<int>& free = fit.setup.free;
  std::vector<int> held;
  std::vector<int> held_place;  // in `carried`
  for (std::size_t i = 0; i < carried.parameters.size(); ++i) {
    if (fit.setup.IsFree(carried.parameters[i])) continue;
    held.push_back(carried.parameters[i]);
    held_place.push_back(static_cast<int>(i));
  }
  FitSetup both = fit.setup;
  both.free.insert(both.free.end(), held.begin(), held.end());
  std::sort(both.free.begin(), both.free.end());
  const LeastSquares least_squares(view, both);
  auto workspace = least_squares.NewWorkspace();
  SparseJacobian jacobian = least_squares.NewJacobian();
  Vector residuals;
  const Vector x = least_squares.Variables(fit.parameters);
  SINEW_TRY(least_squares.Evaluate(x, workspace, residuals, &jacobian));
  const Vector slopes_of_both = least_squares.Slopes(x);
  Matrix all = jacobian.Dense(least_squares.residuals(), least_squares.variables());
  // A held value's own prior was used where it was found.
  const std::vector<int> priors = least_squares.PriorVariables();
  for (std::size_t k = 0; k < priors.size(); ++k) {
    if (PlaceOf(free, both.free[static_cast<std::size_t>(priors[k])]) < 0)
      all.row(least_squares.data_rows() + static_cast<int>(k)).setZero();
  }
  Matrix own(all.rows(), static_cast<Eigen::Index>(free.size()));
  Matrix of_held(all.rows(), static_cast<Eigen::Index>(held.size()));
  Vector slopes(own.cols());
  for (std::size_t i = 0; i < free.size(); ++i) {
    const int place = PlaceOf(both.free, free[i]);
    own.col(static_cast<Eigen::Index>(i)) = all.col(place);
    slopes[static_cast<Eigen::Index>(i)] = slopes_of_both[place];
  }
  for (std::size_t i = 0; i < held.size(); ++i)
    of_held.col(static_cast<Eigen::Index>(i)) = all.col(PlaceOf(both.free, held[i]));

  const Matrix follow =
      held.empty() ? Matrix(own.cols(), 0) : Matrix(-Eigen::ColPivHouseholderQR<Matrix>(own).solve(of_held));
  Matrix of_carried(static_cast<Eigen::Index>(held.size()), static_cast<Eigen::Index>(held.size()));
  for (std::size_t i = 0; i < held.size(); ++i) {
    for (std::size_t k = 0; k < held.size(); ++k)
      of_carried(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          carried.covariance(held_place[i], held_place[k]);
  }
  const Matrix added = follow * of_carried * follow.transpose();
  const Matrix covariance = OwnCovariance(fit.uncertainty, free, slopes) + added;
  const Matrix cross = follow * of_carried;

  for (ParameterVerdict& v : fit.uncertainty.parameters) {
    const int place = PlaceOf(free, v.parameter);
    Widen(fit.setup.parameters[static_cast<std::size_t>(v.parameter)],
          std::sqrt(std::max(0.0, added(place, place))) * slopes[place], v);
  }
  CarriedErrors now;
  now.parameters = both.free;
  now.covariance =
      Matrix::Zero(static_cast<Eigen::Index>(both.free.size()), static_cast<Eigen::Index>(both.free.size()));
  for (std::size_t i = 0; i < both.free.size(); ++i) {
    for (std::size_t k = 0; k < both.free.size(); ++k) {
      const int fi = PlaceOf(free, both.free[i]);
      const int fk = PlaceOf(free, both.free[k]);
      const int hi = fi < 0 ? PlaceOf(held, both.free[i]) : -1;
      const int hk = fk < 0 ? PlaceOf(held, both.free[k]) : -1;
      now.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          fi >= 0 && fk >= 0 ? covariance(fi, fk)
          : fi >= 0          ? cross(fi, hk)
          : fk >= 0          ? cross(fk, hi)
                             : of_carried(hi, hk);
    }
  }
  carried = std::move(now);
  return {};
}

}  // namespace sinew
