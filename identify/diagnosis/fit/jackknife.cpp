#include "identify/diagnosis/fit/jackknife.h"

#include <cmath>
#include <string>
#include <vector>

#include "base/text.h"
#include "identify/diagnosis/fit/folds.h"
#include "identify/execution/shared_loop.h"
#include "identify/statistics/distributions.h"

namespace sinew::diagnosis {

Result<Matrix> JackknifeCovariance(const Problem& problem, const Refit& refit, int threads) {
  constexpr double kTolerance = 1e-5;
  constexpr double kNormal = 1.959964;
  const std::vector<Fold> folds = FoldsOf(problem);
  const auto count = static_cast<double>(folds.size());
  if (count < 2) return Fail("a jackknife needs at least two parts of the training data");
  std::vector<Vector> found(folds.size());
  std::vector<std::string> failures(folds.size());
  ForEachShared(refit.setup->record, threads, folds.size(), [&](std::size_t i, std::size_t) {
    const FoldView view(problem, folds[i]);
    FitSetup setup = WithoutLeftOut(*refit.setup, folds[i]);
    setup.rest = refit.point;
    const LeastSquares fit(view, setup);
    const auto without = FitFromStarts(fit, {refit.point}, kTolerance);
    failures[i] = without.failure;
    if (!without.failure.empty()) return;
    const LeastSquares whole(problem, *refit.setup);
    found[i] = whole.Variables(fit.Parameters(without.x));
  });
  Vector mean = Vector::Zero(refit.x.size());
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (!failures[i].empty()) return Fail("without trial {}: {}", Join(folds[i].trials, ", "), failures[i]);
    mean += found[i] / count;
  }
  Matrix covariance = Matrix::Zero(refit.x.size(), refit.x.size());
  for (const Vector& x : found) covariance += (x - mean) * (x - mean).transpose();
  const double wider = statistics::StudentTQuantile(0.975, count - 1) / kNormal;
  return Matrix(covariance * ((count - 1) / count * wider * wider));
}

}  // namespace sinew::diagnosis
