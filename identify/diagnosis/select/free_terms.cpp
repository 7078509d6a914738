#include "identify/diagnosis/select/free_terms.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "base/column_space.h"
#include "base/decompositions.h"
#include "base/linear_basis.h"
#include "identify/diagnosis/score/shortlist.h"

namespace sinew::diagnosis {
namespace {

constexpr int kFineKnots = 24;
constexpr int kParameterKnots = 5;
constexpr double kSingularBase = 1e-8;
constexpr double kSingularTerm = 1e-6;  // eigenvalue of a term's columns, relative to the largest
constexpr double kNothingLeft = 1e-6;   // share of a column's squared length outside the base's span

// Values of one signal at the rows of the training blocks.
struct RowSignal {
  std::vector<double> values;  // [m]; of rows without it 0
  std::vector<bool> known;     // [m]
};

class Comparison {
 public:
  Comparison(const Problem& problem, const std::vector<Candidate>& candidates, const ScoredModel& base,
             const noise::NoiseModel& noise)
      : problem_(problem),
        candidates_(candidates),
        base_(base),
        fit_(problem, *base.refit.setup),
        whitening_(noise, TrainStretches(fit_)),
        space_(Whitened(base.design.base), kSingularBase),
        left_(space_.TakenFrom(Whitened(base.design.residual))) {}

  [[nodiscard]] double left() const { return left_.squaredNorm(); }

  // What unwhitened columns explain, and how many directions of them the base leaves.
  [[nodiscard]] std::pair<double, int> Explained(const Matrix& columns) const {
    Matrix white = Whitened(columns);
    const Vector before = white.colwise().squaredNorm();
    white = space_.TakenFrom(white);
    Matrix kept(white.rows(), white.cols());
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < white.cols(); ++k) {
      const double length = white.col(k).squaredNorm();
      if (length > kNothingLeft * before[k]) kept.col(count++) = white.col(k) / std::sqrt(before[k]);
    }
    if (count == 0) return {0, 0};
    kept.conservativeResize(Eigen::NoChange, count);
    const Matrix gram = kept.transpose() * kept;
    const Vector pull = kept.transpose() * left_;
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(gram);
    double explained = 0;
    int degrees = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const double value = eigen.eigenvalues()[i];
      if (!(value > kSingularTerm * eigen.eigenvalues()[count - 1])) continue;
      explained += std::pow(eigen.eigenvectors().col(i).dot(pull), 2) / value;
      ++degrees;
    }
    return {explained, degrees};
  }

  // To first order, each at the probe with the largest statistic.
  [[nodiscard]] double OfCauses(const std::vector<int>& causes) const {
    std::vector<int> columns;
    for (const int c : causes) {
      const Score* score = base_.BestOf(c);
      if (score != nullptr) columns.insert(columns.end(), score->columns.begin(), score->columns.end());
    }
    return columns.empty() ? 0 : Explained(Columns(columns)).first;
  }

  Result<std::vector<FreeTerm>> FreeTerms() {
    AddCandidates();
    SINEW_TRY(ReadSignals());
    for (const auto& [signal, values] : signals_) {
      for (const std::string& channel : channels_) {
        const Matrix curve = Curve(values, kFineKnots, channel);
        if (curve.cols() > 0) Add(NameOfReading(channel) + "(" + signal + ")", weights_.asDiagonal() * curve);
      }
    }
    const auto& free = base_.refit.setup->free;
    for (std::size_t v = 0; v < free.size(); ++v) {
      const Parameter& p = base_.refit.setup->parameters[static_cast<std::size_t>(free[v])];
      if (p.kind != ParameterKind::kBase) continue;
      const auto column = base_.design.base.col(static_cast<Eigen::Index>(v));
      for (const auto& [signal, values] : signals_) {
        const Matrix curve = Curve(values, kParameterKnots, "");
        if (curve.cols() > 0) Add(p.name + "(" + signal + ")", column.asDiagonal() * curve);
        if (signal != "time") continue;
        const Eigen::Map<const Vector> time(values.values.data(), column.size());
        Add(p.name + "(time)", column.cwiseProduct(time));
      }
    }
    return std::move(terms_);
  }

 private:
  // That of its port, which differs from the channel's where the model has a port of the channel's name.
  [[nodiscard]] std::string NameOfReading(const std::string& channel) const {
    const std::string apart = channel + "_reading";
    const auto& ports = problem_.ports();
    const bool named =
        std::any_of(ports.begin(), ports.end(), [&](const auto& p) { return p.name == apart; });
    return named ? apart : channel;
  }
  [[nodiscard]] Matrix Whitened(Matrix rows) const {
    for (std::size_t t = 0; t < fit_.train_blocks().size(); ++t) {
      const auto& train = fit_.train_blocks()[t];
      whitening_.Apply(static_cast<int>(t), rows.middleRows(train.first_row, block(t).samples()));
    }
    return rows;
  }

  [[nodiscard]] const Block& block(std::size_t t) const {
    return problem_.layout()[static_cast<std::size_t>(fit_.train_blocks()[t].block)];
  }

  [[nodiscard]] Matrix Columns(const std::vector<int>& which) const {
    Matrix columns(base_.design.candidates.rows(), static_cast<Eigen::Index>(which.size()));
    for (std::size_t k = 0; k < which.size(); ++k)
      columns.col(static_cast<Eigen::Index>(k)) = base_.design.candidates.col(which[k]);
    return columns;
  }

  void Add(std::string name, const Matrix& columns) {
    const auto [explained, degrees] = Explained(columns);
    if (degrees > 0) terms_.push_back({std::move(name), explained, degrees});
  }

  void AddCandidates() {
    std::map<int, std::vector<int>> columns;
    for (std::size_t k = 0; k < base_.design.columns.size(); ++k) {
      const int c = base_.design.columns[k].candidate;
      if (!candidates_[static_cast<std::size_t>(c)].known) columns[c].push_back(static_cast<int>(k));
    }
    for (const auto& [c, which] : columns)
      Add(candidates_[static_cast<std::size_t>(c)].effect, Columns(which));
  }

  Status ReadSignals() {
    std::vector<bool> wanted(problem_.layout().size(), false);
    for (const auto& train : fit_.train_blocks()) wanted[static_cast<std::size_t>(train.block)] = true;
    Prediction prediction(problem_.layout());
    const auto workspace = problem_.NewWorkspace();
    SINEW_TRY(problem_.Predict({base_.refit.point, wanted, false, nullptr}, *workspace, prediction));
    weights_ = Vector::Zero(base_.design.residual.size());
    for (std::size_t t = 0; t < fit_.train_blocks().size(); ++t) {
      const Block& of = block(t);
      channels_.insert(of.channel);
      std::vector<double> time;
      std::vector<double> predicted;
      const auto values = prediction.values(fit_.train_blocks()[t].block);
      for (std::size_t i = 0; i < of.sample.size(); ++i) {
        const int at = of.sample[i];
        weights_[fit_.train_blocks()[t].first_row + static_cast<Eigen::Index>(i)] = of.WeightOf(i);
        time.push_back(of.prediction_time[static_cast<std::size_t>(at)] - of.prediction_time.front());
        predicted.push_back(values[at]);
      }
      Read("time", time, t);
      for (const Problem::Signal& signal : problem_.ResidualCovariates(fit_.train_blocks()[t].block)) {
        if (signal.name != "time")
          Read(signal.name, signal.name == of.channel ? predicted : signal.values, t);
      }
    }
    return {};
  }

  void Read(const std::string& name, const std::vector<double>& values, std::size_t t) {
    if (values.size() != static_cast<std::size_t>(block(t).samples())) return;
    RowSignal& signal = signals_[name];
    const auto rows = static_cast<std::size_t>(base_.design.residual.size());
    signal.values.resize(rows, 0);
    signal.known.resize(rows, false);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      const auto row = static_cast<std::size_t>(fit_.train_blocks()[t].first_row) + i;
      signal.values[row] = values[i];
      signal.known[row] = true;
    }
  }

  // Linear basis functions over the signal's range; zero in rows without the signal and in those of other
  // channels (empty: of all). No columns if the signal is constant there.
  [[nodiscard]] Matrix Curve(const RowSignal& signal, int knots, const std::string& channel) const {
    std::vector<std::size_t> rows;
    for (std::size_t t = 0; t < fit_.train_blocks().size(); ++t) {
      const Block& of = block(t);
      if (!channel.empty() && of.channel != channel) continue;
      for (int i = 0; i < of.samples(); ++i) {
        const auto row = static_cast<std::size_t>(fit_.train_blocks()[t].first_row + i);
        if (signal.known[row]) rows.push_back(row);
      }
    }
    const auto height = static_cast<Eigen::Index>(signal.values.size());
    if (rows.empty()) return Matrix(height, 0);
    const auto less = [&](std::size_t a, std::size_t b) { return signal.values[a] < signal.values[b]; };
    const auto [low, high] = std::minmax_element(rows.begin(), rows.end(), less);
    const double least = signal.values[*low];
    const double span = signal.values[*high] - least;
    if (!(span > 0)) return Matrix(height, 0);
    std::vector<double> at;
    for (int k = 0; k < knots; ++k) at.push_back(least + span * k / (knots - 1));
    Matrix columns = Matrix::Zero(height, knots);
    for (const std::size_t row : rows) {
      const LinearBasis basis = LinearBasisAt(at, signal.values[row]);
      const auto r = static_cast<Eigen::Index>(row);
      columns(r, basis.first) = basis.left;
      if (basis.right != 0) columns(r, basis.first + 1) = basis.right;
    }
    return columns;
  }

  const Problem& problem_;
  const std::vector<Candidate>& candidates_;
  const ScoredModel& base_;
  LeastSquares fit_;
  noise::Whitening whitening_;
  ColumnSpace space_;
  Vector left_;     // of the base model's residual, whitened and projected
  Vector weights_;  // [m] of the rows; 0 of those that are no sample
  std::set<std::string> channels_;
  std::map<std::string, RowSignal> signals_;
  std::vector<FreeTerm> terms_;
};

// Squared whitened residual of a model, off the span of its own parameters.
double LeftBy(const Problem& problem, const ScoredModel& model, const std::vector<Candidate>& candidates) {
  return Comparison(problem, candidates, model, model.noise).left();
}

}  // namespace

double PriceOf(double degrees, std::size_t chosen, std::size_t m) {
  return kPerParameter * degrees + 2 * static_cast<double>(chosen) * std::log(std::max<double>(1, m));
}

Result<FreeTermComparison> CompareWithFreeTerms(const Problem& problem,
                                                const std::vector<Candidate>& candidates,
                                                const ScoredModel& base, const ScoredModel& extended,
                                                const std::vector<int>& causes) {
  Comparison comparison(problem, candidates, base, extended.noise);
  FreeTermComparison found;
  found.named =
      std::max(comparison.OfCauses(causes), comparison.left() - LeftBy(problem, extended, candidates));
  double parameters = 0;
  for (const int c : causes)
    parameters += static_cast<double>(candidates[static_cast<std::size_t>(c)].parameters.size());
  std::set<int> known;
  for (const Score& score : base.whitened.scores) {
    if (candidates[static_cast<std::size_t>(score.candidate)].known) known.insert(score.candidate);
  }
  found.price = PriceOf(parameters, causes.size(), known.size());
  SINEW_ASSIGN(const std::vector<FreeTerm> terms, comparison.FreeTerms());
  for (const FreeTerm& term : terms) {
    const double price = PriceOf(term.degrees, 1, terms.size());
    if (found.best.degrees > 0 && term.explained - price <= found.best.explained - found.best_price) continue;
    found.best = term;
    found.best_price = price;
  }
  return found;
}

}  // namespace sinew::diagnosis
