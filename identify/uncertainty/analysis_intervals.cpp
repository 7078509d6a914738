#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/decompositions.h"
#include "identify/solvers/local_fit.h"
#include "identify/uncertainty/analysis.h"
#include "identify/uncertainty/profile_end.h"

namespace sinew::uncertainty {
namespace {

// A gain in cost at a point that a profile meets after which everything is done again, over that which one
// standard error makes: a quarter of an error.
constexpr double kBetterGain = 0.0625;
// Minima that add to the intervals.
constexpr std::size_t kMaxMinima = 8;
// Share of an interval by which the linear model of another minimum has to go beyond it for a profile there.
constexpr double kWorthAnEnd = 0.02;

// The interval, with what a profile knows to be inside.
// @param x [n] point that gives all other values
Interval Widened(const LeastSquares& problem, const Vector& x, const Finding& finding,
                 const Profile& profile) {
  return MakeInterval(problem, x, finding.variable, std::min(finding.interval.lower_x, profile.lower.x),
                      std::max(finding.interval.upper_x, profile.upper.x));
}

}  // namespace

Vector Analysis::Tangent(const Matrix& normal, int variable) const {
  // Enough to survive rank loss among the others, too little to bend the tangent.
  constexpr double kRidge = 1e-10;
  std::vector<int> moving;
  for (int v = 0; v < problem_.variables(); ++v) {
    if (v != variable && !OnBound(v) && normal(v, v) > 0) moving.push_back(v);
  }
  const auto n = static_cast<Eigen::Index>(moving.size());
  Vector tangent = Vector::Zero(problem_.variables());
  Matrix scaled(n, n);
  Vector pull(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double scale = std::sqrt(normal(moving[i], moving[i]));
    pull[i] = -normal(moving[i], variable) / scale;
    for (Eigen::Index j = 0; j < n; ++j) {
      scaled(i, j) = normal(moving[i], moving[j]) / scale / std::sqrt(normal(moving[j], moving[j]));
    }
    scaled(i, i) += kRidge;
  }
  if (n == 0) return tangent;
  const Vector solution = scaled.ldlt().solve(pull);
  for (Eigen::Index i = 0; i < n; ++i)
    tangent[moving[i]] = solution[i] / std::sqrt(normal(moving[i], moving[i]));
  return tangent;
}

ProfileRequest Analysis::RequestOf(const Finding& finding, const Matrix& normal) const {
  const double half_width = quantile_ * finding.widest;
  return {finding.variable, 0.5 * half_width * half_width / finding.normal, half_width,
          Tangent(normal, finding.variable)};
}

// Errors hold what is on a bound there. An interval must not: what lies on a bound is not known, and leaves
// it as soon as the others, moved with the parameter, let the cost fall inward.
void Analysis::ReleaseBounds() {
  const auto on_bound = [&](int v) { return OnBound(v); };
  std::vector<int> all(static_cast<std::size_t>(problem_.variables()));
  std::iota(all.begin(), all.end(), 0);
  if (std::none_of(all.begin(), all.end(), on_bound)) return;
  const solvers::BoxQuadraticModel model{at_.jacobian.transpose() * at_.jacobian, at_.gradient};
  for (Finding& finding : findings_) {
    if (!IsMeasured(finding)) continue;
    const ProfileRequest request = RequestOf(finding, model.normal);
    const double x = at_.x[finding.variable];
    // Never inside of the interval with bounds held: rounding apart, the model cannot end there.
    const auto end = [&](double sign) {
      const auto found = LinearEnd({at_.x, at_.cost, model, request, sign, 0, 0});
      const double distance = found ? sign * ((*found)[finding.variable] - x) : 0;
      return x + sign * std::max(distance, request.step);
    };
    finding.interval = MakeInterval(problem_, at_.x, finding.variable, end(-1), end(1));
  }
}

Vector Analysis::Widths() const {
  Vector widths = Vector::Zero(problem_.variables());
  for (const Finding& finding : findings_) {
    if (IsMeasured(finding)) widths[finding.variable] = finding.interval.upper_x - finding.interval.lower_x;
  }
  return widths;
}

// Looks for other minima that the data do not distinguish. @return true if the lowest is another one than
// that of the analysis.
bool Analysis::LowerMinimum() {
  const LocalMinimum here{cost_, at_.x};
  answer_.minima = {here};
  if (options_.points == nullptr || problem_.constraints() > 0) return false;
  const solvers::BoxQuadraticModel model{at_.jacobian.transpose() * at_.jacobian, at_.gradient};
  double rise = 0;
  std::vector<Vector> ends;
  for (const Finding& finding : findings_) {
    if (!IsMeasured(finding)) continue;
    rise = std::max(rise, 0.5 * std::pow(quantile_ * finding.plain, 2) / finding.normal);
    const ProfileRequest request = RequestOf(finding, model.normal);
    for (const double sign : {-1.0, 1.0}) {
      if (auto end = LinearEnd({at_.x, at_.cost, model, request, sign, 0, 0}))
        ends.push_back(std::move(*end));
    }
  }
  if (!(rise > 0)) return false;
  const Vector widths = Widths();
  answer_.minima = CompetingMinima(problem_,
                                   {here, rise, widths, *options_.points, ends, penalty_, options_.threads,
                                    options_.interrupt, options_.search_evaluations},
                                   answer_.evaluations);
  const LocalMinimum& lowest = answer_.minima.front();
  if (!(lowest.cost < here.cost) || DistanceInWidths(lowest.x, here.x, widths) < kSameShare) return false;
  answer_.notes.push_back({WarningKind::kBetterFit, {}, {cost_, lowest.cost}, {}});
  answer_.better_point = lowest.x;
  return true;
}

// The intervals as they are by another minimum, with the same limit of the cost.
void Analysis::ExtendTo(const LocalMinimum& other) {
  solvers::LocalFit fit(problem_, penalty_);
  const Result<double> cost = fit.ModelAt(other.x);
  ++answer_.evaluations;
  if (!cost) return;
  const Matrix here = Gram(at_.jacobian);
  std::vector<ProfileRequest> requests;
  std::vector<Finding*> finding_of;
  for (Finding& finding : findings_) {
    if (!IsMeasured(finding)) continue;
    ProfileRequest request = RequestOf(finding, here);
    const double left = request.rise - (*cost - cost_);
    if (!(left > 0)) continue;
    request.step *= std::sqrt(left / request.rise);
    request.rise = left;
    request.tangent = Tangent(fit.model().normal, finding.variable);
    const int v = finding.variable;
    const double margin = kWorthAnEnd * (finding.interval.upper_x - finding.interval.lower_x);
    bool goes_beyond = false;
    for (const double sign : {-1.0, 1.0}) {
      const auto end = LinearEnd({other.x, *cost, fit.model(), request, sign, 0, 0});
      const double x = end ? (*end)[v] : other.x[v];
      goes_beyond =
          goes_beyond || x < finding.interval.lower_x - margin || x > finding.interval.upper_x + margin;
    }
    if (!goes_beyond) continue;
    requests.push_back(std::move(request));
    finding_of.push_back(&finding);
  }
  const std::vector<Profile> profiles =
      ProfileIntervals(problem_, other.x, *cost, requests,
                       {options_.threads, options_.max_profile_evaluations, penalty_, options_.interrupt},
                       answer_.evaluations);
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    Finding& finding = *finding_of[i];
    finding.interval = Widened(problem_, at_.x, finding, profiles[i]);
  }
}

// A value that lies on its bound at one of several minima that the data do not distinguish may lie inside.
bool Analysis::OnBoundEverywhere(int variable) const {
  if (!OnBound(variable)) return false;
  const double bound = status(variable) == VariableStatus::kAtLower ? 0 : 1;
  return std::all_of(answer_.minima.begin(), answer_.minima.end(), [&](const LocalMinimum& minimum) {
    return std::abs(minimum.x[variable] - bound) <= kBoundTolerance;
  });
}

void Analysis::Profiles() {
  const Matrix normal = Gram(at_.jacobian);
  std::vector<ProfileRequest> requests;
  std::vector<std::size_t> finding_of;
  for (std::size_t f = 0; f < findings_.size(); ++f) {
    const Finding& finding = findings_[f];
    if (!IsMeasured(finding)) continue;
    requests.push_back(RequestOf(finding, normal));
    finding_of.push_back(f);
  }
  const std::vector<Profile> profiles =
      ProfileIntervals(problem_, at_.x, cost_, requests,
                       {options_.threads, options_.max_profile_evaluations, penalty_, options_.interrupt},
                       answer_.evaluations);
  LowestCost lowest{cost_, {}};
  bool better = false;
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    const Profile& profile = profiles[i];
    Finding& finding = findings_[finding_of[i]];
    if (profile.lowest.cost < lowest.cost) lowest = profile.lowest;
    // The rise that one standard error makes.
    const double unit = requests[i].rise / (quantile_ * quantile_);
    better = better || cost_ - profile.lowest.cost > kBetterGain * unit;
    finding.no_profile =
        profile.lower.failure == ProfileFailure::kNone ? profile.upper.failure : profile.lower.failure;
    if (finding.no_profile != ProfileFailure::kNone) {
      finding.interval = Widened(problem_, at_.x, finding, profile);
      continue;
    }
    finding.kind = IntervalKind::kProfile;
    finding.interval = MakeInterval(problem_, at_.x, finding.variable, profile.lower.x, profile.upper.x);
  }
  if (better) {
    answer_.notes.push_back({WarningKind::kBetterFit, {}, {cost_, lowest.cost}, {}});
    // A penalty allows a search to end slightly beyond a constraint, where no answer may be.
    if (problem_.constraints() == 0) answer_.better_point = std::move(lowest.x);
  }
}

void Analysis::FindIntervals() {
  for (Finding& finding : findings_) {
    const bool finite = std::isfinite(finding.widest);
    finding.kind = finite ? IntervalKind::kLinear : IntervalKind::kNone;
    finding.interval = LinearInterval(problem_, at_.x, finding.variable, quantile_ * finding.widest);
  }
  ReleaseBounds();
  if (!options_.profile || LowerMinimum()) return;
  const Vector widths = Widths();
  Profiles();
  std::size_t others = 0;
  for (const LocalMinimum& minimum : answer_.minima) {
    if (DistanceInWidths(minimum.x, at_.x, widths) < kSameShare) continue;
    if (++others < kMaxMinima) ExtendTo(minimum);
  }
}

}  // namespace sinew::uncertainty
