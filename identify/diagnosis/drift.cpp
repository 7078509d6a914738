#include "identify/diagnosis/drift.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "identify/diagnosis/design.h"
#include "identify/results/held_out.h"
#include "identify/role_view.h"

namespace sinew {
namespace {

// [base, drift] of a design.
Result<Matrix> ColumnsOf(const Design& design, int candidate, const std::vector<Candidate>& candidates) {
  for (std::size_t k = 0; k < design.columns.size(); ++k) {
    if (design.columns[k].candidate != candidate) continue;
    Matrix columns(design.base.rows(), design.base.cols() + 1);
    columns << design.base, design.candidates.col(static_cast<Eigen::Index>(k));
    return columns;
  }
  return Fail("{}: these data do not show it", candidates[static_cast<std::size_t>(candidate)].effect);
}

void Whiten(const LeastSquares& fit, const Whitening& whitening, Matrix& rows) {
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const auto& train = fit.train_blocks()[t];
    const int n = fit.problem().layout()[static_cast<std::size_t>(train.block)].samples();
    whitening.Apply(static_cast<int>(t), rows.middleRows(train.first_row, n));
  }
}

}  // namespace

Result<DriftFit> FitDrift(const Problem& problem, const Refit& refit,
                          const std::vector<Candidate>& candidates, int candidate, const NoiseModel& noise) {
  DriftFit answer;
  const LeastSquares fit(problem, *refit.setup);
  const Whitening whitening(noise, TrainStretches(fit));
  SINEW_ASSIGN(const Design design, MakeDesign(fit, refit.x, candidates, whitening));
  SINEW_ASSIGN(Matrix columns, ColumnsOf(design, candidate, candidates));
  Matrix residual = design.residual;
  Whiten(fit, whitening, residual);
  Whiten(fit, whitening, columns);
  const Vector length = columns.colwise().norm().cwiseMax(1e-300);
  const Eigen::ColPivHouseholderQR<Matrix> qr(columns * length.cwiseInverse().asDiagonal());
  const Vector step = -qr.solve(residual.col(0)).cwiseQuotient(length);
  const Eigen::Index last = columns.cols() - 1;
  answer.change = step[last];
  // What is left of the drift's column without the others.
  const Eigen::ColPivHouseholderQR<Matrix> others(columns.leftCols(last) *
                                                  length.head(last).cwiseInverse().asDiagonal());
  const Vector taken =
      columns.leftCols(last) * others.solve(columns.col(last)).cwiseQuotient(length.head(last));
  const double left = (columns.col(last) - taken).norm();
  if (!(left > 0))
    return Fail("{}: these data do not show it", candidates[static_cast<std::size_t>(candidate)].effect);
  answer.std_error = 1 / left;

  const HeldOut held_out(problem);
  if (!held_out.exists()) return answer;
  SINEW_ASSIGN(const Vector point, FitHeldOutNuisance(problem, refit.point));
  SINEW_ASSIGN(answer.before, held_out.Residuals(point));
  const RoleView view(problem, [](const Block& block) {
    return block.role == BlockRole::kValidate ? BlockRole::kTrain : BlockRole::kPredicted;
  });
  // The same shared variables, then the nuisance values of held-out trials.
  FitSetup setup = *refit.setup;
  setup.rest = point;
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    if (p.kind == ParameterKind::kNuisance && !setup.IsFree(static_cast<int>(i)))
      setup.free.push_back(static_cast<int>(i));
  }
  std::sort(setup.free.begin(), setup.free.end());
  const LeastSquares there(view, setup);
  const Vector x = there.Variables(point);
  NoiseModel unit;
  unit.channels = {{}};
  unit.channel_of.assign(there.train_blocks().size(), 0);
  const Whitening none(unit, TrainStretches(there));
  SINEW_ASSIGN(const Design seen, MakeDesign(there, x, candidates, none));
  SINEW_ASSIGN(const Matrix reach, ColumnsOf(seen, candidate, candidates));
  Vector after = seen.residual + reach.col(reach.cols() - 1) * answer.change;
  std::vector<Eigen::Index> own;
  for (std::size_t v = 0; v < setup.free.size(); ++v) {
    const auto& mine = refit.setup->free;
    const auto at = std::lower_bound(mine.begin(), mine.end(), setup.free[v]);
    const bool shared = at != mine.end() && *at == setup.free[v];
    if (shared) {
      after += reach.col(static_cast<Eigen::Index>(v)) * step[at - mine.begin()];
    } else if (reach.col(static_cast<Eigen::Index>(v)).norm() > 0) {
      own.push_back(static_cast<Eigen::Index>(v));
    }
  }
  Matrix nuisance(reach.rows(), static_cast<Eigen::Index>(own.size()));
  for (std::size_t k = 0; k < own.size(); ++k) {
    nuisance.col(static_cast<Eigen::Index>(k)) = reach.col(own[k]) / reach.col(own[k]).norm();
  }
  if (nuisance.cols() > 0) after -= nuisance * nuisance.colPivHouseholderQr().solve(after).eval();
  for (const auto& train : there.train_blocks()) {
    const int n = problem.layout()[static_cast<std::size_t>(train.block)].samples();
    answer.after.push_back(after.segment(train.first_row, n));
  }
  return answer;
}

}  // namespace sinew
