// Why a parameter has its verdict and what would help: facts, which identify/text turns into sentences.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "identify/uncertainty/profile.h"

namespace sinew {

/// One parameter's part in a combination of parameters.
struct ParameterChange {
  std::string parameter;
  std::string unit;
  double change = 0;    ///< [unit]
  double relative = 0;  ///< to its value; NaN where its sign may change, so that there is no ratio
};

/// A combination of parameters that the data leave open, as an example of a change along it. The first
/// parameter grows.
struct OpenDirection {
  bool lost = true;  ///< no residual changes at all; false: they change by less than their noise
  std::vector<ParameterChange> changes;  ///< at least two; empty: no such direction
};

/// What makes an interval as wide as it is.
enum class ReasonKind {
  kDetermined,            ///< nothing does: it is narrow enough
  kAtBound,               ///< the best value is on a bound, and the cost would fall beyond it
  kNoResponse,            ///< no fitted channel changes with it over its whole range
  kNoResponseHere,        ///< no fitted channel changes with it near the answer; elsewhere some do
  kCompensated,           ///< nuisance parameters can compensate all that it changes
  kCombination,           ///< only a combination with `partners` is determined
  kFlatCost,              ///< the cost rises more slowly away from the answer than its curvature predicts
  kDependentResiduals,    ///< the residuals are not independent
  kWeakExcitation,        ///< it changes too little even if all other values were known
  kPartiallyCompensated,  ///< nuisance parameters can compensate nearly all that it changes
  kCorrelated,            ///< nearly the same change as one of `partners`
  kNoiseLevelUnknown      ///< too few residuals to estimate the noise beside the parameters
};

/// "determined", "at_bound", "no_response", ...: `reason_kind` in JSON and HDF5.
[[nodiscard]] const char* ToString(ReasonKind kind);

struct Reason {
  ReasonKind kind = ReasonKind::kDetermined;
  std::vector<std::string> partners =
      {};            ///< parameters; for kCompensated and kPartiallyCompensated nuisance
  int nuisance = 0;  ///< kCompensated: number of nuisance parameters that are fitted
  std::vector<std::string> channels = {};  ///< kNoResponse, kNoResponseHere: those that are fitted
  OpenDirection direction = {};            ///< kCombination
  bool at_lower = false;                   ///< kAtBound: the lower bound, not the upper one
  bool by_prior = false;                   ///< undetermined: the interval is that of its prior
  /// Half of the 95 % interval over the value; if not `width_of_value`, the whole over that of the range.
  double width = 0;
  bool width_of_value = false;
  double std_error = std::numeric_limits<double>::infinity();  ///< [unit] that makes the interval wide
  /// [unit] Standard error without what `kind` names (kDependentResiduals, kWeakExcitation,
  /// kPartiallyCompensated, kCorrelated).
  double std_error_without = 0;
  int residuals = 0;  ///< kNoiseLevelUnknown: so many, beside so many fitted values
  int fitted = 0;
  ProfileFailure no_profile = ProfileFailure::kNone;  ///< why the interval is linear
};

enum class AdditionKind { kChannel, kTrial, kKnownValue };

/// "channel", "trial", "known_value".
[[nodiscard]] const char* ToString(AdditionKind kind);

/// Something that could be measured, fitted or known as well.
struct AdditionName {
  AdditionKind kind = AdditionKind::kChannel;
  std::string name;  ///< of the channel to measure, the trial to fit, or the parameter to determine otherwise

  friend bool operator==(const AdditionName& a, const AdditionName& b) {
    return a.kind == b.kind && a.name == b.name;
  }
};

/// Additions that would together determine a parameter.
struct RemedyOption {
  std::vector<AdditionName> additions;
  double std_error = 0;  ///< [unit] that the parameter would then have
};

enum class RemedyKind {
  kNone,              ///< nothing is needed
  kAdditions,         ///< one of `options` would do
  kNoChannel,         ///< no additional channel or trial would; `options`, if any, are known values
  kIndependentNoise,  ///< the model must explain what is left in the residuals
  kNotPredicted,      ///< other channels could not be predicted: `message`
  kOtherBound,        ///< a wider bound where physics allows one
  kMoreSamples        ///< more samples than fitted values, or a stated noise level
};

/// "none", "additions", "no_channel", ...: `remedy_kind` in JSON and HDF5.
[[nodiscard]] const char* ToString(RemedyKind kind);

struct Remedy {
  RemedyKind kind = RemedyKind::kNone;
  std::vector<RemedyOption> options = {};  ///< best first, at most three
  std::string message = {};
};

}  // namespace sinew
