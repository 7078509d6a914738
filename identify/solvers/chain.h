// A chain of solvers, `sa+ceres`: each starts at the best point of those before.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// Runs the solvers in order and records each as a Stage. A budget of evaluations is shared: the solvers
/// before the last get equal parts of four fifths of it, and evaluations they do not use go to those after
/// them. The chain's stop reason is that of its last solver.
class Chain : public Solver {
 public:
  struct Link {
    std::string name;
    std::unique_ptr<Solver> solver;
  };

  /// @pre at least one link.
  explicit Chain(std::vector<Link> links) : links_(std::move(links)) {}

  [[nodiscard]] bool ToleratesFailedStart() const override {
    return links_.front().solver->ToleratesFailedStart();
  }
  [[nodiscard]] bool ToleratesInfeasibleStart() const override {
    return links_.front().solver->ToleratesInfeasibleStart();
  }

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  std::vector<Link> links_;
};

}  // namespace sinew::solvers
