// What measurement would determine a parameter that the fitted channels leave open: computed from the
// Jacobian that it would add.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/uncertainty/linearization.h"
#include "identify/uncertainty/noise.h"
#include "identify/uncertainty/reason.h"

namespace sinew::uncertainty {

/// Something that could be measured, or fitted as well.
struct Addition {
  AdditionName name;
  Matrix information;  ///< [n x n] that it adds about the fitted variables, unit box
};

/// Every channel of role kPredicted (together over all trials that are fitted), and every trial of role
/// kValidate. Noise of one sample: Block::sigma; else that of the fitted channel of the same name; else the
/// median ratio of residual to signal of the fitted channels, times the predicted signal. A channel without
/// measured samples is taken to deliver as many as the fitted channel of its trial with most. Noise is taken
/// as independent. A trial's own nuisance parameters would be fitted with it: what they can follow adds
/// nothing. Errors: the problem's own.
Result<std::vector<Addition>> PossibleAdditions(const LeastSquares& problem, const Linearization& at,
                                                const Noise& noise);

/// Information of the fit itself [n x n]; variables that are held on a bound have none.
[[nodiscard]] Matrix FittedInformation(const Linearization& at, const Noise& noise);

/// Root of the diagonal of the inverse [n, unit box]; infinite for what the information does not determine.
[[nodiscard]] Vector StandardErrors(const Matrix& information);

/// Finds the smallest additions for one parameter after another.
class RemedyFinder {
 public:
  /// Both must outlive this object. @param quantile of a 95 % interval
  RemedyFinder(const LeastSquares& problem, const Linearization& at, const Noise& noise, double quantile);

  /// Single additions, the best first; if there are none, the best pair; else what knowing another parameter
  /// would bring.
  [[nodiscard]] Remedy For(int variable) const;

 private:
  struct Choice {
    std::vector<AdditionName> additions;
    double error = 0;  ///< [unit box]
  };
  [[nodiscard]] bool Fixes(int variable, double error) const;
  /// The best choices, in the parameter's unit.
  [[nodiscard]] std::vector<RemedyOption> Best(int variable, std::vector<Choice> choices) const;
  [[nodiscard]] std::vector<Choice> KnownValues(int variable) const;

  const LeastSquares& problem_;
  const Linearization& at_;
  double quantile_;
  Matrix base_;
  std::vector<Addition> additions_;
  std::vector<Vector> errors_with_;  // [additions]
  std::string failure_;
};

}  // namespace sinew::uncertainty
