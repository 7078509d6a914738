// How far noise of recorded inputs moves the residuals of a fit: propagation of uncertainty by simulation
// (JCGM 101:2008). Where a model integrates its input, that can be a hundred times the noise of the measured
// channel, and it is no misfit of the model.
#pragma once

#include <string>
#include <vector>

#include "identify/least_squares.h"
#include "identify/noise/noise_model.h"

namespace sinew::noise {

/// Dispersion (McCullagh, Nelder 1989, section 4.5) of statistics under InputNoiseModel: what they are
/// divided by, and variances multiplied. The fitted columns hold the same noise as the residual, and the
/// random walk is approximated. Without it 8 of 27 systems with nothing hidden were alarms at the level of 5
/// % (forces of which 0.5 to 10 % are noise).
inline constexpr double kInputNoiseDispersion = 2;

/// Of one fitted channel, root mean squares over its training samples [unit of the weighted residual].
struct PropagatedNoise {
  std::string channel;
  double whole = 0;      ///< what the noise of the inputs moves the prediction by
  double after_fit = 0;  ///< ... less what the free parameters follow
  double residual = 0;   ///< of the fit
};

/// From eight draws of the noise and the linearised fit at x.
/// @param x [n] variables of `fit`
/// @return one per fitted channel; empty if no noise of an input is stated, or no draw can be predicted.
/// Errors: no prediction at x.
Result<std::vector<PropagatedNoise>> PropagateInputNoise(const LeastSquares& fit, const Vector& x);

/// Whether no channel's residual is larger than noise of the inputs can make it. False where no noise of
/// an input is stated.
/// @param ordinary x minimises the unwhitened residuals, so that it follows a part of that noise: up to four
/// times what is left counts, because each trial is one random walk; else twice the whole
[[nodiscard]] bool MayBeInputNoise(const LeastSquares& fit, const Vector& x, bool ordinary);

/// Noise model of a residual that may be noise of the inputs: the autoregression of simulated noise, which is
/// what the draws move the predictions by at x and white noise of the level that differences of the residual
/// show. (Burg 1975; of order 200 at most, and of the last order whose partial autocorrelation stands out
/// from those of white noise by four standard errors.) The residual decides the level of the innovations
/// alone, so that no misfit is absorbed.
///
/// An autoregression of tenth order estimated from the residual, as EstimateNoiseModel gives it, sees too few
/// samples to tell the white noise from the random walk below it. Variance of the standardised score of a
/// smooth column (should be 1), 40 to 60 cases each, two to four trials of 15 to 20 s at 500 Hz or 1 kHz of a
/// mass with viscous friction: it 0.7, 2.1, 10; this one 1.1, 1.1, 1.25, 1.3.
/// Errors: no prediction at x.
Result<NoiseModel> InputNoiseModel(const LeastSquares& fit, const Vector& x);

/// The model with the deviations of its innovations as these residuals have them, times the root of
/// kInputNoiseDispersion. @param residual [m] of `fit`
[[nodiscard]] NoiseModel WithLevelsOf(const LeastSquares& fit, const Vector& residual, NoiseModel model);

}  // namespace sinew::noise
