#include "identify/uncertainty/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "base/constants.h"
#include "base/decompositions.h"
#include "identify/solvers/local_fit.h"
#include "identify/statistics/distributions.h"
#include "identify/uncertainty/competing_minima.h"
#include "identify/uncertainty/covariance.h"
#include "identify/uncertainty/explain.h"
#include "identify/uncertainty/independence.h"
#include "identify/uncertainty/information.h"
#include "identify/uncertainty/interval.h"
#include "identify/uncertainty/linearization.h"
#include "identify/uncertainty/profile.h"
#include "identify/uncertainty/profile_end.h"
#include "identify/uncertainty/remedy.h"

namespace sinew::uncertainty {
namespace {

constexpr double kUpperProbability = 0.975;  // of a two-sided 95 % interval
constexpr long kPolishEvaluations = 100;
// Gain in cost at which the local search stops, over that which one standard error makes: a millionth of an
// error.
constexpr double kPolishTolerance = 1e-12;
// A gain of the local search that is worth a note, on the same scale: a tenth of a standard error is 0.01.
constexpr double kNotedGain = 0.01;
// The same for a point that a profile meets, after which everything is done again: a quarter of a standard
// error.
constexpr double kBetterGain = 0.0625;
// Ratio of robust to plain error from which there is a note.
constexpr double kNotedRatio = 1.5;
// Minima that add to the intervals, and the values that the note of them names.
constexpr std::size_t kMaxMinima = 8;
constexpr std::size_t kNotedValues = 5;
// Share of an interval by which the linear model of another minimum has to go beyond it for a profile there.
constexpr double kWorthAnEnd = 0.02;

/// What is found about one variable, in the unit box.
struct Finding {
  int variable = 0;
  bool determined = false;   ///< by the data
  double plain = kInfinity;  ///< errors in the unit box
  double robust = kInfinity;
  double normal = 0;  ///< (J'J)^-1 of it
  Interval interval;
  IntervalKind kind = IntervalKind::kNone;
  ProfileFailure no_profile = ProfileFailure::kNone;  ///< why the interval is linear

  double widest = kInfinity;  ///< the error that the interval is made of
};

class Analysis {
 public:
  Analysis(const LeastSquares& problem, const UncertaintyOptions& options)
      : problem_(problem), options_(options) {}

  Result<Uncertainty> Run(const Vector& x);

 private:
  Status FindMinimum(const Vector& x);
  void MakeInformations();
  void Unmeasurable(const Vector& x);
  void FindErrors();
  void FindCovariance();
  void FindIntervals();
  void ReleaseBounds();
  bool LowerMinimum();
  void Profiles();
  void ExtendTo(const LocalMinimum& other);
  [[nodiscard]] Vector Widths() const;
  [[nodiscard]] bool IsMeasured(const Finding& finding) const {
    return finding.kind != IntervalKind::kNone && finding.widest > 0;
  }
  [[nodiscard]] bool OnBoundEverywhere(int variable) const;
  [[nodiscard]] ProfileRequest RequestOf(const Finding& finding, const Matrix& normal) const;
  [[nodiscard]] Vector Tangent(const Matrix& normal, int variable) const;
  void Describe(const Vector& x);
  void NoteMinima();
  void AddNotes();

  [[nodiscard]] const Parameter& parameter(int variable) const { return at_.parameter(problem_, variable); }
  [[nodiscard]] int parameter_index(int variable) const {
    return problem_.setup().free[static_cast<std::size_t>(variable)];
  }
  [[nodiscard]] VariableStatus status(int variable) const {
    return at_.status[static_cast<std::size_t>(variable)];
  }
  [[nodiscard]] bool OnBound(int variable) const {
    return status(variable) == VariableStatus::kAtLower || status(variable) == VariableStatus::kAtUpper;
  }

  const LeastSquares& problem_;
  const UncertaintyOptions& options_;
  Uncertainty answer_;
  Linearization at_;
  double cost_ = 0;  // of solvers::LocalFit at the minimum
  double penalty_ = 0;
  std::vector<int> inner_nuisance_;
  Information all_;       // with priors: errors
  Information data_;      // without the priors of findings: verdicts
  Information released_;  // the same, as if no variable were on a bound: reasons
  Noise noise_;
  double quantile_ = 0;
  Matrix plain_;              // [k of all_]
  bool independent_ = false;  // residuals are no evidence against it
  std::vector<Finding> findings_;
};

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
  if (cost - cost_ >
      std::max(kNotedGain * cost_ / problem_.residuals(), kNoDependence * kNoDependence * signal)) {
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
    const double at = other.x[finding.variable];
    const auto x = [&](const ProfileEnd& end) { return end.failure == ProfileFailure::kNone ? end.x : at; };
    finding.interval = MakeInterval(problem_, at_.x, finding.variable,
                                    std::min(finding.interval.lower_x, x(profiles[i].lower)),
                                    std::max(finding.interval.upper_x, x(profiles[i].upper)));
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
    if (finding.no_profile != ProfileFailure::kNone) continue;
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

}  // namespace
}  // namespace sinew::uncertainty

namespace sinew {

const char* ToString(IntervalKind kind) {
  switch (kind) {
    case IntervalKind::kProfile:
      return "profile";
    case IntervalKind::kLinear:
      return "linear";
    case IntervalKind::kNone:
      return "none";
  }
  return "?";
}

Result<Uncertainty> AnalyseUncertainty(const LeastSquares& problem, const Vector& x,
                                       const UncertaintyOptions& options) {
  return uncertainty::Analysis(problem, options).Run(x);
}

}  // namespace sinew
