// CEINMS-RT's calibration file (<simulatedAnnealing>): what it names, and what its objective functions free.
// Facts from CEINMS-RT's sources (ceinmsrt-core-cpp: XSD/simulatedAnnealing.xsd, lib/Calibration), Durandau,
// Farina, Sartori 2018, doi:10.1109/TBME.2017.2704085.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "problems/nms/ceinms/calibration.h"
#include "problems/nms/muscle/subject.h"

namespace sinew {

/// The text of an element, and its place.
struct CeinmsRtText {
  std::string text;
  long line = 0;  ///< 0: the element is absent
};

struct CeinmsRtTrial {
  std::string name;                                          ///< a folder of the trials' directory
  double from_s = -std::numeric_limits<double>::infinity();  ///< -infinity: where the recordings begin
  /// > from_s; infinity: the end of the recordings. Both from the recording's first moment on, both ends
  /// belong to it.
  double to_s = std::numeric_limits<double>::infinity();
  long line = 0;
};

struct CeinmsRtCalibration {
  CeinmsRtText osim;
  CeinmsRtText emg_processing;  ///< filters and greatest EMG; needed for raw EMG only
  CeinmsRtText objective;       ///< one of CeinmsRtObjectives
  CeinmsRtText directory;       ///< of the trials and of the subject
  CeinmsRtText subject;         ///< inputSubjectXMLName, a file in the directory
  bool raw_emg = false;         ///< <filterEMG>: emg.sto is filtered; else emgFilt.sto is taken as it is
  /// <EMD>: the muscles see the EMG so much later [s, 0..1].
  double emg_delay_s = 0;
  bool prescaled = false;                       ///< <preScaling>: CEINMS-RT writes the subject file itself
  std::vector<std::string> joints;              ///< of all steps
  std::vector<std::vector<std::string>> steps;  ///< joints of each
  long joints_line = 0;
  std::vector<CeinmsRtTrial> trials;  ///< at least one
  std::vector<std::string> notes;     ///< what is not read, and what is read otherwise
};

/// Errors, with file and line: another document, an element that is missing, an objective function that
/// CEINMS-RT does not have, numbers that are none, a window that is none.
Result<CeinmsRtCalibration> ReadCeinmsRtCalibration(const std::string& text, const std::string& file);

[[nodiscard]] std::vector<std::string> CeinmsRtObjectives();

/// The parameters that an objective function frees, with its ranges. Muscles whose strengthCoefficient is the
/// same number in the subject file share one strength; this is how CEINMS-RT forms groups.
/// @param objective one of CeinmsRtObjectives
[[nodiscard]] std::vector<CeinmsParameter> CeinmsRtParameters(const std::string& objective,
                                                              const Subject& subject,
                                                              const std::vector<std::string>& joints);

}  // namespace sinew
