#include "identify/solvers/ipopt_solver.h"

#include <algorithm>
#include <coin/IpIpoptApplication.hpp>
#include <coin/IpSolveStatistics.hpp>
#include <coin/IpTNLP.hpp>
#include <limits>
#include <mutex>

namespace sinew::solvers {
namespace {

using Ipopt::Index;
using Ipopt::Number;

constexpr double kIpoptTolerance = 1e-10;
constexpr int kMaxIpoptIterations = 3000;
// A start on a bound is moved inside by this share of the box; Ipopt's default of 1e-2 would undo most of an
// earlier search.
constexpr double kBoundPush = 1e-6;

// A fit as Ipopt's nonlinear program. The cost, its gradient and the Gauss-Newton Hessian come from one
// evaluation.
class Program : public Ipopt::TNLP {
 public:
  Program(Evaluator& evaluator, const Vector& start)
      : evaluator_(evaluator),
        problem_(evaluator.fit()),
        start_(start),
        x_(start),
        jacobian_(problem_.NewJacobian()),
        workspace_(problem_.NewWorkspace()) {}

  [[nodiscard]] int iterations() const { return iterations_; }

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jacobian, Index& nnz_hessian,
                    IndexStyleEnum& style) override {
    n = problem_.variables();
    m = problem_.constraints();
    nnz_jacobian = n * m;
    nnz_hessian = n * (n + 1) / 2;
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* lower, Number* upper, Index m, Number* g_lower,
                       Number* g_upper) override {
    std::fill_n(lower, n, 0.0);
    std::fill_n(upper, n, 1.0);
    std::fill_n(g_lower, m, -std::numeric_limits<double>::max());
    std::fill_n(g_upper, m, 0.0);
    return true;
  }

  bool get_starting_point(Index n, bool /*init_x*/, Number* x, bool /*init_z*/, Number* /*z_lower*/,
                          Number* /*z_upper*/, Index /*m*/, bool /*init_lambda*/,
                          Number* /*lambda*/) override {
    Eigen::Map<Vector>(x, n) = start_;
    return true;
  }

  bool eval_f(Index n, const Number* x, bool /*new_x*/, Number& cost) override {
    if (!Predict(n, x)) return false;
    cost = 0.5 * residuals_.squaredNorm();
    return true;
  }

  bool eval_grad_f(Index n, const Number* x, bool /*new_x*/, Number* gradient) override {
    if (!Predict(n, x)) return false;
    std::fill_n(gradient, n, 0.0);
    for (const SparseJacobian::Piece& piece : jacobian_.pieces) {
      const auto rows = residuals_.segment(piece.first_row, piece.values.rows());
      for (std::size_t k = 0; k < piece.variables.size(); ++k) {
        gradient[piece.variables[k]] += piece.values.col(static_cast<Eigen::Index>(k)).dot(rows);
      }
    }
    return true;
  }

  bool eval_g(Index n, const Number* x, bool /*new_x*/, Index m, Number* g) override {
    if (!problem_.Constraints(Eigen::Map<const Vector>(x, n), workspace_, constraint_values_, nullptr))
      return false;
    Eigen::Map<Vector>(g, m) = constraint_values_;
    return true;
  }

  bool eval_jac_g(Index n, const Number* x, bool /*new_x*/, Index m, Index /*entries*/, Index* row,
                  Index* column, Number* values) override {
    if (values == nullptr) {
      for (Index i = 0; i < n * m; ++i) {
        row[i] = i % m;
        column[i] = i / m;
      }
      return true;
    }
    if (!problem_.Constraints(Eigen::Map<const Vector>(x, n), workspace_, constraint_values_,
                              &constraint_jacobian_))
      return false;
    Eigen::Map<Matrix>(values, m, n) = constraint_jacobian_;
    return true;
  }

  // The curvature of constraints is left out, as that of the residuals is.
  bool eval_h(Index n, const Number* x, bool /*new_x*/, Number cost_factor, Index /*m*/,
              const Number* /*lambda*/, bool /*new_lambda*/, Index /*entries*/, Index* row, Index* column,
              Number* values) override {
    if (values == nullptr) {
      Index at = 0;
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j <= i; ++j) {
          row[at] = i;
          column[at++] = j;
        }
      }
      return true;
    }
    if (!Predict(n, x)) return false;
    Matrix hessian = Matrix::Zero(n, n);
    for (const SparseJacobian::Piece& piece : jacobian_.pieces) {
      const Matrix product = Gram(piece.values);
      for (std::size_t i = 0; i < piece.variables.size(); ++i) {
        for (std::size_t j = 0; j < piece.variables.size(); ++j) {
          hessian(piece.variables[i], piece.variables[j]) +=
              product(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        }
      }
    }
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j <= i; ++j) *values++ = cost_factor * hessian(i, j);
    }
    return true;
  }

  bool intermediate_callback(Ipopt::AlgorithmMode /*mode*/, Index iteration, Number /*cost*/,
                             Number /*infeasibility*/, Number /*dual*/, Number /*mu*/, Number /*step*/,
                             Number /*regularisation*/, Number /*alpha_dual*/, Number /*alpha_primal*/,
                             Index /*line_search*/, const Ipopt::IpoptData* /*data*/,
                             Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {
    iterations_ = iteration;
    return evaluator_.stop_cause() == Evaluator::StopCause::kNone;
  }

  void finalize_solution(Ipopt::SolverReturn /*status*/, Index /*n*/, const Number* /*x*/,
                         const Number* /*z_lower*/, const Number* /*z_upper*/, Index /*m*/,
                         const Number* /*g*/, const Number* /*lambda*/, Number /*cost*/,
                         const Ipopt::IpoptData* /*data*/,
                         Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {}

 private:
  bool Predict(Index n, const Number* x) {
    const Eigen::Map<const Vector> at(x, n);
    if (!evaluated_ || at != x_) {
      x_ = at;
      evaluated_ = true;
      outcome_ = evaluator_.Residuals(x_, residuals_, &jacobian_, Evaluator::Infeasible::kEvaluate);
    }
    return outcome_ == Evaluator::Outcome::kOk;
  }

  Evaluator& evaluator_;
  const LeastSquares& problem_;
  const Vector& start_;
  Vector x_;
  Vector residuals_;
  SparseJacobian jacobian_;
  LeastSquares::Workspace workspace_;  // of constraints
  Vector constraint_values_;
  Matrix constraint_jacobian_;
  bool evaluated_ = false;
  Evaluator::Outcome outcome_ = Evaluator::Outcome::kOk;
  int iterations_ = 0;
};

const char* InWords(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Infeasible_Problem_Detected:
      return "converged to a point that violates a constraint";
    case Ipopt::Restoration_Failed:
      return "restoration phase failed";
    case Ipopt::Error_In_Step_Computation:
      return "error in step computation";
    case Ipopt::Invalid_Number_Detected:
      return "no prediction where the search begins";
    case Ipopt::Maximum_Iterations_Exceeded:
      return "iteration limit reached";
    case Ipopt::Diverging_Iterates:
      return "iterates diverge";
    case Ipopt::User_Requested_Stop:
      return "stopped";
    case Ipopt::Not_Enough_Degrees_Of_Freedom:
      return "more constraints than free parameters";
    case Ipopt::Insufficient_Memory:
      return "out of memory";
    default:
      return "internal error";
  }
}

Stop StopFromIpopt(Ipopt::ApplicationReturnStatus status, Ipopt::IpoptApplication& application) {
  const Ipopt::SmartPtr<Ipopt::SolveStatistics> statistics = application.Statistics();
  if (!Ipopt::IsValid(statistics)) return {Termination::kSolverFailed, InWords(status)};
  Number dual = 0;
  Number violation = 0;
  Number complementarity = 0;
  Number error = 0;
  statistics->ScaledInfeasibilities(dual, violation, complementarity, error);
  switch (status) {
    case Ipopt::Solve_Succeeded:
      return {Termination::kGradient,
              fmt::format("optimality error {:.3g} <= {:.3g}", error, kIpoptTolerance)};
    case Ipopt::Solved_To_Acceptable_Level:
      return {Termination::kGradient,
              fmt::format("optimality error {:.3g} at 15 iterates, acceptable to Ipopt", error)};
    case Ipopt::Search_Direction_Becomes_Too_Small:
      return {Termination::kStepSize, fmt::format("step is rounding, optimality error {:.3g}", error)};
    default:
      return {Termination::kSolverFailed, fmt::format("{}, optimality error {:.3g}", InWords(status), error)};
  }
}

}  // namespace

Search IpoptSolver::DoSolve(Evaluator& evaluator, const Vector& start) const {
  static std::mutex mumps;
  const std::lock_guard<std::mutex> lock(mumps);

  const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
  const Ipopt::SmartPtr<Ipopt::OptionsList> options = application->Options();
  options->SetIntegerValue("print_level", 0);
  options->SetStringValue("sb", "yes");
  options->SetStringValue("linear_solver", "mumps");
  options->SetNumericValue("tol", kIpoptTolerance);
  options->SetIntegerValue("max_iter", kMaxIpoptIterations);
  options->SetNumericValue("bound_relax_factor", 0);
  options->SetNumericValue("bound_push", kBoundPush);
  options->SetNumericValue("bound_frac", kBoundPush);
  options->SetStringValue("mu_strategy", "adaptive");
  if (hessian_ == Hessian::kLimitedMemory) {
    options->SetStringValue("hessian_approximation", "limited-memory");
  }
  if (application->Initialize() != Ipopt::Solve_Succeeded) {
    return {{Termination::kSolverFailed, "Ipopt does not start"}, 0, {}};
  }
  const Ipopt::SmartPtr<Program> program = new Program(evaluator, start);
  const Ipopt::ApplicationReturnStatus status = application->OptimizeTNLP(Ipopt::GetRawPtr(program));
  return {StopFromIpopt(status, *application), program->iterations(), {}};
}

}  // namespace sinew::solvers
