// Gaps in place of what a check found: suggested, applied, and recorded in the data set.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/check/finding.h"
#include "datasets/dataset.h"

namespace sinew {

/// A span of a measured channel that becomes a gap.
struct MaskedSpan {
  std::string trial;
  std::string grid;
  std::string channel;
  TimeSpan span;
  std::string reason;  ///< kind of the finding
};

/// The gaps that leave out what a finding spoils. A measured channel is left out where it is wrong. Where an
/// input is wrong, what is measured at that time is left out, because inputs are needed without gaps. Where a
/// clock jumps, the shorter part of the trial is. Nothing for a drift (an offset or a drift can be fitted)
/// and for a finding that is undecided.
[[nodiscard]] std::vector<MaskedSpan> SuggestMask(const Dataset& dataset, const Finding& finding);

/// The same for several findings, without repetitions.
[[nodiscard]] std::vector<MaskedSpan> SuggestMask(const Dataset& dataset,
                                                  const std::vector<Finding>& findings);

struct MaskOutcome {
  long values = 0;                   ///< that became gaps
  std::vector<std::string> removed;  ///< trials in which nothing measured was left
};

/// Name of the text in Dataset::files that records what was masked.
inline constexpr const char* kMaskFile = "mask.yaml";

/// Sets the spans to NaN and adds them to the record. Errors: no training trial has anything measured left;
/// the data set is then unchanged.
Result<MaskOutcome> ApplyMask(Dataset& dataset, const std::vector<MaskedSpan>& mask);

/// What was masked in this data set, of the trials that it still has. Errors: the record is not readable.
Result<std::vector<MaskedSpan>> RecordedMask(const Dataset& dataset);

/// True if a training trial has at least ten samples of a measured channel that `channels` names (empty: any)
/// that vary.
[[nodiscard]] bool HasTrainingData(const Dataset& dataset, const std::vector<std::string>& channels = {});

}  // namespace sinew
