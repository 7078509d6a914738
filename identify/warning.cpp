#include "identify/warning.h"

namespace sinew {

const char* ToString(WarningKind kind) {
  switch (kind) {
    case WarningKind::kFailedEvaluations:
      return "failed_evaluations";
    case WarningKind::kNotConverged:
      return "not_converged";
    case WarningKind::kNotAMinimum:
      return "not_a_minimum";
    case WarningKind::kSearchUnfinished:
      return "search_unfinished";
    case WarningKind::kBetterFit:
      return "better_fit";
    case WarningKind::kBetterPointTaken:
      return "better_point_taken";
    case WarningKind::kCompetingMinima:
      return "competing_minima";
    case WarningKind::kDependentResiduals:
      return "dependent_residuals";
    case WarningKind::kActiveConstraint:
      return "active_constraint";
    case WarningKind::kHeldFromSteps:
      return "held_from_steps";
    case WarningKind::kUnfinishedStart:
      return "unfinished_start";
    case WarningKind::kStatedCost:
      return "stated_cost";
    case WarningKind::kNoiseAbsorbsMisfit:
      return "noise_absorbs_misfit";
    case WarningKind::kEqualNoise:
      return "equal_noise";
    case WarningKind::kCrossValidated:
      return "cross_validated";
    case WarningKind::kNoiseLevelUnknown:
      return "noise_level_unknown";
    case WarningKind::kNoValidationTrial:
      return "no_validation_trial";
    case WarningKind::kFreeTermExplainsMore:
      return "free_term_explains_more";
    case WarningKind::kOddTrial:
      return "odd_trial";
    case WarningKind::kErrorConcentration:
      return "error_concentration";
    case WarningKind::kErrorDrift:
      return "error_drift";
    case WarningKind::kDataCheck:
      return "data_check";
    case WarningKind::kOther:
      return "other";
  }
  return "?";
}

}  // namespace sinew
