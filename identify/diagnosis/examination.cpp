#include "identify/diagnosis/examination.h"

#include "identify/diagnosis/jackknife.h"

namespace sinew {

double Examination::Loss(const std::vector<Vector>& residuals, const NoiseModel& noise) const {
  if (!selection.gross) return held_out.Innovations(residuals, noise);
  double squares = 0;
  for (const Vector& block : residuals) squares += block.squaredNorm();
  return squares;
}

Result<Matrix> Examination::CovarianceOf(const Refit& refit) const {
  return selection.gross ? JackknifeCovariance(problem, refit) : refitter->Covariance(refit);
}

Refit Examination::Fit(const std::vector<int>& released, const std::vector<Vector>& starts) const {
  constexpr double kTolerance = 1e-6;
  return selection.gross ? refitter->FitOrdinary(released, starts, kTolerance)
                         : refitter->Fit(released, starts);
}

}  // namespace sinew
