// The subject XML of CEINMS and of CEINMS-RT, which name the same things differently.
//
//   CEINMS     <mtuDefault> <mtuSet><mtu> c1 c2 optimalFibreLength pennationAngle [rad]  <dofSet><dof>
//   mtuNameSet CEINMS-RT  <muscleDefault> <muscles><muscle> C1 C2 optimalFiberLength pennationAngle [degrees]
//              <DoFs><DoF> muscleSequence, <Channels><Channel> muscleSequence
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "problems/nms/muscle/subject.h"

namespace sinew {

/// The points that come with CEINMS (Pizzolato et al. 2015), by curve.
[[nodiscard]] const std::array<CurvePoints, kSubjectCurves>& CeinmsCurvePoints();
/// A curve's name in the files.
[[nodiscard]] const char* CeinmsCurveName(SubjectCurve curve);

struct CeinmsSubject {
  Subject subject;
  std::vector<std::string> notes;  ///< elements that are not read, with their lines
};

/// Errors, with file and line: not XML, not a subject, a number that cannot be read or makes no sense, a
/// muscle named twice, a coordinate that names a muscle which is not there, a curve that is missing or no
/// curve.
Result<CeinmsSubject> ReadCeinmsSubject(std::string_view text, const std::string& file_name);

/// The same text with the values of these muscles in it; everything else stays to the last byte. A value
/// that the document gives once for all muscles is written to each muscle that differs from it. Errors: as
/// ReadCeinmsSubject; a muscle that the document does not have.
Result<std::string> WriteCeinmsSubject(std::string_view text, const std::string& file_name,
                                       const std::vector<SubjectMuscle>& muscles);

/// The data set's name for the file that a subject was imported from, byte for byte, where the subject
/// differs from it: "subject.original.xml" for "subject.xml".
[[nodiscard]] std::string OriginalSubjectName(const std::string& name);

/// WriteCeinmsSubject into the original file: its byte-order mark stays, and C1 and C2 of muscles that have
/// those of `imported` still, too.
/// @param imported the subject as the data set has it
Result<std::string> WriteOriginalSubject(std::string_view original, const std::string& file_name,
                                         const Subject& imported, std::vector<SubjectMuscle> muscles);

}  // namespace sinew
