#include "identify/diagnosis/fit/jackknife.h"

#include <cmath>
#include <vector>

#include "base/text.h"
#include "identify/diagnosis/fit/folds.h"
#include "identify/statistics/distributions.h"

namespace sinew::diagnosis {

Result<Matrix> JackknifeCovariance(const Problem& problem, const Refit& refit) {
  constexpr double kTolerance = 1e-5;
  constexpr double kNormal = 1.959964;
  const std::vector<Fold> folds = FoldsOf(problem);
  const auto count = static_cast<double>(folds.size());
  if (count < 2) return Fail("a jackknife needs at least two parts of the training data");
  std::vector<Vector> found;
  Vector mean = Vector::Zero(refit.x.size());
  for (const Fold& fold : folds) {
    const FoldView view(problem, fold);
    FitSetup setup = WithoutLeftOut(*refit.setup, fold);
    setup.rest = refit.point;
    const LeastSquares fit(view, setup);
    const auto without = FitFromStarts(fit, {refit.point}, kTolerance);
    if (!without.failure.empty())
      return Fail("without trial {}: {}", Join(fold.trials, ", "), without.failure);
    const LeastSquares whole(problem, *refit.setup);
    found.push_back(whole.Variables(fit.Parameters(without.x)));
    mean += found.back() / count;
  }
  Matrix covariance = Matrix::Zero(refit.x.size(), refit.x.size());
  for (const Vector& x : found) covariance += (x - mean) * (x - mean).transpose();
  const double wider = statistics::StudentTQuantile(0.975, count - 1) / kNormal;
  return Matrix(covariance * ((count - 1) / count * wider * wider));
}

}  // namespace sinew::diagnosis
