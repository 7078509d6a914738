// Settings of every problem.
#include "base/yaml_reader.h"
#include "problems/ankle_on_dynamometer/settings.h"
#include "problems/contact/settings.h"
#include "problems/drive/settings.h"
#include "problems/emg_shape/settings.h"
#include "problems/free_body/settings.h"
#include "problems/nms/settings.h"
#include "tests/fuzz/targets.h"

namespace sinew::fuzz {
namespace {

constexpr const char* kSettingsFile = "s.yaml";

const std::map<std::string, std::string>& Files() {
  static const std::map<std::string, std::string> kFiles{
      {"sole.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n"},
      {"subject.xml", R"(<subject><mtuDefault>
<curve><name>activeForceLength</name><xPoints>0 0.5 1 1.5</xPoints><yPoints>0 0.3 1 0</yPoints></curve>
<curve><name>passiveForceLength</name><xPoints>0 1 1.5</xPoints><yPoints>0 0 1</yPoints></curve>
<curve><name>forceVelocity</name><xPoints>-1 0 1</xPoints><yPoints>0 1 1.5</yPoints></curve>
<curve><name>tendonForceStrain</name><xPoints>-1 0 0.05</xPoints><yPoints>0 0 1</yPoints></curve></mtuDefault>
<mtuSet><mtu><name>soleus</name><c1>-0.4</c1><c2>-0.6</c2><shapeFactor>-0.5</shapeFactor>
<optimalFibreLength>0.05</optimalFibreLength><pennationAngle>0.4</pennationAngle><tendonSlackLength>0.25</tendonSlackLength>
<maxIsometricForce>3549</maxIsometricForce></mtu>
<mtu><name>tibialis</name><optimalFibreLength>0.1</optimalFibreLength><pennationAngle>0</pennationAngle>
<tendonSlackLength>0.22</tendonSlackLength><maxIsometricForce>905</maxIsometricForce></mtu></mtuSet>
<dofSet><dof><name>ankle</name><mtuNameSet>soleus tibialis</mtuNameSet></dof></dofSet></subject>)"}};
  return kFiles;
}

// The section of one problem.
template <class Read>
void Section(std::string_view bytes, const char* name, const Read& read) {
  const auto yaml = YamlReader::Parse(std::string(bytes), kSettingsFile);
  if (!Holds(yaml, kSettingsFile)) return;
  const auto section = yaml->At(name);
  if (Holds(section, kSettingsFile)) Holds(read(*section), "");
}

}  // namespace

void AnkleSettings(std::string_view bytes) {
  Section(bytes, "ankle_on_dynamometer", ReadAnkleSettings);
}
void ContactSettings(std::string_view bytes) {
  Section(bytes, "contact", [](const YamlReader& yaml) { return ReadContactSettings(yaml, Files()); });
}
void DriveSettings(std::string_view bytes) {
  Section(bytes, "drive", ReadDriveSettings);
}
void EmgShapeSettings(std::string_view bytes) {
  Section(bytes, "emg_shape", ReadEmgShapeSettings);
}
void FreeBodySettings(std::string_view bytes) {
  Section(bytes, "free_body", ReadFreeBodySettings);
}
void NmsSettings(std::string_view bytes) {
  Section(bytes, "nms", [](const YamlReader& yaml) { return ReadNmsSettings(yaml, Files()); });
}

}  // namespace sinew::fuzz
