// Refits of a model with some candidates released: all base parameters free, the noise estimated again, so
// that two models can be compared by likelihood, each with its own noise.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identify/diagnosis/score/candidate.h"
#include "identify/least_squares.h"
#include "identify/noise/noise_model.h"
#include "identify/solvers/local_fit.h"

namespace sinew::diagnosis {

/// A fitted model. It owns its setup, so that a LeastSquares made for that setup stays valid as long as the
/// Refit exists.
struct Refit {
  std::vector<int> released;  ///< indices of the released candidates, increasing
  std::shared_ptr<const FitSetup> setup;
  Vector x;      ///< [n] variables
  Vector point;  ///< [P]
  noise::NoiseModel noise;
  double cost = 0;      ///< half the sum of squared weighted residuals of ordinary least squares
  double deviance = 0;  ///< -2 log-likelihood with profiled noise levels; comparable between refits
  int rows = 0;         ///< number of residuals in the deviance
  bool converged = false;
  bool noise_absorbs_misfit = false;  ///< the noise model would have absorbed the misfit: errors
                                      ///< are assumed independent, the fit is ordinary least squares
  /// Its residual is no larger than noise of recorded inputs can make it, and was fitted under that noise:
  /// that it is slow is no sign of a misfit. See ExpectInputNoise.
  bool holds_input_noise = false;
  std::string failure;       ///< why the fit failed; empty if it did not
  bool interrupted = false;  ///< that is why: it was not begun

  [[nodiscard]] bool usable() const { return failure.empty(); }
  [[nodiscard]] int parameters() const { return static_cast<int>(setup->free.size()); }
};

/// Deviance of a refit less that of another one of the same data, both under independent errors of one level:
/// rows log(cost / cost of the reference).
[[nodiscard]] double IndependentDifference(const Refit& refit, const Refit& reference);

/// Deviance of a refit less that of another one of the same data. Where both were fitted under noise of the
/// inputs, over its dispersion (noise::kInputNoiseDispersion); where one of them was, IndependentDifference.
[[nodiscard]] double LikelihoodDifference(const Refit& refit, const Refit& reference);

/// Fits models with any set of candidates released, by the same procedure, so that they can be compared.
class Refitter {
 public:
  /// Keeps references to `problem` and `candidates`, which must outlive it.
  /// @param base bounds, starts and free parameters of the base model
  /// @param candidates what can be released; released sets are indices into it
  /// @param interrupt if it becomes true, every further fit fails at once with "interrupted"; may be null
  Refitter(const Problem& problem, FitSetup base, const std::vector<Candidate>& candidates,
           const std::atomic<bool>* interrupt = nullptr)
      : problem_(problem), base_(std::move(base)), candidates_(candidates), interrupt_(interrupt) {}

  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] const FitSetup& base() const { return base_; }

  /// Fits the base parameters and the released candidates to the training trials, with a noise model of the
  /// residual.
  ///
  /// Steps: (1) ordinary least squares: a short local search from every start, the best of them continued to
  /// convergence; (2) noise model of its residual (EstimateNoiseModel); (3) generalised least squares, that
  /// is least squares of the whitened residuals, with the noise estimated once more on the way. If the
  /// generalised fit has more than twice the sum of squares of the ordinary one, the noise model has absorbed
  /// misfit: then the ordinary fit is kept, with white noise (Refit::noise_absorbs_misfit). After
  /// AssumeIndependentErrors all fits end in this way.
  ///
  /// @param released indices of candidates, in any order, without duplicates
  /// @param starts [P] each, not empty. Free parameters start there; all others are held at the values of
  /// starts.front(), which may differ from their null.
  /// @return always a Refit. If it is not usable(), `failure` is the reason (interrupted, no prediction at
  /// any start, no noise estimate) and the fitted fields are undefined. A search that stops at its limit
  /// of evaluations is usable, with `converged` false.
  ///
  /// Thread-safe: const, and each call has its own workspaces. The result depends on the arguments alone.
  /// What the record of the base setup holds (FitSetup::record) is taken from there.
  /// Source of step 3: Cochrane, Orcutt (1949), J. Am. Stat. Assoc. 44:32-61, with the noise model by
  /// restricted likelihood.
  [[nodiscard]] Refit Fit(std::vector<int> released, const std::vector<Vector>& starts) const;

  /// Ordinary least squares alone (step 1 of Fit), for misfits that dominate the noise, where a noise model
  /// would absorb them. Noise and deviance are those of its residual.
  /// @param tolerance relative change of the cost at which the search ends
  [[nodiscard]] Refit FitOrdinary(std::vector<int> released, const std::vector<Vector>& starts,
                                  double tolerance) const;

  /// The base setup with the parameters of these candidates free too.
  [[nodiscard]] FitSetup SetupWith(const std::vector<int>& released) const;

  /// From now on every fit is ordinary least squares with white noise. For all models at once: deviances can
  /// be compared only between models with the same assumption. Not thread-safe.
  void AssumeIndependentErrors() { independent_ = true; }

  /// Noise of the base model. Where it is white beside values with priors, hundreds of nuisance values that
  /// follow the data, further fits are least squares under it from the begin, and its levels are where theirs
  /// begin: a search for each set of levels would take most of the time. Not thread-safe.
  void ExpectNoise(const noise::NoiseModel& noise) { expected_ = noise; }

  /// If what these released candidates leave may be noise of the inputs: from now on every fit of which that
  /// is true is generalised least squares under the noise model of this one (noise::InputNoiseModel), also
  /// after AssumeIndependentErrors. @param point [P] of an ordinary fit. Not thread-safe.
  void ExpectInputNoise(const std::vector<int>& released, const Vector& point);

  /// Covariance of the variables [n x n, unit box] under the refit's own noise model; zero rows and columns
  /// for variables on a bound and those that change nothing. Variables that take part in a combination that
  /// the data do not determine (rank loss) have an infinite variance and covariances of zero.
  /// @param held parameters (indices into Problem::parameters()) whose values are taken as known, as if on a
  /// bound. Errors: those of Problem::Predict.
  [[nodiscard]] Result<Matrix> Covariance(const Refit& refit, const std::vector<int>& held = {}) const;

 private:
  [[nodiscard]] Refit Asked(std::vector<int> released, const std::vector<Vector>& starts) const;
  [[nodiscard]] Refit MakeOrdinary(Refit refit, const std::vector<Vector>& starts, double tolerance) const;
  [[nodiscard]] Refit MakeGeneralised(Refit refit, const std::vector<Vector>& starts) const;
  [[nodiscard]] Refit MakeUnderInputNoise(Refit refit) const;
  /// Noise model of the refit's residual; white if errors are assumed independent. @param like see
  /// NoiseModelOptions, may be null
  [[nodiscard]] Status EstimateNoise(LeastSquares& fit, bool white, const noise::NoiseModel* like,
                                     Refit& refit) const;
  [[nodiscard]] Status FitGeneralised(LeastSquares& fit, Refit& refit) const;
  /// Whether ExpectNoise applies to this fit.
  [[nodiscard]] bool Expects(const LeastSquares& fit) const;
  [[nodiscard]] Refit FitUnderExpectedNoise(std::vector<int> released,
                                            const std::vector<Vector>& starts) const;
  [[nodiscard]] Refit MakeUnderExpectedNoise(Refit refit, const std::vector<Vector>& starts) const;
  [[nodiscard]] Status Finish(const LeastSquares& fit, Refit& refit) const;

  const Problem& problem_;
  FitSetup base_;
  const std::vector<Candidate>& candidates_;
  const std::atomic<bool>* interrupt_;
  bool independent_ = false;
  std::optional<noise::NoiseModel> expected_;
  std::optional<noise::NoiseModel> input_noise_;
};

/// Least squares by a short search from every start, the best of them continued to convergence. @param starts
/// [P] each, not empty. If there is no prediction at any start, the cost is infinite and `failure` is the
/// reason.
[[nodiscard]] solvers::LocalFit::Outcome FitFromStarts(const LeastSquares& fit,
                                                       const std::vector<Vector>& starts, double tolerance);

/// Rows at which the stretches without a gap begin, of every training block.
[[nodiscard]] std::vector<std::vector<int>> TrainStretches(const LeastSquares& fit);

/// -2 log-likelihood of the training residuals, plus the priors, with the innovation variance of each channel
/// profiled out. The likelihood is the exact one of stationary stretches without its constants, so that noise
/// models of any order can be compared.
/// @param residual [m] weighted @param counted if not null, set to the number of rows in the likelihood
[[nodiscard]] double Deviance(const LeastSquares& fit, const Vector& residual, const noise::NoiseModel& noise,
                              int* counted);

}  // namespace sinew::diagnosis
