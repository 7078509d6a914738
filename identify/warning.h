// What limits a result: facts, which identify/text turns into sentences.
#pragma once

#include <string>
#include <vector>

namespace sinew {

/// What a reader of a result must be told; after the colon, what `names` and `numbers` of the warning hold.
enum class WarningKind {
  // Of an identification.
  kFailedEvaluations,   ///< rejected by the solver: numbers {failed, all, then of each name how many}; names
                        ///< are the most frequent reasons (execution/failure_reasons.h); message of the first
  kNotConverged,        ///< the search ended early: message is the solver's stop test
  kNotAMinimum,         ///< a local search lowered the cost: numbers {from, to}
  kSearchUnfinished,    ///< that local search did not converge: intervals are rough
  kBetterFit,           ///< the cost fell below the minimum on the way to an interval: numbers {from, to}
  kBetterPointTaken,    ///< such a point, or one of that local search, became the answer: numbers {from, to}
  kCompetingMinima,     ///< that the data do not distinguish: numbers {minima, largest relative difference of
                        ///< costs, then of each name the largest difference in widths of its interval}; names
                        ///< are the values that differ most
  kDependentResiduals,  ///< numbers {largest widening of an interval, lag-one correlation of each channel};
                        ///< names are the channels
  kActiveConstraint,    ///< names {constraint}
  kOddTrial,  ///< the model fitted to the other trials contradicts this one: names {channel, trial, unit};
              ///< numbers {RMS error left out, largest of the others (if late: in step), number of
              ///< trials, time by which it is late [s] or 0}
  kHeldFromSteps,    ///< intervals contain the errors of `names`, which earlier steps found
  kUnfinishedStart,  ///< the values that it begins with, or is made of, are those of a run that was not
                     ///< finished: names {file}
  kStatedCost,       ///< that run states another cost than its values have: names {file}; numbers {stated,
                     ///< evaluated}
  // Of a diagnosis.
  kNoiseAbsorbsMisfit,  ///< residuals count as independent, since a noise model would replace the model
  kCrossValidated,  ///< causes chosen by the prediction of trials left out of the fit (Diagnosis::left_out):
                    ///< numbers {training trials searched, training trials}
  kEqualNoise,      ///< models are compared under equal noise, not under the objective of the problem
  kNoiseLevelUnknown,     ///< of channels: names {channel, why (few_samples, correlated, constant, smooth)},
                          ///< then those of other channels
  kNoValidationTrial,     ///< no gain can be measured
  kFreeTermExplainsMore,  ///< than the causes, so that these are not its explanation: names {term}; numbers
                          ///< {by the term, by the causes: predicted delta LR less the price of each}
  // Of both.
  kErrorConcentration,  ///< names {channel, trial}; numbers {share, width [s], time [s]}; then those of
                        ///< other channels and trials, the same again
  kErrorDrift,          ///< errors that grow to the end of a trial; the same
  kDataCheck,  ///< of a check of the data: names {kind of the finding, channel, trial}; numbers {from, to
               ///< [s]}; message
  kOther       ///< of the problem or of the data: message; names and numbers, if any, are its facts
};

/// "failed_evaluations", "not_converged", ...: the `kind` in JSON and HDF5.
[[nodiscard]] const char* ToString(WarningKind kind);

struct Warning {
  WarningKind kind = WarningKind::kOther;
  std::vector<std::string> names;
  std::vector<double> numbers;
  std::string message;
  std::string step = {};  ///< of a stepwise fit that it is about; empty: the last, or the only one
};

}  // namespace sinew
