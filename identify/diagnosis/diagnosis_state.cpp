#include "identify/diagnosis/diagnosis_state.h"

#include "identify/diagnosis/fit/jackknife.h"

namespace sinew::diagnosis {

double DiagnosisState::Loss(const std::vector<Vector>& residuals, const noise::NoiseModel& noise) const {
  if (!selection.cross_validated) return held_out.Innovations(residuals, noise);
  double squares = 0;
  for (const Vector& block : residuals) squares += block.squaredNorm();
  return squares;
}

Result<Matrix> DiagnosisState::CovarianceOf(const Refit& refit) const {
  return selection.cross_validated ? JackknifeCovariance(problem, refit) : refitter->Covariance(refit);
}

Refit DiagnosisState::Fit(const std::vector<int>& released, const std::vector<Vector>& starts) const {
  constexpr double kTolerance = 1e-6;
  return selection.cross_validated ? refitter->FitOrdinary(released, starts, kTolerance)
                                   : refitter->Fit(released, starts);
}

}  // namespace sinew::diagnosis
