#include "identify/diagnosis/fit/jackknife.h"

#include <cmath>
#include <vector>

#include "base/text.h"
#include "identify/diagnosis/fit/trial_folds.h"
#include "identify/role_view.h"
#include "identify/statistics/distributions.h"

namespace sinew::diagnosis {

Result<Matrix> JackknifeCovariance(const Problem& problem, const Refit& refit) {
  constexpr double kTolerance = 1e-5;
  constexpr double kNormal = 1.959964;
  const std::vector<TrialFold> folds = FoldsOf(problem);
  const auto count = static_cast<double>(folds.size());
  if (count < 2) return Fail("a jackknife needs at least two training trials");
  std::vector<Vector> found;
  Vector mean = Vector::Zero(refit.x.size());
  for (const TrialFold& fold : folds) {
    const RoleView view(problem, [&](const Block& block) {
      return block.role == BlockRole::kTrain && fold.Has(block.trial) ? BlockRole::kPredicted : block.role;
    });
    FitSetup setup = *refit.setup;
    setup.rest = refit.point;
    setup.free.clear();
    for (const int index : refit.setup->free) {
      if (!fold.Has(setup.parameters[static_cast<std::size_t>(index)].trial)) setup.free.push_back(index);
    }
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
