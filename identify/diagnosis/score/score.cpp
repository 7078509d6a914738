#include "identify/diagnosis/score/score.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/column_space.h"
#include "base/decompositions.h"
#include "identify/statistics/distributions.h"

namespace sinew::diagnosis {
namespace {

constexpr double kNothingLeft =
    1e-3;  // share of a column outside the span of the base, below which it counts as zero
constexpr int kUnknownDirections = 5;  // principal components per smooth curve: more of them reduce the power
constexpr double kSecondaryWeight =
    5;  // discrepancy terms and single-trial effects share a fifth of the level
// A curve with at least this many knots is also scored in windows of its signal, because the score of the
// whole curve has little power for a local error.
constexpr std::size_t kFineKnots = 16;
constexpr std::array<double, 3> kWindows{0.5, 1, 2};  // standard deviations, in knots
constexpr double kWindowWeight = 25;
constexpr double kSingular = 1e-8;

void WhitenAll(const LeastSquares& fit, const noise::Whitening* whitening, const Vector& scale,
               Matrix& rows) {
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const auto& train = fit.train_blocks()[t];
    const int n = fit.problem().layout()[static_cast<std::size_t>(train.block)].samples();
    auto block = rows.middleRows(train.first_row, n);
    if (whitening != nullptr) {
      whitening->Apply(static_cast<int>(t), block);
    } else {
      block *= scale[static_cast<Eigen::Index>(t)];
    }
  }
}

// Scale without whitening: one over the residual's standard deviation per channel, so that channels can be
// added.
Vector PlainScale(const LeastSquares& fit, const Vector& residual) {
  const auto& blocks = fit.train_blocks();
  Vector scale(static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t t = 0; t < blocks.size(); ++t) {
    double sum = 0;
    double count = 0;
    for (const auto& other : blocks) {
      const Block& a = fit.problem().layout()[static_cast<std::size_t>(blocks[t].block)];
      const Block& b = fit.problem().layout()[static_cast<std::size_t>(other.block)];
      if (a.channel != b.channel) continue;
      sum += residual.segment(other.first_row, b.samples()).squaredNorm();
      count += b.samples();
    }
    scale[static_cast<Eigen::Index>(t)] = sum > 0 ? std::sqrt(count / sum) : 0;
  }
  return scale;
}

// Predicted drop of the squared residual for a set of directions; a single one-sided direction counts only if
// t > 0.
double Drop(const ScoreTable& table, const std::vector<int>& which) {
  if (which.size() == 1) {
    const auto i = static_cast<std::size_t>(which.front());
    const double t = table.t[which.front()];
    return table.positive[i] && t < 0 ? 0 : t * t;
  }
  const auto n = static_cast<Eigen::Index>(which.size());
  Matrix gram(n, n);
  Vector t(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    t[i] = table.t[which[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < n; ++j)
      gram(i, j) = table.correlation(which[static_cast<std::size_t>(i)], which[static_cast<std::size_t>(j)]);
  }
  return t.dot(MinimumNormSolution(gram, t));
}

class TableMaker {
 public:
  TableMaker(const LeastSquares& fit, const Design& design, const std::vector<Candidate>& candidates,
             const noise::Whitening* whitening)
      : design_(design), candidates_(candidates) {
    const Vector scale = whitening == nullptr ? PlainScale(fit, design.residual) : Vector();
    residual_ = design.residual;
    base_ = design.base;
    columns_ = design.candidates;
    WhitenAll(fit, whitening, scale, residual_);
    WhitenAll(fit, whitening, scale, base_);
    WhitenAll(fit, whitening, scale, columns_);
  }

  ScoreTable Make() {
    const Vector before = columns_.colwise().norm();
    ProjectOutBase();
    const auto count = columns_.cols();
    table_.length = columns_.colwise().norm();
    table_.kept = Vector::Zero(count);
    table_.estimate = Vector::Zero(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      if (before[k] > 0) table_.kept[k] = table_.length[k] / before[k];
      if (!(table_.kept[k] > kNothingLeft)) table_.length[k] = 0;
      // The sign is negative because the residual is predicted minus measured.
      if (table_.length[k] > 0)
        table_.estimate[k] = -columns_.col(k).dot(residual_.col(0)) / (table_.length[k] * table_.length[k]);
    }
    for (Eigen::Index first = 0; first < count;) {
      Eigen::Index end = first;
      while (end < count && SameGroup(first, end)) ++end;
      AddGroup(static_cast<int>(first), static_cast<int>(end));
      first = end;
    }
    Finish();
    return std::move(table_);
  }

 private:
  [[nodiscard]] bool SameGroup(Eigen::Index a, Eigen::Index b) const {
    const DesignColumn& x = design_.columns[static_cast<std::size_t>(a)];
    const DesignColumn& y = design_.columns[static_cast<std::size_t>(b)];
    return x.candidate == y.candidate && x.probe == y.probe;
  }

  void ProjectOutBase() {
    const ColumnSpace base(base_, kSingular);
    residual_ = base.TakenFrom(residual_);
    columns_ = base.TakenFrom(columns_);
  }

  void AddGroup(int first, int end) {
    const DesignColumn& column = design_.columns[static_cast<std::size_t>(first)];
    const Candidate& candidate = candidates_[static_cast<std::size_t>(column.candidate)];
    Score score;
    score.candidate = column.candidate;
    score.probe = column.probe;
    score.weight = candidate.primary() ? 1 : kSecondaryWeight;
    for (int k = first; k < end; ++k) {
      if (table_.length[k] > 0) score.columns.push_back(k);
    }
    if (score.columns.empty()) return;
    if (candidate.known) {
      for (const int k : score.columns) {
        const DesignColumn& one = design_.columns[static_cast<std::size_t>(k)];
        const double sign = one.negative ? -1 : 1;
        const bool alone = score.columns.size() == 1;
        AddDirection(score, sign * columns_.col(k) / table_.length[k],
                     alone && (one.positive || one.negative));
      }
    } else {
      AddSmoothDirections(score);
      if (score.columns.size() >= kFineKnots) AddWindows(score);
    }
    table_.scores.push_back(std::move(score));
  }

  void AddWindows(const Score& whole) {
    const auto knots = static_cast<int>(whole.columns.size());
    for (const double width : kWindows) {
      for (int centre = 0; centre < knots; ++centre) {
        Vector window = Vector::Zero(columns_.rows());
        for (int k = 0; k < knots; ++k) {
          const double away = (k - centre) / width;
          if (std::abs(away) < 3)
            window += std::exp(-0.5 * away * away) * columns_.col(whole.columns[static_cast<std::size_t>(k)]);
        }
        const double length = window.norm();
        if (!(length > 0)) continue;
        Score score;
        score.candidate = whole.candidate;
        score.probe = whole.probe;
        score.columns = whole.columns;
        score.weight = kWindowWeight;
        score.searched = 2;
        AddDirection(score, window / length, false);
        table_.scores.push_back(std::move(score));
      }
    }
  }

  // Keeps the smooth curves, which contain most of a detectable error; rough ones are mostly noise.
  void AddSmoothDirections(Score& score) {
    Matrix basis(columns_.rows(), static_cast<Eigen::Index>(score.columns.size()));
    for (std::size_t k = 0; k < score.columns.size(); ++k)
      basis.col(static_cast<Eigen::Index>(k)) = columns_.col(score.columns[k]);
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Gram(basis));
    const auto last = eigen.eigenvalues().size() - 1;
    for (Eigen::Index i = 0; i <= std::min<Eigen::Index>(last, kUnknownDirections - 1); ++i) {
      const double value = eigen.eigenvalues()[last - i];
      if (!(value > kSingular * eigen.eigenvalues()[last])) break;
      AddDirection(score, basis * eigen.eigenvectors().col(last - i) / std::sqrt(value), false);
    }
  }

  void AddDirection(Score& score, Vector direction, bool positive) {
    score.directions.push_back(static_cast<int>(made_.size()));
    made_.push_back(std::move(direction));
    table_.positive.push_back(positive);
  }

  void Finish() {
    table_.directions.resize(columns_.rows(), static_cast<Eigen::Index>(made_.size()));
    for (std::size_t i = 0; i < made_.size(); ++i)
      table_.directions.col(static_cast<Eigen::Index>(i)) = made_[i];
    table_.t = -(table_.directions.transpose() * residual_.col(0));
    table_.correlation = Gram(table_.directions);
    for (Score& score : table_.scores) {
      score.statistic = Drop(table_, score.directions);
      score.p_value =
          statistics::GroupPValue(table_.correlation, table_.t, {score.directions, IsPositive(score), 1});
    }
  }

  [[nodiscard]] bool IsPositive(const Score& score) const {
    return score.directions.size() == 1 &&
           table_.positive[static_cast<std::size_t>(score.directions.front())];
  }

  const Design& design_;
  const std::vector<Candidate>& candidates_;
  Matrix residual_;
  Matrix base_;
  Matrix columns_;
  std::vector<Vector> made_;
  ScoreTable table_;
};

// An orthonormal basis of the span of some directions, in terms of all directions [D x rank].
Matrix BasisOf(const ScoreTable& table, const std::vector<int>& which) {
  const auto n = static_cast<Eigen::Index>(which.size());
  Matrix gram(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      gram(i, j) = table.correlation(which[static_cast<std::size_t>(i)], which[static_cast<std::size_t>(j)]);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(gram);
  Matrix basis = Matrix::Zero(table.correlation.rows(), n);
  Eigen::Index rank = 0;
  for (Eigen::Index k = n - 1; k >= 0 && eigen.eigenvalues()[k] > kSingular * eigen.eigenvalues()[n - 1];
       --k) {
    for (Eigen::Index i = 0; i < n; ++i)
      basis(which[static_cast<std::size_t>(i)], rank) =
          eigen.eigenvectors()(i, k) / std::sqrt(eigen.eigenvalues()[k]);
    ++rank;
  }
  return basis.leftCols(rank);
}

}  // namespace

double ScoreTable::Correlation(const Score& a, const Score& b) const {
  const Matrix cross = BasisOf(*this, a.directions).transpose() * correlation * BasisOf(*this, b.directions);
  const Eigen::JacobiSVD<Matrix> svd(cross);
  // The smallest canonical correlation: it is 1 only if every direction of the smaller span lies in the
  // other.
  return svd.singularValues().size() > 0 ? std::min(1.0, svd.singularValues().minCoeff()) : 0;
}

ScoreTable MakeScores(const LeastSquares& fit, const Design& design, const std::vector<Candidate>& candidates,
                      const noise::Whitening* whitening) {
  return TableMaker(fit, design, candidates, whitening).Make();
}

double JointStatistic(const ScoreTable& table, const std::vector<const Score*>& scores) {
  std::vector<int> which;
  for (const Score* score : scores)
    which.insert(which.end(), score->directions.begin(), score->directions.end());
  return which.empty() ? 0 : Drop(table, which);
}

double Family::FamilyPValue(double weighted_p) const {
  return alarm == nullptr ? 1 : alarm->FamilyPValue(weighted_p);
}

Family FamilyOf(const ScoreTable& table, double level, std::uint64_t seed) {
  Family family;
  family.level = level;
  std::vector<statistics::AlarmGroup> groups;
  for (const Score& score : table.scores) {
    const bool positive =
        score.directions.size() == 1 && table.positive[static_cast<std::size_t>(score.directions.front())];
    groups.push_back({score.directions, positive, score.weight});
  }
  if (groups.empty()) return family;
  family.alarm = std::make_shared<const statistics::AlarmLevel>(table.correlation, groups, seed);
  family.smallest_p = family.alarm->Threshold(level);
  family.threshold = statistics::TwoSidedThreshold(family.smallest_p);
  for (const Score& score : table.scores) {
    family.score_p_value.push_back(family.FamilyPValue(std::min(1.0, score.weight * score.p_value)));
    family.p_value = std::min(family.p_value, family.score_p_value.back());
  }
  return family;
}

}  // namespace sinew::diagnosis
