// Diagnosis of a fitted model: which errors remain, which known effect explains them, which other effects
// explain them equally well, and how much the extended model improves the prediction of held-out trials.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/effect.h"
#include "identify/fit_quality.h"
#include "identify/fit_setup.h"
#include "identify/noise/noise_model.h"
#include "identify/problem.h"
#include "identify/solvers/solver.h"

namespace sinew {

/// kAdequate: no error that these data can show. kExplained: one cause (per error). kAmbiguous: a set of
/// causes that these data cannot distinguish. kUnexplained: an error that no known effect explains.
enum class DiagnosisVerdict { kAdequate, kExplained, kAmbiguous, kUnexplained };

[[nodiscard]] const char* ToString(DiagnosisVerdict verdict);

struct DiagnosisOptions {
  std::string solver = "ceres";  ///< of the base fit; a global one for costs with many local minima
  double alarm_level = 0.05;     ///< family-wise: probability of any alarm if the model is adequate
  std::uint64_t seed = 1;
  int threads = 1;
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string& step)> progress;  ///< called with the name of each step as it begins
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

/// The score test of one effect on the base model, and the result of its refit if it was refitted.
struct EffectScore {
  std::string effect;
  Level level = Level::kSensor;
  bool known = true;      ///< false: a model discrepancy term
  std::string probe;      ///< its probe values, "stribeck_velocity = 0.05 rad/s"; empty if scored at the null
  int degrees = 1;        ///< degrees of freedom of the test
  double statistic = 0;   ///< score statistic of the whitened residual: predicted drop of -2 log-likelihood
  double unwhitened = 0;  ///< the same without whitening
  double p_value = 1;     ///< of this effect alone
  double family_p_value = 1;  ///< family-wise: of any test at least as significant
  bool judged =
      true;  ///< false: its effect is a combination of those of the base parameters, or zero in these data
  std::string why_not;  ///< reason if not judged
  bool refitted = false;
  double delta_lr = 0;  ///< likelihood ratio: drop of -2 log-likelihood by the refit, each with its own noise
  double delta_bic = 0;  ///< BIC(base) - BIC(with it); above 0 favours the effect
  double smallest_detectable =
      0;  ///< size of its first parameter that is detected with probability 95 %; 0: not known
  std::string detectable_parameter;
  std::string detectable_unit;
};

/// An effect that these data cannot distinguish from a named cause.
struct Alternative {
  std::string instead_of;
  std::string effect;
  Level level = Level::kSensor;
  std::string sentence;
  std::vector<DiagnosedParameter> parameters;  ///< of the effect, fitted in place of the cause
  double delta_lr = 0;                         ///< likelihood ratio in favour of the named cause
  double delta_bic = 0;
  double correlation = 0;  ///< of the two signatures, projected off the base parameters
  bool same_class =
      false;  ///< declared class, |correlation| > 0.97: not distinguishable by data of this kind
  /// It is a more general law with the cause as a special case. No experiment can exclude it, so it counts as
  /// an alternative only if it fits better.
  bool contains_cause = false;
  /// Size (as Cause::size) from which data of this kind distinguish the two with probability 95 %: where 1 -
  /// |R| > 0.4165 / s^2 for the correlation R; infinite if never.
  double separating_size = 0;
  std::string separated_by;  ///< an experiment that distinguishes the two
};

struct Cause {
  std::string effect;
  Level level = Level::kSensor;
  std::string sentence;
  std::vector<DiagnosedParameter> parameters;
  double p_value = 1;
  double delta_lr = 0;  ///< likelihood ratio against the model without it
  double delta_bic = 0;
  double size = 0;      ///< relative to the size that a test of this effect alone detects (95 % power at 5 %)
  double left_out = 0;  ///< if Diagnosis::left_out: error of left-out trials with it / without it; else 0
};

/// A cause that improves the fit of the training trials but not the prediction of the held-out trials.
struct WithdrawnCause {
  std::string effect;
  std::string reason;
};

/// A dependence of the residual on one signal: the share of its variance that a smooth curve of the signal
/// predicts for trials that the curve was not fitted to (cross-validation).
struct Structure {
  std::string channel;
  std::string signal;
  std::string unit;  ///< of the signal
  double explained_fraction = 0;
  std::string shape;  ///< odd, step at zero, quadratic, ...
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

struct NoiseFloor {
  std::string channel;
  std::string unit;
  double sigma = 0;   ///< standard deviation of the noise process
  double rmse = 0;    ///< of the base model on the training trials
  std::string basis;  ///< "stated by the data", "residual of the extended model", ...
};

struct Gain {
  std::string channel;  ///< quantity, pooled over the held-out trials and plates
  std::string unit;
  double before = 0;             ///< RMSE [unit] of the base model on held-out trials
  double after = 0;              ///< of the extended model
  double reduction = 0;          ///< 1 - after / before
  std::array<double, 2> ci95{};  ///< of the reduction, block bootstrap
  double gap_closed = 0;         ///< share of the mean squared error above the noise floor that is removed
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
  std::string unit;         ///< of the port
  std::string shape;        ///< odd, even, step at zero, saturating, quadratic, ...; "1.6 Hz"
  std::string nearest_law;  ///< the known law whose curve is nearest
  double p_value = 1;
  double held_out_reduction = 0;  ///< of RMSE on held-out trials
  std::vector<double> knots;
  std::vector<double> curve;      ///< [knots, unit of the port]
  std::vector<double> deviation;  ///< standard errors of `curve`; NaN where they cannot be computed
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

struct Diagnosis {
  DiagnosisVerdict verdict = DiagnosisVerdict::kAdequate;
  bool concluded = true;               ///< false: no conclusion; the sentences give the reason
  std::vector<std::string> sentences;  ///< findings, the most important first
  std::vector<std::string> warnings;   ///< limitations of the conclusion

  FitSetup setup;     ///< of the base fit
  SolverResult base;  ///< how the base fit ended
  std::vector<DiagnosedParameter> base_parameters;
  std::vector<FitQuality> base_fit;  ///< pooled per role and quantity
  std::vector<FitQuality> extended_fit;
  std::vector<NoiseFloor> noise;
  std::vector<ResidualTest> tests;
  std::vector<Structure> structure;  ///< strongest first
  double threshold = 0;              ///< critical |t| of a single known effect at the family-wise level
  double family_p_value = 1;         ///< of the most significant test
  bool strongly_autocorrelated =
      false;  ///< no alarm, but the residual is more autocorrelated than instrument noise

  /// Trials that were left out of the fit in turn, if causes were chosen by cross-validation because the
  /// misfit dominates the noise.
  std::vector<std::string> left_out;
  std::vector<EffectScore> scores;  ///< of every effect and discrepancy term, most significant first
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
};

/// Diagnoses a problem: fits the base parameters (from `setup`'s start) and performs the steps of
/// docs/diagnosis.md. Training trials decide everything except the gain and the rejection of unsupported
/// causes, which use the held-out trials.
///
/// Errors: nothing to fit or to compare; the base model cannot be predicted at all. A base fit that does not
/// converge is not an error: the diagnosis then has `concluded` false.
Result<Diagnosis> Diagnose(const Problem& problem, FitSetup setup, const DiagnosisOptions& options);

}  // namespace sinew
