#include "identify/diagnosis/diagnosis_state.h"

#include <cmath>

#include "identify/diagnosis/fit/jackknife.h"

namespace sinew::diagnosis {

double DiagnosisState::Loss(const std::vector<Vector>& residuals, const noise::NoiseModel& noise) const {
  if (!selection.cross_validated) return held_out.Innovations(residuals, noise);
  double squares = 0;
  for (const Vector& block : residuals) squares += block.squaredNorm();
  return squares;
}

Result<Matrix> DiagnosisState::CovarianceOf(const Refit& refit) const {
  return selection.cross_validated ? JackknifeCovariance(problem, refit, options.threads)
                                   : refitter->Covariance(refit);
}

Vector DiagnosisState::SpreadOverSets(const Refit& refit) const {
  const LeastSquares fit(problem, *refit.setup);
  Vector spread = Vector::Zero(refit.x.size());
  for (const ResampledSet& set : selection.resampled) {
    const FitSetup theirs = refitter->SetupWith(set.released);
    const Vector x = fit.Variables(set.point);
    for (Eigen::Index v = 0; v < x.size(); ++v) {
      if (theirs.IsFree(refit.setup->free[static_cast<std::size_t>(v)]))
        spread[v] += set.share * std::pow(x[v] - refit.x[v], 2);
    }
  }
  return spread;
}

Refit DiagnosisState::Fit(const std::vector<int>& released, const std::vector<Vector>& starts) const {
  constexpr double kTolerance = 1e-6;
  if (!selection.cross_validated) return refitter->Fit(released, starts);
  const Refitter& with = selection.refitter ? *selection.refitter : *refitter;
  return with.FitOrdinary(released, starts, kTolerance);
}

}  // namespace sinew::diagnosis
