// A person's muscles as a calibration describes them: which there are, what they move, what excites them.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace sinew {

/// Points of a curve; x increasing.
struct CurvePoints {
  std::vector<double> x;
  std::vector<double> y;
};

enum SubjectCurve {
  kActiveForceLength,
  kPassiveForceLength,
  kForceVelocity,
  kTendonForceStrain,
  kSubjectCurves
};

/// What CEINMS calls a musculotendon unit. Values that the file gives once for all muscles are copied to
/// each.
struct SubjectMuscle {
  std::string name;
  double c1 = -0.5;                          ///< of the filter, at the rate of the lengths [-1..1]
  double c2 = -0.5;                          ///< of the filter [-1..1]
  double shape_factor = -0.1;                ///< A [1]
  double delay = 0;                          ///< electromechanical [s, >= 0]
  double optimal_fibre_length = 0;           ///< [m, > 0]
  double pennation_angle = 0;                ///< at optimal length [rad, 0..pi/2)
  double tendon_slack_length = 0;            ///< [m, > 0]
  double maximal_isometric_force = 0;        ///< [N, > 0]
  double strength_coefficient = 1;           ///< [1, > 0]
  double percentage_change = 0.15;           ///< of the optimal length without activation [1]
  double damping = 0.1;                      ///< [1, >= 0]
  double maximal_contraction_velocity = 10;  ///< [optimal lengths per second, > 0]
};

struct Subject {
  std::string name;
  std::array<CurvePoints, kSubjectCurves> curves;
  std::vector<SubjectMuscle> muscles;
  /// Joint coordinates with the muscles that move them, in the file's order.
  std::vector<std::pair<std::string, std::vector<std::string>>> dofs;
  /// Measured signals with the muscles they excite (CEINMS-RT); empty if the file has none.
  std::vector<std::pair<std::string, std::vector<std::string>>> channels;

  /// nullptr: no such muscle.
  [[nodiscard]] const SubjectMuscle* Find(const std::string& muscle) const;
};

}  // namespace sinew
