#include "identify/diagnosis/select/starts_without.h"

#include <algorithm>

#include "identify/solvers/box_quadratic_model.h"

namespace sinew::diagnosis {
namespace {

// Of columns of unit length: without it, values that the data do not determine would run to their bounds.
constexpr double kDampingOfTheRest = 1e-8;

}  // namespace

Result<std::vector<Vector>> StartsWithout(const LeastSquares& fit, const Vector& x,
                                          const std::vector<std::vector<int>>& causes, const Vector& nulls) {
  auto workspace = fit.NewWorkspace();
  SparseJacobian jacobian = fit.NewJacobian();
  Vector residuals;
  SINEW_TRY(fit.Evaluate(x, workspace, residuals, &jacobian));
  solvers::BoxQuadraticModel whole;
  if (!whole.Set(fit.variables(), residuals, jacobian)) return Fail("a derivative is not finite");
  const Vector at_nulls = fit.Variables(nulls);
  std::vector<Vector> starts;
  for (const std::vector<int>& parameters : causes) {
    Vector change = Vector::Zero(x.size());
    solvers::BoxQuadraticModel rest = whole;
    std::vector<Eigen::Index> own;
    for (Eigen::Index v = 0; v < x.size(); ++v) {
      const int index = fit.setup().free[static_cast<std::size_t>(v)];
      if (std::find(parameters.begin(), parameters.end(), index) != parameters.end()) own.push_back(v);
    }
    for (const Eigen::Index v : own) change[v] = at_nulls[v] - x[v];
    rest.gradient += whole.normal * change;
    // Variables without influence do not move.
    for (const Eigen::Index v : own) {
      rest.gradient[v] = 0;
      rest.normal.row(v).setZero();
      rest.normal.col(v).setZero();
    }
    const Vector without = x + change;
    double gain = 0;
    const Vector step = rest.BoxStep(without, -1, kDampingOfTheRest, gain);
    Vector point = fit.Parameters((without + step).cwiseMax(0).cwiseMin(1));
    for (const int index : parameters) point[index] = nulls[index];
    starts.push_back(std::move(point));
  }
  return starts;
}

}  // namespace sinew::diagnosis
