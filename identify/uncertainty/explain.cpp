#include "identify/uncertainty/explain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "identify/uncertainty/interval.h"

namespace sinew::uncertainty {
namespace {

// Partners are named if their loading is at least this share of the largest one.
constexpr double kNamedLoading = 0.1;
// Directions are drawn to this relative change: large enough to be seen, small enough to be linear.
constexpr double kShownChange = 0.1;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A quantity with relative changes: neither its sign nor its size can vanish.
bool IsRatioQuantity(const Parameter& parameter, double value) {
  return value != 0 && (parameter.lower >= 0 || parameter.upper <= 0);
}

}  // namespace

double Explainer::value(int variable) const {
  return at_.parameters[problem_.setup().free[static_cast<std::size_t>(variable)]];
}

double Explainer::ErrorAlone(const VectorRef& column) const {
  return noise_.deviation.cwiseProduct(column).norm() / column.squaredNorm();
}

bool Explainer::WideWith(int variable, double error) const {
  return IsWide(parameter(variable), value(variable),
                LinearInterval(problem_, at_.x, variable, quantile_ * error));
}

double Explainer::ErrorTogether(int j) const {
  if (!info_.determined[static_cast<std::size_t>(j)]) return std::numeric_limits<double>::infinity();
  return (info_.columns * info_.inverse.col(j)).cwiseProduct(noise_.deviation).norm();
}

int Explainer::DominantDirection(int j) const {
  const bool lost = !info_.determined[static_cast<std::size_t>(j)];
  int dominant = lost ? info_.rank : 0;
  double largest = -1;
  for (int i = dominant; i < (lost ? static_cast<int>(info_.directions.cols()) : info_.rank); ++i) {
    const double share = std::abs(info_.directions(j, i)) / (lost ? 1 : info_.singular_values[i]);
    if (share > largest) {
      largest = share;
      dominant = i;
    }
  }
  return dominant;
}

std::vector<std::string> Explainer::Partners(int j, int direction) const {
  const double largest = info_.directions.col(direction).cwiseAbs().maxCoeff();
  std::vector<std::pair<double, std::string>> partners;
  for (std::size_t i = 0; i < info_.variables.size(); ++i) {
    const double loading = std::abs(info_.directions(static_cast<Eigen::Index>(i), direction));
    if (static_cast<int>(i) == j || loading < kNamedLoading * largest) continue;
    partners.emplace_back(-loading, parameter(info_.variables[i]).name);
  }
  std::stable_sort(partners.begin(), partners.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (const auto& partner : partners) names.push_back(partner.second);
  return names;
}

std::vector<std::string> Explainer::NuisancePartners(int j) const {
  const Vector share = info_.nuisance_share.col(j);
  const double largest = share.maxCoeff();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < info_.nuisance.size(); ++i) {
    if (share[static_cast<Eigen::Index>(i)] >= kNamedLoading * largest) {
      names.push_back(parameter(info_.nuisance[i]).name);
    }
  }
  return names;
}

OpenDirection Explainer::Direction(int direction) const {
  OpenDirection open;
  open.lost = direction >= info_.rank;
  const double largest_loading = info_.directions.col(direction).cwiseAbs().maxCoeff();
  double largest = 0;  // per unit of the direction, of the value or of the range
  for (std::size_t i = 0; i < info_.variables.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    if (std::abs(info_.directions(j, direction)) < kNamedLoading * largest_loading) continue;
    const int variable = info_.variables[i];
    const Parameter& p = parameter(variable);
    const double change = info_.directions(j, direction) / info_.norm[j] * at_.slopes[variable];
    const bool ratio = IsRatioQuantity(p, value(variable));
    const double relative = change / (ratio ? value(variable) : p.upper - p.lower);
    open.changes.push_back({p.name, p.unit, change, ratio ? relative : kNaN});
    largest = std::max(largest, std::abs(relative));
  }
  double amount = kShownChange / largest;
  if (!open.lost)
    amount = std::min(amount, quantile_ * noise_.residual_scale / info_.singular_values[direction]);
  if (open.changes.front().change < 0) amount = -amount;
  for (ParameterChange& part : open.changes) {
    part.change *= amount;
    part.relative *= amount;
  }
  return open;
}

Reason Explainer::WhyUndetermined(int variable) const {
  Reason reason;
  reason.by_prior = parameter(variable).prior.has_value();
  if (at_.status[static_cast<std::size_t>(variable)] == VariableStatus::kNoDependence) {
    reason.kind = IsWithoutEffectEverywhere(problem_, at_, variable) ? ReasonKind::kNoResponse
                                                                     : ReasonKind::kNoResponseHere;
    reason.channels = FittedChannels(problem_);
    return reason;
  }
  const int j = info_.index_of(variable);
  if (info_.lost_to_nuisance[static_cast<std::size_t>(j)]) {
    reason.kind = ReasonKind::kCompensated;
    reason.partners = NuisancePartners(j);
    reason.nuisance = static_cast<int>(info_.nuisance.size());
    return reason;
  }
  const int direction = DominantDirection(j);
  reason.kind = ReasonKind::kCombination;
  reason.partners = Partners(j, direction);
  reason.direction = Direction(direction);
  return reason;
}

Reason Explainer::WhyWide(int variable, const Interval& interval, double error) const {
  Reason reason;
  AddWidth(variable, interval, reason);
  const auto in_units = [&](double x) { return x * at_.slopes[variable]; };
  const int j = info_.index_of(variable);
  const double plain = ErrorTogether(j);
  if (!WideWith(variable, plain)) {
    const bool curved = WideWith(variable, error);
    reason.kind = curved ? ReasonKind::kDependentResiduals : ReasonKind::kFlatCost;
    reason.std_error = in_units(error);
    if (curved) reason.std_error_without = in_units(plain);
    return reason;
  }
  if (std::isfinite(plain)) reason.std_error = in_units(plain);
  const double alone = ErrorAlone(at_.jacobian.col(variable));
  if (WideWith(variable, alone)) {
    reason.kind = ReasonKind::kWeakExcitation;
    reason.std_error_without = in_units(alone);
    return reason;
  }
  const double without_nuisance = ErrorAlone(info_.columns.col(j));
  if (WideWith(variable, without_nuisance)) {
    reason.kind = ReasonKind::kPartiallyCompensated;
    reason.partners = NuisancePartners(j);
    reason.std_error_without = in_units(alone);
    return reason;
  }
  reason.kind = ReasonKind::kCorrelated;
  reason.partners = Partners(j, DominantDirection(j));
  reason.std_error_without = in_units(without_nuisance);
  return reason;
}

Reason Explainer::WhyAtBound(int variable) const {
  Reason reason;
  reason.kind = ReasonKind::kAtBound;
  reason.at_lower = at_.status[static_cast<std::size_t>(variable)] == VariableStatus::kAtLower;
  return reason;
}

Reason Explainer::WhyIdentifiable(int variable, const Interval& interval) const {
  Reason reason;
  AddWidth(variable, interval, reason);
  return reason;
}

void Explainer::AddWidth(int variable, const Interval& interval, Reason& reason) const {
  const Parameter& p = parameter(variable);
  const double width = interval.upper - interval.lower;
  reason.width_of_value = IsRatioQuantity(p, value(variable));
  reason.width =
      reason.width_of_value ? 0.5 * width / std::abs(value(variable)) : width / (p.upper - p.lower);
}

std::vector<OpenDirection> Explainer::OpenDirections(const std::vector<int>& wide_variables) const {
  std::set<int> directions;
  for (int i = info_.rank; i < info_.directions.cols(); ++i) directions.insert(i);
  for (const int variable : wide_variables) {
    const int j = info_.index_of(variable);
    if (j < 0) continue;
    const bool together = WideWith(variable, ErrorTogether(j));
    if (together && !WideWith(variable, ErrorAlone(info_.columns.col(j))))
      directions.insert(DominantDirection(j));
  }
  std::vector<OpenDirection> open;
  for (const int direction : directions) {
    const Vector loadings = info_.directions.col(direction).cwiseAbs();
    const auto involved = (loadings.array() >= kNamedLoading * loadings.maxCoeff()).count();
    if (involved >= 2) open.push_back(Direction(direction));
  }
  return open;
}

}  // namespace sinew::uncertainty
