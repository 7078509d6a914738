#include "identify/uncertainty/analysis.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "identify/solvers/local_fit.h"
#include "identify/statistics/distributions.h"
#include "identify/uncertainty/covariance.h"
#include "identify/uncertainty/independence.h"

namespace sinew::uncertainty {
namespace {

constexpr double kUpperProbability = 0.975;  // of a two-sided 95 % interval
constexpr long kPolishEvaluations = 100;
// Gain in cost at which the local search stops, over that which one standard error makes: a millionth of an
// error.
constexpr double kPolishTolerance = 1e-12;
// A gain of the local search that is worth a note, on the same scale: a tenth of a standard error is 0.01.
constexpr double kNotedGain = 0.01;

}  // namespace

Result<Uncertainty> Analysis::Run(const Vector& x) {
  if (x.size() != problem_.variables()) {
    return Fail("the solution has {} variables, expected {}", x.size(), problem_.variables());
  }
  if (problem_.train_blocks().empty()) return Fail("nothing is fitted: no block has the role train");
  const Status found = FindMinimum(x);
  if (!found) return Fail("the solution cannot be analysed: {}", found.error().message);
  MakeInformations();
  answer_.singular_values = data_.singular_values;
  Result<Noise> noise = EstimateNoise(problem_, at_, all_.leverage);
  if (!noise) {
    Unmeasurable(x);
    return std::move(answer_);
  }
  noise_ = std::move(*noise);
  quantile_ = statistics::StudentTQuantile(kUpperProbability, noise_.degrees_of_freedom);
  answer_.noise = noise_.channels;
  answer_.residual_scale = noise_.residual_scale;
  answer_.degrees_of_freedom = noise_.degrees_of_freedom;
  FindErrors();
  FindCovariance();
  FindIntervals();
  Describe(x);
  AddNotes();
  return std::move(answer_);
}

Status Analysis::FindMinimum(const Vector& x) {
  solvers::LocalFit fit(problem_);
  double cost = 0;
  {
    LeastSquares::Workspace workspace = problem_.NewWorkspace();
    SINEW_ASSIGN(cost, problem_.Cost(x, workspace));
  }
  const solvers::LocalFit::Outcome outcome =
      fit.Minimize(x, -1, {0, kPolishTolerance / problem_.residuals()}, kPolishEvaluations);
  if (!outcome.failure.empty()) return Fail("{}", outcome.failure);
  cost_ = outcome.cost;
  penalty_ = fit.penalty();
  SINEW_ASSIGN(at_, Linearize(problem_, outcome.x));
  answer_.evaluations += fit.evaluations() + 2;
  answer_.minimum = at_.parameters;

  double signal = 0;  // sum of squares
  for (const Linearization::Rows& rows : at_.blocks) signal += rows.count * rows.signal * rows.signal;
  if (cost - cost_ > std::max(kNotedGain * cost_ / problem_.residuals(), kNoChange * kNoChange * signal)) {
    answer_.notes.push_back({WarningKind::kNotAMinimum, {}, {cost, cost_}, {}});
    answer_.better_point = outcome.x;
  }
  if (!outcome.converged) answer_.notes.push_back({WarningKind::kSearchUnfinished, {}, {}, {}});
  return {};
}

void Analysis::MakeInformations() {
  const auto inner = [&](const std::vector<int>& variables, bool with_priors) {
    std::vector<int> kept;
    for (const int v : variables) {
      const bool by_prior = with_priors && status(v) == VariableStatus::kNoDependence && parameter(v).prior;
      if (status(v) == VariableStatus::kInside || by_prior) kept.push_back(v);
    }
    return kept;
  };
  inner_nuisance_ = inner(at_.nuisance, true);
  all_ = MakeInformation(at_.jacobian, inner(at_.reported, true), inner_nuisance_);

  Matrix data_only = at_.jacobian;
  for (std::size_t i = 0; i < at_.prior_variable.size(); ++i) {
    if (parameter(at_.prior_variable[i]).kind == ParameterKind::kNuisance) continue;
    data_only.row(at_.data_rows + static_cast<Eigen::Index>(i)).setZero();
  }
  // Nor is a range anything that was measured.
  const auto known = at_.data_rows + static_cast<Eigen::Index>(at_.prior_variable.size());
  data_only.bottomRows(data_only.rows() - known).setZero();
  data_ = MakeInformation(data_only, inner(at_.reported, false), inner_nuisance_);
  std::vector<int> released;
  std::copy_if(at_.reported.begin(), at_.reported.end(), std::back_inserter(released),
               [&](int v) { return status(v) != VariableStatus::kNoDependence; });
  released_ = MakeInformation(data_only, released, inner_nuisance_);
}

void Analysis::FindErrors() {
  plain_ = PlainCovariance(all_, noise_.deviation);
  const Matrix robust = RobustCovariance(all_, at_, noise_.deviation);
  independent_ = ResidualsLookIndependent(problem_, at_);
  for (const int v : at_.reported) {
    Finding finding;
    finding.variable = v;
    const int in_data = data_.index_of(v);
    finding.determined = in_data >= 0 && data_.determined[static_cast<std::size_t>(in_data)];
    if (const int j = all_.index_of(v); j >= 0 && all_.determined[static_cast<std::size_t>(j)]) {
      finding.plain = std::sqrt(plain_(j, j));
      finding.robust = std::sqrt(std::max(robust(j, j), 0.0));
      finding.widest = independent_ ? finding.plain : std::max(finding.plain, finding.robust);
      finding.normal = all_.inverse(j, j);
    } else if (OnBound(v)) {
      // As if the bound were not there. Its interval is that of the plain error: the misfit that a bound
      // causes looks like correlated noise, and is none.
      std::vector<int> released = all_.variables;
      released.push_back(v);
      const Information info = MakeInformation(at_.jacobian, released, inner_nuisance_);
      const auto last = static_cast<Eigen::Index>(released.size()) - 1;
      finding.determined = info.determined.back();
      if (finding.determined) {
        finding.plain = std::sqrt(PlainCovariance(info, noise_.deviation)(last, last));
        finding.robust = std::sqrt(std::max(RobustCovariance(info, at_, noise_.deviation)(last, last), 0.0));
        finding.widest = finding.plain;
        finding.normal = info.inverse(last, last);
      }
    }
    findings_.push_back(std::move(finding));
  }
}

void Analysis::FindCovariance() {
  const auto k = static_cast<Eigen::Index>(findings_.size());
  answer_.covariance = Matrix::Zero(k, k);
  answer_.correlation = Matrix::Identity(k, k);
  for (Eigen::Index a = 0; a < k; ++a) {
    const Finding& one = findings_[static_cast<std::size_t>(a)];
    const double slope = at_.slopes[one.variable];
    answer_.covariance(a, a) = std::pow(one.plain * slope, 2);
    const int i = all_.index_of(one.variable);
    for (Eigen::Index b = 0; b < a; ++b) {
      const Finding& other = findings_[static_cast<std::size_t>(b)];
      const int j = all_.index_of(other.variable);
      if (i < 0 || j < 0 || !std::isfinite(one.plain) || !std::isfinite(other.plain)) continue;
      const double covariance = plain_(i, j) * slope * at_.slopes[other.variable];
      answer_.covariance(a, b) = answer_.covariance(b, a) = covariance;
      const double both = one.plain * other.plain;
      answer_.correlation(a, b) = answer_.correlation(b, a) = both > 0 ? plain_(i, j) / both : 0;
    }
  }
}

}  // namespace sinew::uncertainty
