// What CEINMS-RT makes of raw EMG (executionEMG.xml): high-pass, rectification, low-pass, each in one pass as
// in real time, then division by the greatest value. Facts from CEINMS-RT's sources (ceinmsrt-core-cpp:
// lib/Producers/EMGPreProcessing.cpp, lib/Calibration/TorquesComputationRT.cpp).
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "models/emg/filter_section.h"

namespace sinew {

struct CeinmsRtEmg {
  FilterSections high_pass;
  FilterSections low_pass;
  std::vector<double>
      greatest;  ///< <maxEMG> [unit of the filtered signal], by channels in alphabetical order
};

/// Reads <executionEMG>. <dcFilter> is not used, nor does CEINMS-RT use it.
/// Errors, with file and line: another document, a filter that is missing, has more coefficients than one
/// section of second order or never settles, a greatest value below 0.
Result<CeinmsRtEmg> ReadCeinmsRtEmg(const std::string& text, const std::string& file);

/// The envelope before its division. Filters start from rest. @param raw [N, any unit, finite]
[[nodiscard]] std::vector<double> CeinmsRtEnvelope(const CeinmsRtEmg& emg, const std::vector<double>& raw);

}  // namespace sinew
