// Settings of the nms problem: which muscles, joints and parameters.
//
//   nms:
//     subject: subject.xml             # a file of the data set, CEINMS or CEINMS-RT
//     tendon: rigid                    # or equilibrium, elastic
//     activation: exponential          # or piecewise
//     as_ceinms: false                 # true: numbers as CEINMS computes them, curves included
//     joints: [knee_angle_r, ankle_angle_r]
//     objective: noise                 # or thesis: squares over variance and samples, per trial and joint
//     fibre_range: {lower: 0.5, upper: 1.5, tolerance: 0.05, as: penalty}   # or constraint; see docs/nms.md
//     steps:                           # of `identify --stepwise`; by default everything is fitted at once
//       - {joints: [knee_angle_r], parameters: [shape, strength]}
//       - {joints: [knee_angle_r, ankle_angle_r], parameters: [tendon_slack_length]}
//     mode: {type: open_loop}          # of `simulate`: see excitation/mode.h
//     parameters:
//       shape: {share: single, lower: -3, upper: 0}
//       strength: {groups: {calf: [med_gas_r, lat_gas_r], rest: [soleus_r]}, lower: 0.5, upper: 2.5}
//       tendon_slack_length: {share: single, lower: 0.85, upper: 1.15, relative: true, prior: 0.05}
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "problems/nms/excitation/mode.h"
#include "problems/nms/muscle/muscle_force.h"
#include "problems/nms/muscle/subject.h"

namespace sinew {

/// A parameter of the muscles as people name it.
struct MuscleParameterName {
  const char* name;
  MuscleSlot slot;
  const char* unit;
  const char* meaning;
  const char* source;
};
[[nodiscard]] const std::vector<MuscleParameterName>& MuscleParameterNames();

/// One parameter that a group of muscles shares.
struct NmsParameterSetting {
  MuscleSlot slot = kStrength;
  std::string group;                 ///< its name; a muscle's if it has only one
  std::vector<std::string> muscles;  ///< at least one
  double lower = 0;
  double upper = 1;
  bool relative = false;             ///< a factor on the subject's value, which may differ in the group
  std::optional<double> prior = {};  ///< standard deviation about the start before the data speak
};

/// Where fibre lengths of training trials should stay, as shares of the optimal length.
struct FibreRange {
  double lower = 0.5;
  double upper = 1.5;
  double tolerance = 0.05;  ///< that costs as much as a moment that is wrong by its spread, or its noise
  bool strict = false;      ///< a constraint
};

/// A fit of some parameters to some joints.
struct NmsStep {
  std::vector<std::string> joints;      ///< at least one
  std::vector<std::string> parameters;  ///< names of MuscleParameterNames, at least one
};

enum class NmsObjective { kNoise, kThesis };

struct NmsSettings {
  Subject subject;
  std::string subject_file;  ///< its name in the data set
  std::string subject_text;
  std::string
      subject_original;  ///< the file that it was imported from, if it differs; see OriginalSubjectName
  MuscleModel model;
  std::vector<std::string> joints;
  std::vector<NmsParameterSetting> parameters;
  NmsMode mode;  ///< of simulations; what is fitted is always open loop
  NmsObjective objective = NmsObjective::kNoise;
  std::optional<FibreRange> fibre_range;
  std::vector<NmsStep> steps;
  std::vector<std::string> notes;
};

/// @param files of the data set. Errors, with file and line: unknown keys, a joint or a muscle that the
/// subject does not have, a muscle that is in two groups of one parameter, bounds that are no range.
Result<NmsSettings> ReadNmsSettings(const YamlReader& yaml, const std::map<std::string, std::string>& files);

/// The muscles that move one of the joints, in the subject's order.
[[nodiscard]] std::vector<std::string> MusclesOf(const Subject& subject,
                                                 const std::vector<std::string>& joints);

/// The subject's curves, smooth, or as CEINMS draws them. Errors: points that are no curve.
Result<MuscleCurves> CurvesOf(const Subject& subject, bool as_ceinms);

/// A muscle's parameters by slot; 0 where the subject file has none. @param as_ceinms the filter from C1 and
/// C2, else from times at this rate [1/s]
[[nodiscard]] std::array<double, kMuscleSlots> SlotsOf(const SubjectMuscle& muscle, bool as_ceinms,
                                                       double rate);
/// The inverse of SlotsOf.
void StoreSlots(const std::array<double, kMuscleSlots>& slots, bool as_ceinms, double rate,
                SubjectMuscle& muscle);

}  // namespace sinew
