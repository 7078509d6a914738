// Quantised channels: they are recognised from the readings without a fit, and what counts for the diagnosis
// is the share of quantisation in the residual.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/score/candidate.h"
#include "identify/problem.h"

namespace sinew::diagnosis {

struct Quantisation {
  std::string channel;
  std::string unit;
  std::string effect;      ///< CHANNEL.quantisation
  double step = 0;         ///< [unit]
  double uncertainty = 0;  ///< of the step [unit], such that its multiples fit the largest reading
  double statistic =
      0;  ///< sum of squared rounding errors (step^2 / 12 per sample) over the residual's variance
};

/// Channels whose readings in the training trials are multiples of a step (QuantisationStep), with its share
/// of the residual of a model. @param point [P] of the model. Errors: those of Problem::Predict.
Result<std::vector<Quantisation>> FindQuantisation(const Problem& problem, const Vector& point);

/// Removes the quantisation effects from the candidates: the change of the prediction by rounding is not a
/// signature that a score test can use.
void RemoveQuantisation(const Problem& problem, std::vector<Candidate>& candidates);

}  // namespace sinew::diagnosis
