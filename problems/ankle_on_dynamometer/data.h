// Recorded trials as the ankle problem uses them: the machine's motion on the integrator's stages,
// excitations, and what was measured.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "identify/layout.h"
#include "models/dynamometer/implicit_step.h"
#include "models/dynamometer/strapped_foot.h"
#include "problems/ankle_on_dynamometer/settings.h"

namespace sinew {

/// What a block is about.
enum class AnkleQuantity { kMachineTorque, kAnkleAngle, kFibreLength };

struct AnkleBlock {
  int block = 0;  ///< of the layout
  AnkleQuantity quantity = AnkleQuantity::kMachineTorque;
  std::size_t muscle = 0;         ///< of a fibre length
  std::vector<std::size_t> stop;  ///< [predictions] index into AnkleTrial::stops
};

/// What a trial is: the attachment alone, a person who relaxes, or one who is active.
enum class AnkleTask { kAttachmentAlone, kPassive, kActive };

struct AnkleTrial {
  std::string name;
  AnkleTask task = AnkleTask::kActive;
  std::vector<double> stops;       ///< [S, s, increasing] where something is predicted
  std::vector<PlateMotion> plate;  ///< [S] at the stops

  struct Step {
    double begin = 0;  ///< [s]
    double length = 0;
    int stop = -1;  ///< index of the stop that it ends at; -1: none
    std::array<PlateMotion, ImplicitStep::kStages> plate;
  };
  std::vector<Step> steps;
  std::vector<double> stage_times;   ///< [1 + 3 steps, s] first stop, then every stage
  std::vector<double> stage_angles;  ///< [1 + 3 steps, rad] of the plate there

  std::vector<double> excitation_time;           ///< [M, s]; empty: the muscles are silent
  std::vector<std::vector<double>> excitations;  ///< [muscles][M, 0..1]
  std::vector<AnkleBlock> blocks;
  std::vector<int> columns;  ///< parameters of its simulation, increasing
  int zero = -1;             ///< parameter that is the zero of its torque; -1: none
};

struct AnkleData {
  AnkleSettings settings;
  MuscleCurves curves;
  std::vector<MusclePath> paths;  ///< [muscles]
  std::vector<AnkleTrial> trials;
  Layout layout;
  std::vector<std::string> notes;
};

[[nodiscard]] std::string DescribeAnkleChannels();

/// @param margin by which a reading may be late [s]: channels are predicted by so much beyond their samples,
/// as far as the machine's angle goes
/// Errors, with the trial's name: a channel that is missing, another unit, a gap of an input, an angle that
/// is not known where a torque was measured; no trial.
Result<AnkleData> PrepareAnkleData(const Dataset& data, AnkleSettings settings, double margin);

}  // namespace sinew
