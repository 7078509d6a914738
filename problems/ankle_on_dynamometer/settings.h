// Settings of the ankle on a dynamometer: the foot, its muscles, ranges of parameters.
//
//   ankle_on_dynamometer:
//     foot: {ankle_height: 0.08, heel: 0.05, toe: 0.17, width: 0.08, mass: 1.1, mass_x: 0.05, mass_y: -0.04,
//            inertia: 0.008}                    # [m, kg, kg m2], see FootGeometry
//     straps: [{foot: [0.11, -0.03], plate: 0.11}, {foot: [0.02, 0], plate: 0.035}]   # [m], see FootStrap
//     strips: 16                                # springs along the sole
//     gravity: 9.81
//     shank_tilt: 0                             # of the shank from the vertical, the knee forward [rad]
//     step: 0.01                                # longest step of the integration [s]
//     angle_cutoff: 15                          # low-pass of the machine's angle, zero lag [Hz]; 0: none; by
//                                               # default found by cross-validation, trial by trial
//     rate: 100                                 # measured channels become medians over 1 / rate [Hz]; 0: no
//     torque_zero: 0.5                          # standard deviation of a zero of the torque that every trial
//                                               # has of its own [N m]; 0: none
//     muscles:
//       tib_ant_r: {isometric_force: 905, optimal_length: 0.098, tendon_slack_length: 0.223,
//                   pennation: 0.087, length: 0.31, arm: [0.041, -0.006, -0.02], group: dorsiflexors}
//     parameters:                               # other starts, ranges and priors than the default ones
//       strap_stiffness: {start: 2e4, lower: 1e3, upper: 1e6, prior: 1}
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "models/dynamometer/foot_geometry.h"
#include "models/dynamometer/muscle_path.h"
#include "problems/ankle_on_dynamometer/unknown_terms.h"

namespace sinew {

/// One muscle. Parameters that are not listed are those of CEINMS's generic muscle.
struct AnkleMuscle {
  std::string name;
  double isometric_force = 0;      ///< [N, > 0]
  double optimal_length = 0;       ///< [m, > 0]
  double tendon_slack_length = 0;  ///< [m, > 0]
  double pennation = 0;            ///< at optimal length [rad, 0..1.4]
  MusclePath path;
  std::string group;       ///< that shares strength and tendon slack length; by default the muscle's name
  std::string excitation;  ///< channel of the grid `excitations`; by default the muscle's name
};

/// What a settings file says of a parameter beside its defaults.
struct AnkleParameterChange {
  std::optional<double> start;
  std::optional<double> lower;
  std::optional<double> upper;
  std::optional<double> prior;  ///< standard deviation about the start, of the logarithm on a log scale
};

struct AnkleSettings {
  FootGeometry foot;
  double step = 0.01;        ///< [s]
  double angle_cutoff = -1;  ///< [Hz]; 0: none; negative: by cross-validation
  double rate = 0;           ///< of what is compared [Hz]; 0: as recorded
  double torque_zero = 0;    ///< standard deviation of every trial's own zero [N m]; 0: none
  std::vector<AnkleMuscle> muscles;
  std::map<std::string, AnkleParameterChange> parameters;
  /// Not of the file: over what the trials span; over wide ranges without data.
  UnknownTermKnots knots = KnotsOver(AnkleRanges(), 0);
};

/// @param yaml the map under the key `ankle_on_dynamometer`. Errors: unknown keys, wrong values, each with
/// file and line.
Result<AnkleSettings> ReadAnkleSettings(const YamlReader& yaml);

}  // namespace sinew
