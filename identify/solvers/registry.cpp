// Every solver in one visible list.
#include "base/text.h"
#include "identify/solvers/basin_hopping.h"
#include "identify/solvers/ceres_solver.h"
#include "identify/solvers/chain.h"
#include "identify/solvers/cmaes.h"
#include "identify/solvers/continuation.h"
#include "identify/solvers/independent_starts.h"
#include "identify/solvers/ipopt_solver.h"
#include "identify/solvers/levenberg_marquardt.h"
#include "identify/solvers/multistart.h"
#include "identify/solvers/nlopt_solver.h"
#include "identify/solvers/simulated_annealing.h"
#include "identify/solvers/solver.h"
#include "identify/solvers/stated_starts.h"

namespace sinew {
namespace {

const std::string kNloptPrefix = "nlopt:";

Status CheckOptions(const SolverOptions& options) {
  if (options.threads < 1) return Fail("threads: {}, expected at least 1", options.threads);
  if (options.starts < 1) return Fail("starts of a multi-start: {}, expected at least 1", options.starts);
  if (!(options.cost_tolerance > 0 && options.cost_tolerance < 1)) {
    return Fail("cost tolerance: {}, expected between 0 and 1", options.cost_tolerance);
  }
  return {};
}

Result<std::unique_ptr<Solver>> MakeOne(const std::string& name, const SolverOptions& options) {
  if (name == "sa") return std::make_unique<solvers::SimulatedAnnealing>(options.seed);
  if (name == "cmaes") return std::make_unique<solvers::CmaEs>(options.seed, options.cost_tolerance);
  if (name == "multistart") return std::make_unique<solvers::MultiStart>(options);
  if (name == "basin-hopping" || name == "hop") return std::make_unique<solvers::BasinHopping>(options);
  if (name == "restarts") return std::make_unique<solvers::IndependentStarts>(options);
  if (name == "starts") return std::make_unique<solvers::StatedStarts>(options);
  if (name == "ceres") return std::make_unique<solvers::CeresSolver>(options.cost_tolerance);
  if (name == "lm") return std::make_unique<solvers::LevenbergMarquardt>(options.cost_tolerance);
  if (name == "continuation") return std::make_unique<solvers::Continuation>(options.cost_tolerance);
  if (name == "ipopt")
    return std::make_unique<solvers::IpoptSolver>(solvers::IpoptSolver::Hessian::kGaussNewton);
  if (name == "ipopt-lbfgs")
    return std::make_unique<solvers::IpoptSolver>(solvers::IpoptSolver::Hessian::kLimitedMemory);
  if (name.compare(0, kNloptPrefix.size(), kNloptPrefix) == 0) {
    return solvers::MakeNlopt(name.substr(kNloptPrefix.size()), options);
  }
  std::vector<std::string> names;
  for (const SolverEntry& entry : SolverRegistry()) names.push_back(entry.name);
  return Fail("solver '{}' does not exist{}", name, Suggestion(name, names));
}

}  // namespace

const std::vector<SolverEntry>& SolverRegistry() {
  constexpr bool kGlobal = true;
  constexpr bool kLocal = false;
  constexpr bool kGradient = true;
  constexpr bool kCostOnly = false;
  constexpr bool kConstraints = true;
  constexpr bool kBox = false;
  static const std::vector<SolverEntry> kEntries = {
      {"sa", kGlobal, kCostOnly, kBox,
       "simulated annealing (Corana et al. 1987; Goffe, Ferrier, Rogers 1994)"},
      {"cmaes", kGlobal, kCostOnly, kBox, "covariance matrix adaptation (Hansen, Ostermeier 2001)"},
      {"multistart", kGlobal, kGradient, kBox, "Latin hypercube of starts, each polished by ceres"},
      {"basin-hopping", kGlobal, kGradient, kBox,
       "(alias: hop) lm from displacements of the best point (Wales, Doye 1997; Leary 2000)"},
      {"restarts", kGlobal, kGradient, kBox,
       "lm and basin hopping from independent starts until two end at the same minimum; beside nuisance "
       "values "
       "with priors continuation by different schedules"},
      {"starts", kLocal, kGradient, kBox, "lm from the given start and from others that the problem states"},
      {"ceres", kLocal, kGradient, kBox, "Levenberg-Marquardt on residual blocks (Ceres; Marquardt 1963)"},
      {"lm", kLocal, kGradient, kBox,
       "Levenberg-Marquardt with active bounds (Levenberg 1944; Marquardt 1963)"},
      {"continuation", kLocal, kGradient, kBox,
       "lm at noise levels that fall to the stated ones (Blake, Zisserman 1987; Allgower, Georg 1990)"},
      {"ipopt", kLocal, kGradient, kConstraints,
       "interior point, Gauss-Newton Hessian (Waechter, Biegler 2006)"},
      {"ipopt-lbfgs", kLocal, kGradient, kConstraints,
       "interior point, L-BFGS Hessian (Waechter, Biegler 2006)"},
      {"nlopt:LN_BOBYQA", kLocal, kCostOnly, kBox, "quadratic models in a trust region (Powell 2009)"},
      {"nlopt:LN_COBYLA", kLocal, kCostOnly, kConstraints, "linear models in a trust region (Powell 1994)"},
      {"nlopt:LN_NELDERMEAD", kLocal, kCostOnly, kBox, "downhill simplex (Nelder, Mead 1965; Box 1965)"},
      {"nlopt:LN_SBPLX", kLocal, kCostOnly, kBox, "simplex in subspaces (Rowan 1990)"},
      {"nlopt:LN_PRAXIS", kLocal, kCostOnly, kBox, "principal axes (Brent 1972)"},
      {"nlopt:LD_LBFGS", kLocal, kGradient, kBox, "limited-memory BFGS (Nocedal 1980; Luksan)"},
      {"nlopt:LD_SLSQP", kLocal, kGradient, kConstraints, "sequential quadratic programming (Kraft 1988)"},
      {"nlopt:LD_MMA", kLocal, kGradient, kConstraints, "moving asymptotes (Svanberg 2002)"},
      {"nlopt:LD_CCSAQ", kLocal, kGradient, kConstraints,
       "conservative separable quadratics (Svanberg 2002)"},
      {"nlopt:LD_TNEWTON_PRECOND_RESTART", kLocal, kGradient, kBox,
       "truncated Newton (Dembo, Steihaug 1983; Luksan)"},
      {"nlopt:LD_VAR2", kLocal, kGradient, kBox, "shifted variable metric (Vlcek, Luksan 2006)"},
      {"nlopt:GN_DIRECT_L", kGlobal, kCostOnly, kBox,
       "dividing rectangles (Jones et al. 1993; Gablonsky 2001)"},
      {"nlopt:GN_CRS2_LM", kGlobal, kCostOnly, kBox,
       "controlled random search (Price 1983; Kaelo, Ali 2006)"},
      {"nlopt:GN_ISRES", kGlobal, kCostOnly, kConstraints, "evolution strategy (Runarsson, Yao 2005)"},
      {"nlopt:GN_ESCH", kGlobal, kCostOnly, kBox, "evolutionary (Santos et al. 2010)"},
      {"nlopt:GN_AGS", kGlobal, kCostOnly, kConstraints, "adaptive global search (Strongin, Sergeyev 2000)"},
      {"nlopt:GD_STOGO", kGlobal, kGradient, kBox,
       "branch and bound (Gudmundsson 1998; Zertchaninov, Madsen)"},
      {"nlopt:GN_MLSL_LDS", kGlobal, kCostOnly, kBox,
       "multi-level single linkage with BOBYQA (Rinnooy Kan, Timmer 1987; Kucherenko, Sytsko 2005)"},
      {"nlopt:GD_MLSL_LDS", kGlobal, kGradient, kBox,
       "multi-level single linkage with L-BFGS (Rinnooy Kan, Timmer 1987; Kucherenko, Sytsko 2005)"},
  };
  return kEntries;
}

Result<std::unique_ptr<Solver>> MakeSolver(const std::string& name, const SolverOptions& options) {
  SINEW_TRY(CheckOptions(options));
  const std::vector<std::string_view> names = Split(name, '+');
  if (names.size() == 1) return MakeOne(name, options);

  std::vector<solvers::Chain::Link> links;
  for (const std::string_view link : names) {
    if (link.empty()) return Fail("solver chain '{}' has an empty link, expected names joined by '+'", name);
    SINEW_ASSIGN(std::unique_ptr<Solver> solver, MakeOne(std::string(link), options));
    links.push_back({std::string(link), std::move(solver)});
  }
  return std::make_unique<solvers::Chain>(std::move(links));
}

}  // namespace sinew
