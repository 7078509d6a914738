#include "identify/uncertainty/reason.h"

namespace sinew {

const char* ToString(ReasonKind kind) {
  switch (kind) {
    case ReasonKind::kDetermined:
      return "determined";
    case ReasonKind::kAtBound:
      return "at_bound";
    case ReasonKind::kNoResponse:
      return "no_response";
    case ReasonKind::kNoResponseHere:
      return "no_response_here";
    case ReasonKind::kCompensated:
      return "compensated";
    case ReasonKind::kCombination:
      return "combination";
    case ReasonKind::kFlatCost:
      return "flat_cost";
    case ReasonKind::kDependentResiduals:
      return "dependent_residuals";
    case ReasonKind::kWeakExcitation:
      return "weak_excitation";
    case ReasonKind::kPartiallyCompensated:
      return "partially_compensated";
    case ReasonKind::kCorrelated:
      return "correlated";
    case ReasonKind::kNoiseLevelUnknown:
      return "noise_level_unknown";
  }
  return "?";
}

const char* ToString(AdditionKind kind) {
  switch (kind) {
    case AdditionKind::kChannel:
      return "channel";
    case AdditionKind::kTrial:
      return "trial";
    case AdditionKind::kKnownValue:
      return "known_value";
  }
  return "?";
}

const char* ToString(RemedyKind kind) {
  switch (kind) {
    case RemedyKind::kNone:
      return "none";
    case RemedyKind::kAdditions:
      return "additions";
    case RemedyKind::kNoChannel:
      return "no_channel";
    case RemedyKind::kIndependentNoise:
      return "independent_noise";
    case RemedyKind::kNotPredicted:
      return "not_predicted";
    case RemedyKind::kOtherBound:
      return "other_bound";
    case RemedyKind::kMoreSamples:
      return "more_samples";
  }
  return "?";
}

const char* ToString(ProfileFailure kind) {
  switch (kind) {
    case ProfileFailure::kNone:
      return "";
    case ProfileFailure::kInterrupted:
      return "interrupted";
    case ProfileFailure::kBudgetSpent:
      return "budget_spent";
    case ProfileFailure::kRefitNotConverged:
      return "refit_not_converged";
    case ProfileFailure::kNoPrediction:
      return "no_prediction";
    case ProfileFailure::kRoughCost:
      return "rough_cost";
  }
  return "?";
}

}  // namespace sinew
