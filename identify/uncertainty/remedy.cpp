#include "identify/uncertainty/remedy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/column_space.h"
#include "base/constants.h"
#include "base/decompositions.h"
#include "identify/uncertainty/interval.h"
#include "identify/uncertainty/verdict.h"

namespace sinew::uncertainty {
namespace {

// Above this many additions, pairs of them cost more than they are worth.
constexpr std::size_t kMaxForPairs = 12;
// Of more ways to determine one parameter the best three are enough.
constexpr std::size_t kMaxChoices = 3;
// Eigenvalues of the information with a unit diagonal are squares of singular values, and are exact to about
// n eps: the square of kRankTolerance is out of reach.
constexpr double kLostEigenvalue = 1e-12;

const Block& BlockOf(const LeastSquares& problem, int b) {
  return problem.problem().layout()[static_cast<std::size_t>(b)];
}

double MedianRelativeNoise(const Noise& noise) {
  std::vector<double> relative;
  for (const ChannelNoise& channel : noise.channels) relative.push_back(channel.relative);
  std::sort(relative.begin(), relative.end());
  return relative[relative.size() / 2];
}

/// Samples of the densest fitted channel of a trial; 0 if none of it is fitted.
int FittedSamples(const LeastSquares& problem, const std::string& trial) {
  int samples = 0;
  for (const LeastSquares::TrainBlock& train : problem.train_blocks()) {
    const Block& block = BlockOf(problem, train.block);
    if (block.trial == trial) samples = std::max(samples, block.samples());
  }
  return samples;
}

/// Noise of one sample [unit]; nothing if there is no signal to relate it to.
std::optional<double> AssumedSigma(const Block& block, const Noise& noise, const VectorRef& predicted) {
  if (block.sigma) return block.sigma;
  if (const ChannelNoise* fitted = noise.Find(block.channel)) return fitted->sigma;
  const double signal = std::sqrt(predicted.squaredNorm() / static_cast<double>(predicted.size()));
  const double sigma = MedianRelativeNoise(noise) * signal;
  if (!(sigma > 0)) return std::nullopt;
  return sigma;
}

/// Position of a parameter in an increasing list; -1 if it is not there.
int PositionIn(const std::vector<int>& list, int parameter) {
  const auto found = std::lower_bound(list.begin(), list.end(), parameter);
  return found != list.end() && *found == parameter ? static_cast<int>(found - list.begin()) : -1;
}

/// Nuisance parameters (initial states, offsets) that would be free as well if the trial were fitted:
/// increasing.
std::vector<int> NuisanceAddedBy(const LeastSquares& problem, const AdditionName& addition) {
  std::vector<int> added;
  if (addition.kind != AdditionKind::kTrial) return added;
  const FitSetup& setup = problem.setup();
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    const auto index = static_cast<int>(i);
    if (p.kind == ParameterKind::kNuisance && p.trial == addition.name && !setup.IsFree(index) &&
        !setup.IsHeld(index))
      added.push_back(index);
  }
  return added;
}

/// Derivatives of one block's residuals in units of their noise: [rows x n] by the fitted variables (unit
/// box), then a column for each of `nuisance` (its own unit). No rows if nothing is known of its noise.
Matrix BlockSlopes(const LeastSquares& problem, const Linearization& at, const Noise& noise, int b,
                   const std::vector<int>& nuisance, const Prediction& prediction) {
  const Block& block = BlockOf(problem, b);
  const Eigen::Index columns = problem.variables() + static_cast<Eigen::Index>(nuisance.size());
  const std::optional<double> sigma = AssumedSigma(block, noise, prediction.values(b));
  if (!sigma) return Matrix(0, columns);
  std::vector<int> rows = block.sample;
  double share = 1;  // of the samples that count
  if (rows.empty()) {
    for (int i = 0; i < block.predictions(); ++i) rows.push_back(i);
    const int samples = FittedSamples(problem, block.trial);
    share = std::min(1.0, static_cast<double>(samples) / block.predictions());
  }
  Matrix slopes = Matrix::Zero(static_cast<Eigen::Index>(rows.size()), columns);
  for (std::size_t c = 0; c < block.columns.size(); ++c) {
    const int variable = PositionIn(problem.setup().free, block.columns[c]);
    const int added = PositionIn(nuisance, block.columns[c]);
    if (variable < 0 && added < 0) continue;
    if (variable >= 0 && (at.status[static_cast<std::size_t>(variable)] == VariableStatus::kAtLower ||
                          at.status[static_cast<std::size_t>(variable)] == VariableStatus::kAtUpper)) {
      continue;
    }
    const Eigen::Index to = variable >= 0 ? variable : problem.variables() + added;
    const double scale = (variable >= 0 ? at.slopes[variable] : 1) * std::sqrt(share) / *sigma;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      slopes(static_cast<Eigen::Index>(i), to) =
          prediction.derivatives(b)(rows[i], static_cast<Eigen::Index>(c)) * scale;
    }
  }
  if (!slopes.allFinite()) return Matrix(0, columns);
  return slopes;
}

/// Rows of the priors of these parameters, in the columns of BlockSlopes.
Matrix PriorSlopes(const LeastSquares& problem, const Linearization& at, const std::vector<int>& nuisance) {
  Matrix slopes = Matrix::Zero(static_cast<Eigen::Index>(nuisance.size()),
                               problem.variables() + static_cast<Eigen::Index>(nuisance.size()));
  for (std::size_t k = 0; k < nuisance.size(); ++k) {
    const Parameter& p = problem.setup().parameters[static_cast<std::size_t>(nuisance[k])];
    if (!p.prior) continue;
    const double unit = p.scale == Scale::kLog ? at.parameters[nuisance[k]] : 1;
    slopes(static_cast<Eigen::Index>(k), problem.variables() + static_cast<Eigen::Index>(k)) =
        1 / (unit * p.prior->standard_deviation);
  }
  return slopes;
}

/// What rows add about the first n of their columns [n x n] if the values of all others are fitted as well:
/// these are projected out.
Matrix InformationWithout(const Matrix& rows, Eigen::Index n) {
  const Eigen::Index others = rows.cols() - n;
  if (others == 0) return Gram(rows);
  return Gram(ColumnSpace(rows.rightCols(others), kRankTolerance).TakenFrom(rows.leftCols(n)));
}

/// The addition that a block belongs to; nothing if it is no candidate.
std::optional<AdditionName> AdditionOf(const LeastSquares& problem, const Block& block) {
  switch (block.role) {
    case BlockRole::kTrain:
      return std::nullopt;
    case BlockRole::kValidate:
      return AdditionName{AdditionKind::kTrial, block.trial};
    case BlockRole::kPredicted:
      if (FittedSamples(problem, block.trial) > 0) return AdditionName{AdditionKind::kChannel, block.channel};
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

Result<std::vector<Addition>> PossibleAdditions(const LeastSquares& problem, const Linearization& at,
                                                const Noise& noise) {
  const Layout& layout = problem.problem().layout();
  std::vector<std::optional<AdditionName>> addition_of;
  std::vector<bool> wanted;
  for (const Block& block : layout) {
    addition_of.push_back(AdditionOf(problem, block));
    wanted.push_back(addition_of.back().has_value());
  }
  std::vector<Addition> additions;
  if (std::find(wanted.begin(), wanted.end(), true) == wanted.end()) return additions;

  LeastSquares::Workspace workspace = problem.NewWorkspace();
  SINEW_TRY(problem.problem().Predict({at.parameters, wanted, true, nullptr}, *workspace.problem,
                                      workspace.prediction));
  for (std::size_t first = 0; first < layout.size(); ++first) {
    const auto is_known = [&](const Addition& a) { return a.name == *addition_of[first]; };
    if (!wanted[first] || std::any_of(additions.begin(), additions.end(), is_known)) continue;
    const AdditionName& name = *addition_of[first];
    const std::vector<int> nuisance = NuisanceAddedBy(problem, name);
    Matrix rows = PriorSlopes(problem, at, nuisance);
    for (std::size_t b = first; b < layout.size(); ++b) {
      if (!wanted[b] || !(*addition_of[b] == name)) continue;
      const Matrix more =
          BlockSlopes(problem, at, noise, static_cast<int>(b), nuisance, workspace.prediction);
      rows.conservativeResize(rows.rows() + more.rows(), Eigen::NoChange);
      rows.bottomRows(more.rows()) = more;
    }
    additions.push_back({name, InformationWithout(rows, problem.variables())});
  }
  return additions;
}

Matrix FittedInformation(const Linearization& at, const Noise& noise) {
  Matrix white = noise.deviation.cwiseInverse().asDiagonal() * at.jacobian;
  for (std::size_t v = 0; v < at.status.size(); ++v) {
    if (at.status[v] != VariableStatus::kInside) white.col(static_cast<Eigen::Index>(v)).setZero();
  }
  return Gram(white);
}

Vector StandardErrors(const Matrix& information) {
  const Eigen::Index n = information.rows();
  const Vector norm = information.diagonal().cwiseMax(0).cwiseSqrt();
  Matrix scaled = Matrix::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      if (norm[i] > 0 && norm[j] > 0) scaled(i, j) = information(i, j) / norm[i] / norm[j];
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scaled);
  Vector variance = Vector::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool lost = !(eigen.eigenvalues()[i] > kLostEigenvalue * eigen.eigenvalues()[n - 1]);
    for (Eigen::Index j = 0; j < n; ++j) {
      const double loading = eigen.eigenvectors()(j, i);
      if (!lost) {
        variance[j] += loading * loading / eigen.eigenvalues()[i];
      } else if (std::abs(loading) > kTakesPart) {
        variance[j] = kInfinity;
      }
    }
  }
  Vector errors(n);
  for (Eigen::Index j = 0; j < n; ++j) errors[j] = norm[j] > 0 ? std::sqrt(variance[j]) / norm[j] : kInfinity;
  return errors;
}

RemedyFinder::RemedyFinder(const LeastSquares& problem, const Linearization& at, const Noise& noise,
                           double quantile)
    : problem_(problem), at_(at), quantile_(quantile), base_(FittedInformation(at, noise)) {
  Result<std::vector<Addition>> additions = PossibleAdditions(problem, at, noise);
  if (!additions) {
    failure_ = additions.error().message;
    return;
  }
  additions_ = std::move(*additions);
  for (const Addition& addition : additions_) {
    errors_with_.push_back(StandardErrors(base_ + addition.information));
  }
}

bool RemedyFinder::Fixes(int variable, double error) const {
  if (!std::isfinite(error)) return false;
  const Parameter& parameter = at_.parameter(problem_, variable);
  const double value = at_.parameters[problem_.setup().free[static_cast<std::size_t>(variable)]];
  return !IsWide(parameter, value, LinearInterval(problem_, at_.x, variable, quantile_ * error));
}

std::vector<RemedyOption> RemedyFinder::Best(int variable, std::vector<Choice> choices) const {
  std::stable_sort(choices.begin(), choices.end(),
                   [](const Choice& a, const Choice& b) { return a.error < b.error; });
  choices.resize(std::min(choices.size(), kMaxChoices));
  std::vector<RemedyOption> options;
  for (Choice& choice : choices)
    options.push_back({std::move(choice.additions), choice.error * at_.slopes[variable]});
  return options;
}

std::vector<RemedyFinder::Choice> RemedyFinder::KnownValues(int variable) const {
  std::vector<Choice> choices;
  for (const int other : at_.reported) {
    if (other == variable) continue;
    Matrix information = base_;
    information.row(other).setZero();
    information.col(other).setZero();
    const double error = StandardErrors(information)[variable];
    if (Fixes(variable, error)) {
      choices.push_back({{{AdditionKind::kKnownValue, at_.parameter(problem_, other).name}}, error});
    }
  }
  return choices;
}

Remedy RemedyFinder::For(int variable) const {
  if (!failure_.empty()) return {RemedyKind::kNotPredicted, {}, failure_};
  if (Fixes(variable, StandardErrors(base_)[variable])) return {RemedyKind::kIndependentNoise};
  std::vector<Choice> choices;
  for (std::size_t a = 0; a < additions_.size(); ++a) {
    const double error = errors_with_[a][variable];
    if (Fixes(variable, error)) choices.push_back({{additions_[a].name}, error});
  }
  if (!choices.empty()) return {RemedyKind::kAdditions, Best(variable, std::move(choices))};
  for (std::size_t a = 0; additions_.size() <= kMaxForPairs && a < additions_.size(); ++a) {
    for (std::size_t b = a + 1; b < additions_.size(); ++b) {
      const Matrix both = base_ + additions_[a].information + additions_[b].information;
      const double error = StandardErrors(both)[variable];
      if (Fixes(variable, error)) choices.push_back({{additions_[a].name, additions_[b].name}, error});
    }
  }
  if (!choices.empty()) return {RemedyKind::kAdditions, Best(variable, std::move(choices))};
  return {RemedyKind::kNoChannel, Best(variable, KnownValues(variable))};
}

}  // namespace sinew::uncertainty
