// Readings on a lattice: no fit is needed to see that a sensor rounds, and no model can undo it; what counts
// is how much of the residual it makes.
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
  double uncertainty = 0;  ///< of the step [unit]: how far its multiples may be off at the largest reading
  double statistic = 0;  ///< sum of squares of rounding (step^2 / 12 per sample) over the residual's variance
};

/// Channels whose fitted readings lie on a lattice (QuantisationStep), against the residual of a model.
/// @param point [P] of the model. Errors: the problem's own.
Result<std::vector<Quantisation>> FindQuantisation(const Problem& problem, const Vector& point);

/// Takes the rounding of channels out of the candidates: their change of the prediction is no signature.
void RemoveQuantisation(const Problem& problem, std::vector<Candidate>& candidates);

}  // namespace sinew::diagnosis
