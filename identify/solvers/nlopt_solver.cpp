#include "identify/solvers/nlopt_solver.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <limits>
#include <mutex>
#include <vector>

#include "base/text.h"
#include "identify/solvers/objective.h"

namespace sinew::solvers {
namespace {

// Distance in the unit box.
constexpr double kBeside = 1e-3;
constexpr double kStepTolerance = 1e-10;          // in the unit box
constexpr int kDefaultGlobalEvaluations = 20000;  // global searches without a budget
constexpr long kMaxStogoEvaluations = 100000;
constexpr std::size_t kMostFailed = 4096;
constexpr double kCostWithoutAnyPrediction = 1e100;  // until one point has a cost

using Handle = std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)>;

bool Contains(const std::string& name, const char* part) {
  return name.find(part) != std::string::npos;
}

// What NLopt's callbacks share.
struct Call {
  Call(Evaluator& to, Evaluator::Infeasible infeasible, nlopt_opt of)
      : evaluator(to), objective(to, infeasible), handle(of), workspace(to.fit().NewWorkspace()) {
    if (to.has_best() && to.best().cost > 0) scale = 1 / to.best().cost;
  }

  Evaluator& evaluator;
  Objective objective;
  nlopt_opt handle;
  /// The cost is divided by its first value for NLopt: SLSQP's first step is the gradient itself, and with a
  /// cost of 1e5 it would end in a corner of the box.
  double scale = 1;
  Vector x;
  Vector gradient;
  LeastSquares::Workspace workspace;
  Vector constraint_values;
  Matrix constraint_jacobian;
  double best = std::numeric_limits<double>::infinity();
  double last_improvement = 0;  // relative
  std::deque<Vector> failed;    // points, the last kMostFailed of them
};

double CostForNlopt(unsigned n, const double* x, double* gradient, void* data) {
  Call& call = *static_cast<Call*>(data);
  call.x = Eigen::Map<const Vector>(x, n);
  double cost = 0;
  if (gradient == nullptr) {
    cost = call.objective.Cost(call.x);
  } else {
    cost = call.objective.Gradient(call.x, call.gradient);
    Eigen::Map<Vector>(gradient, n) = call.scale * call.gradient;
  }
  cost *= call.scale;
  if (call.objective.stopped()) nlopt_force_stop(call.handle);
  if (!std::isfinite(cost)) {
    if (call.failed.size() == kMostFailed) call.failed.pop_front();
    if (!call.objective.stopped()) call.failed.push_back(call.x);
    return std::isfinite(call.objective.worst()) ? 2 * call.scale * call.objective.worst()
                                                 : kCostWithoutAnyPrediction;
  }
  if (cost < call.best) {
    call.last_improvement = std::isfinite(call.best) ? (call.best - cost) / call.best : 1;
    call.best = cost;
  }
  return cost;
}

void ConstraintsForNlopt(unsigned m, double* values, unsigned n, const double* x, double* gradient,
                         void* data) {
  Call& call = *static_cast<Call*>(data);
  const Vector at = Eigen::Map<const Vector>(x, n);
  const Status status = call.evaluator.fit().Constraints(
      at, call.workspace, call.constraint_values, gradient == nullptr ? nullptr : &call.constraint_jacobian);
  if (!status) {  // no prediction: the cost fails at this point too
    std::fill_n(values, m, 1.0);
    if (gradient != nullptr) std::fill_n(gradient, m * n, 0.0);
    return;
  }
  Eigen::Map<Vector>(values, m) = call.constraint_values;
  if (gradient == nullptr) return;
  for (unsigned i = 0; i < m; ++i) {
    for (unsigned k = 0; k < n; ++k) gradient[i * n + k] = call.constraint_jacobian(i, k);
  }
}

class NloptSolver : public Solver {
 public:
  NloptSolver(nlopt_algorithm algorithm, std::string name, std::uint64_t seed, double cost_tolerance)
      : algorithm_(algorithm), name_(std::move(name)), seed_(seed), cost_tolerance_(cost_tolerance) {}

  [[nodiscard]] bool ToleratesFailedStart() const override { return global(); }
  [[nodiscard]] bool ToleratesInfeasibleStart() const override { return global() || TakesConstraints(); }

 private:
  [[nodiscard]] bool global() const { return name_[0] == 'G'; }

  // Asked of NLopt itself, which rejects constraints that the algorithm does not support.
  [[nodiscard]] bool TakesConstraints() const {
    const Handle handle(nlopt_create(algorithm_, 1), &nlopt_destroy);
    const auto constraint = [](unsigned, double*, unsigned, const double*, double*, void*) {};
    return nlopt_add_inequality_mconstraint(handle.get(), 1, constraint, nullptr, nullptr) == NLOPT_SUCCESS;
  }

  void SetStops(nlopt_opt handle) const {
    nlopt_set_ftol_rel(handle, cost_tolerance_);
    nlopt_set_xtol_abs1(handle, kStepTolerance);
  }

  Search DoSolve(Evaluator& evaluator, const Vector& start) const override {
    static std::mutex generator;
    const std::lock_guard<std::mutex> lock(generator);
    nlopt_srand(static_cast<unsigned long>(seed_));

    const auto n = static_cast<unsigned>(start.size());
    const Handle handle(nlopt_create(algorithm_, n), &nlopt_destroy);
    nlopt_opt opt = handle.get();
    nlopt_set_lower_bounds1(opt, 0);
    nlopt_set_upper_bounds1(opt, 1);
    SetStops(opt);
    const bool limited = evaluator.options().budget.max_evaluations != Budget{}.max_evaluations;
    int most = global() && !limited ? kDefaultGlobalEvaluations : 0;
    // StoGO ignores nlopt_force_stop: after a stop it continues to its own limit with a constant cost.
    if (limited && Contains(name_, "STOGO")) {
      most = static_cast<int>(std::min(evaluator.remaining().max_evaluations, kMaxStogoEvaluations));
    }
    nlopt_set_maxeval(opt, most);
    if (Contains(name_, "MLSL") || Contains(name_, "AUGLAG")) {
      const bool gradient = name_[1] == 'D';
      const Handle local(nlopt_create(gradient ? NLOPT_LD_LBFGS : NLOPT_LN_BOBYQA, n), &nlopt_destroy);
      SetStops(local.get());
      nlopt_set_local_optimizer(opt, local.get());
    }
    const auto constraints = static_cast<unsigned>(evaluator.fit().constraints());
    const bool aware = constraints > 0 && TakesConstraints();
    Call call(evaluator, aware ? Evaluator::Infeasible::kEvaluate : Evaluator::Infeasible::kReject, opt);
    if (aware) nlopt_add_inequality_mconstraint(opt, constraints, ConstraintsForNlopt, &call, nullptr);
    nlopt_set_min_objective(opt, CostForNlopt, &call);

    Vector x = start;
    double cost = 0;
    const nlopt_result result = nlopt_optimize(opt, x.data(), &cost);
    Search search{StopFromNlopt(result, opt, call), nlopt_get_numevals(opt), {}};
    const bool sees_values_only = name_[0] == 'L' && name_[1] == 'N';
    if (sees_values_only && search.stop.converged() && evaluator.has_best() && EndedBesideFailures(call))
      search.stop = {Termination::kSolverFailed,
                     "it ended beside points without prediction, which may lie between "
                     "it and the minimum; " +
                         search.stop.test};
    return search;
  }

  // A search that knows values only cannot tell a minimum from the edge of a region without prediction.
  static bool EndedBesideFailures(const Call& call) {
    const Vector& best = call.evaluator.best().x;
    return std::any_of(call.failed.begin(), call.failed.end(), [&](const Vector& x) {
      return (x - best).cwiseAbs().maxCoeff() <= kBeside && !call.evaluator.Violated(x);
    });
  }

  [[nodiscard]] Stop StopFromNlopt(nlopt_result result, nlopt_opt opt, const Call& call) const {
    const std::string last = fmt::format("last improvement {:.3g} of the cost", call.last_improvement);
    // StoGO reports that as a success.
    const int most = nlopt_get_maxeval(opt);
    if (most > 0 && nlopt_get_numevals(opt) >= most) result = NLOPT_MAXEVAL_REACHED;
    switch (result) {
      case NLOPT_FTOL_REACHED:
        return {Termination::kCostChange,
                fmt::format("relative cost change <= {:.3g}; {}", cost_tolerance_, last)};
      case NLOPT_XTOL_REACHED:
        return {Termination::kStepSize,
                fmt::format("step <= {:.3g} of every range; {}", kStepTolerance, last)};
      case NLOPT_ROUNDOFF_LIMITED:
        return {Termination::kStepSize, "rounding limits the progress; " + last};
      case NLOPT_SUCCESS:
        return {name_[1] == 'D' ? Termination::kGradient : Termination::kCostChange,
                "NLopt's own test of convergence; " + last};
      case NLOPT_MAXEVAL_REACHED:
        return {Termination::kMaxEvaluations,
                fmt::format("{} evaluations, the most that this search is given; {}", most, last)};
      default: {
        const char* words = nlopt_get_errmsg(opt);
        return {Termination::kSolverFailed,
                fmt::format("NLopt: {}{}{}; {}", Lowercase(nlopt_result_to_string(result)),
                            words == nullptr ? "" : ", ", words == nullptr ? "" : words, last)};
      }
    }
  }

  nlopt_algorithm algorithm_;
  std::string name_;
  std::uint64_t seed_;
  double cost_tolerance_;
};

}  // namespace

Result<std::unique_ptr<Solver>> MakeNlopt(const std::string& algorithm, const SolverOptions& options) {
  std::vector<std::string> names;
  for (int i = 0; i < NLOPT_NUM_ALGORITHMS; ++i) {
    const auto known = static_cast<nlopt_algorithm>(i);
    names.emplace_back(nlopt_algorithm_to_string(known));
    if (names.back() != algorithm) continue;
    return std::make_unique<NloptSolver>(known, algorithm, options.seed, options.cost_tolerance);
  }
  return Fail("solver 'nlopt:{}': NLopt has no such algorithm{}", algorithm, Suggestion(algorithm, names));
}

}  // namespace sinew::solvers
