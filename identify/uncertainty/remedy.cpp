#include "identify/uncertainty/remedy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/constants.h"
#include "base/decompositions.h"
#include "base/text.h"
#include "identify/uncertainty/interval.h"
#include "identify/uncertainty/verdict.h"

namespace sinew {
namespace {

// Above this many additions, pairs of them cost more than they are worth.
constexpr std::size_t kMaxForPairs = 12;
// More than three ways to fix one parameter only bore.
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

/// What one block would add, [n x n] in the unit box.
Matrix BlockInformation(const LeastSquares& problem, const Linearization& at, const Noise& noise, int b,
                        const Prediction& prediction) {
  const Block& block = BlockOf(problem, b);
  Matrix information = Matrix::Zero(problem.variables(), problem.variables());
  const std::optional<double> sigma = AssumedSigma(block, noise, prediction.values(b));
  if (!sigma) return information;
  std::vector<int> rows = block.sample;
  double share = 1;  // of the samples that count
  if (rows.empty()) {
    for (int i = 0; i < block.predictions(); ++i) rows.push_back(i);
    const int samples = FittedSamples(problem, block.trial);
    share = std::min(1.0, static_cast<double>(samples) / block.predictions());
  }
  Matrix slopes = Matrix::Zero(static_cast<Eigen::Index>(rows.size()), problem.variables());
  for (std::size_t c = 0; c < block.columns.size(); ++c) {
    const auto& free = problem.setup().free;
    const auto found = std::lower_bound(free.begin(), free.end(), block.columns[c]);
    if (found == free.end() || *found != block.columns[c]) continue;
    const auto variable = static_cast<int>(found - free.begin());
    if (at.status[static_cast<std::size_t>(variable)] == VariableStatus::kAtLower ||
        at.status[static_cast<std::size_t>(variable)] == VariableStatus::kAtUpper) {
      continue;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      slopes(static_cast<Eigen::Index>(i), variable) =
          prediction.derivatives(b)(rows[i], static_cast<Eigen::Index>(c)) * at.slopes[variable] / *sigma;
    }
  }
  if (!slopes.allFinite()) return information;
  information = share * slopes.transpose() * slopes;
  return information;
}

/// The phrase that a block belongs to; empty if it is no candidate.
std::string PhraseOf(const LeastSquares& problem, const Block& block) {
  switch (block.role) {
    case BlockRole::kTrain:
      return {};
    case BlockRole::kValidate:
      return fmt::format("fitting trial {} too", block.trial);
    case BlockRole::kPredicted:
      return FittedSamples(problem, block.trial) > 0 ? fmt::format("measuring {}", block.channel)
                                                     : std::string{};
  }
  return {};
}

}  // namespace

Result<std::vector<Addition>> PossibleAdditions(const LeastSquares& problem, const Linearization& at,
                                                const Noise& noise) {
  const Layout& layout = problem.problem().layout();
  std::vector<std::string> phrase_of;
  std::vector<bool> wanted;
  for (const Block& block : layout) {
    phrase_of.push_back(PhraseOf(problem, block));
    wanted.push_back(!phrase_of.back().empty());
  }
  std::vector<Addition> additions;
  if (std::find(wanted.begin(), wanted.end(), true) == wanted.end()) return additions;

  LeastSquares::Workspace workspace = problem.NewWorkspace();
  SINEW_TRY(problem.problem().Predict({at.parameters, wanted, true, nullptr}, *workspace.problem,
                                      workspace.prediction));
  for (std::size_t b = 0; b < layout.size(); ++b) {
    if (!wanted[b]) continue;
    const Matrix information =
        BlockInformation(problem, at, noise, static_cast<int>(b), workspace.prediction);
    const auto same = std::find_if(additions.begin(), additions.end(),
                                   [&](const Addition& a) { return a.phrase == phrase_of[b]; });
    if (same == additions.end()) {
      additions.push_back({phrase_of[b], information});
    } else {
      same->information += information;
    }
  }
  return additions;
}

Matrix FittedInformation(const Linearization& at, const Noise& noise) {
  Matrix white = noise.deviation.cwiseInverse().asDiagonal() * at.jacobian;
  for (std::size_t v = 0; v < at.status.size(); ++v) {
    if (at.status[v] != VariableStatus::kInside) white.col(static_cast<Eigen::Index>(v)).setZero();
  }
  return white.transpose() * white;
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

std::string RemedyFinder::ErrorInUnits(int variable, double error) const {
  const std::string& unit = at_.parameter(problem_, variable).unit;
  return fmt::format("{:.2g}{}{}", error * at_.slopes[variable], unit == "1" ? "" : " ",
                     unit == "1" ? "" : unit);
}

std::string RemedyFinder::Sentence(int variable, std::vector<Choice> choices) const {
  std::stable_sort(choices.begin(), choices.end(),
                   [](const Choice& a, const Choice& b) { return a.error < b.error; });
  choices.resize(std::min(choices.size(), kMaxChoices));
  std::string sentence = fmt::format("{} would fix it (standard error {})", choices.front().phrase,
                                     ErrorInUnits(variable, choices.front().error));
  for (std::size_t i = 1; i < choices.size(); ++i) {
    sentence += fmt::format("{} {} ({})", i == 1 ? "; so would" : " or", choices[i].phrase,
                            ErrorInUnits(variable, choices[i].error));
  }
  return sentence;
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
      choices.push_back({fmt::format("a known value of {}", at_.parameter(problem_, other).name), error});
    }
  }
  return choices;
}

std::string RemedyFinder::For(int variable) const {
  if (!failure_.empty()) {
    return fmt::format("what other channels would bring could not be predicted: {}", failure_);
  }
  if (Fixes(variable, StandardErrors(base_)[variable])) {
    return "its error would be small if the residuals were independent noise: explain what is left in them "
           "first";
  }
  std::vector<Choice> choices;
  for (std::size_t a = 0; a < additions_.size(); ++a) {
    const double error = errors_with_[a][variable];
    if (Fixes(variable, error)) choices.push_back({additions_[a].phrase, error});
  }
  if (!choices.empty()) return Sentence(variable, std::move(choices));
  for (std::size_t a = 0; additions_.size() <= kMaxForPairs && a < additions_.size(); ++a) {
    for (std::size_t b = a + 1; b < additions_.size(); ++b) {
      const Matrix both = base_ + additions_[a].information + additions_[b].information;
      const double error = StandardErrors(both)[variable];
      if (!Fixes(variable, error)) continue;
      choices.push_back(
          {fmt::format("{} and {} together", additions_[a].phrase, additions_[b].phrase), error});
    }
  }
  if (!choices.empty()) return Sentence(variable, std::move(choices));
  std::string sentence = "no channel that this model predicts would fix it in these trials";
  choices = KnownValues(variable);
  if (!choices.empty()) sentence += "; " + Sentence(variable, std::move(choices));
  return sentence;
}

}  // namespace sinew
