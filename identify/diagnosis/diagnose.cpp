// The steps of a diagnosis, in order; docs/diagnosis.md explains them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/check_problem.h"
#include "identify/diagnosis/diagnosis_state.h"
#include "identify/diagnosis/discover/discovery.h"
#include "identify/diagnosis/discover/structure.h"
#include "identify/diagnosis/fit/base_fit_record.h"
#include "identify/diagnosis/held_out_validation.h"
#include "identify/diagnosis/level_evidence.h"
#include "identify/diagnosis/score/quantised_channels.h"
#include "identify/diagnosis/select/cross_validated_search.h"
#include "identify/diagnosis/select/equivalent_effects.h"
#include "identify/diagnosis/select/noise_below_misfit.h"
#include "identify/diagnosis/tabulation.h"
#include "identify/equal_noise_view.h"
#include "identify/error_concentration.h"
#include "identify/solvers/improved_start.h"
#include "identify/solvers/prior_choice.h"

namespace sinew {
namespace diagnosis {
namespace {

// Limit of evaluations of the base fit: usual fits need 10 to 200, 650 in a narrow valley, so that one that
// needs more has no clear minimum.
constexpr long kBaseEvaluations = 2000;
constexpr long kMaxEvaluations = 200000;  // limit for other solvers, which have their own stopping rules
// Least share of the measured variance that the base model must explain: below it, with the rest described as
// innovations, misfit and noise cannot be distinguished.
constexpr double kMinExplained = 0.1;

Status CheckThatDataSuffice(const Problem& problem, const FitSetup& setup) {
  int rows = 0;
  for (const Block& block : problem.layout()) rows += block.role == BlockRole::kTrain ? block.samples() : 0;
  // A prior is an observation of its parameter: it takes no more from the samples than it brings.
  const auto open = static_cast<int>(std::count_if(setup.free.begin(), setup.free.end(), [&](int index) {
    return !setup.parameters[static_cast<std::size_t>(index)].prior;
  }));
  if (rows < 2 * open + 20) {
    return Fail("{} samples are too few to fit {} parameters and to judge what is left", rows, open);
  }
  return {};
}

// Share of the measured variance, about the mean of each training block, that is not innovations: that of the
// channel where it is largest, because one informative channel is enough.
double ExplainedShare(const Problem& problem, const LeastSquares& fit, const noise::NoiseModel& noise) {
  std::vector<double> variance(noise.channels.size(), 0);
  std::vector<double> innovations(noise.channels.size(), 0);
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const Block& block = problem.layout()[static_cast<std::size_t>(fit.train_blocks()[t].block)];
    const Eigen::Map<const Vector> measured(block.measured.data(), block.samples());
    const auto channel = static_cast<std::size_t>(noise.channel_of[t]);
    variance[channel] += block.weight * block.weight * (measured.array() - measured.mean()).square().sum();
    innovations[channel] += block.samples() * std::pow(noise.channels[channel].deviation, 2);
  }
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < variance.size(); ++c) {
    if (variance[c] > 0) largest = std::max(largest, 1 - innovations[c] / variance[c]);
  }
  return largest;
}

class DiagnosisRun {
 public:
  DiagnosisRun(const Problem& problem, const DiagnosisOptions& options)
      : problem_(problem), options_(options), state_(problem, options) {}

  Result<Diagnosis> Run(FitSetup setup) {
    Result<Diagnosis> found = Diagnosed(std::move(setup));
    if (options_.at_end) options_.at_end();
    return found;
  }

 private:
  Result<Diagnosis> Diagnosed(FitSetup setup) {
    const auto began = std::chrono::steady_clock::now();
    SINEW_TRY(CheckProblem(problem_, setup));
    SINEW_TRY(Continue());
    SINEW_TRY(CheckThatDataSuffice(problem_, setup));
    setup.record = options_.record;
    out_.setup = solvers::ChoosePriors(problem_, setup, {options_.interrupt}).setup;
    out_.has_held_out = state_.held_out.exists();
    state_.candidates = ListCandidates(problem_, out_.setup);
    RemoveQuantisation(problem_, state_.candidates);
    Say(DiagnosisStep::kBaseFit);
    SINEW_ASSIGN(const bool fitted, FitBase());
    if (fitted) SINEW_TRY(RunSteps());
    out_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return out_;  // not moved: the search of the base fit refers to the setup
  }

  void Say(DiagnosisStep step) const {
    if (options_.progress) options_.progress({step});
  }

  // Step 0. Returns false if there is no usable base fit; the diagnosis then has no conclusion.
  Result<bool> FitBase() {
    const LeastSquares& fit = base_fit_.emplace(problem_, out_.setup);
    SolverOptions how;
    how.seed = options_.seed;
    how.threads = options_.threads;
    const std::string name = options_.solver.empty() ? problem_.default_solver() : options_.solver;
    SINEW_ASSIGN(const auto solver, MakeSolver(name, how));
    Evaluator::Options gate = options_.base_search;
    gate.interrupt = options_.interrupt;
    gate.began = std::chrono::steady_clock::now();
    gate.budget.max_evaluations = name == "ceres" ? kBaseEvaluations : kMaxEvaluations;
    Evaluator& evaluator = base_search_.emplace(fit, std::move(gate));
    const BaseFitRecord kept(fit, name, options_.seed);
    if (auto known = kept.Find(); known) {
      out_.base = std::move(*known);
      evaluator.RestoreAll();
    } else {
      out_.base = solver->Solve(evaluator, solvers::BestStart(evaluator));
      kept.Keep(out_.base);
    }
    out_.base_point = fit.Parameters(out_.base.x);
    out_.extended_point = out_.base_point;
    if (!out_.base.stop.usable() || !out_.base.stop.converged()) {
      ConcludeNothing(Inconclusive::kBaseFitNotConverged);
      return false;
    }
    state_.refitter = std::make_unique<Refitter>(problem_, out_.setup, state_.candidates, options_.interrupt);
    return true;
  }

  void ConcludeNothing(Inconclusive why) {
    out_.verdict = DiagnosisVerdict::kUnexplained;
    out_.inconclusive = why;
  }

  Status RunSteps() {
    state_.refitter->ExpectInputNoise({}, out_.base_point);
    Refit base = state_.refitter->Fit({}, {out_.base_point});
    SINEW_TRY(Continue());
    if (!base.usable()) return Fail("the base model: {}", base.failure);
    const double share = ExplainedShare(problem_, LeastSquares(problem_, *base.setup), base.noise);
    if (share < kMinExplained && !MisfitScale(problem_).At(base).Dominates(base.noise)) {
      ConcludeNothing(Inconclusive::kNoiseTooLarge);
      scale_ = MisfitScale(problem_).At(base);
      return MeasureGain(base.noise);
    }
    if (base.noise_absorbs_misfit) {
      state_.refitter->AssumeIndependentErrors();
      out_.warnings.push_back({WarningKind::kNoiseAbsorbsMisfit, {}, {}, {}});
    }
    out_.base_point = base.point;
    state_.refitter->ExpectNoise(base.noise);
    Say(DiagnosisStep::kScore);
    SINEW_ASSIGN(state_.base, ScoreModel(problem_, state_.candidates, std::move(base), options_.alarm_level,
                                         options_.seed));
    SINEW_TRY(DescribeResidual());
    if (state_.held_out.exists()) {
      SINEW_ASSIGN(const auto residuals, state_.held_out.Residuals(state_.base.refit.point));
      SINEW_TRY(state_.held_out.EstimateOwnNoise(residuals));
    }
    Say(DiagnosisStep::kRefit);
    SINEW_ASSIGN(state_.selection,
                 Select(problem_, *state_.refitter, state_.candidates, state_.base, options_));
    SINEW_TRY(Continue());
    SINEW_TRY(ValidateOnHeldOutTrials());
    TellImitations();
    SINEW_TRY(AddEquivalentEffects(state_));
    SINEW_TRY(Continue());
    out_.extended_point = state_.selection.model.point;
    SINEW_TRY(Tabulate(state_, out_));
    WeighLevels(state_, out_);
    if (state_.selection.structure_left) {
      Say(DiagnosisStep::kDiscover);
      SINEW_TRY(DiscoverUnknown(state_, out_));
    }
    SINEW_TRY(Continue());
    SINEW_TRY(CompareWithNoiseBelowMisfit());
    SINEW_TRY(MeasureGain(state_.selection.model.noise));
    Conclude();
    return {};
  }

  Result<std::vector<WithdrawnCause>> WithoutUnsupportedCauses() {
    if (state_.selection.causes.empty()) return std::vector<WithdrawnCause>();
    return RejectUnsupportedCauses(state_);
  }

  // Unknown terms stay if held-out trials are predicted better with them, each time with the causes that
  // these trials leave.
  Status ValidateOnHeldOutTrials() {
    if (!state_.held_out.exists()) return {};
    const std::shared_ptr<const Selection> plain = state_.selection.without_terms;
    SINEW_ASSIGN(out_.withdrawn, WithoutUnsupportedCauses());
    if (!plain) return {};
    const Selection with = std::exchange(state_.selection, *plain);
    SINEW_ASSIGN(std::vector<WithdrawnCause> withdrawn, WithoutUnsupportedCauses());
    SINEW_ASSIGN(const auto beside, state_.held_out.Residuals(with.model.point));
    SINEW_ASSIGN(const auto without, state_.held_out.Residuals(state_.selection.model.point));
    if (state_.Loss(beside, with.model.noise) < state_.Loss(without, state_.selection.model.noise)) {
      state_.selection = with;
    } else {
      out_.withdrawn = std::move(withdrawn);
    }
    return {};
  }

  void TellImitations() {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    for (const int c : state_.selection.imitations) {
      WithdrawnCause cause{state_.candidate(c).effect, kNaN, kNaN};
      for (const int term : state_.selection.terms) cause.terms.push_back(state_.candidate(term).effect);
      out_.withdrawn.push_back(std::move(cause));
    }
  }

  // An interrupted diagnosis is an error: part of it is not a result.
  [[nodiscard]] Status Continue() const {
    if (options_.interrupt != nullptr && options_.interrupt->load()) return Fail("interrupted");
    return {};
  }

  // Steps 1 and 2.
  Status DescribeResidual() {
    const LeastSquares fit(problem_, *state_.base.refit.setup);
    SINEW_ASSIGN(const auto rows, NoiseRowsAt(fit, state_.base.refit.x));
    out_.tests = TestResiduals(rows.blocks);
    SINEW_ASSIGN(out_.structure, FindStructure(problem_, state_.base.refit.point));
    out_.threshold = state_.base.family.threshold;
    out_.family_p_value = state_.base.family.p_value;
    return {};
  }

  // What is left of the chosen model; unknown terms that are not fitted with the causes are not in it.
  Status CompareWithNoiseBelowMisfit() {
    const Refit& model = state_.selection.model;
    SINEW_ASSIGN(const auto rows, NoiseRowsAt(LeastSquares(problem_, *model.setup), model.x));
    noise_below_misfit_ = NoiseBelowMisfit(rows.blocks);
    scale_ = MisfitScale(problem_).At(model);
    for (const std::string& channel : scale_->LikeInputNoise()) noise_below_misfit_.erase(channel);
    return {};
  }

  // Step 6, second half. @param noise of the extended model
  Status MeasureGain(const noise::NoiseModel& noise) {
    state_.held_out.Align(out_.base_point, out_.extended_point);
    out_.base_point = state_.held_out.Fitted(out_.base_point);
    out_.extended_point = state_.held_out.Fitted(out_.extended_point);
    SINEW_ASSIGN(const FullPrediction base, PredictAll(problem_, out_.base_point));
    SINEW_ASSIGN(FullPrediction extended, PredictAll(problem_, out_.extended_point));
    for (const auto& [b, residual] : state_.added) {
      const Block& block = problem_.layout()[static_cast<std::size_t>(b)];
      for (std::size_t i = 0; i < block.sample.size(); ++i)
        extended.values[static_cast<std::size_t>(b)][block.sample[i]] =
            block.measured[i] + residual[static_cast<Eigen::Index>(i)] / block.WeightOf(i);
    }
    Assess(problem_.layout(), extended);
    for (const Concentration& found : FindConcentrations(problem_.layout(), extended.values))
      out_.warnings.push_back(ToWarning(found));
    for (Warning& warning : problem_.WarningsAt(out_.extended_point))
      out_.warnings.push_back(std::move(warning));
    out_.base_fit = base.pooled;
    out_.extended_fit = extended.pooled;
    for (std::size_t b = 0; b < problem_.layout().size(); ++b) {
      const Block& block = problem_.layout()[b];
      if (block.role == BlockRole::kPredicted || block.samples() == 0) continue;
      TracePair trace{block.trial, block.role, block.channel, block.unit, {}, block.measured, {}, {}};
      for (const int at : block.sample) {
        trace.time.push_back(block.prediction_time[static_cast<std::size_t>(at)]);
        trace.before.push_back(base.values[b][at]);
        trace.after.push_back(extended.values[b][at]);
      }
      out_.traces.push_back(std::move(trace));
    }
    const noise::NoiseModel floor = WithNoiseBelowMisfit(scale_->Floor(noise), noise_below_misfit_);
    ReportNoise(noise, floor);
    if (!state_.held_out.exists()) return {};
    std::vector<Vector> before;
    std::vector<Vector> after;
    for (const int b : state_.held_out.blocks()) {
      const Block& block = problem_.layout()[static_cast<std::size_t>(b)];
      before.push_back(WeightedResidual(block, base.values[static_cast<std::size_t>(b)]));
      after.push_back(WeightedResidual(block, extended.values[static_cast<std::size_t>(b)]));
    }
    out_.gain = state_.held_out.Gains(before, after, floor, options_.seed);
    return {};
  }

  static Vector WeightedResidual(const Block& block, const Vector& predicted) {
    Vector residual(block.samples());
    for (int i = 0; i < block.samples(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      residual[i] = block.weight * (predicted[block.sample[at]] - block.measured[at]);
    }
    return residual;
  }

  // @param residual of the extended model @param noise the floor that follows from it
  void ReportNoise(const noise::NoiseModel& residual, const noise::NoiseModel& noise) {
    for (std::size_t c = 0; c < noise.channels.size(); ++c) {
      const noise::ChannelNoiseModel& model = noise.channels[c];
      NoiseFloor floor;
      floor.channel = model.channel;
      double squares = 0;
      double count = 0;
      for (const TracePair& trace : out_.traces) {
        if (trace.channel != model.channel || trace.role != BlockRole::kTrain) continue;
        for (std::size_t i = 0; i < trace.time.size(); ++i)
          squares += std::pow(trace.before[i] - trace.measured[i], 2);
        count += static_cast<double>(trace.time.size());
      }
      for (const Block& block : problem_.layout()) {
        if (block.channel != model.channel || block.role != BlockRole::kTrain) continue;
        floor.unit = block.unit;
        floor.sigma = NoiseFloorOf(block, noise, problem_.layout()) / block.weight;
        const bool is_residual = model.deviation == residual.channels[c].deviation;
        floor.basis = block.sigma                                    ? NoiseBasis::kStatedByData
                      : noise_below_misfit_.count(model.channel) > 0 ? NoiseBasis::kHighFrequencies
                      : scale_->HoldsInputNoise(model.channel)       ? NoiseBasis::kInputs
                      : is_residual                                  ? NoiseBasis::kExtendedModel
                                                                     : NoiseBasis::kDifferences;
        break;
      }
      floor.rmse = count > 0 ? std::sqrt(squares / count) : 0;
      out_.noise.push_back(std::move(floor));
    }
  }

  void Conclude() {
    const Selection& selection = state_.selection;
    const bool more_than_noise = !noise_below_misfit_.empty() || scale_->Dominates(selection.model.noise);
    out_.strongly_autocorrelated = !selection.alarm && more_than_noise;
    if (out_.strongly_autocorrelated) {
      out_.verdict = DiagnosisVerdict::kUnexplained;
    } else if (!selection.alarm) {
      out_.verdict = DiagnosisVerdict::kAdequate;
    } else if (out_.causes.empty() || selection.structure_left || more_than_noise) {
      out_.verdict = DiagnosisVerdict::kUnexplained;
    } else {
      const bool alone = std::all_of(out_.alternatives.begin(), out_.alternatives.end(),
                                     [](const Alternative& other) { return other.contains_cause; });
      out_.verdict = alone ? DiagnosisVerdict::kExplained : DiagnosisVerdict::kAmbiguous;
    }
    out_.family_p_value = selection.family_p_value;
    if (!out_.causes.empty()) out_.held_out_shortfall = selection.held_out_shortfall;
    if (selection.better_term && !out_.causes.empty()) {
      const FreeTermComparison& found = *selection.better_term;
      out_.warnings.push_back({WarningKind::kFreeTermExplainsMore,
                               {found.best.name},
                               {found.best.explained - found.best_price, found.named - found.price},
                               {}});
    }
    if (selection.cross_validated) {
      for (const Fold& fold : selection.left_out) {
        out_.left_out.push_back({fold.trials, {}});
        if (fold.window) out_.left_out.back().window = {fold.window->first, fold.window->last};
      }
      out_.ladder = selection.ladder;
      for (const auto& [c, share] : selection.chosen_shares)
        out_.chosen_shares.push_back({state_.candidate(c).effect, share});
      std::stable_sort(out_.chosen_shares.begin(), out_.chosen_shares.end(),
                       [](const ChosenShare& a, const ChosenShare& b) { return a.share > b.share; });
      out_.warnings.push_back(
          {WarningKind::kCrossValidated,
           {},
           {static_cast<double>(selection.searched), static_cast<double>(TrainingTrials(problem_).size())},
           {}});
    }
    WarnOfUnknownNoise();
    if (!state_.held_out.exists()) out_.warnings.push_back({WarningKind::kNoValidationTrial, {}, {}, {}});
  }

  // Channels whose noise is neither stated nor visible: what is left of them has nothing to be compared with.
  void WarnOfUnknownNoise() {
    Warning warning{WarningKind::kNoiseLevelUnknown, {}, {}, {}};
    for (const MisfitScale::Channel& channel : scale_->channels()) {
      if (channel.unknown == NoiseUnknown::kNo) continue;
      warning.names.push_back(channel.name);
      warning.names.emplace_back(ToString(channel.unknown));
    }
    if (!warning.names.empty()) out_.warnings.push_back(std::move(warning));
  }

  const Problem& problem_;
  const DiagnosisOptions& options_;
  DiagnosisState state_;
  Diagnosis out_;
  std::map<std::string, double> noise_below_misfit_;  // of the chosen model
  std::optional<MisfitScale> scale_;                  // at the chosen model
  std::optional<LeastSquares> base_fit_;
  std::optional<Evaluator> base_search_;  // until the end: a checkpoint holds its evaluations
};

}  // namespace
}  // namespace diagnosis

const char* ToString(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::kAdequate:
      return "adequate";
    case DiagnosisVerdict::kExplained:
      return "explained";
    case DiagnosisVerdict::kAmbiguous:
      return "ambiguous";
    case DiagnosisVerdict::kUnexplained:
      return "unexplained";
  }
  return "?";
}

const char* ToString(UnknownKind kind) {
  switch (kind) {
    case UnknownKind::kCurve:
      return "curve";
    case UnknownKind::kDrift:
      return "drift";
    case UnknownKind::kPeriodic:
      return "periodic";
  }
  return "?";
}

const char* ToString(NotJudged reason) {
  switch (reason) {
    case NotJudged::kNone:
      return "";
    case NotJudged::kNoDistinctChange:
      return "no_distinct_change";
  }
  return "?";
}

const char* ToString(CauseKind kind) {
  switch (kind) {
    case CauseKind::kEffect:
      return "effect";
    case CauseKind::kQuantisation:
      return "quantisation";
  }
  return "?";
}

const char* ToString(LevelStanding standing) {
  switch (standing) {
    case LevelStanding::kBlamed:
      return "blamed";
    case LevelStanding::kPossible:
      return "possible";
    case LevelStanding::kWorse:
      return "worse";
  }
  return "?";
}

const char* ToString(NoiseBasis basis) {
  switch (basis) {
    case NoiseBasis::kStatedByData:
      return "stated_by_data";
    case NoiseBasis::kExtendedModel:
      return "extended_model";
    case NoiseBasis::kDifferences:
      return "differences";
    case NoiseBasis::kHighFrequencies:
      return "high_frequencies";
    case NoiseBasis::kInputs:
      return "inputs";
  }
  return "?";
}

const char* ToString(Inconclusive reason) {
  switch (reason) {
    case Inconclusive::kNone:
      return "";
    case Inconclusive::kBaseFitNotConverged:
      return "base_fit_not_converged";
    case Inconclusive::kNoiseTooLarge:
      return "noise_too_large";
  }
  return "?";
}

Result<Diagnosis> Diagnose(const Problem& problem, FitSetup setup, const DiagnosisOptions& options) {
  if (problem.weights_are_noise_levels())
    return diagnosis::DiagnosisRun(problem, options).Run(std::move(setup));
  const EqualNoiseView view(problem);
  SINEW_ASSIGN(Diagnosis found, diagnosis::DiagnosisRun(view, options).Run(std::move(setup)));
  found.warnings.insert(found.warnings.begin(), {WarningKind::kEqualNoise, {}, {}, {}});
  return found;
}

}  // namespace sinew
