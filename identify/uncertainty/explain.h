// Why a parameter is determined or not.
#pragma once

#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "identify/uncertainty/information.h"
#include "identify/uncertainty/linearization.h"
#include "identify/uncertainty/noise.h"
#include "identify/uncertainty/reason.h"
#include "identify/uncertainty/verdict.h"

namespace sinew::uncertainty {

/// All must outlive this object.
class Explainer {
 public:
  /// @param info of the data alone, without the priors of findings, and as if no variable were on a bound
  /// @param quantile of a 95 % interval
  Explainer(const LeastSquares& problem, const Linearization& at, const Information& info, const Noise& noise,
            double quantile)
      : problem_(problem), at_(at), info_(info), noise_(noise), quantile_(quantile) {}

  /// For a variable that no fitted channel depends on, or that takes part in a lost direction.
  [[nodiscard]] Reason WhyUndetermined(int variable) const;
  /// For an interval that is too wide. @param error that it is made of, unit box
  [[nodiscard]] Reason WhyWide(int variable, const Interval& interval, double error) const;
  [[nodiscard]] Reason WhyAtBound(int variable) const;
  [[nodiscard]] Reason WhyIdentifiable(int variable, const Interval& interval) const;

  /// Combinations that are lost, or that make one of the given variables (with intervals that are too wide)
  /// what it is.
  [[nodiscard]] std::vector<OpenDirection> OpenDirections(const std::vector<int>& wide_variables) const;

 private:
  [[nodiscard]] const Parameter& parameter(int variable) const { return at_.parameter(problem_, variable); }
  [[nodiscard]] double value(int variable) const;
  /// Standard error of one variable if the columns of all others did not exist, unit box.
  [[nodiscard]] double ErrorAlone(const VectorRef& column) const;
  /// Standard error of the variable at place j with all others fitted, for independent residuals, unit box.
  [[nodiscard]] double ErrorTogether(int j) const;
  [[nodiscard]] bool WideWith(int variable, double error) const;
  /// The direction that makes up most of the variance of the variable at place j.
  [[nodiscard]] int DominantDirection(int j) const;
  /// Parameters that take part in a direction beside the one at place j, the largest loading first.
  [[nodiscard]] std::vector<std::string> Partners(int j, int direction) const;
  [[nodiscard]] std::vector<std::string> NuisancePartners(int j) const;
  [[nodiscard]] OpenDirection Direction(int direction) const;
  void AddWidth(int variable, const Interval& interval, Reason& reason) const;

  const LeastSquares& problem_;
  const Linearization& at_;
  const Information& info_;
  const Noise& noise_;
  double quantile_;
};

}  // namespace sinew::uncertainty
