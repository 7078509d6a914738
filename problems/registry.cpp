#include "problems/registry.h"

#include "base/text.h"
#include "problems/ankle_on_dynamometer/laboratory/synthesis.h"
#include "problems/ankle_on_dynamometer/problem.h"
#include "problems/ankle_study/emg_shape_synthesis.h"
#include "problems/ankle_study/nms_synthesis.h"
#include "problems/contact/laboratory/synthesis.h"
#include "problems/contact/problem.h"
#include "problems/drive/data/channels.h"
#include "problems/drive/laboratory/synthesis.h"
#include "problems/drive/problem.h"
#include "problems/emg_shape/averaging_problem.h"
#include "problems/emg_shape/problem.h"
#include "problems/free_body/problem.h"
#include "problems/free_body/synthesis.h"
#include "problems/kit/bind.h"
#include "problems/nms/problem.h"

namespace sinew {
namespace {

// How far a problem predicts beyond its samples when a sensor may be late: the reach of
// CHANNEL.time_offset.
constexpr double kSensorMargin = 0.1;

double SensorMargin(bool with_sensor_effects) {
  return with_sensor_effects ? kSensorMargin : 0;
}

Result<BoundProblem> BindAnkle(const Dataset& data, const YamlReader& settings, bool with_sensor_effects) {
  return Bind("ankle_on_dynamometer", settings, ReadAnkleSettings, [&](AnkleSettings ankle) {
    return Bound(AnkleProblem::Make(data, std::move(ankle), SensorMargin(with_sensor_effects)),
                 with_sensor_effects);
  });
}

Result<BoundProblem> BindContact(const Dataset& data, const YamlReader& settings, bool with_sensor_effects) {
  const auto read = [&](const YamlReader& section) { return ReadContactSettings(section, data.files); };
  return Bind("contact", settings, read, [&](ContactSettings contact) {
    return Bound(ContactProblem::Make(data, std::move(contact), SensorMargin(with_sensor_effects)),
                 with_sensor_effects);
  });
}

Result<BoundProblem> BindDrive(const Dataset& data, const YamlReader& settings, bool with_sensor_effects) {
  return Bind("drive", settings, ReadDriveSettings, [&](const DriveSettings& drive) {
    return Bound(DriveProblem::Make(data, drive, SensorMargin(with_sensor_effects)), with_sensor_effects);
  });
}

// The cameras' faults are effects of the problem itself: they must reach the states that its windows fit.
Result<BoundProblem> BindFreeBody(const Dataset& data, const YamlReader& settings,
                                  bool /*with_sensor_effects*/) {
  return Bind("free_body", settings, ReadFreeBodySettings,
              [&](const FreeBodySettings& body) { return Bound(FreeBodyProblem::Make(data, body), false); });
}

// Faults of electrodes are effects of the problem itself.
Result<BoundProblem> BindEmgShape(const Dataset& data, const YamlReader& settings,
                                  bool /*with_sensor_effects*/) {
  return Bind("emg_shape", settings, ReadEmgShapeSettings, [&](EmgShapeSettings emg) {
    return emg.model == EmgShapeModel::kAveraging ? Bound(AveragingProblem::Make(data, emg), false)
                                                  : Bound(EmgShapeProblem::Make(data, std::move(emg)), false);
  });
}

Result<BoundProblem> BindNms(const Dataset& data, const YamlReader& settings, bool with_sensor_effects) {
  const auto read = [&](const YamlReader& section) { return ReadNmsSettings(section, data.files); };
  return Bind("nms", settings, read, [&](NmsSettings nms) {
    return Bound(NmsProblem::Make(data, std::move(nms)), with_sensor_effects);
  });
}

}  // namespace

const std::vector<ProblemEntry>& ProblemRegistry() {
  static const std::vector<ProblemEntry> kProblems{
      {"ankle_on_dynamometer",
       "an ankle, the straps that hold its foot and the dynamometer in one simulation, from torque and EMG",
       DescribeAnkleChannels(), BindAnkle, SynthesizeAnkle, DefaultAnkleParameters, AnkleExperiment},
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
