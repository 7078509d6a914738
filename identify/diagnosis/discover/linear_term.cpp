#include "identify/diagnosis/discover/linear_term.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/column_space.h"
#include "base/decompositions.h"
#include "identify/diagnosis/score/design.h"
#include "identify/role_view.h"
#include "identify/solvers/held_out_nuisance.h"

namespace sinew::diagnosis {
namespace {

constexpr double kSingular = 1e-8;

void Whiten(const LeastSquares& fit, const noise::Whitening& whitening, Matrix& rows) {
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const auto& train = fit.train_blocks()[t];
    const int n = fit.problem().layout()[static_cast<std::size_t>(train.block)].samples();
    whitening.Apply(static_cast<int>(t), rows.middleRows(train.first_row, n));
  }
}

std::vector<Vector> PerBlock(const LeastSquares& fit, const Vector& rows) {
  std::vector<Vector> blocks;
  for (const auto& train : fit.train_blocks()) {
    const int n = fit.problem().layout()[static_cast<std::size_t>(train.block)].samples();
    blocks.push_back(rows.segment(train.first_row, n));
  }
  return blocks;
}

/// Maximum-likelihood estimate of the common standard deviation of values that are N(0, deviation^2), seen in
/// unit noise through columns whose Gram matrix has these eigenvalues, with these scores along its
/// eigenvectors.
double MaximumLikelihoodDeviation(const Vector& eigenvalues, const Vector& scores) {
  constexpr int kSteps = 120;
  const double most = eigenvalues.maxCoeff();
  double best = 0;
  double best_likelihood = -std::numeric_limits<double>::infinity();
  for (int step = 0; step < kSteps; ++step) {
    // Search range: from a hundredth of the deviation that the best determined direction can detect, to a
    // million times that.
    const double variance = std::pow(10.0, -4 + 16.0 * step / (kSteps - 1)) / most;
    double likelihood = 0;
    for (Eigen::Index i = 0; i < scores.size(); ++i) {
      const double grown = 1 + variance * std::max(0.0, eigenvalues[i]);
      likelihood += 0.5 * (variance * scores[i] * scores[i] / grown - std::log(grown));
    }
    if (likelihood > best_likelihood) {
      best_likelihood = likelihood;
      best = variance;
    }
  }
  return std::sqrt(best);
}

/// Predicts the held-out trials with the parameters from the training trials.
class Transfer {
 public:
  Transfer(const Problem& problem, const Refit& refit, const Candidate& candidate, const HeldOut& held_out)
      : problem_(problem), refit_(refit), candidate_(candidate), held_out_(held_out) {}

  /// @param step [n] of the refit's variables
  Status Apply(const Vector& step, LinearTerm& term) const {
    if (!held_out_.exists()) return {};
    const Vector point = held_out_.Fitted(refit_.point);
    SINEW_ASSIGN(term.before, held_out_.Residuals(refit_.point));
    const RoleView view(problem_, [](const Block& block) {
      return block.role == BlockRole::kValidate ? BlockRole::kTrain : BlockRole::kPredicted;
    });
    // Shared variables as in the training fit, then the nuisance parameters of the held-out trials.
    FitSetup setup = *refit_.setup;
    setup.rest = point;
    for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
      const Parameter& p = setup.parameters[i];
      if (p.kind == ParameterKind::kNuisance && !setup.IsFree(static_cast<int>(i)))
        setup.free.push_back(static_cast<int>(i));
    }
    std::sort(setup.free.begin(), setup.free.end());
    const LeastSquares there(view, setup);
    noise::NoiseModel unit;
    unit.channels = {{}};
    unit.channel_of.assign(there.train_blocks().size(), 0);
    const noise::Whitening none(unit, TrainStretches(there));
    SINEW_ASSIGN(const Design seen, MakeDesign(there, there.Variables(point), {candidate_}, none));
    if (seen.candidates.cols() != term.values.size())
      return Fail("{}: held-out trials show another part of it", candidate_.effect);
    Vector after = seen.residual + seen.candidates * term.values;
    std::vector<Eigen::Index> own;
    for (std::size_t v = 0; v < setup.free.size(); ++v) {
      const auto& mine = refit_.setup->free;
      const auto column = static_cast<Eigen::Index>(v);
      const auto at = std::lower_bound(mine.begin(), mine.end(), setup.free[v]);
      if (at != mine.end() && *at == setup.free[v]) {
        after += seen.base.col(column) * step[at - mine.begin()];
      } else {
        own.push_back(column);
      }
    }
    Matrix nuisance(seen.base.rows(), static_cast<Eigen::Index>(own.size()));
    for (std::size_t k = 0; k < own.size(); ++k)
      nuisance.col(static_cast<Eigen::Index>(k)) = seen.base.col(own[k]);
    if (nuisance.cols() > 0) after = ColumnSpace(nuisance, kSingular).TakenFrom(after);
    term.after = PerBlock(there, after);
    return {};
  }

 private:
  const Problem& problem_;
  const Refit& refit_;
  const Candidate& candidate_;
  const HeldOut& held_out_;
};

}  // namespace

Result<LinearTerm> FitLinearTerm(const Problem& problem, const Refit& refit, const Candidate& candidate,
                                 const noise::NoiseModel& noise, const HeldOut& held_out) {
  const LeastSquares fit(problem, *refit.setup);
  const noise::Whitening whitening(noise, TrainStretches(fit));
  SINEW_ASSIGN(const Design design, MakeDesign(fit, refit.x, {candidate}, whitening));
  Matrix residual = design.residual;
  Matrix base = design.base;
  Matrix columns = design.candidates;
  Whiten(fit, whitening, residual);
  Whiten(fit, whitening, base);
  Whiten(fit, whitening, columns);
  const ColumnSpace taken(base, kSingular);
  const Matrix left = taken.TakenFrom(columns);
  if (!(left.norm() > 1e-6 * columns.norm())) return Fail("{}: these data do not show it", candidate.effect);

  LinearTerm answer;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Gram(left));
  const Vector gram = eigen.eigenvalues();
  // The sign is negative because the residual is predicted minus measured.
  const Vector pull = -(left.transpose() * taken.TakenFrom(residual).col(0));
  const Vector turned = eigen.eigenvectors().transpose() * pull;
  const bool curve = candidate.drifting < 0;
  answer.shrinkage =
      curve ? MaximumLikelihoodDeviation(gram, turned) : std::numeric_limits<double>::infinity();
  const double precision = 1 / (answer.shrinkage * answer.shrinkage);
  answer.values = Vector::Zero(gram.size());
  Vector variance = Vector::Zero(gram.size());
  for (Eigen::Index i = 0; i < gram.size(); ++i) {
    const double known = std::max(0.0, gram[i]) + precision;
    if (!(known > 0)) continue;
    const Vector direction = eigen.eigenvectors().col(i);
    answer.values += direction * (turned[i] / known);
    variance += direction.cwiseAbs2() / known;
  }
  answer.deviations = variance.cwiseSqrt();

  const Vector step = -taken.Solve(residual.col(0) + columns * answer.values);
  answer.train = PerBlock(fit, design.residual + design.base * step + design.candidates * answer.values);
  SINEW_TRY(Transfer(problem, refit, candidate, held_out).Apply(step, answer));
  return answer;
}

}  // namespace sinew::diagnosis
