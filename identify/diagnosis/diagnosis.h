// Diagnosis of a fitted model: which errors remain, which known effect explains them, which other effects
// explain them equally well, and how much the extended model improves the prediction of held-out trials.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/diagnosis/discover/shape.h"
#include "identify/effect.h"
#include "identify/fit_quality.h"
#include "identify/fit_setup.h"
#include "identify/noise/noise_model.h"
#include "identify/problem.h"
#include "identify/solvers/solver.h"
#include "identify/warning.h"

namespace sinew {

/// kAdequate: no error that these data can show. kExplained: one cause (per error). kAmbiguous: a set of
/// causes that these data cannot distinguish. kUnexplained: an error that no known effect explains.
enum class DiagnosisVerdict { kAdequate, kExplained, kAmbiguous, kUnexplained };

[[nodiscard]] const char* ToString(DiagnosisVerdict verdict);

/// What a diagnosis does, in this order.
enum class DiagnosisStep { kBaseFit, kScore, kRefit, kCrossValidate, kDiscover };

struct DiagnosisProgress {
  DiagnosisStep step = DiagnosisStep::kBaseFit;
  std::vector<std::string> effects = {};  ///< kCrossValidate: the best set of this size so far
  double left_out_share = 0;              ///< ... and its error of left-out trials, over the base model's
};

struct DiagnosisOptions {
  std::string solver;         ///< of the base fit; empty: Problem::default_solver()
  double alarm_level = 0.05;  ///< family-wise: probability of any alarm if the model is adequate
  std::uint64_t seed = 1;
  int threads = 1;
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const DiagnosisProgress&)> progress;  ///< what is done now
  /// What was done before, and is not done again: the refits (FitSetup::record), may be null; the search of
  /// the base fit (Evaluator::Options::replay and finished). Those that are made are added to the record.
  FitRecord* record = nullptr;
  Evaluator::Options base_search;  ///< its budget and interrupt are set by the diagnosis
  std::function<void()> at_end;    ///< while the search of the base fit can still be watched; may be empty
};

/// A fitted value of one parameter.
struct DiagnosedParameter {
  std::string name;
  std::string unit;
  double value = 0;
  double std_error = 0;
  std::array<double, 2> ci95{};
  double before = 0;          ///< value in the base model (the null, for effect parameters)
  std::string at_bound = {};  ///< "lower" or "upper" if held at that bound (std_error is NaN); else empty
};

/// Whether the data determine it: one that no channel responds to has a standard error of 0 or none.
[[nodiscard]] inline bool IsDetermined(const DiagnosedParameter& parameter) {
  return std::isfinite(parameter.std_error) && parameter.std_error > 0;
}

/// Why an effect was not judged.
enum class NotJudged {
  kNone,             ///< it was
  kNoDistinctChange  ///< it changes no fitted channel, or nothing that the base parameters cannot compensate
};

/// "" (judged), "no_distinct_change".
[[nodiscard]] const char* ToString(NotJudged reason);

/// A parameter that stood at a value while others were scored.
struct ProbeValue {
  std::string parameter;
  std::string unit;
  double value = 0;
};

/// How one effect answers before any refit, and after it if it was tried.
struct EffectScore {
  std::string effect;
  Level level = Level::kSensor;
  bool known = true;              ///< false: an unknown term
  std::vector<ProbeValue> probe;  ///< where it was probed; empty if at the null
  int degrees = 1;                ///< parameters judged
  double statistic = 0;   ///< predicted drop of twice the negative log-likelihood, from the whitened score
  double unwhitened = 0;  ///< the same without whitening
  double p_value = 1;     ///< of this effect alone
  double family_p_value = 1;  ///< of an alarm by anything at least as strong, if nothing is wrong
  bool judged = true;
  NotJudged why_not = NotJudged::kNone;
  bool refitted = false;
  double delta_lr = 0;  ///< likelihood ratio: drop of -2 log-likelihood by the refit, each with its own noise
  double delta_bic = 0;  ///< BIC(base) - BIC(with it); above 0 favours the effect
  double smallest_detectable =
      0;  ///< size of its first parameter that is detected with probability 95 %; 0: not known
  std::string detectable_parameter;
  std::string detectable_unit;
};

/// Error of left-out data with an alternative over that with the cause (Alternative::left_out), up to which
/// the two predict equally well.
inline constexpr double kSameError = 1.05;

/// An effect that these data cannot distinguish from a named cause.
struct Alternative {
  std::string instead_of;
  std::string effect;
  Level level = Level::kSensor;
  std::string description;                     ///< of the effect, from the problem's library
  std::vector<DiagnosedParameter> parameters;  ///< of the effect, if it is put in place of the cause
  double delta_lr = 0;                         ///< by which the named cause fits better
  double delta_bic = 0;
  /// If Diagnosis::left_out: error of left-out data with it over that with the cause; delta_lr is NaN then.
  double left_out = 0;
  double correlation = 0;  ///< of the two signatures, projected off the base parameters
  bool same_class =
      false;  ///< declared class, |correlation| > 0.97: not distinguishable by data of this kind
  /// It is a more general law with the cause as a special case. No experiment can exclude it, so it counts as
  /// an alternative only if it fits better.
  bool contains_cause = false;
  /// Size (as Cause::size) from which data of this kind distinguish the two with probability 95 %: where 1 -
  /// |R| > 0.4165 / s^2 for the correlation R; infinite if never.
  double separating_size = 0;
  bool less_common = false;  ///< than the cause, in practice (Effect::occurrence)
  std::string separated_by;  ///< an experiment that distinguishes the two
};

/// kEffect: an effect of the problem's library. kQuantisation: a sensor rounds its readings, which is found
/// without a test, and which no model can undo.
enum class CauseKind { kEffect, kQuantisation };

/// "effect", "quantisation".
[[nodiscard]] const char* ToString(CauseKind kind);

struct Cause {
  CauseKind kind = CauseKind::kEffect;
  std::string effect;
  Level level = Level::kSensor;
  std::string description;  ///< kEffect: of the effect, from the problem's library
  std::string channel;      ///< kQuantisation: that is rounded
  std::vector<DiagnosedParameter> parameters;
  double p_value = 1;
  double delta_lr = 0;  ///< likelihood ratio against the model without it
  double delta_bic = 0;
  double size = 0;      ///< relative to the size that a test of this effect alone detects (95 % power at 5 %)
  double left_out = 0;  ///< if Diagnosis::left_out: error of left-out data with it / without it; else 0
  /// No 95 % interval of the parameters that are its size excludes their values without the effect.
  bool interval_contains_null = false;
};

/// How a level stands against the others.
enum class LevelStanding {
  kBlamed,    ///< a cause is of it
  kPossible,  ///< none is, but these data do not tell it from one that is
  kWorse      ///< its effects explain the error less well
};

/// "blamed", "possible", "worse".
[[nodiscard]] const char* ToString(LevelStanding standing);

/// What the effects of one level explain without those of any other.
struct LevelEvidence {
  Level level = Level::kSensor;
  LevelStanding standing = LevelStanding::kWorse;
  std::vector<std::string> effects;  ///< of this level alone, that explain the error best
  int parameters = 0;                ///< of these effects
  double delta_lr = 0;               ///< likelihood ratio against the base model; NaN if Diagnosis::left_out
  /// By how much it explains less than the named causes (the base model, if there are none): difference of
  /// -2 log-likelihood at the price of 4 per parameter; NaN if Diagnosis::left_out.
  double behind = 0;
  bool suffices = false;  ///< that is within the width of the stated set: these effects alone may be all
  /// If Diagnosis::left_out: error of left-out data with these effects over that of the base model; else 0,
  /// or where no set of this level alone was fitted.
  double left_out = 0;
};

/// Data that are left out of a fit: trials, or a window of time of one trial.
struct LeftOutData {
  std::vector<std::string> trials;
  std::optional<std::array<double, 2>> window;  ///< [s] from, to; infinite to the end of the trial
};

/// The set of so many causes that predicts left-out data best.
struct LadderStep {
  std::vector<std::string> effects;
  double error = 1;  ///< of left-out data, as a share of that of the base model
};

/// How often an effect is in the set that is chosen, when the parts of the data that are left out are drawn
/// again with replacement.
struct ChosenShare {
  std::string effect;
  double share = 0;
};

/// Root mean square error of one held-out trace with and without a cause [unit].
struct TraceErrors {
  std::string trial;
  std::string channel;
  std::string unit;
  double without = 0;
  double with = 0;
};

/// A cause that improves the fitted trials but makes the held-out trials worse.
struct WithdrawnCause {
  std::string effect;
  double delta_lr = 0;  ///< improvement of the fitted trials; NaN if causes were chosen by cross-validation
  double held_out_loss = 0;  ///< deterioration of the held-out trials, in the same units; else NaN
  std::optional<TraceErrors> worst = {};  ///< the trace that it makes worse most, if it does any
  /// The unknown terms beside which left-out data do not need it, because it may have been a part of them;
  /// empty if held-out trials withdrew it.
  std::vector<std::string> terms = {};
};

/// A dependence of the residual on one signal: the share of its variance that a smooth curve of the signal
/// predicts for trials that the curve was not fitted to (cross-validation).
struct Structure {
  std::string channel;
  std::string signal;
  std::string unit;  ///< of the signal
  double explained_fraction = 0;
  Shape shape = {};
  std::vector<double> knots;
  std::vector<double> curve;  ///< [knots, unit of the channel]
};

/// A test of whiteness of the residual of one channel.
struct ResidualTest {
  std::string channel;
  std::string name;  ///< "Ljung-Box", "runs", ...
  double statistic = 0;
  double p_value = 1;
};

/// What a noise floor rests on.
enum class NoiseBasis { kStatedByData, kExtendedModel, kDifferences, kHighFrequencies, kInputs };

/// "stated_by_data", "extended_model", "differences" (of the measured signal: DifferenceNoise),
/// "high_frequencies" (of the extended model's residual, if it is more: noise::FindLowFrequencyExcess),
/// "inputs" (noise of the recorded inputs, as the model carries it to the channel:
/// noise::PropagateInputNoise).
[[nodiscard]] const char* ToString(NoiseBasis basis);

struct NoiseFloor {
  std::string channel;
  std::string unit;
  double sigma = 0;  ///< standard deviation of the noise, colour included
  double rmse = 0;   ///< of the base model on the training trials
  NoiseBasis basis = NoiseBasis::kExtendedModel;
};

struct Gain {
  std::string channel;  ///< quantity, pooled over the held-out trials and plates
  std::string unit;
  double before = 0;             ///< RMSE [unit] of the base model on held-out trials
  double after = 0;              ///< of the extended model
  double reduction = 0;          ///< 1 - after / before
  std::array<double, 2> ci95{};  ///< of the reduction, block bootstrap
  double gap_closed = 0;  ///< share of the error above the noise floor that is removed, of mean squares
};

/// kCurve: a curve of a signal is added at a port. kDrift: a parameter changes with time. kPeriodic: a line
/// in the spectrum of a channel.
enum class UnknownKind { kCurve, kDrift, kPeriodic };

[[nodiscard]] const char* ToString(UnknownKind kind);

struct UnknownFinding {
  UnknownKind kind = UnknownKind::kCurve;
  std::string name;  ///< as in the scores: "torque(position)", "inertia(time)", "position(period)"
  std::string port;  ///< or the parameter that is not constant, or the channel
  std::string signal;
  std::string signal_unit;
  std::string unit;               ///< of the port
  Shape shape = {};               ///< kCurve
  double frequency = 0;           ///< [Hz] kPeriodic
  double p_value = 1;             ///< NaN if it was chosen by cross-validation
  double held_out_reduction = 0;  ///< of RMSE on held-out trials
  std::vector<double> knots;
  std::vector<double> curve;      ///< [knots, unit of the port]
  std::vector<double> deviation;  ///< standard errors of `curve`; NaN where the data do not determine it
  /// kCurve: parameters that are determined only together with the curve, because a part of it does the same.
  /// `curve` and `deviation` are then those for the fitted values of these parameters. Usually empty.
  std::vector<std::string> inseparable_from = {};
};

/// Measured and predicted values of one block, before (base model) and after (extended model), for figures.
struct TracePair {
  std::string trial;
  BlockRole role = BlockRole::kTrain;
  std::string channel;
  std::string unit;
  std::vector<double> time;
  std::vector<double> measured;
  std::vector<double> before;
  std::vector<double> after;
};

/// Why nothing can be concluded.
enum class Inconclusive {
  kNone,                 ///< something can
  kBaseFitNotConverged,  ///< a cause named on top of it would be a guess
  kNoiseTooLarge  ///< what the base model leaves is as large as what was measured, and looks like noise
};

/// "" (conclusive), "base_fit_not_converged", "noise_too_large".
[[nodiscard]] const char* ToString(Inconclusive reason);

/// Facts; text::Sentences and text::Warnings tell them (identify/text/diagnosis_sentences.h).
struct Diagnosis {
  DiagnosisVerdict verdict = DiagnosisVerdict::kAdequate;
  Inconclusive inconclusive = Inconclusive::kNone;
  std::vector<Warning> warnings;  ///< what limits the conclusion
  bool has_held_out = false;      ///< some trial was not fitted: gains can be measured

  FitSetup setup;     ///< of the base fit
  SolverResult base;  ///< how the base fit ended
  std::vector<DiagnosedParameter> base_parameters;
  std::vector<FitQuality> base_fit;  ///< pooled per role and quantity
  std::vector<FitQuality> extended_fit;
  std::vector<NoiseFloor> noise;
  std::vector<ResidualTest> tests;
  std::vector<Structure> structure;  ///< strongest first
  double threshold = 0;              ///< on |t| of a single known effect, at the family-wise level
  double family_p_value = 1;         ///< of the strongest alarm
  /// No alarm, but the residual is autocorrelated more strongly than the noise of instruments usually is, or
  /// more than 1.75 times the noise that is visible at its high frequencies.
  bool strongly_autocorrelated = false;
  /// Share of the gain that the causes should bring in held-out trials, by the change of their predictions,
  /// and do not, beyond chance; 0: none. If it is above 0 the misfit counts as not explained.
  double held_out_shortfall = 0;

  /// What was left out of the fit in turn, if causes had to be chosen by what they predict there, since the
  /// misfit is much larger than the noise.
  std::vector<LeftOutData> left_out;
  std::vector<LadderStep> ladder;          ///< from no cause on, as far as that search went
  std::vector<ChosenShare> chosen_shares;  ///< of every effect that is chosen at least once, most often first
  std::vector<EffectScore> scores;         ///< of every effect and unknown term, strongest first
  std::vector<LevelEvidence> levels;       ///< blamed ones first; empty if nothing was found
  std::vector<Cause> causes;
  std::vector<Alternative> alternatives;
  std::vector<WithdrawnCause> withdrawn;
  std::vector<UnknownFinding> unknown_terms;
  std::vector<Gain> gain;
  std::vector<DiagnosedParameter> extended_parameters;  ///< base and effects, of the extended model

  Vector base_point;      ///< [P]
  Vector extended_point;  ///< [P]; the base point if nothing was found
  std::vector<TracePair> traces;
  double seconds = 0;

  [[nodiscard]] bool concluded() const { return inconclusive == Inconclusive::kNone; }
};

/// Diagnoses a problem: fits the base parameters (from `setup`'s start) and performs the steps of
/// docs/diagnosis.md. Training trials decide everything except the gain and the rejection of unsupported
/// causes, which use the held-out trials.
///
/// Errors: nothing to fit or to compare; the base model cannot be predicted at all. A base fit that does not
/// converge is not an error: the diagnosis then has `concluded` false.
Result<Diagnosis> Diagnose(const Problem& problem, FitSetup setup, const DiagnosisOptions& options);

}  // namespace sinew
