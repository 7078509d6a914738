// A chain of solvers, `sa+ceres`: each begins at the best point so far.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "identify/solvers/solver.h"

namespace sinew {

/// Runs every link in order and keeps each as a Stage. A budget of evaluations is shared: the links before
/// the last get equal parts of four fifths of it, and what they leave goes to those after them. The chain's
/// own reason to stop is that of its last link.
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

}  // namespace sinew
