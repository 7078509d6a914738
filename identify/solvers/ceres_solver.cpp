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

namespace sinew::solvers {
namespace {

// Below this a step in the unit box is rounding.
constexpr double kCeresStepTolerance = 1e-14;
// A projected gradient of this share of the first cost per unit of the box is rounding.
constexpr double kGradientTolerance = 1e-16;
// Never reached by a search that makes progress; users limit a search by its evaluations.
constexpr int kMaxCeresIterations = 100000;
// Limit for the changes of the active set (the variables held at a bound).
constexpr int kMaxRounds = 100;

// Variables that form one parameter block of Ceres: all shared ones, or those of one trial.
struct Group {
  std::vector<int> variables;
  std::vector<double> values;  // Ceres writes the iterate here
};

// Variables that are held at their bound are left out.
std::vector<Group> GroupByTrial(const LeastSquares& problem, const Vector& x, const std::vector<bool>& held) {
  std::map<std::string, Group> by_trial;
  const FitSetup& setup = problem.setup();
  for (std::size_t k = 0; k < setup.free.size(); ++k) {
    if (held[k]) continue;
    Group& group = by_trial[setup.parameters[static_cast<std::size_t>(setup.free[k])].trial];
    group.variables.push_back(static_cast<int>(k));
    group.values.push_back(x[static_cast<Eigen::Index>(k)]);
  }
  std::vector<Group> groups;
  for (auto& [trial, group] : by_trial) groups.push_back(std::move(group));
  return groups;
}

// Predicts the iterate in the groups once; all cost functions use this prediction.
class Iterate : public ceres::EvaluationCallback {
 public:
  Iterate(Evaluator& evaluator, const Vector& start)
      : evaluator_(evaluator), x_(start), jacobian_(evaluator.fit().NewJacobian()) {}

  void SetGroups(const std::vector<Group>* groups) { groups_ = groups; }

  // Derivatives are always included: most trial points are accepted, and then they are needed.
  void PrepareForEvaluation(bool /*evaluate_jacobians*/, bool /*new_evaluation_point*/) override {
    Vector x = x_;
    for (const Group& group : *groups_) {
      for (std::size_t i = 0; i < group.variables.size(); ++i) x[group.variables[i]] = group.values[i];
    }
    if (evaluated_ && x == x_) return;
    x_ = x;
    evaluated_ = true;
    outcome_ = evaluator_.Residuals(x_, residuals_, &jacobian_);
  }

  [[nodiscard]] bool ok() const { return outcome_ == Evaluator::Outcome::kOk; }
  [[nodiscard]] const Vector& x() const { return x_; }
  [[nodiscard]] const Vector& residuals() const { return residuals_; }
  [[nodiscard]] const SparseJacobian& jacobian() const { return jacobian_; }

  // For every variable: the gradient of the cost, and the decrease of the cost if this variable alone moved
  // to the minimum of the linearised problem.
  struct Slopes {
    Vector gradient;
    Vector gain;
  };
  [[nodiscard]] Slopes GetSlopes() const {
    Slopes slopes{Vector::Zero(x_.size()), Vector::Zero(x_.size())};
    Vector curvature = Vector::Zero(x_.size());
    for (const SparseJacobian::Piece& piece : jacobian_.pieces) {
      const auto rows = residuals_.segment(piece.first_row, piece.values.rows());
      for (std::size_t k = 0; k < piece.variables.size(); ++k) {
        const auto column = piece.values.col(static_cast<Eigen::Index>(k));
        slopes.gradient[piece.variables[k]] += column.dot(rows);
        curvature[piece.variables[k]] += column.squaredNorm();
      }
    }
    for (Eigen::Index k = 0; k < x_.size(); ++k) {
      if (curvature[k] > 0) slopes.gain[k] = 0.5 * slopes.gradient[k] * slopes.gradient[k] / curvature[k];
    }
    return slopes;
  }

 private:
  Evaluator& evaluator_;
  const std::vector<Group>* groups_ = nullptr;
  Vector x_;
  Vector residuals_;
  SparseJacobian jacobian_;
  bool evaluated_ = false;
  Evaluator::Outcome outcome_ = Evaluator::Outcome::kOk;
};

// Variables on a bound with the cost decreasing outward.
std::vector<bool> Pushed(const Vector& x, const Vector& gradient) {
  std::vector<bool> pushed(static_cast<std::size_t>(x.size()));
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    pushed[static_cast<std::size_t>(k)] = (x[k] == 0 && gradient[k] > 0) || (x[k] == 1 && gradient[k] < 0);
  }
  return pushed;
}

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

  // The groups that this piece depends on.
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

// Ends the iterations when the evaluator stops, or when a variable stays at a bound with the cost decreasing
// outward.
class IterationEnd : public ceres::IterationCallback {
 public:
  IterationEnd(const Evaluator& evaluator, const Iterate& iterate, const std::vector<bool>& held)
      : evaluator_(evaluator), iterate_(iterate), held_(held), pushed_for_(held.size(), 0) {}

  [[nodiscard]] bool found_active_bound() const { return found_active_bound_; }

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (evaluator_.stop_cause() != Evaluator::StopCause::kNone) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    if (summary.step_is_successful && iterate_.ok())
      pushed_ = Pushed(iterate_.x(), iterate_.GetSlopes().gradient);
    for (std::size_t k = 0; k < pushed_.size(); ++k) {
      pushed_for_[k] = pushed_[k] && !held_[k] ? pushed_for_[k] + 1 : 0;
      if (pushed_for_[k] >= kPatience) found_active_bound_ = true;
    }
    return found_active_bound_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  static constexpr int kPatience = 3;

  const Evaluator& evaluator_;
  const Iterate& iterate_;
  const std::vector<bool>& held_;
  std::vector<bool> pushed_;
  std::vector<int> pushed_for_;  // iterations in a row
  bool found_active_bound_ = false;
};

bool StartsWith(const std::string& text, const std::string& beginning) {
  return text.compare(0, beginning.size(), beginning) == 0;
}

// Ceres states the test and its values in a message such as "Function tolerance reached. |cost_change|/cost:
// 2.100000e-13 <= 1.000000e-12"; its summary has the values for accepted steps only. Returns our name of the
// quantity with the values after the colon.
std::string Test(const std::string& quantity, const std::string& words) {
  const std::size_t colon = words.rfind(": ");
  const std::size_t sign = words.rfind("<=");
  if (colon == std::string::npos || sign == std::string::npos || sign < colon) return words;
  const auto value = ParseNumber(words.substr(colon + 2, sign - colon - 2));
  const auto limit = ParseNumber(words.substr(sign + 2));
  if (!value || !limit) return words;
  return fmt::format("{} {:.2g} <= {:.2g}", quantity, *value, *limit);
}

Stop StopFromSummary(const ceres::Solver::Summary& summary) {
  const std::string& words = summary.message;
  if (summary.termination_type == ceres::CONVERGENCE) {
    if (StartsWith(words, "Function tolerance"))
      return {Termination::kCostChange, Test("relative cost change", words)};
    if (StartsWith(words, "Gradient tolerance"))
      return {Termination::kGradient, Test("largest gradient", words)};
    if (StartsWith(words, "Parameter tolerance"))
      return {Termination::kStepSize, Test("relative step", words)};
    if (StartsWith(words, "Minimum trust region radius"))
      return {Termination::kStepSize, Test("trust region radius", words)};
  }
  return {Termination::kSolverFailed, words};
}

// Ceres writes warnings to stderr through glog even when its own logging is silent.
void SilenceGlog() {
  static const int kLevel = FLAGS_minloglevel = google::GLOG_FATAL;
  (void)kLevel;
}

// One run of Ceres over the variables that are not held.
struct Round {
  ceres::Solver::Summary summary;
  bool found_active_bound = false;
};

Round SolveFace(Evaluator& evaluator, Iterate& iterate, std::vector<Group>& groups,
                const std::vector<bool>& held, double cost_tolerance) {
  iterate.SetGroups(&groups);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.evaluation_callback = &iterate;
  std::vector<std::unique_ptr<PieceCost>> costs;
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
    // A piece that no variable of the face moves adds a constant to the cost.
    if (!blocks.empty()) problem.AddResidualBlock(costs.back().get(), nullptr, blocks);
  }

  ceres::Solver::Options options;
  options.minimizer_type = ceres::TRUST_REGION;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = groups.size() > 1 ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = kMaxCeresIterations;
  options.function_tolerance = cost_tolerance;
  options.parameter_tolerance = kCeresStepTolerance;
  options.gradient_tolerance = kGradientTolerance * evaluator.best().cost;
  IterationEnd end(evaluator, iterate, held);
  options.callbacks.push_back(&end);

  Round round;
  ceres::Solve(options, &problem, &round.summary);
  round.found_active_bound = end.found_active_bound();
  return round;
}

}  // namespace

// Ceres enforces bounds by projecting its steps. Along an active bound these become short, and it may stop
// where the cost still decreases along the other variables; so variables with the cost decreasing outward are
// held at their bound, and released when it no longer does.
Search CeresSolver::DoSolve(Evaluator& evaluator, const Vector& start) const {
  SilenceGlog();
  const auto n = static_cast<std::size_t>(start.size());
  const double cost_tolerance = std::max(cost_tolerance_, evaluator.fit().problem().cost_noise_level());
  Iterate iterate(evaluator, start);
  Vector x = start;
  std::vector<bool> held(n, false);
  Search search;
  for (int rounds = 0; rounds < kMaxRounds; ++rounds) {
    std::vector<Group> groups = GroupByTrial(evaluator.fit(), x, held);
    Round round;
    if (!groups.empty()) {
      round = SolveFace(evaluator, iterate, groups, held, cost_tolerance);
      search.stop = StopFromSummary(round.summary);
      search.iterations += static_cast<int>(round.summary.iterations.size());
      if (evaluator.stop_cause() != Evaluator::StopCause::kNone) return search;
      for (const Group& group : groups) {
        for (std::size_t i = 0; i < group.variables.size(); ++i) x[group.variables[i]] = group.values[i];
      }
    }
    const bool at_bound = (x.array() == 0 || x.array() == 1).any();
    if (!at_bound || (!round.found_active_bound && !search.stop.converged() && !groups.empty()))
      return search;

    iterate.PrepareForEvaluation(true, true);
    if (!iterate.ok()) return search;
    const Iterate::Slopes slopes = iterate.GetSlopes();
    const std::vector<bool> pushed = Pushed(x, slopes.gradient);
    double gain = 0;
    for (std::size_t k = 0; k < n; ++k) {
      if (!pushed[k]) gain = std::max(gain, slopes.gain[static_cast<Eigen::Index>(k)]);
    }
    const double allowed = cost_tolerance * evaluator.best().cost;
    if (gain <= allowed) {
      if (groups.empty() || !search.stop.converged()) {
        search.stop = {
            Termination::kGradient,
            fmt::format("no variable alone lowers the cost by more than {:.3g} <= {:.3g}", gain, allowed)};
      }
      return search;
    }
    if (pushed == held) return search;
    held = pushed;
  }
  search.stop = {Termination::kSolverFailed,
                 fmt::format("the set of variables at their bounds did not settle in {} rounds", kMaxRounds)};
  return search;
}

}  // namespace sinew::solvers
