// Trials that the model contradicts although it fits all others: what was measured there, or recorded as
// input, is likely to be wrong.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "identify/fit_setup.h"
#include "identify/problem.h"
#include "identify/warning.h"

namespace sinew {

/// A channel of a training trial that the model, fitted to the other ones, predicts much worse than it fits
/// any of these; or at another time, where the prediction of the others is in step.
struct OddTrial {
  std::string trial;
  std::string channel;
  std::string unit;
  double rmse = 0;    ///< [unit] of this trial, left out of the fit but for its own nuisance parameters
  double others = 0;  ///< [unit] the largest of the other trials; if it is late, its own in step
  int among = 0;      ///< trials that have the channel, this one included
  double late = 0;    ///< [s] by which the measurement is late; 0: that is not what is odd
};

/// At most a third of the training trials and four, the oddest first; of each the channel that is odd most.
/// Nothing with fewer than three of them. Trials whose errors are like those of the others cost nothing; each
/// that is not costs a refit, which starts at `parameters`.
/// @param parameters [P] of the fit @param interrupt null: none; set: what was found so far
[[nodiscard]] std::vector<OddTrial> FindOddTrials(const Problem& problem, const FitSetup& setup,
                                                  const Vector& parameters,
                                                  const std::atomic<bool>* interrupt);

/// kOddTrial.
[[nodiscard]] Warning ToWarning(const OddTrial& odd);

}  // namespace sinew
