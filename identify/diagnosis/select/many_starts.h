// Fits of one set of causes from many starts: local searches end in local minima, of which models with dry
// friction have many.
#pragma once

#include <vector>

#include "base/random.h"
#include "identify/fit_setup.h"
#include "identify/solvers/local_fit.h"

namespace sinew::diagnosis {

/// Short searches from all starts; the best few are continued to convergence. Searches of one step do not
/// depend on each other, so that several threads can share them.
class ManyStarts {
 public:
  /// @param fit must outlive it
  /// @param starts [P] each, not empty
  /// @param tolerance relative, of the cost
  /// @param continued more than one where the answer counts: a start in a wide basin is ahead at first
  ManyStarts(const LeastSquares& fit, const std::vector<Vector>& starts, double tolerance,
             std::size_t continued);

  [[nodiscard]] std::size_t starts() const { return found_.size(); }
  /// The short search from one start; any thread.
  void Search(std::size_t start);
  /// Keeps the best few. @pre the searches from all starts are done
  void Shorten();
  /// Those that are left.
  [[nodiscard]] std::size_t left() const { return found_.size(); }
  /// Continues one of them; any thread. @pre Shorten
  void Continue(std::size_t one);
  /// @pre all that are left were continued
  [[nodiscard]] const solvers::LocalFit::Outcome& Best() const;

 private:
  const LeastSquares& fit_;
  double tolerance_;
  std::size_t continued_;
  double penalty_ = 0;  // the same for all, so that their costs can be compared
  std::vector<solvers::LocalFit::Outcome> found_;
};

/// A random point [P] around `point`: normal steps of free base and effect parameters, in the logarithm where
/// the parameter has such a scale, else relative to its distance from the null. Three widths take turns: far
/// ones find other basins, near ones the lowest minimum of a rough one. @param turn 0, 1, ...: every second
/// draw places effect parameters anywhere in their ranges, uniform in the logarithm of their size, because a
/// local search may stay at the null, and at a bound that is one
[[nodiscard]] Vector DrawStart(const FitSetup& setup, const Vector& point, int turn, Random& random);

/// `point` [P] with all free effect parameters anywhere in their ranges.
[[nodiscard]] Vector DrawEffects(const FitSetup& setup, const Vector& point, Random& random);

}  // namespace sinew::diagnosis
