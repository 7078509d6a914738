#include "identify/diagnosis/score/design.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/column_space.h"

namespace sinew::diagnosis {
namespace {

constexpr double kWellSized =
    2.5;  // accepted ratio of a secant's length to kDetectableLength, or its inverse
constexpr int kSecantTries = 12;
constexpr double kSingularBase = 1e-8;
constexpr double kSameAsKnown = 0.97;  // correlation: a declared class
constexpr double kCompensated = 1e-6;  // share of a column outside the span of the base: they do the same

// Predicts at points near one point, and turns predictions into rows of the training blocks.
class Rows {
 public:
  explicit Rows(const LeastSquares& fit) : fit_(fit), workspace_(fit.NewWorkspace()) {
    wanted_.assign(fit.problem().layout().size(), false);
    for (const auto& train : fit.train_blocks()) {
      wanted_[static_cast<std::size_t>(train.block)] = true;
      rows_ = train.first_row + block(train.block).samples();
    }
  }

  [[nodiscard]] const Block& block(int b) const {
    return fit_.problem().layout()[static_cast<std::size_t>(b)];
  }

  Status Predict(const Vector& point, const std::vector<bool>* differentiate) {
    return fit_.problem().Predict({point, wanted_, differentiate != nullptr, differentiate},
                                  *workspace_.problem, workspace_.prediction);
  }

  /// Weighted predictions [m] of the last call.
  [[nodiscard]] Vector Values() const {
    Vector rows(rows_);
    for (const auto& train : fit_.train_blocks()) {
      const Block& b = block(train.block);
      const auto values = workspace_.prediction.values(train.block);
      for (int i = 0; i < b.samples(); ++i)
        rows[train.first_row + i] =
            b.WeightOf(static_cast<std::size_t>(i)) * values[b.sample[static_cast<std::size_t>(i)]];
    }
    return rows;
  }

  /// Weighted derivative [m] for a parameter of the last call; zero in blocks that do not depend on it.
  [[nodiscard]] Vector Derivative(int parameter) const {
    Vector rows = Vector::Zero(rows_);
    for (const auto& train : fit_.train_blocks()) {
      const Block& b = block(train.block);
      const auto found = std::lower_bound(b.columns.begin(), b.columns.end(), parameter);
      if (found == b.columns.end() || *found != parameter) continue;
      const auto column = workspace_.prediction.derivatives(train.block).col(found - b.columns.begin());
      for (int i = 0; i < b.samples(); ++i)
        rows[train.first_row + i] =
            b.WeightOf(static_cast<std::size_t>(i)) * column[b.sample[static_cast<std::size_t>(i)]];
    }
    return rows;
  }

 private:
  const LeastSquares& fit_;
  LeastSquares::Workspace workspace_;
  std::vector<bool> wanted_;
  int rows_ = 0;
};

double WhitenedNorm(const LeastSquares& fit, const noise::Whitening& whitening, Vector rows) {
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const auto& train = fit.train_blocks()[t];
    const int n = fit.problem().layout()[static_cast<std::size_t>(train.block)].samples();
    whitening.Apply(static_cast<int>(t), rows.segment(train.first_row, n));
  }
  return rows.norm();
}

class DesignMaker {
 public:
  DesignMaker(const LeastSquares& fit, const Vector& x, const std::vector<Candidate>& candidates,
              const noise::Whitening& whitening, ScoredCandidates which)
      : fit_(fit),
        candidates_(candidates),
        whitening_(whitening),
        which_(which),
        rows_(fit),
        point_(fit.Parameters(x)) {}

  Result<Design> Make(const Vector& x) {
    Design design;
    design.x = x;
    auto workspace = fit_.NewWorkspace();
    SparseJacobian jacobian = fit_.NewJacobian();
    SINEW_TRY(fit_.Evaluate(x, workspace, design.residual, &jacobian));
    design.base = jacobian.Dense(fit_.residuals(), fit_.variables());
    const Vector gradient = design.base.transpose() * design.residual;
    for (Eigen::Index v = 0; v < x.size(); ++v) {
      if ((x[v] <= 0 && gradient[v] >= 0) || (x[v] >= 1 && gradient[v] <= 0)) {
        design.at_bound.emplace_back(v, design.base.col(v));
        design.base.col(v).setZero();
      }
    }
    SINEW_TRY(rows_.Predict(point_, nullptr));
    at_null_ = rows_.Values();
    // Priors and ranges have rows too. Candidates do not change priors; the change of a ranged prediction by
    // a candidate is left out of the scores, and counted in full when the candidate is refitted.
    height_ = design.residual.size();

    std::size_t most_probes = 1;
    for (const Candidate& candidate : candidates_)
      most_probes = std::max(most_probes, candidate.probes.size());
    for (std::size_t probe = 0; probe < most_probes; ++probe) AddDerivatives(probe);
    for (std::size_t c = 0; c < candidates_.size(); ++c) AddSecants(static_cast<int>(c));
    AddDrifts(design.base);

    Order();
    design.candidates.resize(height_, static_cast<Eigen::Index>(made_.size()));
    for (std::size_t k = 0; k < made_.size(); ++k) {
      design.candidates.col(static_cast<Eigen::Index>(k)) = made_[k].rows;
      design.columns.push_back(made_[k].column);
    }
    return design;
  }

 private:
  struct Made {
    DesignColumn column;
    Vector rows;
  };

  // A candidate that the fit has released already is not scored again.
  [[nodiscard]] bool IsReleased(const Candidate& candidate) const {
    return std::any_of(candidate.parameters.begin(), candidate.parameters.end(),
                       [&](int index) { return fit_.setup().IsFree(index); });
  }

  [[nodiscard]] const Parameter& parameter(int index) const {
    return fit_.setup().parameters[static_cast<std::size_t>(index)];
  }

  void Add(int candidate, std::size_t probe, int index, const Vector& rows) {
    if (!rows.allFinite()) return;
    const Parameter& p = parameter(index);
    Made made;
    made.column = {candidate, static_cast<int>(probe), index, p.null_value <= p.lower,
                   p.null_value >= p.upper};
    made.rows = Vector::Zero(height_);
    made.rows.head(rows.size()) = rows;
    made_.push_back(std::move(made));
  }

  // Derivatives of all candidates with such a probe in one prediction: at their nulls they do not influence
  // each other.
  void AddDerivatives(std::size_t probe) {
    Vector point = point_;
    std::vector<bool> differentiate(fit_.setup().parameters.size(), false);
    std::vector<std::pair<int, int>> wanted;  // candidate, parameter
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      const Candidate& candidate = candidates_[c];
      if (probe >= candidate.probes.size() || IsScoredBySecant(candidate, probe)) continue;
      if (IsReleased(candidate)) continue;
      if (candidate.beside_causes && which_ == ScoredCandidates::kTested) continue;
      for (const auto& [index, value] : candidate.probes[probe].at) point[index] = value;
      for (const int index : ScoredParameters(candidate, probe)) {
        if (parameter(index).null_step > 0) continue;
        differentiate[static_cast<std::size_t>(index)] = true;
        wanted.emplace_back(static_cast<int>(c), index);
      }
    }
    if (wanted.empty() || !rows_.Predict(point, &differentiate)) return;
    for (const auto& [c, index] : wanted) Add(c, probe, index, rows_.Derivative(index));
  }

  // Change of the weighted predictions from the null of a parameter to `value`, per unit; empty if the
  // prediction fails or does not change.
  Vector Secant(Vector point, int index, double value) {
    point[index] = value;
    if (!rows_.Predict(point, nullptr)) return {};
    const Vector change = rows_.Values() - at_null_;
    if (!change.allFinite() || change.cwiseAbs().maxCoeff() == 0) return {};
    return change / (value - parameter(index).null_value);
  }

  void AddSecants(int c) {
    const Candidate& candidate = candidates_[static_cast<std::size_t>(c)];
    if (IsReleased(candidate)) return;
    for (std::size_t probe = 0; probe < candidate.probes.size(); ++probe) {
      Vector point = point_;
      if (IsScoredBySecant(candidate, probe)) {
        const auto& [index, value] = candidate.probes[probe].at.front();
        const Vector rows = Secant(point, index, value);
        if (rows.size() > 0) Add(c, probe, index, rows);
        continue;
      }
      for (const auto& [index, value] : candidate.probes[probe].at) point[index] = value;
      for (const int index : ScoredParameters(candidate, probe)) {
        if (parameter(index).null_step > 0) AddSizedSecant(c, probe, index, point);
      }
    }
  }

  // A secant whose trace is about as long as the shortest one that can be detected: shorter ones are
  // dominated by the noise of the cost at the kink, longer ones by nonlinearity.
  void AddSizedSecant(int c, std::size_t probe, int index, const Vector& point) {
    const Parameter& p = parameter(index);
    const double direction = p.null_value < p.upper ? 1 : -1;
    const double reach = direction > 0 ? p.upper - p.null_value : p.null_value - p.lower;
    double step = std::min(p.null_step, reach);
    Vector best;
    for (int i = 0; i < kSecantTries; ++i) {
      const Vector rows = Secant(point, index, p.null_value + direction * step);
      if (rows.size() > 0) best = rows;
      const double norm = rows.size() > 0 ? step * WhitenedNorm(fit_, whitening_, rows) : 0;
      if (norm > kDetectableLength / kWellSized && norm < kDetectableLength * kWellSized) break;
      const double next =
          norm > 0 ? step * std::clamp(kDetectableLength / norm, 0.1, 10.0) : std::min(4 * step, reach);
      if (!(next > 0) || next > reach || next == step) break;
      step = next;
    }
    if (best.size() > 0) Add(c, probe, index, best);
  }

  // Drifts of parameters that are free; and of those that are not because a constant change of them does what
  // the free ones can do (the gain of a drive of unknown scale): their change with time is something else.
  void AddDrifts(const Matrix& base) {
    const std::vector<bool> held = HeldThatDrift(base);
    std::vector<bool> differentiate = held;
    for (const Candidate& candidate : candidates_) {
      if (candidate.drifting >= 0 && fit_.setup().IsFree(candidate.drifting))
        differentiate[static_cast<std::size_t>(candidate.drifting)] = true;
    }
    const bool any = std::find(differentiate.begin(), differentiate.end(), true) != differentiate.end();
    if (!any || !rows_.Predict(point_, &differentiate)) return;
    Vector time = Vector::Zero(rows_.Values().size());
    for (const auto& train : fit_.train_blocks()) {
      const Block& block = rows_.block(train.block);
      time.segment(train.first_row, block.samples()) = TimeInTrial(block);
    }
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      const int index = candidates_[c].drifting;
      if (index < 0 || !differentiate[static_cast<std::size_t>(index)]) continue;
      const Vector rows = rows_.Derivative(index).cwiseProduct(time);
      if (!(rows.norm() > 0)) continue;
      if (held[static_cast<std::size_t>(index)] && IsKnown(rows, base)) continue;
      Add(static_cast<int>(c), 0, index, rows);
    }
  }

  // Whether an effect of the library, one number, does the same off the span of the base (supply_sag is the
  // drift of a drive's gain): then the drift has its name, and is no second finding.
  [[nodiscard]] bool IsKnown(const Vector& rows, const Matrix& base) const {
    std::vector<const Made*> known;
    for (const Made& made : made_) {
      const Candidate& candidate = candidates_[static_cast<std::size_t>(made.column.candidate)];
      if (candidate.primary() && candidate.drifting < 0) known.push_back(&made);
    }
    Matrix columns = Matrix::Zero(height_, static_cast<Eigen::Index>(known.size()) + 1);
    columns.col(0).head(rows.size()) = rows;
    for (std::size_t k = 0; k < known.size(); ++k)
      columns.col(static_cast<Eigen::Index>(k) + 1) = known[k]->rows;
    const Matrix left = ColumnSpace(base, kSingularBase).TakenFrom(columns);
    const double length = left.col(0).norm();
    for (Eigen::Index k = 1; k < left.cols(); ++k) {
      if (std::abs(left.col(0).dot(left.col(k))) > kSameAsKnown * length * left.col(k).norm()) return true;
    }
    return false;
  }

  // [parameters] Held ones among the drifts whose derivative lies in the span of the base.
  [[nodiscard]] std::vector<bool> HeldThatDrift(const Matrix& base) {
    const std::size_t count = fit_.setup().parameters.size();
    std::vector<bool> drift(count, false);
    std::vector<int> held;
    for (const Candidate& candidate : candidates_) {
      const int index = candidate.drifting;
      if (index >= 0 && !fit_.setup().IsFree(index) && !(parameter(index).null_step > 0))
        held.push_back(index);
    }
    if (held.empty()) return drift;
    Matrix columns = Matrix::Zero(height_, static_cast<Eigen::Index>(held.size()));
    for (std::size_t k = 0; k < held.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      // Mostly the effect is a candidate itself, and the column is there already.
      const auto made = std::find_if(made_.begin(), made_.end(),
                                     [&](const Made& m) { return m.column.parameter == held[k]; });
      if (made != made_.end()) {
        columns.col(at) = made->rows;
        continue;
      }
      std::vector<bool> one(count, false);
      one[static_cast<std::size_t>(held[k])] = true;
      if (!rows_.Predict(point_, &one)) continue;
      const Vector derivative = rows_.Derivative(held[k]);
      columns.col(at).head(derivative.size()) = derivative;
    }
    const Vector before = columns.colwise().norm();
    const Vector left = ColumnSpace(base, kSingularBase).TakenFrom(columns).colwise().norm();
    for (std::size_t k = 0; k < held.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      drift[static_cast<std::size_t>(held[k])] = before[at] > 0 && left[at] <= kCompensated * before[at];
    }
    return drift;
  }

  // Sorts the columns by candidate and probe.
  void Order() {
    std::stable_sort(made_.begin(), made_.end(), [](const Made& a, const Made& b) {
      return std::pair(a.column.candidate, a.column.probe) < std::pair(b.column.candidate, b.column.probe);
    });
  }

  const LeastSquares& fit_;
  const std::vector<Candidate>& candidates_;
  const noise::Whitening& whitening_;
  ScoredCandidates which_;
  Rows rows_;
  Vector point_;
  Vector at_null_;
  Eigen::Index height_ = 0;
  std::vector<Made> made_;
};

}  // namespace

Result<NoiseRows> NoiseRowsAt(const LeastSquares& fit, const Vector& x) {
  auto workspace = fit.NewWorkspace();
  SparseJacobian jacobian = fit.NewJacobian();
  Vector residuals;
  SINEW_TRY(fit.Evaluate(x, workspace, residuals, &jacobian));
  NoiseRows rows;
  for (std::size_t t = 0; t < fit.train_blocks().size(); ++t) {
    const auto& train = fit.train_blocks()[t];
    const Block& block = fit.problem().layout()[static_cast<std::size_t>(train.block)];
    noise::NoiseBlock noise;
    noise.channel = block.channel;
    noise.residual = residuals.segment(train.first_row, block.samples());
    noise.regressors = jacobian.pieces[t].values;
    noise.columns = jacobian.pieces[t].variables;
    noise.stretches = noise::Stretches(block);
    if (block.sigma) noise.stated = block.weight * *block.sigma;
    noise.white = block.white;
    noise.largest_root = noise::LargestRoot(block);
    rows.blocks.push_back(std::move(noise));
  }
  const std::vector<int> priors = fit.PriorVariables();
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const SparseJacobian::Piece& piece = jacobian.pieces[fit.train_blocks().size() + i];
    rows.priors.push_back({priors[i], piece.values(0, 0), residuals[piece.first_row]});
  }
  return rows;
}

Result<Design> MakeDesign(const LeastSquares& fit, const Vector& x, const std::vector<Candidate>& candidates,
                          const noise::Whitening& whitening, ScoredCandidates which) {
  return DesignMaker(fit, x, candidates, whitening, which).Make(x);
}

}  // namespace sinew::diagnosis
