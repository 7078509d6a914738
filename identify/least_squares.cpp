#include "identify/least_squares.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

double ToParameter(const Parameter& p, double x) {
  x = std::clamp(x, 0.0, 1.0);
  if (x == 0) return p.lower;  // the bounds themselves, without rounding
  if (x == 1) return p.upper;
  const double value = p.scale == Scale::kLog ? p.lower * std::exp(x * std::log(p.upper / p.lower))
                                              : p.lower + x * (p.upper - p.lower);
  return std::clamp(value, p.lower, p.upper);  // next to a bound, rounding would carry it across
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

LeastSquares::LeastSquares(const Problem& problem, const FitSetup& setup) : problem_(problem), setup_(setup) {
  variable_of_.assign(setup.parameters.size(), -1);
  differentiate_.assign(setup.parameters.size(), false);
  for (std::size_t k = 0; k < setup.free.size(); ++k) {
    variable_of_[static_cast<std::size_t>(setup.free[k])] = static_cast<int>(k);
    differentiate_[static_cast<std::size_t>(setup.free[k])] = true;
  }
  const Layout& layout = problem.layout();
  wanted_.assign(layout.size(), false);
  for (std::size_t b = 0; b < layout.size(); ++b) {
    if (layout[b].role != BlockRole::kTrain) continue;
    wanted_[b] = true;
    train_blocks_.push_back({static_cast<int>(b), rows_});
    rows_ += layout[b].samples();
  }
  for (const int index : setup.free) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (p.prior)
      priors_.push_back({variable_of_[static_cast<std::size_t>(index)], *p.prior, p.scale == Scale::kLog});
  }
  rows_ += static_cast<int>(priors_.size());
}

LeastSquares::Workspace LeastSquares::NewWorkspace() const {
  return {problem_.NewWorkspace(), Prediction(problem_.layout()), setup_.rest, Vector(rows_)};
}

SparseJacobian LeastSquares::NewJacobian() const {
  SparseJacobian jacobian;
  for (const TrainBlock& train : train_blocks_) {
    const Block& block = problem_.layout()[static_cast<std::size_t>(train.block)];
    SparseJacobian::Piece piece;
    piece.first_row = train.first_row;
    for (const int column : block.columns) {
      const int variable = variable_of_[static_cast<std::size_t>(column)];
      if (variable >= 0) piece.variables.push_back(variable);
    }
    piece.values = Matrix::Zero(block.samples(), static_cast<Eigen::Index>(piece.variables.size()));
    jacobian.pieces.push_back(std::move(piece));
  }
  for (std::size_t i = 0; i < priors_.size(); ++i) {
    const int row = rows_ - static_cast<int>(priors_.size() - i);
    jacobian.pieces.push_back({row, {priors_[i].variable}, Matrix::Zero(1, 1)});
  }
  return jacobian;
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
  SINEW_TRY(problem_.Predict(query, *workspace.problem, workspace.prediction));

  const Layout& layout = problem_.layout();
  residuals.resize(rows_);
  for (std::size_t t = 0; t < train_blocks_.size(); ++t) {
    const auto [b, first_row] = train_blocks_[t];
    const Block& block = layout[static_cast<std::size_t>(b)];
    const auto predicted = workspace.prediction.values(b);
    for (int i = 0; i < block.samples(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      residuals[first_row + i] = block.weight * (predicted[block.sample[at]] - block.measured[at]);
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
      const double factor =
          block.weight * Slope(setup_.parameters[static_cast<std::size_t>(block.columns[c])], x[variable]);
      for (int i = 0; i < block.samples(); ++i) {
        piece.values(i, k) =
            factor * derivatives(block.sample[static_cast<std::size_t>(i)], static_cast<Eigen::Index>(c));
      }
      ++k;
    }
    if (transform_ != nullptr) transform_->Apply(static_cast<int>(t), piece.values);
  }
  for (std::size_t i = 0; i < priors_.size(); ++i) {
    const Prior& prior = priors_[i];
    const int index = setup_.free[static_cast<std::size_t>(prior.variable)];
    const double value = workspace.parameters[index];
    const auto row = static_cast<Eigen::Index>(rows_) - static_cast<Eigen::Index>(priors_.size() - i);
    residuals[row] = ((prior.logarithmic ? std::log(value) : value) - prior.density.mean) /
                     prior.density.standard_deviation;
    if (jacobian != nullptr) {
      const double slope = Slope(setup_.parameters[static_cast<std::size_t>(index)], x[prior.variable]);
      jacobian->pieces[train_blocks_.size() + i].values(0, 0) =
          (prior.logarithmic ? slope / value : slope) / prior.density.standard_deviation;
    }
  }
  if (!residuals.allFinite()) return Fail("a predicted value is not finite");
  return {};
}

Result<double> LeastSquares::Cost(const Vector& x, Workspace& workspace) const {
  SINEW_TRY(Evaluate(x, workspace, workspace.residuals, nullptr));
  return 0.5 * workspace.residuals.squaredNorm();
}

void LeastSquares::Constraints(const Vector& x, Vector& values, Matrix* jacobian) const {
  const Vector parameters = Parameters(x);
  const Vector slopes = Slopes(x);
  values.resize(constraints());
  if (jacobian != nullptr) jacobian->resize(constraints(), variables());
  for (int i = 0; i < constraints(); ++i) {
    const Constraint& constraint = problem_.constraints()[static_cast<std::size_t>(i)];
    values[i] = constraint.offset + constraint.coefficients.dot(parameters);
    if (jacobian == nullptr) continue;
    for (int k = 0; k < variables(); ++k) {
      (*jacobian)(i, k) = constraint.coefficients[setup_.free[static_cast<std::size_t>(k)]] * slopes[k];
    }
  }
}

}  // namespace sinew
