#include "identify/least_squares.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/guarded.h"

namespace sinew {
namespace {

double ToParameter(const Parameter& p, double x) {
  x = std::clamp(x, 0.0, 1.0);
  if (x == 0) return p.lower;  // the bounds themselves, without rounding
  if (x == 1) return p.upper;
  const double value = p.scale == Scale::kLog ? p.lower * std::exp(x * std::log(p.upper / p.lower))
                                              : p.lower + x * (p.upper - p.lower);
  return std::clamp(value, p.lower, p.upper);  // rounding can put a value next to a bound beyond it
}

double ToVariable(const Parameter& p, double value) {
  const double x = p.scale == Scale::kLog ? std::log(value / p.lower) / std::log(p.upper / p.lower)
                                          : (value - p.lower) / (p.upper - p.lower);
  return std::clamp(x, 0.0, 1.0);
}

double Slope(const Parameter& p, double x) {
  if (p.scale == Scale::kLog) return ToParameter(p, x) * std::log(p.upper / p.lower);
  return p.upper - p.lower;
}

// Where the first predicted value that is not finite is.
tl::unexpected<Error> NotFinite(const Layout& layout, const std::vector<LeastSquares::TrainBlock>& blocks,
                                const Prediction& prediction) {
  for (const auto& [b, first_row] : blocks) {
    const Block& block = layout[static_cast<std::size_t>(b)];
    for (std::size_t i = 0; i < block.sample.size(); ++i) {
      const double value = prediction.values(b)[block.sample[i]];
      if (std::isfinite(value)) continue;
      return Fail("a predicted value is not finite: block {}/{}, sample {} (t = {:.6g} s) is {}", block.trial,
                  block.channel, i, block.prediction_time[static_cast<std::size_t>(block.sample[i])], value);
    }
  }
  return Fail("a residual is not finite");
}

}  // namespace

Matrix SparseJacobian::Dense(int rows, int variables) const {
  Matrix dense = Matrix::Zero(rows, variables);
  for (const Piece& piece : pieces) {
    for (std::size_t k = 0; k < piece.variables.size(); ++k) {
      dense.block(piece.first_row, piece.variables[k], piece.values.rows(), 1) =
          piece.values.col(static_cast<Eigen::Index>(k));
    }
  }
  return dense;
}

Vector SparseJacobian::Times(const Vector& x, Eigen::Index rows) const {
  Vector product = Vector::Zero(rows);
  for (const Piece& piece : pieces) {
    auto of_piece = product.segment(piece.first_row, piece.values.rows());
    for (std::size_t k = 0; k < piece.variables.size(); ++k)
      of_piece += x[piece.variables[k]] * piece.values.col(static_cast<Eigen::Index>(k));
  }
  return product;
}

Vector SparseJacobian::TransposedTimes(const Vector& y, Eigen::Index variables) const {
  Vector product = Vector::Zero(variables);
  for (const Piece& piece : pieces) {
    const Vector pull = piece.values.transpose() * y.segment(piece.first_row, piece.values.rows());
    for (std::size_t k = 0; k < piece.variables.size(); ++k)
      product[piece.variables[k]] += pull[static_cast<Eigen::Index>(k)];
  }
  return product;
}

LeastSquares::LeastSquares(const Problem& problem, const FitSetup& setup) : problem_(problem), setup_(setup) {
  variable_of_.assign(setup.parameters.size(), -1);
  differentiate_.assign(setup.parameters.size(), false);
  for (std::size_t k = 0; k < setup.free.size(); ++k) {
    variable_of_[static_cast<std::size_t>(setup.free[k])] = static_cast<int>(k);
    differentiate_[static_cast<std::size_t>(setup.free[k])] = true;
  }
  const Layout& layout = problem.layout();
  wanted_.assign(layout.size(), false);
  constrained_.assign(layout.size(), false);
  for (std::size_t b = 0; b < layout.size(); ++b) {
    if (layout[b].range) {
      (layout[b].range->strict ? strict_ranges_ : ranges_).push_back(static_cast<int>(b));
      (layout[b].range->strict ? constrained_ : wanted_)[b] = true;
    }
    if (layout[b].role != BlockRole::kTrain) continue;
    wanted_[b] = true;
    train_blocks_.push_back({static_cast<int>(b), data_rows_});
    data_rows_ += layout[b].samples();
  }
  for (const int index : setup.free) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (p.prior)
      priors_.push_back({variable_of_[static_cast<std::size_t>(index)], *p.prior, p.scale == Scale::kLog});
  }
  rows_ = data_rows_ + static_cast<int>(priors_.size() + ranges_.size());
}

void LeastSquares::AddTo(Digest& digest) const {
  const auto count = [](std::size_t number) { return static_cast<std::uint64_t>(number); };
  digest.Add(count(setup_.free.size()));
  for (const int index : setup_.free) {
    const Parameter& p = setup_.parameters[static_cast<std::size_t>(index)];
    digest.Add(count(static_cast<std::size_t>(index))).Add(count(static_cast<std::size_t>(p.scale)));
    digest.Add(p.lower).Add(p.upper).Add(count(p.prior ? 1 : 0));
    if (p.prior) digest.Add(p.prior->mean).Add(p.prior->standard_deviation);
  }
  digest.Add(setup_.rest.data(), count(static_cast<std::size_t>(setup_.rest.size())));
  for (const Block& block : problem_.layout()) {
    // Of blocks that are not compared only the ranges matter, which no view changes.
    digest.Add(count(static_cast<std::size_t>(block.role)));
    if (block.role != BlockRole::kTrain) continue;
    digest.Add(block.weight).Add(block.sigma.value_or(0)).Add(block.noise_memory.value_or(0));
    digest.Add(count(block.white ? 1 : 0));
    digest.Add(block.relative_weight.data(), block.relative_weight.size());
    digest.Add(block.measured.data(), block.measured.size());
    for (const int sample : block.sample) digest.Add(count(static_cast<std::size_t>(sample)));
  }
  digest.Add(count(transform_ == nullptr ? 0 : 1));
  if (transform_ != nullptr) transform_->AddTo(digest);
}

LeastSquares::Workspace LeastSquares::NewWorkspace() const {
  return {problem_.NewWorkspace(), Prediction(problem_.layout()), setup_.rest, Vector(rows_), {}};
}

SparseJacobian::Piece LeastSquares::NewPiece(const Block& block, int first_row, int rows) const {
  SparseJacobian::Piece piece;
  piece.first_row = first_row;
  for (const int column : block.columns) {
    const int variable = variable_of_[static_cast<std::size_t>(column)];
    if (variable >= 0) piece.variables.push_back(variable);
  }
  piece.values = Matrix::Zero(rows, static_cast<Eigen::Index>(piece.variables.size()));
  return piece;
}

SparseJacobian LeastSquares::NewJacobian() const {
  const Layout& layout = problem_.layout();
  SparseJacobian jacobian;
  for (const TrainBlock& train : train_blocks_) {
    const Block& block = layout[static_cast<std::size_t>(train.block)];
    jacobian.pieces.push_back(NewPiece(block, train.first_row, block.samples()));
  }
  int row = data_rows_;
  for (const Prior& prior : priors_) jacobian.pieces.push_back({row++, {prior.variable}, Matrix::Zero(1, 1)});
  for (const int b : ranges_)
    jacobian.pieces.push_back(NewPiece(layout[static_cast<std::size_t>(b)], row++, 1));
  return jacobian;
}

std::vector<int> LeastSquares::PriorVariables() const {
  std::vector<int> variables;
  for (const Prior& prior : priors_) variables.push_back(prior.variable);
  return variables;
}

void LeastSquares::ParametersInto(const Vector& x, Vector& parameters) const {
  parameters = setup_.rest;
  for (std::size_t k = 0; k < setup_.free.size(); ++k) {
    parameters[setup_.free[k]] = ToParameter(setup_.parameters[static_cast<std::size_t>(setup_.free[k])],
                                             x[static_cast<Eigen::Index>(k)]);
  }
}

Vector LeastSquares::Parameters(const Vector& x) const {
  Vector parameters;
  ParametersInto(x, parameters);
  return parameters;
}

Vector LeastSquares::Variables(const Vector& parameters) const {
  Vector x(variables());
  for (std::size_t k = 0; k < setup_.free.size(); ++k) {
    const int index = setup_.free[k];
    x[static_cast<Eigen::Index>(k)] =
        ToVariable(setup_.parameters[static_cast<std::size_t>(index)], parameters[index]);
  }
  return x;
}

Vector LeastSquares::Slopes(const Vector& x) const {
  Vector slopes(variables());
  for (std::size_t k = 0; k < setup_.free.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    slopes[i] = Slope(setup_.parameters[static_cast<std::size_t>(setup_.free[k])], x[i]);
  }
  return slopes;
}

Status LeastSquares::Evaluate(const Vector& x, Workspace& workspace, Vector& residuals,
                              SparseJacobian* jacobian) const {
  ParametersInto(x, workspace.parameters);
  const Query query{workspace.parameters, wanted_, jacobian != nullptr, &differentiate_};
  SINEW_TRY(PredictGuarded(problem_, query, *workspace.problem, workspace.prediction));

  const Layout& layout = problem_.layout();
  residuals.resize(rows_);
  for (std::size_t t = 0; t < train_blocks_.size(); ++t) {
    const auto [b, first_row] = train_blocks_[t];
    const Block& block = layout[static_cast<std::size_t>(b)];
    const auto predicted = workspace.prediction.values(b);
    for (int i = 0; i < block.samples(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      residuals[first_row + i] = block.WeightOf(at) * (predicted[block.sample[at]] - block.measured[at]);
    }
    if (transform_ != nullptr) {
      transform_->Apply(static_cast<int>(t), residuals.middleRows(first_row, block.samples()));
    }
    if (jacobian == nullptr) continue;
    const auto derivatives = workspace.prediction.derivatives(b);
    SparseJacobian::Piece& piece = jacobian->pieces[t];
    Eigen::Index k = 0;
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      const int variable = variable_of_[static_cast<std::size_t>(block.columns[c])];
      if (variable < 0) continue;
      const double slope = Slope(setup_.parameters[static_cast<std::size_t>(block.columns[c])], x[variable]);
      for (int i = 0; i < block.samples(); ++i) {
        piece.values(i, k) =
            block.WeightOf(static_cast<std::size_t>(i)) * slope *
            derivatives(block.sample[static_cast<std::size_t>(i)], static_cast<Eigen::Index>(c));
      }
      ++k;
    }
    if (transform_ != nullptr) transform_->Apply(static_cast<int>(t), piece.values);
  }
  EvaluatePriors(x, workspace, residuals, jacobian);
  EvaluateRanges(x, workspace, residuals, jacobian);
  if (!residuals.allFinite()) return NotFinite(layout, train_blocks_, workspace.prediction);
  return {};
}

void LeastSquares::EvaluatePriors(const Vector& x, const Workspace& workspace, Vector& residuals,
                                  SparseJacobian* jacobian) const {
  for (std::size_t i = 0; i < priors_.size(); ++i) {
    const Prior& prior = priors_[i];
    const int index = setup_.free[static_cast<std::size_t>(prior.variable)];
    const double value = workspace.parameters[index];
    residuals[data_rows_ + static_cast<Eigen::Index>(i)] =
        ((prior.logarithmic ? std::log(value) : value) - prior.density.mean) /
        prior.density.standard_deviation;
    if (jacobian == nullptr) continue;
    const double slope = Slope(setup_.parameters[static_cast<std::size_t>(index)], x[prior.variable]);
    jacobian->pieces[train_blocks_.size() + i].values(0, 0) =
        (prior.logarithmic ? slope / value : slope) / prior.density.standard_deviation;
  }
}

void LeastSquares::EvaluateRanges(const Vector& x, Workspace& workspace, Vector& residuals,
                                  SparseJacobian* jacobian) const {
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const int b = ranges_[i];
    const Block& block = problem_.layout()[static_cast<std::size_t>(b)];
    const double distance = DistanceFrom(*block.range, workspace.prediction.values(b),
                                         jacobian == nullptr ? nullptr : &workspace.slopes);
    residuals[data_rows_ + static_cast<Eigen::Index>(priors_.size() + i)] = block.weight * distance;
    if (jacobian == nullptr) continue;
    workspace.slopes *= block.weight;
    RowOf(x, b, workspace.prediction, workspace.slopes,
          jacobian->pieces[train_blocks_.size() + priors_.size() + i].values);
  }
}

void LeastSquares::RowOf(const Vector& x, int block, const Prediction& prediction, const Vector& slopes,
                         Eigen::Ref<Matrix> row) const {
  const std::vector<int>& columns = problem_.layout()[static_cast<std::size_t>(block)].columns;
  const auto derivatives = prediction.derivatives(block);
  Eigen::Index k = 0;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const int variable = variable_of_[static_cast<std::size_t>(columns[c])];
    if (variable < 0) continue;
    row(0, k++) = slopes.dot(derivatives.col(static_cast<Eigen::Index>(c))) *
                  Slope(setup_.parameters[static_cast<std::size_t>(columns[c])], x[variable]);
  }
}

Result<double> LeastSquares::Cost(const Vector& x, Workspace& workspace) const {
  SINEW_TRY(Evaluate(x, workspace, workspace.residuals, nullptr));
  return 0.5 * workspace.residuals.squaredNorm();
}

std::string LeastSquares::ConstraintName(int constraint) const {
  const auto i = static_cast<std::size_t>(constraint);
  const std::vector<Constraint>& linear = problem_.constraints();
  if (i < linear.size()) return linear[i].name;
  const Block& block = problem_.layout()[static_cast<std::size_t>(strict_ranges_[i - linear.size()])];
  return fmt::format("{} within {} .. {} in trial {}", block.channel, block.range->lower, block.range->upper,
                     block.trial);
}

Vector LeastSquares::ConstraintSizes(const Vector& x) const {
  const Vector parameters = Parameters(x);
  std::vector<double> sizes;
  for (const Constraint& c : problem_.constraints())
    sizes.push_back(std::abs(c.offset) + c.coefficients.cwiseProduct(parameters).cwiseAbs().sum());
  for (const int b : strict_ranges_) {
    const Range& range = *problem_.layout()[static_cast<std::size_t>(b)].range;
    sizes.push_back(std::max(std::abs(range.lower), std::abs(range.upper)));
  }
  return Eigen::Map<const Vector>(sizes.data(), static_cast<Eigen::Index>(sizes.size()));
}

Status LeastSquares::Constraints(const Vector& x, Workspace& workspace, Vector& values,
                                 Matrix* jacobian) const {
  ParametersInto(x, workspace.parameters);
  const Vector slopes = Slopes(x);
  const std::vector<Constraint>& linear = problem_.constraints();
  const auto count = static_cast<Eigen::Index>(linear.size());
  values.resize(constraints());
  if (jacobian != nullptr) jacobian->setZero(constraints(), variables());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Constraint& constraint = linear[static_cast<std::size_t>(i)];
    values[i] = constraint.offset + constraint.coefficients.dot(workspace.parameters);
    if (jacobian == nullptr) continue;
    for (int k = 0; k < variables(); ++k) {
      (*jacobian)(i, k) = constraint.coefficients[setup_.free[static_cast<std::size_t>(k)]] * slopes[k];
    }
  }
  if (strict_ranges_.empty()) return {};
  const Query query{workspace.parameters, constrained_, jacobian != nullptr, &differentiate_};
  SINEW_TRY(PredictGuarded(problem_, query, *workspace.problem, workspace.prediction));
  for (std::size_t r = 0; r < strict_ranges_.size(); ++r) {
    const int b = strict_ranges_[r];
    const Block& block = problem_.layout()[static_cast<std::size_t>(b)];
    const Eigen::Index i = count + static_cast<Eigen::Index>(r);
    values[i] = FarthestFrom(*block.range, workspace.prediction.values(b),
                             jacobian == nullptr ? nullptr : &workspace.slopes);
    if (!std::isfinite(values[i])) return Fail("a predicted value is not finite");
    if (jacobian == nullptr) continue;
    SparseJacobian::Piece piece = NewPiece(block, 0, 1);
    RowOf(x, b, workspace.prediction, workspace.slopes, piece.values);
    for (std::size_t k = 0; k < piece.variables.size(); ++k)
      (*jacobian)(i, piece.variables[k]) = piece.values(0, static_cast<Eigen::Index>(k));
  }
  return {};
}

Vector LowerOf(const LeastSquares& fit, Vector first, Vector second) {
  auto workspace = fit.NewWorkspace();
  const auto here = fit.Cost(first, workspace);
  const auto there = fit.Cost(second, workspace);
  return there && !(here && *here <= *there) ? std::move(second) : std::move(first);
}

}  // namespace sinew
