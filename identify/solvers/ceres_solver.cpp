#include "identify/solvers/ceres_solver.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"

namespace sinew {
namespace {

// Below this a step in the unit box is rounding.
constexpr double kStepTolerance = 1e-14;
// A projected gradient of this share of the first cost per unit of the box is rounding.
constexpr double kGradientTolerance = 1e-16;
// No search that makes progress needs so many; the budget of evaluations is what users set.
constexpr int kMaxIterations = 100000;

// Variables that Ceres sees as one parameter block: all shared ones, or those of one trial.
struct Group {
  std::vector<int> variables;
  std::vector<double> values;  // Ceres writes the iterate here
};

std::vector<Group> GroupByTrial(const LeastSquares& problem) {
  std::map<std::string, Group> by_trial;
  const FitSetup& setup = problem.setup();
  for (std::size_t k = 0; k < setup.free.size(); ++k) {
    const Parameter& parameter = setup.parameters[static_cast<std::size_t>(setup.free[k])];
    by_trial[parameter.trial].variables.push_back(static_cast<int>(k));
  }
  std::vector<Group> groups;
  for (auto& [trial, group] : by_trial) {
    group.values.resize(group.variables.size());
    groups.push_back(std::move(group));
  }
  return groups;
}

// Predicts the iterate that stands in the groups once; the cost functions read the answer.
class Iterate : public ceres::EvaluationCallback {
 public:
  Iterate(Evaluator& evaluator, std::vector<Group>& groups, const Vector& start)
      : evaluator_(evaluator), groups_(groups), x_(start), jacobian_(evaluator.problem().NewJacobian()) {
    for (Group& group : groups_) {
      for (std::size_t i = 0; i < group.variables.size(); ++i) group.values[i] = start[group.variables[i]];
    }
  }

  // With derivatives at once: most trial points are accepted, and then they are needed.
  void PrepareForEvaluation(bool /*evaluate_jacobians*/, bool /*new_evaluation_point*/) override {
    const Vector previous = x_;
    for (const Group& group : groups_) {
      for (std::size_t i = 0; i < group.variables.size(); ++i) x_[group.variables[i]] = group.values[i];
    }
    if (evaluated_ && x_ == previous) return;
    outcome_ = evaluator_.Residuals(x_, residuals_, &jacobian_);
    evaluated_ = true;
  }

  [[nodiscard]] bool ok() const { return outcome_ == Evaluator::Outcome::kOk; }
  [[nodiscard]] const Vector& residuals() const { return residuals_; }
  [[nodiscard]] const SparseJacobian& jacobian() const { return jacobian_; }

 private:
  Evaluator& evaluator_;
  std::vector<Group>& groups_;
  Vector x_;
  Vector residuals_;
  SparseJacobian jacobian_;
  bool evaluated_ = false;
  Evaluator::Outcome outcome_ = Evaluator::Outcome::kOk;
};

// Residuals of one piece of the Jacobian: a training block, or a prior.
class PieceCost : public ceres::CostFunction {
 public:
  PieceCost(const Iterate& iterate, std::size_t piece, const std::vector<Group>& groups)
      : iterate_(iterate), piece_(piece) {
    const SparseJacobian::Piece& shape = iterate.jacobian().pieces[piece];
    set_num_residuals(static_cast<int>(shape.values.rows()));
    for (std::size_t g = 0; g < groups.size(); ++g) {
      Columns columns;
      const std::vector<int>& variables = groups[g].variables;
      for (std::size_t k = 0; k < shape.variables.size(); ++k) {
        const auto place = std::lower_bound(variables.begin(), variables.end(), shape.variables[k]);
        if (place == variables.end() || *place != shape.variables[k]) continue;
        columns.emplace_back(static_cast<Eigen::Index>(k), place - variables.begin());
      }
      if (columns.empty()) continue;
      groups_.push_back(g);
      columns_.push_back(std::move(columns));
      mutable_parameter_block_sizes()->push_back(static_cast<int>(variables.size()));
    }
  }

  // Groups that it depends on.
  [[nodiscard]] const std::vector<std::size_t>& groups() const { return groups_; }

  bool Evaluate(double const* const* /*parameters*/, double* residuals, double** jacobians) const override {
    if (!iterate_.ok()) return false;
    const SparseJacobian::Piece& piece = iterate_.jacobian().pieces[piece_];
    const Eigen::Index rows = piece.values.rows();
    Eigen::Map<Vector>(residuals, rows) = iterate_.residuals().segment(piece.first_row, rows);
    if (jacobians == nullptr) return true;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (jacobians[g] == nullptr) continue;
      // Column by column, as Eigen has no row-major matrix of one column.
      const int width = parameter_block_sizes()[g];
      std::fill_n(jacobians[g], rows * width, 0.0);
      for (const auto& [from, to] : columns_[g]) {
        Eigen::Map<Vector, 0, Eigen::InnerStride<>>(jacobians[g] + to, rows, Eigen::InnerStride<>(width)) =
            piece.values.col(from);
      }
    }
    return true;
  }

 private:
  using Columns = std::vector<std::pair<Eigen::Index, std::ptrdiff_t>>;  // of the piece -> of the group

  const Iterate& iterate_;
  std::size_t piece_;
  std::vector<std::size_t> groups_;
  std::vector<Columns> columns_;  // per group in groups_
};

// Ends the iterations once the evaluator said stop.
class StopCallback : public ceres::IterationCallback {
 public:
  explicit StopCallback(const Evaluator& evaluator) : evaluator_(evaluator) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return evaluator_.stop_cause() == Evaluator::StopCause::kNone ? ceres::SOLVER_CONTINUE
                                                                  : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const Evaluator& evaluator_;
};

bool StartsWith(const std::string& text, const std::string& beginning) {
  return text.compare(0, beginning.size(), beginning) == 0;
}

// Ceres states the test with its figures in words, such as
// "Function tolerance reached. |cost_change|/cost: 2.1e-13 <= 1.0e-12"; its summary has them for accepted steps
// only.
Stop StopFromSummary(const ceres::Solver::Summary& summary) {
  const std::string& words = summary.message;
  const std::size_t sentence = words.find(". ");
  const std::string figures(Trim(sentence == std::string::npos ? words : words.substr(sentence + 2)));
  if (summary.termination_type == ceres::CONVERGENCE) {
    if (StartsWith(words, "Function tolerance")) return {Termination::kCostChange, figures};
    if (StartsWith(words, "Gradient tolerance")) return {Termination::kGradient, figures};
    if (StartsWith(words, "Parameter tolerance")) return {Termination::kStepSize, figures};
    if (StartsWith(words, "Minimum trust region radius")) return {Termination::kStepSize, figures};
  }
  return {Termination::kSolverFailed, words};
}

// Ceres writes warnings to stderr through glog even when its own logging is silent.
void SilenceGlog() {
  static const int kLevel = FLAGS_minloglevel = google::GLOG_FATAL;
  (void)kLevel;
}

}  // namespace

Search CeresSolver::DoSolve(Evaluator& evaluator, const Vector& start) const {
  SilenceGlog();
  std::vector<Group> groups = GroupByTrial(evaluator.problem());
  Iterate iterate(evaluator, groups, start);
  std::vector<std::unique_ptr<PieceCost>> costs;

  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.evaluation_callback = &iterate;
  ceres::Problem problem(ownership);
  for (Group& group : groups) {
    const int size = static_cast<int>(group.values.size());
    problem.AddParameterBlock(group.values.data(), size);
    for (int i = 0; i < size; ++i) {
      problem.SetParameterLowerBound(group.values.data(), i, 0);
      problem.SetParameterUpperBound(group.values.data(), i, 1);
    }
  }
  for (std::size_t piece = 0; piece < iterate.jacobian().pieces.size(); ++piece) {
    costs.push_back(std::make_unique<PieceCost>(iterate, piece, groups));
    std::vector<double*> blocks;
    for (const std::size_t g : costs.back()->groups()) blocks.push_back(groups[g].values.data());
    // A block that no free variable moves adds a constant to the cost.
    if (!blocks.empty()) problem.AddResidualBlock(costs.back().get(), nullptr, blocks);
  }

  ceres::Solver::Options options;
  options.minimizer_type = ceres::TRUST_REGION;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = groups.size() > 1 ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = kMaxIterations;
  options.function_tolerance = cost_tolerance_;
  options.parameter_tolerance = kStepTolerance;
  options.gradient_tolerance = kGradientTolerance * evaluator.best().cost;
  StopCallback stop(evaluator);
  options.callbacks.push_back(&stop);

  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {StopFromSummary(summary), static_cast<int>(summary.iterations.size()), {}};
}

}  // namespace sinew
