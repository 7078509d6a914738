#include "problems/registry.h"

#include <set>

#include "base/text.h"
#include "identify/observation/sensor_effects.h"
#include "problems/contact/contact_problem.h"
#include "problems/contact/contact_synthesis.h"
#include "problems/drive/drive_channels.h"
#include "problems/drive/drive_problem.h"
#include "problems/drive/drive_synthesis.h"
#include "problems/emg_shape/averaging_problem.h"
#include "problems/emg_shape/emg_shape_problem.h"
#include "problems/emg_shape/emg_shape_synthesis.h"
#include "problems/free_body/free_body_problem.h"
#include "problems/free_body/free_body_synthesis.h"
#include "problems/nms/nms_problem.h"
#include "problems/nms/nms_synthesis.h"

namespace sinew {
namespace {

// How far a problem predicts beyond its samples when a sensor may be late: the reach of
// CHANNEL.time_offset.
constexpr double kSensorMargin = 0.1;

// A problem with its notes, behind the sensors' effects if they are wanted.
template <class P>
BoundProblem Bound(std::unique_ptr<P> problem, bool with_sensor_effects) {
  BoundProblem bound;
  bound.notes = problem->data().notes;
  if (with_sensor_effects) {
    bound.problem = std::make_unique<SensorEffects>(std::move(problem));
  } else {
    bound.problem = std::move(problem);
  }
  return bound;
}

Result<BoundProblem> BindContact(const Dataset& data, const YamlReader& settings, bool with_sensor_effects) {
  SINEW_TRY(settings.OnlyKeys({"contact"}));
  SINEW_ASSIGN(const YamlReader section, settings.At("contact"));
  SINEW_ASSIGN(ContactSettings contact, ReadContactSettings(section, data.files));
  SINEW_ASSIGN(auto problem,
               ContactProblem::Make(data, std::move(contact), with_sensor_effects ? kSensorMargin : 0));
  return Bound(std::move(problem), with_sensor_effects);
}

Result<BoundProblem> BindDrive(const Dataset& data, const YamlReader& settings, bool with_sensor_effects) {
  SINEW_TRY(settings.OnlyKeys({"drive"}));
  SINEW_ASSIGN(const YamlReader section, settings.At("drive"));
  SINEW_ASSIGN(const DriveSettings drive, ReadDriveSettings(section));
  SINEW_ASSIGN(auto problem, DriveProblem::Make(data, drive, with_sensor_effects ? kSensorMargin : 0));
  return Bound(std::move(problem), with_sensor_effects);
}

// The cameras' faults are effects of the problem itself: they must reach the states that its windows fit.
Result<BoundProblem> BindFreeBody(const Dataset& data, const YamlReader& settings,
                                  bool /*with_sensor_effects*/) {
  SINEW_TRY(settings.OnlyKeys({"free_body"}));
  SINEW_ASSIGN(const YamlReader section, settings.At("free_body"));
  SINEW_ASSIGN(const FreeBodySettings body, ReadFreeBodySettings(section));
  SINEW_ASSIGN(auto problem, FreeBodyProblem::Make(data, body));
  return Bound(std::move(problem), false);
}

// Faults of electrodes are effects of the problem itself.
Result<BoundProblem> BindEmgShape(const Dataset& data, const YamlReader& settings,
                                  bool /*with_sensor_effects*/) {
  SINEW_TRY(settings.OnlyKeys({"emg_shape"}));
  SINEW_ASSIGN(const YamlReader section, settings.At("emg_shape"));
  SINEW_ASSIGN(EmgShapeSettings emg, ReadEmgShapeSettings(section));
  if (emg.model == EmgShapeModel::kAveraging) {
    SINEW_ASSIGN(auto averaging, AveragingProblem::Make(data, emg));
    return Bound(std::move(averaging), false);
  }
  SINEW_ASSIGN(auto problem, EmgShapeProblem::Make(data, std::move(emg)));
  return Bound(std::move(problem), false);
}

Result<BoundProblem> BindNms(const Dataset& data, const YamlReader& settings, bool with_sensor_effects) {
  SINEW_TRY(settings.OnlyKeys({"nms"}));
  SINEW_ASSIGN(const YamlReader section, settings.At("nms"));
  SINEW_ASSIGN(NmsSettings nms, ReadNmsSettings(section, data.files));
  SINEW_ASSIGN(auto problem, NmsProblem::Make(data, std::move(nms)));
  return Bound(std::move(problem), with_sensor_effects);
}

}  // namespace

const std::vector<ProblemEntry>& ProblemRegistry() {
  static const std::vector<ProblemEntry> kProblems{
      {"contact", "contact parameters of soles from ground reaction forces under a measured motion",
       DescribeContactChannels(), BindContact, SynthesizeContact, DefaultContactParameters,
       ContactExperiment},
      {"drive", "inertia, friction, gravity and motor of one actuated joint from its input and its motion",
       DescribeDriveChannels(), BindDrive, SynthesizeDrive, DefaultDriveParameters, DriveExperiment, true},
      {"emg_shape", "EMG of a cyclic movement from its angle and speed, without electrodes",
       DescribeEmgShapeChannels(), BindEmgShape, SynthesizeEmgShape, DefaultEmgShapeParameters,
       EmgShapeExperiment},
      {"free_body", "contact and friction of a body that is thrown on a table, from its recorded pose",
       DescribeFreeBodyChannels(), BindFreeBody, SynthesizeFreeBody, DefaultFreeBodyParameters,
       FreeBodyExperiment},
      {"nms", "muscles driven by EMG from the moments of the joints that they move", DescribeNmsChannels(),
       BindNms, SynthesizeNms, DefaultNmsParameters, NmsExperiment},
  };
  return kProblems;
}

Result<const ProblemEntry*> FindProblem(const std::string& name) {
  return FindProblem(ProblemRegistry(), name);
}

Result<const ProblemEntry*> FindProblem(const std::vector<ProblemEntry>& problems, const std::string& name) {
  std::vector<std::string> names;
  for (const ProblemEntry& entry : problems) {
    if (entry.name == name) return &entry;
    names.push_back(entry.name);
  }
  return Fail("problem '{}' does not exist{}", name, Suggestion(name, names));
}

}  // namespace sinew
