// Whether named causes explain the error at least as well as terms that stand for no cause.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/score/scored_model.h"

namespace sinew::diagnosis {

/// A term that could explain the error without any effect of the library.
struct FreeTerm {
  std::string name;      ///< CHANNEL(SIGNAL), PARAMETER(SIGNAL), or the name of a discrepancy term
  double explained = 0;  ///< drop of the squared whitened residual, to first order
  int degrees = 0;       ///< directions that the base model leaves of it
};

/// Price of a model's freedom in units of deviance: kPerParameter for each of its `degrees`, and 2 ln(m) for
/// each of the `chosen` terms that were picked from `m` (risk inflation: Foster, George (1994), Ann. Stat.
/// 22:1947-1975). Without the second part several named causes, each the best of a library, would always be
/// cheaper than one curve.
[[nodiscard]] double PriceOf(double degrees, std::size_t chosen, std::size_t m);

/// The named causes of a model against the best free term.
struct FreeTermComparison {
  double named = 0;  ///< explained by all causes together
  double price = 0;  ///< of the causes: PriceOf(their parameters, causes, known candidates)
  FreeTerm best;     ///< with the largest explained - price; `degrees` 0: there was none to compare with
  double best_price = 0;

  /// The free term explains more after the prices.
  [[nodiscard]] bool FreeTermIsBetter() const {
    return best.degrees > 0 && best.explained - best_price > named - price;
  }
};

/// Compares, for the training trials, what the causes explain of the base model's residual with what each of
/// these terms explains there in their place:
///  - every discrepancy term and drift among the candidates, with all its knots;
///  - for every channel and each of its signals (time in the trial and Problem::ResidualCovariates) a curve
///    of 24 linear basis functions, which is added to the reading: three times finer than a port's;
///  - for every free parameter a change that is proportional to the time in the trial, and a curve of 5
///    linear basis functions of each signal: a parameter of the model should be a constant (varying
///    coefficients: Hastie, Tibshirani (1993), J. R. Stat. Soc. B 55:757-796). To first order.
///
/// All in one noise model, that of the extended model, because a noise model of the base model's residual can
/// absorb the error. The causes' share is the larger of that of their linearisation and of their refit. A
/// signal with the name of the channel itself is taken from the prediction, since the noise of the reading
/// would be in both.
///
/// @param base the base model @param extended the model with the causes, scored @param causes released in
/// `extended`, not empty
/// Errors: those of Problem::Predict at the base point.
Result<FreeTermComparison> CompareWithFreeTerms(const Problem& problem,
                                                const std::vector<Candidate>& candidates,
                                                const ScoredModel& base, const ScoredModel& extended,
                                                const std::vector<int>& causes);

}  // namespace sinew::diagnosis
