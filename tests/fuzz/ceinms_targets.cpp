// Projects of CEINMS and of CEINMS-RT.
#include "base/yaml_reader.h"
#include "problems/nms/ceinms/calibration.h"
#include "problems/nms/ceinms/project.h"
#include "problems/nms/ceinms/rt_calibration.h"
#include "problems/nms/ceinms/rt_emg.h"
#include "problems/nms/ceinms/rt_execution.h"
#include "problems/nms/ceinms/subject.h"
#include "tests/fuzz/targets.h"

namespace sinew::fuzz {
namespace {

constexpr const char* kSubject =
    R"(<subject><mtuDefault><emDelay>0.02</emDelay><percentageChange>0.1</percentageChange>
<damping>0.05</damping><curve><name>activeForceLength</name><xPoints>0 0.5 1 1.5</xPoints><yPoints>0 0.3 1 0</yPoints></curve>
<curve><name>passiveForceLength</name><xPoints>0 1 1.5</xPoints><yPoints>0 0 1</yPoints></curve>
<curve><name>forceVelocity</name><xPoints>-1 0 1</xPoints><yPoints>0 1 1.5</yPoints></curve>
<curve><name>tendonForceStrain</name><xPoints>-1 0 0.05</xPoints><yPoints>0 0 1</yPoints></curve></mtuDefault>
<mtuSet><mtu><name>sol</name><c1>-0.4</c1><c2>-0.6</c2><shapeFactor>-0.5</shapeFactor>
<optimalFibreLength>0.05</optimalFibreLength><pennationAngle>0.4</pennationAngle><tendonSlackLength>0.25</tendonSlackLength>
<maxIsometricForce>3549</maxIsometricForce><strengthCoefficient>1</strengthCoefficient></mtu></mtuSet>
<dofSet><dof><name>ankle</name><mtuNameSet>sol</mtuNameSet></dof></dofSet></subject>)";
constexpr const char* kCalibration =
    "<calibration><NMSmodel><type><openLoop/></type><tendon><stiff/></tendon><activation><exponential/>"
    "</activation></NMSmodel><trialSet>trial.xml</trialSet></calibration>";

std::string Table(const char* column) {
  return std::string("t\nnRows=3\nnColumns=2\nendheader\ntime\t") + column + "\n0\t0.1\n0.1\t0.2\n0.2\t0.1\n";
}

}  // namespace

void CeinmsSubject(std::string_view bytes) {
  const auto read = ReadCeinmsSubject(bytes, "s.xml");
  if (!Holds(read, "s.xml")) return;
  const auto written = WriteCeinmsSubject(bytes, "s.xml", read->subject.muscles);
  Demand(written.has_value(), "a subject that was read cannot be written");
  const auto again = ReadCeinmsSubject(*written, "s.xml");
  Demand(again && again->subject.muscles.size() == read->subject.muscles.size(),
         "a subject that was written cannot be read");
}

void CeinmsCalibration(std::string_view bytes) {
  const auto read = ReadCeinmsCalibration(std::string(bytes), "c.xml");
  if (!Holds(read, "c.xml")) return;
  const auto yaml = YamlReader::Parse(SettingsText(*read), "nms.yaml");
  Demand(yaml || !yaml.error().message.empty(), "an error without words");
}

void CeinmsProject(std::string_view bytes) {
  static const bool made = [] {
    Scratch("subject.xml", kSubject);
    Scratch("calibration.xml", kCalibration);
    Scratch("lengths.sto", Table("sol"));
    Scratch("arms.sto", Table("sol"));
    Scratch("emg.mot", Table("sol_emg"));
    Scratch("id.sto", Table("ankle_moment"));
    return true;
  }();
  Demand(made, "files");
  const std::vector<std::string> parts = Parts(bytes, 3);
  const std::string setup = Scratch("setup.xml", parts[0]);
  Scratch("generator.xml", parts[1]);
  Scratch("trial.xml", parts[2]);
  const auto project = ReadCeinmsProject(setup, {}, "");
  if (Holds(project, "")) Demand(project->data.Check().has_value(), "a project is no data set");
}

void CeinmsRtCalibration(std::string_view bytes) {
  Holds(ReadCeinmsRtCalibration(std::string(bytes), "c.xml"), "c.xml");
}

void CeinmsRtEmg(std::string_view bytes) {
  const auto read = ReadCeinmsRtEmg(std::string(bytes), "e.xml");
  if (!Holds(read, "e.xml")) return;
  const std::vector<double> raw{0, 1, -1, 0.5, 0};
  Demand(CeinmsRtEnvelope(*read, raw).size() == raw.size(), "an envelope's length");
}

void CeinmsRtExecution(std::string_view bytes) {
  Holds(ReadCeinmsRtExecution(std::string(bytes), "e.xml"), "e.xml");
}

}  // namespace sinew::fuzz
