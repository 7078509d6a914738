// Settings of a cyclic movement and its EMG.
//
//   emg_shape:
//     angle: ankle_angle_r            # channel of the movement, on any grid [rad]
//     muscles: [soleus_r, tib_ant_r]  # channels of grid excitations; default: all of them
//     model: shape                    # or averaging, the thesis's
//     cycles:                         # see models/emg/cycles.h
//       begins_at: highest            # or lowest
//       swing: 0.6                    # of the angle's range
//       shortest: 0                   # [s]
//       duration_tolerance: 0.25
//       longest_gap: 0                # [s]
//     laws: [amplitude, lead]         # how EMG changes with speed, fitted; what is not listed is an effect
//     timing: per_muscle              # or shared: bursts of all muscles move together
//     cycle_scatter: true             # gains and timings of single cycles are fitted too
//     low_pass: 6                     # [Hz] of the envelopes' filter, order 4; 0: none
//     knots: 14                       # control points of a shape; default: 14, 20 or 28, as the cycles need
//     rate: 25                        # [Hz] of the samples that are compared
//     same_speed: 0.03                # trials whose speeds differ by less than this share have one speed
//     hold_out: [train_030]           # training trials that are predicted, not fitted
//     reference: {speed: 1.31, period: 1.5}  # [rad/s], [s]; default: the middle training speed
//     jitter: {soleus_r: 0.02}        # of the timing of single bursts [cycle]; where there is no training
//     trial
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "models/emg/cycles.h"

namespace sinew {

enum class EmgShapeModel {
  kShape,     ///< identified: shape, laws of speed, deviations of measured speeds
  kAveraging  ///< mean shapes and shape factors, thesis ch. 6
};

/// The speed at which gain is 1 and timing 0.
struct EmgReference {
  double speed = 1;   ///< [rad/s]
  double period = 1;  ///< of a cycle [s]
};

struct EmgShapeSettings {
  std::string angle;
  std::vector<std::string> muscles;  ///< empty: all
  EmgShapeModel model = EmgShapeModel::kShape;
  CycleSettings cycles;
  bool amplitude_law = true;
  bool lead_law = true;
  bool timing_per_muscle = true;
  bool cycle_scatter = true;
  double low_pass = 6;
  std::optional<int> knots;  ///< none: as the cycles need
  double rate = 25;
  double same_speed = 0.03;
  std::vector<std::string> hold_out;
  std::optional<EmgReference> reference;
  std::map<std::string, double> jitter;
};

/// @param yaml the map under the key `emg_shape`. Errors: unknown keys, wrong values, each with file and
/// line.
Result<EmgShapeSettings> ReadEmgShapeSettings(const YamlReader& yaml);

}  // namespace sinew
