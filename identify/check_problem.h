// Whether a problem keeps the contract of Problem: asked once, before anything is fitted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/fit_setup.h"
#include "identify/problem.h"

namespace sinew {

/// One derivative that is not what differences of the predictions say.
struct WrongDerivative {
  int block = 0;         ///< index into the layout
  std::string trial;     ///< of that block
  std::string channel;   ///< of that block
  int parameter = 0;     ///< index into parameters()
  std::string name;      ///< of the parameter
  int row = 0;           ///< prediction where they differ most
  double time = 0;       ///< [s] of that prediction
  double expected = 0;   ///< difference of the predictions [unit of the channel / unit of the parameter]
  double got = 0;        ///< derivative that Predict returned
  double deviation = 0;  ///< norm of the difference over all predictions, of the larger of the two norms
  Vector point;          ///< [P] where
};

struct JacobianReport {
  std::vector<WrongDerivative> wrong;  ///< worst first; at most one per block and parameter
  int columns = 0;                     ///< of all blocks and points
  int compared = 0;                    ///< those that are smooth enough for differences
  double worst = 0;                    ///< largest deviation of a compared column
  std::vector<int> never;              ///< parameters of which no column could be compared
};

struct JacobianOptions {
  int points = 3;           ///< the start, then random points inside of the bounds
  std::uint64_t seed = 1;   ///< of the random points
  double tolerance = 1e-4;  ///< deviation that is accepted
};

/// Compares every derivative of a problem with central differences of its predictions. Columns where
/// one-sided differences, or those of a longer step, disagree have a kink or are noisy there and are not
/// compared; neither are slopes that are secants (Parameter::null_step). Rounding steps are held at their
/// null (Parameter::is_rounding_step). Errors: no prediction at the start; a value or derivative that is not
/// finite.
Result<JacobianReport> CheckJacobian(const Problem& problem, const JacobianOptions& options = {});

/// Whether anything is fitted: a problem is bound, and predicts, without any training trial. Error: no block
/// of role kTrain has a sample.
[[nodiscard]] Status CheckSomethingToFit(const Problem& problem);

/// The declaration alone: parameters, layout (sizes, order, indices, finite numbers), effects, ports and
/// constraints. The error names the block (trial, channel), or the effect, the index and the value.
[[nodiscard]] Status CheckStructure(const Problem& problem);

/// Effects alone: indices in range, parameters that are this effect's.
[[nodiscard]] Status CheckEffects(const Problem& problem);

/// CheckStructure, then one prediction at the start with every derivative: each must be set and finite, and
/// agree in size and sign with differences (to a tenth). The error names trial, channel, sample and
/// parameter. A start that the problem itself refuses (Predict returns an Error) is that Error; what it
/// throws is one. Then CheckDistinctEffects.
[[nodiscard]] Status CheckProblem(const Problem& problem);

/// The same for a fit, and CheckSomethingToFit: what is free, at its start, on training blocks. A refused
/// start passes: the search reports it. Costs some five evaluations.
[[nodiscard]] Status CheckProblem(const Problem& problem, const FitSetup& setup);

}  // namespace sinew
