// A problem in a few lines, for tests of code that uses the interface alone: a formula per sample.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/problem.h"

namespace sinew::toy {

/// Value of a block at a time, and its gradient for all parameters [P, given as zeros] if not null; a failure
/// where there is none.
using Formula =
    std::function<Result<double>(const Block& block, double t, const Vector& parameters, Vector* gradient)>;

class ToyProblem final : public Problem {
 public:
  /// Every block may depend on every parameter.
  ToyProblem(std::vector<Parameter> parameters, Layout layout, Formula formula,
             std::vector<Constraint> constraints = {})
      : parameters_(std::move(parameters)),
        layout_(std::move(layout)),
        formula_(std::move(formula)),
        constraints_(std::move(constraints)) {
    for (Block& block : layout_) {
      for (std::size_t i = 0; i < parameters_.size(); ++i) block.columns.push_back(static_cast<int>(i));
    }
  }

  /// Unlike problems, toys are copied, because functions return them.
  ToyProblem(const ToyProblem& other)
      : Problem(),
        parameters_(other.parameters_),
        layout_(other.layout_),
        formula_(other.formula_),
        constraints_(other.constraints_) {}
  ToyProblem& operator=(const ToyProblem&) = delete;

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  const Layout& layout() const override { return layout_; }
  const std::vector<Constraint>& constraints() const override { return constraints_; }

  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const override {
    Vector gradient(static_cast<Eigen::Index>(parameters_.size()));
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      if (!query.blocks[b]) continue;
      const auto block = static_cast<int>(b);
      for (int i = 0; i < layout_[b].predictions(); ++i) {
        gradient.setZero();
        SINEW_ASSIGN(prediction.values(block)[i],
                     formula_(layout_[b], layout_[b].prediction_time[static_cast<std::size_t>(i)],
                              query.parameters, query.derivatives ? &gradient : nullptr));
        if (query.derivatives) prediction.derivatives(block).row(i) = gradient.transpose();
      }
    }
    return {};
  }

  /// Sets what was measured: the formula at `truth` plus noise(block, i) [unit of the block].
  void Measure(const Vector& truth, const std::function<double(const Block&, int)>& noise) {
    for (Block& block : layout_) {
      for (std::size_t i = 0; i < block.measured.size(); ++i) {
        const double t = block.prediction_time[static_cast<std::size_t>(block.sample[i])];
        block.measured[i] = *formula_(block, t, truth, nullptr) + noise(block, static_cast<int>(i));
      }
    }
  }

 private:
  std::vector<Parameter> parameters_;
  Layout layout_;
  Formula formula_;
  std::vector<Constraint> constraints_;
};

inline Parameter MakeParameter(std::string name, double lower, double upper, double start,
                               ParameterKind kind = ParameterKind::kBase) {
  Parameter parameter;
  parameter.name = std::move(name);
  parameter.unit = "1";
  parameter.lower = lower;
  parameter.upper = upper;
  parameter.start = start;
  parameter.kind = kind;
  return parameter;
}

/// `samples` times from 0 to `duration`, all measured (as zero until Measure) unless the role is kPredicted.
inline Block MakeBlock(std::string trial, std::string channel, int samples, double duration,
                       BlockRole role = BlockRole::kTrain) {
  Block block;
  block.trial = std::move(trial);
  block.channel = std::move(channel);
  block.unit = "1";
  block.role = role;
  for (int i = 0; i < samples; ++i) {
    block.prediction_time.push_back(duration * i / (samples - 1));
    if (role == BlockRole::kPredicted) continue;
    block.sample.push_back(i);
    block.measured.push_back(0);
  }
  return block;
}

/// A problem with its default setup (all base and nuisance parameters free) and its view for solvers.
struct ToyFit {
  explicit ToyFit(const ToyProblem& problem) : setup(*MakeFitSetup(problem, {})), view(problem, setup) {}
  ToyFit(const ToyFit&) = delete;
  ToyFit& operator=(const ToyFit&) = delete;

  FitSetup setup;
  LeastSquares view;
};

inline Vector Values(std::initializer_list<double> values) {
  Vector vector(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) vector[i++] = value;
  return vector;
}

}  // namespace sinew::toy
