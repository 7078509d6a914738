#include "identify/diagnosis/tabulation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/diagnosis/score/quantised_channels.h"

namespace sinew::diagnosis {
namespace {

constexpr double kPower = 1.645;        // 95 % above a threshold
constexpr double kSeparation = 0.4165;  // see Alternative::separating_size
constexpr double kSameClass = 0.97;
constexpr double kContained = 0.9999;
constexpr double kNormal95 = 1.959964;

double SizeOf(double statistic) {
  return statistic > 0 ? std::sqrt(statistic) / kDetectableLength : 0;
}

// Free parameters that are no nuisance, and no weight of an unknown term, which is described as a curve.
std::vector<int> Findings(const DiagnosisState& state, const Refit& refit) {
  std::vector<int> findings;
  for (const int index : refit.setup->free) {
    const bool of_term = std::any_of(refit.released.begin(), refit.released.end(), [&](int c) {
      const Candidate& candidate = state.candidate(c);
      const auto& own = candidate.parameters;
      return !candidate.known && std::find(own.begin(), own.end(), index) != own.end();
    });
    if (!of_term && refit.setup->parameters[static_cast<std::size_t>(index)].kind != ParameterKind::kNuisance)
      findings.push_back(index);
  }
  return findings;
}

class Tables {
 public:
  Tables(DiagnosisState& state, Diagnosis& diagnosis)
      : state_(state), out_(diagnosis), log_rows_(std::log(state.selection.model.rows)) {}

  Status Fill() {
    const Refit& model = state_.selection.model;
    SINEW_ASSIGN(const Matrix base_covariance, state_.CovarianceOf(state_.base.refit));
    out_.base_parameters =
        ValuesOf(state_, state_.base.refit, base_covariance, Findings(state_, state_.base.refit));
    SINEW_ASSIGN(const Matrix covariance, CovarianceOverSets(model));
    out_.extended_parameters = ValuesOf(state_, model, covariance, Findings(state_, model));
    for (const ChosenCause& chosen : state_.selection.causes) AddCause(chosen, covariance);
    for (const Rival& rival : state_.selection.rivals) SINEW_TRY(AddAlternative(rival));
    AddScores();
    return AddRoundings();
  }

 private:
  // With the variance over the sets of causes, where the data determine a variable at all.
  [[nodiscard]] Result<Matrix> CovarianceOverSets(const Refit& refit) const {
    SINEW_ASSIGN(Matrix covariance, state_.CovarianceOf(refit));
    const Vector spread = state_.SpreadOverSets(refit);
    for (Eigen::Index v = 0; v < spread.size(); ++v) {
      if (covariance(v, v) > 0) covariance(v, v) += spread[v];
    }
    return covariance;
  }

  void AddCause(const ChosenCause& chosen, const Matrix& covariance) {
    const Candidate& candidate = state_.candidate(chosen.candidate);
    Cause cause;
    cause.effect = candidate.effect;
    cause.level = candidate.level;
    cause.description = candidate.description;
    cause.parameters = ValuesOf(state_, state_.selection.model, covariance, candidate.parameters);
    cause.p_value = chosen.p_value;
    cause.left_out = chosen.left_out;
    cause.delta_lr = chosen.delta_lr;
    cause.delta_bic = chosen.delta_lr - static_cast<double>(candidate.parameters.size()) * log_rows_;
    cause.size = SizeOf(chosen.delta_lr);
    // Where and how fast a law acts is none of its size.
    cause.interval_contains_null = NoneExcludesNull(
        ValuesOf(state_, state_.selection.model, covariance, ScoredParameters(candidate, 0)));
    out_.causes.push_back(std::move(cause));
  }

  Status AddAlternative(const Rival& rival) {
    const Candidate& candidate = state_.candidate(rival.candidate);
    const Candidate& cause = state_.candidate(rival.instead_of);
    SINEW_ASSIGN(const Matrix covariance, CovarianceOverSets(rival.refit));
    Alternative other;
    other.instead_of = cause.effect;
    other.effect = candidate.effect;
    other.level = candidate.level;
    other.description = candidate.description;
    other.parameters = ValuesOf(state_, rival.refit, covariance, candidate.parameters);
    other.delta_lr = rival.delta_lr;
    other.delta_bic = rival.delta_lr + (static_cast<double>(candidate.parameters.size()) -
                                        static_cast<double>(cause.parameters.size())) *
                                           log_rows_;
    other.left_out = rival.left_out;
    other.correlation = rival.correlation;
    other.same_class = std::abs(rival.correlation) > kSameClass;
    other.less_common = candidate.occurrence > cause.occurrence;
    const double apart = 1 - std::abs(rival.correlation);
    other.separating_size =
        apart > 1e-6 ? std::sqrt(kSeparation / apart) : std::numeric_limits<double>::infinity();
    other.contains_cause =
        std::abs(rival.correlation) > kContained && candidate.parameters.size() > cause.parameters.size();
    if (!other.contains_cause)
      other.separated_by = candidate.revealing_experiment.empty() ? cause.revealing_experiment
                                                                  : candidate.revealing_experiment;
    out_.alternatives.push_back(std::move(other));
    return {};
  }

  void AddScores() {
    for (std::size_t c = 0; c < state_.candidates.size(); ++c) {
      const Candidate& candidate = state_.candidates[c];
      const Score* best = state_.base.BestOf(static_cast<int>(c));
      // A drift is scored only if its parameter is in the model.
      if (best == nullptr && (candidate.drifting >= 0 || candidate.beside_causes)) continue;
      EffectScore score;
      score.effect = candidate.effect;
      score.level = candidate.level;
      score.known = candidate.known;
      if (best == nullptr) {
        score.judged = false;
        score.why_not = NotJudged::kNoDistinctChange;
      } else {
        FillScore(candidate, static_cast<int>(c), *best, score);
      }
      for (const Refit& refit : state_.selection.tried) {
        if (refit.released != std::vector<int>{static_cast<int>(c)}) continue;
        score.refitted = true;
        score.delta_lr = LikelihoodDifference(state_.base.refit, refit);
        score.delta_bic = score.delta_lr - static_cast<double>(candidate.parameters.size()) * log_rows_;
      }
      out_.scores.push_back(std::move(score));
    }
    std::stable_sort(out_.scores.begin(), out_.scores.end(),
                     [](const EffectScore& a, const EffectScore& b) { return a.statistic > b.statistic; });
  }

  void FillScore(const Candidate& candidate, int c, const Score& best, EffectScore& score) const {
    const ScoredModel& base = state_.base;
    for (const auto& [index, value] : candidate.probes[static_cast<std::size_t>(best.probe)].at) {
      const Parameter& p = base.refit.setup->parameters[static_cast<std::size_t>(index)];
      score.probe.push_back({p.name, p.unit, value});
    }
    score.degrees = static_cast<int>(best.directions.size());
    score.statistic = best.statistic;
    score.p_value = best.p_value;
    if (const Score* plain = base.BestOf(c, base.plain)) score.unwhitened = plain->statistic;
    for (std::size_t i = 0; i < base.whitened.scores.size(); ++i) {
      if (base.whitened.scores[i].candidate == c)
        score.family_p_value = std::min(score.family_p_value, base.family.score_p_value[i]);
    }
    if (!candidate.known) return;
    const int column = best.columns.front();
    const auto& parameter = base.refit.setup->parameters[static_cast<std::size_t>(
        base.design.columns[static_cast<std::size_t>(column)].parameter)];
    score.detectable_parameter = parameter.name;
    score.detectable_unit = parameter.unit;
    score.smallest_detectable = (base.family.threshold + kPower) / base.whitened.length[column];
  }

  Status AddRoundings() {
    SINEW_ASSIGN(const auto roundings, FindQuantisation(state_.problem, state_.selection.model.point));
    for (const Quantisation& rounding : roundings) {
      const double size = SizeOf(rounding.statistic);
      EffectScore score;
      score.effect = rounding.effect;
      score.statistic = rounding.statistic;
      score.p_value = size > 1 ? 0 : 1;
      score.family_p_value = score.p_value;
      Insert(std::move(score), out_.scores);
      if (size <= 1) continue;
      Cause cause;
      cause.effect = rounding.effect;
      cause.kind = CauseKind::kQuantisation;
      cause.channel = rounding.channel;
      cause.p_value = 0;
      cause.delta_lr = rounding.statistic;
      cause.delta_bic = rounding.statistic - log_rows_;
      cause.size = size;
      const double reach = rounding.uncertainty;
      cause.parameters = {{rounding.effect,
                           rounding.unit,
                           rounding.step,
                           reach / kNormal95,
                           {rounding.step - reach, rounding.step + reach},
                           0}};
      // The other causes stay in the order of their selection: a quantisation, which is certain, is inserted
      // before those that explain less.
      const auto less = std::find_if(out_.causes.begin(), out_.causes.end(),
                                     [&](const Cause& other) { return other.delta_lr < cause.delta_lr; });
      out_.causes.insert(less, std::move(cause));
      state_.selection.family_p_value = 0;
      state_.selection.alarm = true;
    }
    return {};
  }

  DiagnosisState& state_;
  Diagnosis& out_;
  double log_rows_;
};

}  // namespace

std::vector<DiagnosedParameter> ValuesOf(const DiagnosisState& state, const Refit& refit,
                                         const Matrix& covariance, const std::vector<int>& which) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const LeastSquares fit(state.problem, *refit.setup);
  const Vector slopes = fit.Slopes(refit.x);
  std::vector<DiagnosedParameter> values;
  for (const int index : which) {
    const auto at = std::lower_bound(refit.setup->free.begin(), refit.setup->free.end(), index);
    if (at == refit.setup->free.end() || *at != index) continue;
    const auto v = static_cast<Eigen::Index>(at - refit.setup->free.begin());
    const Parameter& p = refit.setup->parameters[static_cast<std::size_t>(index)];
    DiagnosedParameter one;
    one.name = p.name;
    one.unit = p.unit;
    one.value = refit.point[index];
    one.before = state.base.refit.point[index];
    if (!(covariance(v, v) > 0)) {  // held at its bound, or without any effect
      one.std_error = kUnknown;
      one.ci95 = {kUnknown, kUnknown};
      if (one.value <= p.lower || one.value >= p.upper)
        one.at_bound = one.value <= p.lower ? "lower" : "upper";
      values.push_back(std::move(one));
      continue;
    }
    one.std_error = std::sqrt(covariance(v, v)) * std::abs(slopes[v]);
    if (p.scale == Scale::kLog && one.value > 0) {
      const double factor = std::exp(kNormal95 * one.std_error / one.value);
      one.ci95 = {one.value / factor, one.value * factor};
    } else {
      one.ci95 = {one.value - kNormal95 * one.std_error, one.value + kNormal95 * one.std_error};
    }
    one.ci95 = {std::max(one.ci95[0], p.lower), std::min(one.ci95[1], p.upper)};
    values.push_back(std::move(one));
  }
  return values;
}

bool NoneExcludesNull(const std::vector<DiagnosedParameter>& sizes) {
  return !sizes.empty() && std::all_of(sizes.begin(), sizes.end(), [](const DiagnosedParameter& size) {
    if (!size.at_bound.empty()) return size.value == size.before;
    return !IsDetermined(size) || (size.ci95[0] <= size.before && size.before <= size.ci95[1]);
  });
}

void Insert(EffectScore score, std::vector<EffectScore>& scores) {
  const auto at =
      std::upper_bound(scores.begin(), scores.end(), score,
                       [](const EffectScore& a, const EffectScore& b) { return a.statistic > b.statistic; });
  scores.insert(at, std::move(score));
}

Status Tabulate(DiagnosisState& state, Diagnosis& diagnosis) {
  return Tables(state, diagnosis).Fill();
}

}  // namespace sinew::diagnosis
