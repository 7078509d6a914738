// Laboratory experiments that never happened: a driven joint with gravity, its torque and its position. And
// the trials of the motorised ankle-foot orthosis (SCIENCE section 2). Synthetic, and marked so.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "datasets/dataset.h"
#include "problems/drive/laboratory/noise.h"
#include "problems/drive/laboratory/simulation.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// An experiment before it is carried out: what is true, what is asked of the joint, what the sensors add.
struct DrivePlan {
  DriveTruth truth;
  std::vector<DriveTrial> trials;  ///< those to train on first
  std::size_t train = 0;
  DriveNoise position_noise;
  double speed_noise = 0;                ///< [rad/s] white
  bool speed = false;                    ///< is the speed recorded too?
  bool known_noise = true;               ///< do the data state the noise level?
  bool orthosis = false;                 ///< the joint is that of the motorised ankle-foot orthosis
  bool cascade = false;                  ///< the joint follows positions under a cascade
  double step = kFineStep;               ///< [s] of the simulation
  bool session = false;                  ///< is it recorded when each trial began?
  bool exact = false;                    ///< position and speed are those of the fitted model itself
  std::map<std::string, double> starts;  ///< of exact data: initial_position@TRIAL, initial_speed@TRIAL
  std::uint64_t seed = 1;
};

/// The experiment that is requested. Errors: unknown settings or effects (with a suggestion), values out of
/// range.
Result<DrivePlan> PlanDrive(const SynthesisRequest& request);

/// What `joint` alone would do: every other entry at its null.
[[nodiscard]] DriveTruth WithoutEffects(const DriveTruth& joint);

/// Largest magnitude of the torque that the trials command, with that truth; of a known controller its limit.
/// Errors: those of SimulateDrive.
Result<double> CommandScale(const DriveTruth& truth, const std::vector<DriveTrial>& trials);

/// Draws the position noise of one trial of the plan.
[[nodiscard]] Vector DrawPositionNoise(const DrivePlan& plan, std::size_t trial, Eigen::Index count);

/// Carries the experiment out: trials `train_1`, ..., `validate_1`, ..., and drive.yaml. The truth is not in
/// the data. Errors: those of SimulateDrive.
Result<Dataset> RecordDrive(const DrivePlan& plan);

/// RecordDrive(PlanDrive(request)).
///
/// The standard experiment is a rotary joint: `torque` is recorded without noise (straight between samples,
/// which is also how it acted), `position` with noise; 4 + 2 trials of 10 s at 100 Hz. With `--set mafo=1` it
/// is the five trials of the orthosis: `reference` is the speed that was asked for, the controller and its
/// torque limit are in drive.yaml; train on 5, 10 and 20 deg/s, validate on 10 then 20 and 20 then 10.
/// `hidden=1` adds what the thesis's errors look like: a command delay of 0.18 s and Coulomb friction of
/// 1.5 N m.
///
/// The thesis gives neither inertia nor gains. Chosen: rotor of a flat 50 W motor of 94.3 mN m (0.0135 g m2)
/// behind a gear of 300 (about 1.2 kg m2), 232.38 N m as the limit of the gear (0.77 N m at the motor, a
/// short-time torque of that class), foot plate of 1.5 kg at 0.1 m.
Result<Dataset> SynthesizeDrive(const SynthesisRequest& request);

/// Name and default of everything that `--set` takes.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> DriveExperiment();

}  // namespace sinew
