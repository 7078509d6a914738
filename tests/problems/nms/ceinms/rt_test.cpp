#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/random.h"
#include "problems/nms/ceinms/rt_calibration.h"
#include "problems/nms/ceinms/rt_emg.h"
#include "problems/nms/ceinms/rt_execution.h"
#include "problems/nms/ceinms/rt_files.h"
#include "tests/problems/nms/ceinms/replaced.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kCalibration = R"(<simulatedAnnealing>
<EMGProccesing>cfg/M/executionEMG.xml</EMGProccesing>
<osimFile>cfg/M/model/leg.osim</osimFile>
<subjectXML>cfg/M/data/before.xml</subjectXML>
<nameOfSubject>M</nameOfSubject>
<dofsSpline>ankle knee</dofsSpline>
<computeSpline><use>false</use></computeSpline>
<calibration>
<use>true</use>
<objectiveFunction>ShapeFactor</objectiveFunction>
<EMD>0.04</EMD>
<dofToCalibrate><dofs>ankle
 knee</dofs></dofToCalibrate>
<trials><directory>cfg/M/data/</directory>
<trial><trialName>walk</trialName><cropMinTimeFromZero>1</cropMinTimeFromZero><cropMaxTimeFromZero>2.5</cropMaxTimeFromZero></trial>
</trials>
<option><noEpsilon>2</noEpsilon></option>
<inputSubjectXMLName>before.xml</inputSubjectXMLName>
<outputSubjectXMLName>after.xml</outputSubjectXMLName>
</calibration></simulatedAnnealing>
)";

const std::string kEmg = R"(<executionEMG><ip>1</ip><port>2</port>
<hpFilter><aCoeff>-1.56 0.64</aCoeff><bCoeff>0.8 -1.6 0.8</bCoeff></hpFilter>
<lpFilter><aCoeff>-0.9</aCoeff><bCoeff>0.05 0.05</bCoeff></lpFilter>
<maxEMG>1 0 2</maxEMG></executionEMG>)";

std::string Execution(const std::string& tendon, const std::string& activation = "exponential") {
  return "<execution>\n<NMSmodel><type><realTime><openLoop/></realTime></type><tendon>\n<" + tendon +
         "/></tendon>\n<activation><" + activation + "/></activation></NMSmodel></execution>";
}

SubjectMuscle Muscle(const std::string& name, double strength) {
  SubjectMuscle muscle;
  muscle.name = name;
  muscle.strength_coefficient = strength;
  return muscle;
}

// Two muscles of the calf alike, and one of the knee that has the shin's number.
Subject Leg() {
  Subject leg;
  leg.muscles = {Muscle("shin", 0.21), Muscle("soleus", 0.23), Muscle("gastrocnemius", 0.23),
                 Muscle("vastus", 0.21), Muscle("iliacus", 0.23)};
  leg.dofs = {{"ankle", {"shin", "soleus", "gastrocnemius"}}, {"knee", {"gastrocnemius", "vastus"}}};
  return leg;
}

std::vector<std::string> Entries(const std::vector<CeinmsParameter>& parameters) {
  std::vector<std::string> entries;
  for (const CeinmsParameter& parameter : parameters)
    entries.push_back(parameter.name + " " + parameter.entry);
  return entries;
}

TEST(CeinmsRtCalibration, SaysWhatIsNamed) {
  const auto read = ReadCeinmsRtCalibration(kCalibration, "c.xml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->osim.text, "cfg/M/model/leg.osim");
  EXPECT_EQ(read->osim.line, 3);
  EXPECT_EQ(read->subject.text, "before.xml");
  EXPECT_EQ(read->directory.text, "cfg/M/data/");
  EXPECT_EQ(read->emg_processing.text, "cfg/M/executionEMG.xml");
  EXPECT_FALSE(read->raw_emg);
  EXPECT_EQ(read->emg_delay_s, 0.04);
  EXPECT_THAT(read->joints, ElementsAre("ankle", "knee"));
  ASSERT_EQ(read->trials.size(), 1U);
  EXPECT_EQ(read->trials[0].name, "walk");
  EXPECT_EQ(read->trials[0].from_s, 1);
  EXPECT_EQ(read->trials[0].to_s, 2.5);
  EXPECT_EQ(read->trials[0].line, 15);
  EXPECT_THAT(read->notes, ElementsAre(HasSubstr("c.xml:17: settings of its annealing are not read")));
}

TEST(CeinmsRtCalibration, StepsAndUnknownElementsAreNoted) {
  const auto read =
      ReadCeinmsRtCalibration(Replaced(Replaced(kCalibration, "ankle\n knee", "ankle</dofs><dofs>knee ankle"),
                                       "<EMD>", "<filterEMG>true</filterEMG><speed>3</speed><EMD>"),
                              "c.xml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->raw_emg);
  EXPECT_THAT(read->joints, ElementsAre("ankle", "knee"));
  EXPECT_THAT(read->notes,
              ElementsAre(HasSubstr("2 steps"), HasSubstr("<speed> is not read"), HasSubstr("annealing")));
}

TEST(CeinmsRtCalibration, WithoutCropTimesItIsAllOfTheRecording) {
  const auto read = ReadCeinmsRtCalibration(
      Replaced(Replaced(kCalibration, "<cropMinTimeFromZero>1</cropMinTimeFromZero>", ""),
               "<cropMaxTimeFromZero>2.5</cropMaxTimeFromZero>", "<cropMaxTime>2</cropMaxTime>"),
      "c.xml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(std::isinf(read->trials.front().from_s));
  EXPECT_LT(read->trials.front().from_s, 0);
  EXPECT_TRUE(std::isinf(read->trials.front().to_s));
  EXPECT_THAT(read->notes, testing::Contains(HasSubstr("<cropMaxTime> is not read")));
}

TEST(CeinmsRtCalibration, WrongFilesGetALine) {
  struct Case {
    std::string from;
    std::string to;
    std::string message;
  };
  for (const Case& wrong : std::vector<Case>{
           {"<osimFile>cfg/M/model/leg.osim</osimFile>", "",
            "c.xml:1: <simulatedAnnealing> has no <osimFile>"},
           {">ShapeFactor<", ">ShapeFacto<",
            "c.xml:10: CEINMS-RT has no objective function 'ShapeFacto'; did you mean 'ShapeFactor'?"},
           {">0.04<", ">soon<", "c.xml:11: EMD is 'soon', expected a number"},
           {">0.04<", ">-0.04<", "c.xml:11: EMD is -0.04 s, expected 0 to 1"},
           {"ankle\n knee", " ", "c.xml:12: <dofToCalibrate><dofs> names no joint coordinate"},
           {">2.5<", ">1<", "c.xml:15: trial 'walk': the window 1 to 1 s is none"},
           {">2.5<", ">inf<", "the window 1 to inf s is none"},
           {"<trialName>walk</trialName>", "", "c.xml:15: <trial> has no <trialName>"},
           {"<directory>cfg/M/data/</directory>", "", "c.xml:14: <trials> has no <directory>"},
           {"<inputSubjectXMLName>before.xml</inputSubjectXMLName>", "",
            "c.xml:8: <calibration> has no <inputSubjectXMLName>"},
           {"</calibration>", "", "not well-formed XML"},
       }) {
    const auto read = ReadCeinmsRtCalibration(Replaced(kCalibration, wrong.from, wrong.to), "c.xml");
    ASSERT_FALSE(read) << wrong.message;
    EXPECT_THAT(read.error().message, HasSubstr(wrong.message));
  }
  EXPECT_THAT(ReadCeinmsRtCalibration("<a/>", "c.xml").error().message,
              HasSubstr("c.xml:1: the outermost element is <a>, expected <simulatedAnnealing>"));
}

// Ranges and sharing as ceinmsrt-core-cpp/lib/Calibration/SimAnnealParameters sets them.
TEST(CeinmsRtCalibration, ObjectivesFreeWhatCeinmsRtFrees) {
  const std::string shape = "lower: -2.999, upper: -0.001}";
  EXPECT_THAT(Entries(CeinmsRtParameters("ShapeFactor", Leg(), {"ankle"})),
              ElementsAre("shape {share: single, " + shape));
  EXPECT_THAT(Entries(CeinmsRtParameters("StrengthCoefficients_ShapeFactor_TendonSlackLength_single", Leg(),
                                         {"ankle"})),
              ElementsAre("shape {share: single, " + shape,
                          "strength {groups: {shin: [shin], group_2: [soleus, gastrocnemius]}, lower: 0.5, "
                          "upper: 1.5}",
                          "tendon_slack_length {share: single, lower: 0.95, upper: 1.05, relative: true}",
                          "optimal_length {share: single, lower: 0.975, upper: 1.025, relative: true}"));
  const auto wider = Entries(CeinmsRtParameters(
      "StrengthCoefficients_ShapeFactor_TendonSlackLength_single_widerRange", Leg(), {"ankle", "knee"}));
  EXPECT_THAT(wider, ElementsAre("shape {share: single, " + shape,
                                 HasSubstr("{group_1: [shin, vastus], group_2: [soleus, gastrocnemius]}"),
                                 HasSubstr("lower: 0.85, upper: 1.15, relative: true"),
                                 HasSubstr("lower: 0.75, upper: 1.25, relative: true")));
  EXPECT_THAT(Entries(CeinmsRtParameters("GroupedStrengthCoefficients_IndividualLstLom", Leg(), {"knee"})),
              ElementsAre("shape {share: global, " + shape,
                          HasSubstr("{gastrocnemius: [gastrocnemius], vastus: [vastus]}"), HasSubstr("0.95"),
                          HasSubstr("0.975")));
}

TEST(CeinmsRtExecution, KnowsTheTendon) {
  for (const auto& [ceinms, ours] : std::vector<std::pair<std::string, std::string>>{
           {"stiff", "rigid"}, {"elastic", "equilibrium"}, {"elasticBiSec", "elastic"}}) {
    const auto read = ReadCeinmsRtExecution(Execution(ceinms), "e.xml");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->tendon, ours);
    EXPECT_EQ(read->notes.empty(), ours == "rigid");
  }
  EXPECT_THAT(ReadCeinmsRtExecution(Execution("stif"), "e.xml").error().message,
              HasSubstr("e.xml:3: <tendon> has no kind <stif>; did you mean 'stiff'?"));
  EXPECT_THAT(ReadCeinmsRtExecution(Execution("stiff", "piecewise"), "e.xml").error().message,
              HasSubstr("e.xml:4: activation <piecewise>: CEINMS-RT calibrates <exponential> only"));
  EXPECT_THAT(ReadCeinmsRtExecution("<execution/>", "e.xml").error().message, HasSubstr("has no <NMSmodel>"));
}

TEST(CeinmsRtEmg, FiltersAsTheDifferenceEquations) {
  const auto emg = ReadCeinmsRtEmg(kEmg, "emg.xml");
  ASSERT_TRUE(emg) << emg.error().message;
  EXPECT_THAT(emg->greatest, ElementsAre(1, 0, 2));
  std::vector<double> raw;
  for (int i = 0; i < 60; ++i) raw.push_back(std::sin(0.7 * i) + 0.3 * std::cos(2.9 * i) + 0.5);
  const std::vector<double> envelope = CeinmsRtEnvelope(*emg, raw);
  const auto past = [](const std::vector<double>& v, std::size_t i, std::size_t back) {
    return i >= back ? v[i - back] : 0.0;
  };
  std::vector<double> high;
  std::vector<double> rectified;
  std::vector<double> low;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    high.push_back(0.8 * raw[i] - 1.6 * past(raw, i, 1) + 0.8 * past(raw, i, 2) + 1.56 * past(high, i, 1) -
                   0.64 * past(high, i, 2));
    rectified.push_back(std::abs(high.back()));
    low.push_back(0.05 * rectified[i] + 0.05 * past(rectified, i, 1) + 0.9 * past(low, i, 1));
    EXPECT_NEAR(envelope[i], low[i], 1e-13) << i;  // rounding of 60 steps
  }
}

TEST(CeinmsRtEmg, WrongFiltersGetALine) {
  EXPECT_THAT(ReadCeinmsRtEmg(Replaced(kEmg, "-1.56 0.64", "-1.66 0.64"), "emg.xml").error().message,
              HasSubstr("emg.xml:2: <hpFilter> with aCoeff -1.66 0.64 never settles"));
  EXPECT_THAT(ReadCeinmsRtEmg(Replaced(kEmg, ">0.05 0.05<", "><"), "emg.xml").error().message,
              HasSubstr("emg.xml:3: <lpFilter> has 1 aCoeff and 0 bCoeff"));
  EXPECT_THAT(ReadCeinmsRtEmg(Replaced(kEmg, "1 0 2", "1 nan 2"), "emg.xml").error().message,
              HasSubstr("emg.xml:4: maxEMG has nan"));
  EXPECT_THAT(ReadCeinmsRtEmg("<a/>", "emg.xml").error().message, HasSubstr("expected <executionEMG>"));
}

class CeinmsRtFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("ceinms_rt_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Make(const std::string& name) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << "x";
    return (folder_ / name).string();
  }
  [[nodiscard]] Result<std::string> Find(const std::string& written, int kept = 1,
                                         const std::string& calibration = "cfg/M/Calibration.xml") const {
    return FindCeinmsRtFile({(folder_ / calibration).string(), 7, "<osimFile>", written, kept});
  }

  fs::path folder_;
};

TEST_F(CeinmsRtFiles, AreFoundFromTheFolderThatHoldsCfg) {
  Make("cfg/M/Calibration.xml");
  const std::string model = Make("cfg/M/model/leg.osim");
  EXPECT_EQ(Find("cfg/M/model/leg.osim").value(), model);
  EXPECT_EQ(Find("cfg\\M\\model\\leg.osim").value(), model);
  EXPECT_EQ(Find("./cfg/M//model/../model/leg.osim").value(), model);
  EXPECT_EQ(Find(model).value(), model);
}

TEST_F(CeinmsRtFiles, AreFoundBesideTheCalibration) {
  Make("moved/Calibration.xml");
  const std::string angles = Make("moved/walk/ik.sto");
  const std::string beside = Make("moved/ik.sto");
  EXPECT_EQ(Find("cfg/M/data/walk/ik.sto", 2, "moved/Calibration.xml").value(), angles);
  // What must stay together is not taken apart: this file is of another trial.
  EXPECT_FALSE(Find("cfg/M/data/run/ik.sto", 2, "moved/Calibration.xml"));
  EXPECT_EQ(Find("cfg/M/data/run/ik.sto", 1, "moved/Calibration.xml").value(), beside);
}

TEST_F(CeinmsRtFiles, AreSaidToBeNowhere) {
  const std::string calibration = Make("cfg/M/Calibration.xml");
  fs::create_directories(folder_ / "cfg/M/leg.osim");  // a folder is no file
  const auto found = Find("cfg/M/model/leg.osim");
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().message,
            calibration +
                ":7: <osimFile> names 'cfg/M/model/leg.osim', which is not there: it was looked for from the "
                "working folder, from the folder of this file and those above it, and beside this file as "
                "M/model/leg.osim, model/leg.osim, leg.osim");
  EXPECT_FALSE(Find(std::string(5000, 'a')));
  EXPECT_FALSE(Find(std::string("a\0b", 3)));
  EXPECT_FALSE(Find("/"));
}

// Any bytes are an error or an answer.
TEST(CeinmsRtFuzz, NothingCrashes) {
  Random random(7);
  const std::vector<std::string> texts{kCalibration, kEmg, Execution("elasticBiSec")};
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = texts[static_cast<std::size_t>(i) % texts.size()];
    for (int k = 0; k < 1 + i % 4; ++k) {
      const auto at = static_cast<std::size_t>(random.Uniform() * static_cast<double>(text.size()));
      text[std::min(at, text.size() - 1)] = static_cast<char>(static_cast<int>(random.Uniform() * 256));
    }
    if (i % 7 == 0)
      text.resize(static_cast<std::size_t>(random.Uniform() * static_cast<double>(text.size())));
    const auto calibration = ReadCeinmsRtCalibration(text, "c.xml");
    const auto emg = ReadCeinmsRtEmg(text, "c.xml");
    const auto execution = ReadCeinmsRtExecution(text, "c.xml");
    refused += calibration ? 0 : 1;
    EXPECT_TRUE(calibration || calibration.error().message.rfind("c.xml:", 0) == 0);
    EXPECT_TRUE(emg || emg.error().message.rfind("c.xml:", 0) == 0);
    EXPECT_TRUE(execution || execution.error().message.rfind("c.xml:", 0) == 0);
  }
  EXPECT_GT(refused, 2000);  // two thirds are other documents
}

}  // namespace
}  // namespace sinew
