// A Problem made of functions, for tests of code that uses problems.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "identify/least_squares.h"
#include "identify/problem.h"

namespace sinew {

/// Blocks predicted by functions of all parameters, with exact derivatives.
class FunctionProblem : public Problem {
 public:
  /// @param p [P] @param values [M] @param derivatives [M x P, zero when called], or null if not wanted.
  using Function = std::function<Status(const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives)>;

  FunctionProblem& Add(Parameter parameter) {
    parameters_.push_back(std::move(parameter));
    return *this;
  }
  /// A parameter on a linear scale with this name, these bounds and this start.
  FunctionProblem& Add(const std::string& name, double lower, double upper, double start) {
    Parameter parameter;
    parameter.name = name;
    parameter.unit = "1";
    parameter.lower = lower;
    parameter.upper = upper;
    parameter.start = start;
    return Add(std::move(parameter));
  }
  FunctionProblem& Add(Constraint constraint) {
    constraints_.push_back(std::move(constraint));
    return *this;
  }
  /// A training block, measured at 0, 1, 2, ...; add its parameters first.
  FunctionProblem& AddBlock(const std::string& trial, const std::vector<double>& measured,
                            std::vector<int> columns, Function function) {
    Block block;
    block.trial = trial;
    block.channel = "y";
    block.unit = "1";
    block.measured = measured;
    block.columns = std::move(columns);
    for (std::size_t i = 0; i < measured.size(); ++i) {
      block.prediction_time.push_back(static_cast<double>(i));
      block.sample.push_back(static_cast<int>(i));
    }
    layout_.push_back(std::move(block));
    functions_.push_back(std::move(function));
    return *this;
  }

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Constraint>& constraints() const override { return constraints_; }

  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const override {
    const auto parameters = static_cast<Eigen::Index>(parameters_.size());
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      if (!query.blocks[b]) continue;
      const int index = static_cast<int>(b);
      Matrix derivatives;
      if (query.derivatives) derivatives = Matrix::Zero(layout_[b].predictions(), parameters);
      auto values = prediction.values(index);
      SINEW_TRY(functions_[b](query.parameters, values, query.derivatives ? &derivatives : nullptr));
      if (!query.derivatives) continue;
      auto wanted = prediction.derivatives(index);
      for (std::size_t c = 0; c < layout_[b].columns.size(); ++c) {
        wanted.col(static_cast<Eigen::Index>(c)) = derivatives.col(layout_[b].columns[c]);
      }
    }
    return {};
  }

 private:
  std::vector<Parameter> parameters_;
  Layout layout_;
  std::vector<Constraint> constraints_;
  std::vector<Function> functions_;
};

/// A problem with its setup and least squares, owned together.
struct Fit {
  explicit Fit(const Problem& problem, const FitRequest& request = {})
      : setup(MakeFitSetup(problem, request).value()), least_squares(problem, setup) {}
  Fit(const Fit&) = delete;
  Fit& operator=(const Fit&) = delete;

  FitSetup setup;
  LeastSquares least_squares;
};

}  // namespace sinew
