#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identify/uncertainty/analysis.h"
#include "identify/uncertainty/explain.h"
#include "identify/uncertainty/remedy.h"

namespace sinew::uncertainty {
namespace {

constexpr double kNotedRatio = 1.5;      // of a robust to its plain error: from here there is a note
constexpr std::size_t kNotedValues = 5;  // that the note of competing minima names

}  // namespace

void Analysis::Describe(const Vector& x) {
  const Explainer explainer(problem_, at_, released_, noise_, quantile_);
  const Vector values = problem_.Parameters(x);
  std::optional<RemedyFinder> remedies;  // predicts all other channels: only if it is needed
  std::vector<int> wide;
  for (const Finding& finding : findings_) {
    const int v = finding.variable;
    const Parameter& p = parameter(v);
    ParameterVerdict verdict;
    verdict.parameter = parameter_index(v);
    verdict.value = values[verdict.parameter];
    verdict.std_error = finding.plain * at_.slopes[v];
    verdict.std_error_robust = finding.robust * at_.slopes[v];
    verdict.ci95_lower = finding.interval.lower;
    verdict.ci95_upper = finding.interval.upper;
    verdict.lower_open = finding.interval.lower_open;
    verdict.upper_open = finding.interval.upper_open;
    verdict.interval = finding.kind;
    verdict.verdict = Judge(
        p, {finding.determined, OnBoundEverywhere(v), at_.parameters[verdict.parameter], finding.interval});
    switch (verdict.verdict) {
      case Verdict::kIdentifiable:
        verdict.reason = explainer.WhyIdentifiable(v, finding.interval);
        break;
      case Verdict::kAtBound:
        verdict.reason = explainer.WhyAtBound(v);
        verdict.remedy.kind = RemedyKind::kOtherBound;
        break;
      case Verdict::kWeak:
      case Verdict::kNotIdentifiable:
        verdict.reason = finding.determined ? explainer.WhyWide(v, finding.interval, finding.widest)
                                            : explainer.WhyUndetermined(v);
        if (!remedies) remedies.emplace(problem_, at_, noise_, quantile_);
        verdict.remedy = remedies->For(v);
        wide.push_back(v);
        break;
    }
    verdict.reason.no_profile = finding.no_profile;
    answer_.parameters.push_back(std::move(verdict));
  }
  answer_.directions = explainer.OpenDirections(wide);
}

// The minima, and the values that differ most between them, in widths of their intervals.
void Analysis::NoteMinima() {
  if (answer_.minima.size() < 2 || answer_.better_point.size() > 0) return;
  std::vector<std::pair<double, int>> spreads;
  const Vector widths = Widths();
  for (const int v : at_.reported) {
    double lowest = at_.x[v];
    double highest = lowest;
    for (const LocalMinimum& minimum : answer_.minima) {
      lowest = std::min(lowest, minimum.x[v]);
      highest = std::max(highest, minimum.x[v]);
    }
    if (widths[v] > 0) spreads.emplace_back((highest - lowest) / widths[v], v);
  }
  std::stable_sort(spreads.begin(), spreads.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  const double worst = answer_.minima.back().cost;
  Warning warning{WarningKind::kCompetingMinima,
                  {},
                  {static_cast<double>(answer_.minima.size()), cost_ > 0 ? worst / cost_ - 1 : 0},
                  {}};
  for (const auto& [spread, v] : spreads) {
    if (warning.names.size() == kNotedValues || spread < kSameShare) break;
    warning.names.push_back(parameter(v).name);
    warning.numbers.push_back(spread);
  }
  answer_.notes.push_back(std::move(warning));
}

void Analysis::AddNotes() {
  double largest = 1;
  for (const Finding& finding : findings_) {
    if (std::isfinite(finding.plain) && finding.plain > 0) {
      largest = std::max(largest, finding.robust / finding.plain);
    }
  }
  if (!independent_ && largest > kNotedRatio) {
    Warning warning{WarningKind::kDependentResiduals, {}, {largest}, {}};
    for (const ChannelNoise& channel : noise_.channels) {
      warning.names.push_back(channel.channel);
      warning.numbers.push_back(channel.correlation);
    }
    answer_.notes.push_back(std::move(warning));
  }
  NoteMinima();
  if (problem_.constraints() == 0) return;
  Vector constraint;
  LeastSquares::Workspace workspace = problem_.NewWorkspace();
  if (!problem_.Constraints(at_.x, workspace, constraint, nullptr)) return;  // predicted before at this x
  const Vector sizes = problem_.ConstraintSizes(at_.x);
  for (Eigen::Index i = 0; i < constraint.size(); ++i) {
    if (constraint[i] < -kBoundTolerance * sizes[i]) continue;
    answer_.notes.push_back(
        {WarningKind::kActiveConstraint, {problem_.ConstraintName(static_cast<int>(i))}, {}, {}});
  }
}

void Analysis::Unmeasurable(const Vector& x) {
  const Vector values = problem_.Parameters(x);
  const auto k = static_cast<Eigen::Index>(at_.reported.size());
  answer_.covariance = Matrix::Zero(k, k);
  answer_.covariance.diagonal().setConstant(kInfinity);
  answer_.correlation = Matrix::Identity(k, k);
  for (const int v : at_.reported) {
    ParameterVerdict verdict;
    verdict.parameter = parameter_index(v);
    verdict.value = values[verdict.parameter];
    verdict.std_error = verdict.std_error_robust = kInfinity;
    verdict.ci95_lower = parameter(v).lower;
    verdict.ci95_upper = parameter(v).upper;
    verdict.lower_open = verdict.upper_open = true;
    verdict.reason.kind = ReasonKind::kNoiseLevelUnknown;
    verdict.reason.residuals = at_.data_rows;
    verdict.reason.fitted = problem_.variables();
    verdict.remedy.kind = RemedyKind::kMoreSamples;
    answer_.parameters.push_back(std::move(verdict));
  }
}

}  // namespace sinew::uncertainty
