// A discrepancy term to first order: a parameter that changes with time within a trial, whose effect follows
// from the parameter's own derivative; or a curve with many knots, some of which the data determine badly.
#pragma once

#include <vector>

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/held_out_gain.h"
#include "identify/diagnosis/score/candidate.h"

namespace sinew::diagnosis {

struct LinearTerm {
  Vector values;  ///< [K] of a curve at its knots; of a drift one value: half the change from begin to end
                  ///< [its unit]
  Vector deviations;     ///< [K] standard deviations of `values`
  double shrinkage = 0;  ///< prior standard deviation of a curve's values [its unit]; infinite for a drift
  std::vector<Vector> train;  ///< residuals of the training blocks with the term [blocks][samples], weighted
  /// Residuals of the held-out trials [blocks][samples], weighted, as from HeldOut, without and with the
  /// term. Empty if there are none.
  std::vector<Vector> before;
  std::vector<Vector> after;
};

/// One linear step from a fitted model: its free parameters and the term together, under its noise. The
/// held-out trials are predicted with the values from the training trials and their own nuisance parameters.
///
/// A curve's values are shrunk towards zero as random effects (Laird, Ware 1982), with the prior deviation of
/// maximum likelihood: values at knots with little data then stay near zero.
/// @param candidate a discrepancy term or a drift @param noise a model that has not absorbed the term:
/// ScoredModel::noise, not that of the refit. Errors: those of Problem::Predict; the data do not determine
/// the term.
Result<LinearTerm> FitLinearTerm(const Problem& problem, const Refit& refit, const Candidate& candidate,
                                 const noise::NoiseModel& noise, const HeldOut& held_out);

}  // namespace sinew::diagnosis
