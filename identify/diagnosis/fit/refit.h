// Refitting a model with some candidates released: all base parameters free, noise estimated anew, so that
// two models can be compared by likelihood, each with its own noise.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "identify/diagnosis/score/candidate.h"
#include "identify/least_squares.h"
#include "identify/noise/noise_model.h"
#include "identify/solvers/local_fit.h"

namespace sinew::diagnosis {

/// A fitted model. Owns its setup, so that a LeastSquares made for it can be used as long as it lives.
struct Refit {
  std::vector<int> released;  ///< candidates, increasing
  std::shared_ptr<const FitSetup> setup;
  Vector x;      ///< [n] variables
  Vector point;  ///< [P]
  noise::NoiseModel noise;
  double cost = 0;      ///< half the least sum of squared weighted residuals, before any noise model
  double deviance = 0;  ///< -2 log-likelihood, noise levels profiled out; comparable between refits
  int rows = 0;         ///< residuals that the deviance counts
  bool converged = false;
  bool noise_absorbs_misfit = false;  ///< coloured noise would have taken the place of the model: errors
                                      ///< count as independent, the fit is ordinary least squares
  std::string failure;                ///< why there is no such model; empty otherwise

  [[nodiscard]] bool usable() const { return failure.empty(); }
  [[nodiscard]] int parameters() const { return static_cast<int>(setup->free.size()); }
};

class Refitter {
 public:
  /// @param interrupt once true, every further fit fails at once; may be null
  Refitter(const Problem& problem, FitSetup base, const std::vector<Candidate>& candidates,
           const std::atomic<bool>* interrupt = nullptr)
      : problem_(problem), base_(std::move(base)), candidates_(candidates), interrupt_(interrupt) {}

  [[nodiscard]] const FitSetup& base() const { return base_; }

  /// Ordinary least squares from every start, the best of them to the end; noise of its residual; generalised
  /// least squares with it; noise again.
  /// @param starts [P] each, not empty @param held [P index, value] parameters that stay where the starts
  /// have them although a candidate owns them
  [[nodiscard]] Refit Fit(std::vector<int> released, const std::vector<Vector>& starts) const;

  /// Ordinary least squares alone: what is wrong dwarfs the noise, and a noise model would swallow it. Noise
  /// and deviance are those of its residual.
  /// @param tolerance relative, of the cost
  [[nodiscard]] Refit FitOrdinary(std::vector<int> released, const std::vector<Vector>& starts,
                                  double tolerance) const;

  /// The base setup with the candidates' parameters free too.
  [[nodiscard]] FitSetup SetupWith(const std::vector<int>& released) const;

  /// From now on all fits are ordinary and take errors for independent: models can be compared only if all of
  /// them do.
  void AssumeIndependentErrors() { independent_ = true; }

  /// Standard deviations and covariance of the variables [n x n, unit box] under the refit's own noise; of
  /// variables on a bound 0. Errors: the problem's own.
  [[nodiscard]] Result<Matrix> Covariance(const Refit& refit) const;

 private:
  /// Noise of the refit's residual; white if errors count as independent. @param like may be null
  [[nodiscard]] Status EstimateNoise(LeastSquares& fit, bool white, const noise::NoiseModel* like,
                                     Refit& refit) const;
  [[nodiscard]] Status FitGeneralised(LeastSquares& fit, Refit& refit) const;
  [[nodiscard]] Status Finish(const LeastSquares& fit, Refit& refit) const;

  const Problem& problem_;
  FitSetup base_;
  const std::vector<Candidate>& candidates_;
  const std::atomic<bool>* interrupt_;
  bool independent_ = false;
};

/// Least squares from every start, the best of them to the end. @param starts [P] each, not empty. Infinite
/// cost and a reason if there is no prediction at any.
[[nodiscard]] LocalFit::Outcome FitFromStarts(const LeastSquares& fit, const std::vector<Vector>& starts,
                                              double tolerance);

/// Stretches of every training block.
[[nodiscard]] std::vector<std::vector<int>> TrainStretches(const LeastSquares& fit);

/// -2 log-likelihood and priors (exact, that of stationary stretches; constants left out) with the
/// innovations' variance of each channel profiled out: comparable between noise models of any order.
/// @param residual [m] weighted @param counted how many rows that were; may be null
[[nodiscard]] double Deviance(const LeastSquares& fit, const Vector& residual, const noise::NoiseModel& noise,
                              int* counted);

}  // namespace sinew::diagnosis
