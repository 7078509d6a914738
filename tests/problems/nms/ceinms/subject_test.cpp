#include "problems/nms/ceinms/subject.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/problems/nms/ceinms/replaced.h"

namespace sinew {
namespace {

const std::string kCurves = R"(
  <curve><name>activeForceLength</name><xPoints>0 0.5 1 1.5</xPoints><yPoints>0 0.3 1 0</yPoints></curve>
  <curve><name>passiveForceLength</name><xPoints>0 1 1.5</xPoints><yPoints>0 0 1</yPoints></curve>
  <curve><name>forceVelocity</name><xPoints>-1 0 1</xPoints><yPoints>0 1 1.5</yPoints></curve>
)";
const std::string kTendon =
    "<curve><name>tendonForceStrain</name><xPoints>-1 0 0.05</xPoints><yPoints>0 0 1</yPoints></curve>";

std::string Ceinms() {
  return "<?xml version=\"1.0\"?>\n<subject>\n<mtuDefault><emDelay>0.02</emDelay><percentageChange>0.1"
         "</percentageChange><damping>0.05</damping>" +
         kCurves + kTendon + R"(</mtuDefault>
<!-- kept -->
<mtuSet>
  <mtu><name>soleus</name><c1>-0.4</c1><c2>-0.6</c2><shapeFactor>-0.5</shapeFactor><optimalFibreLength>0.05</optimalFibreLength>
    <pennationAngle>0.4</pennationAngle><tendonSlackLength>0.25</tendonSlackLength><maxIsometricForce>3549</maxIsometricForce></mtu>
  <mtu><name>tibialis</name><optimalFibreLength>0.1</optimalFibreLength><pennationAngle>0</pennationAngle>
    <tendonSlackLength>0.22</tendonSlackLength><maxIsometricForce>905</maxIsometricForce><strengthCoefficient>1.3</strengthCoefficient>
    <colour>red</colour></mtu>
</mtuSet>
<dofSet><dof><name>ankle</name><mtuNameSet>soleus tibialis</mtuNameSet></dof></dofSet>
</subject>
)";
}

std::string Realtime() {
  std::string text = Ceinms();
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"mtuDefault", "muscleDefault"},
                                                        {"mtuSet", "muscles"},
                                                        {"<mtu>", "<muscle>"},
                                                        {"</mtu>", "</muscle>"},
                                                        {"curve>", "Curve>"},
                                                        {"FibreLength", "FiberLength"},
                                                        {"dofSet", "DoFs"},
                                                        {"dof>", "DoF>"},
                                                        {"mtuNameSet", "muscleSequence"},
                                                        {"c1>", "C1>"},
                                                        {"c2>", "C2>"},
                                                        {">0.4<", ">23<"}}) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  }
  return Replaced(
      text, "</subject>",
      "<Channels><Channel><name>emg</name><muscleSequence>soleus</muscleSequence></Channel></Channels>"
      "</subject>");
}

TEST(CeinmsSubjectTest, ReadsWhatItSays) {
  const auto read = ReadCeinmsSubject(Ceinms(), "s.xml");
  ASSERT_TRUE(read) << read.error().message;
  const Subject& subject = read->subject;
  ASSERT_EQ(subject.muscles.size(), 2U);
  const SubjectMuscle& soleus = subject.muscles[0];
  EXPECT_EQ(soleus.c2, -0.6);
  EXPECT_EQ(soleus.delay, 0.02) << "given once for all";
  EXPECT_EQ(soleus.percentage_change, 0.1);
  EXPECT_EQ(soleus.pennation_angle, 0.4);
  EXPECT_EQ(subject.muscles[1].strength_coefficient, 1.3);
  EXPECT_EQ(subject.dofs, (decltype(subject.dofs){{"ankle", {"soleus", "tibialis"}}}));
  EXPECT_EQ(subject.curves[kForceVelocity].y, (std::vector<double>{0, 1, 1.5}));
  EXPECT_THAT(read->notes, testing::ElementsAre(testing::HasSubstr("<colour> is not read")));
}

TEST(CeinmsSubjectTest, ReadsTheOtherDialect) {
  const auto read = ReadCeinmsSubject(Realtime(), "s.xml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_NEAR(read->subject.muscles[0].pennation_angle, 23 * 3.14159265358979 / 180, 1e-12) << "degrees";
  EXPECT_EQ(read->subject.channels, (decltype(read->subject.channels){{"emg", {"soleus"}}}));
}

TEST(CeinmsSubjectTest, WritesBackWhatChanged) {
  for (const std::string& text : {Ceinms(), Realtime()}) {
    auto muscles = ReadCeinmsSubject(text, "s.xml")->subject.muscles;
    muscles[0].tendon_slack_length = 0.2612345678901234;
    muscles[0].pennation_angle = 0.35;
    muscles[1].delay = 0.03;
    const auto written = WriteCeinmsSubject(text, "s.xml", muscles);
    ASSERT_TRUE(written) << written.error().message;
    const auto again = ReadCeinmsSubject(*written, "s.xml");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->subject.muscles[0].tendon_slack_length, 0.2612345678901234);
    EXPECT_NEAR(again->subject.muscles[0].pennation_angle, 0.35, 1e-15);
    EXPECT_EQ(again->subject.muscles[1].delay, 0.03);
    EXPECT_EQ(again->subject.muscles[0].delay, 0.02);
    EXPECT_THAT(*written, testing::HasSubstr("<!-- kept -->"));
    EXPECT_THAT(*written, testing::HasSubstr("<colour>red</colour>"));
  }
}

TEST(CeinmsSubjectTest, NothingChangedLeavesTheTextAlone) {
  const auto muscles = ReadCeinmsSubject(Ceinms(), "s.xml")->subject.muscles;
  EXPECT_EQ(*WriteCeinmsSubject(Ceinms(), "s.xml", muscles), Ceinms());
}

TEST(CeinmsSubjectTest, WrongFilesGetOneSentenceWithItsLine) {
  const auto failure = [](const std::string& text) {
    const auto read = ReadCeinmsSubject(text, "s.xml");
    return read ? std::string() : read.error().message;
  };
  EXPECT_THAT(failure("<subject>"), testing::HasSubstr("not well-formed XML"));
  EXPECT_THAT(failure("<model/>"), testing::HasSubstr("expected <subject>"));
  EXPECT_THAT(failure("<subject/>"), testing::HasSubstr("no <mtuSet>"));
  EXPECT_THAT(failure(Replaced(Ceinms(), "<c1>-0.4", "<c1>x")),
              testing::HasSubstr("c1 is 'x', expected a number"));
  EXPECT_THAT(failure(Replaced(Ceinms(), "<c1>-0.4", "<c1>-4")),
              testing::HasSubstr("c1 is -4, expected -0.9999 to 0.9999"));
  EXPECT_THAT(failure(Replaced(Ceinms(), "<tendonSlackLength>0.25</tendonSlackLength>", "")),
              testing::HasSubstr("'soleus' has no <tendonSlackLength>"));
  EXPECT_THAT(failure(Replaced(Ceinms(), "tibialis</name>", "soleus</name>")),
              testing::HasSubstr("is there twice"));
  EXPECT_THAT(failure(Replaced(Ceinms(), "soleus tibialis<", "soleus tibialus<")),
              testing::AllOf(testing::HasSubstr("'tibialus', which is not in the file"),
                             testing::HasSubstr("tibialis")));
  EXPECT_THAT(failure(Replaced(Ceinms(), "<yPoints>0 0.3 1 0<", "<yPoints>0 0.3 1<")),
              testing::HasSubstr("4 xPoints and 3 yPoints"));
  EXPECT_THAT(failure(Replaced(Ceinms(), "0 0.5 1 1.5<", "0 0.5 0.5 1.5<")),
              testing::HasSubstr("do not increase"));
  EXPECT_THAT(failure(Replaced(Ceinms(), kTendon, "")), testing::HasSubstr("no curve 'tendonForceStrain'"));
  const auto read = ReadCeinmsSubject(Replaced(Ceinms(), "<c1>-0.4", "<c1>x"), "s.xml");
  EXPECT_THAT(read.error().message, testing::HasSubstr("s.xml:10:"));
  const SubjectMuscle stranger{"peroneus"};
  EXPECT_THAT(WriteCeinmsSubject(Ceinms(), "s.xml", {stranger}).error().message,
              testing::HasSubstr("'peroneus'"));
}

TEST(CeinmsSubjectTest, NoBytesBreakIt) {
  Random random(3);
  for (int i = 0; i < 3000; ++i) {
    std::string text = i % 2 == 0 ? Ceinms() : Realtime();
    for (int k = 0; k < 1 + i % 5; ++k) {
      const auto at = static_cast<std::size_t>(random.Uniform(0, static_cast<double>(text.size())));
      const auto length = static_cast<std::size_t>(random.Uniform(0, 30));
      if (k % 2 == 0) {
        text.erase(at, length);
      } else {
        text.insert(at, std::string(length % 4 + 1, static_cast<char>(random.Index(256))));
      }
    }
    const auto read = ReadCeinmsSubject(text, "s.xml");
    if (read) {
      EXPECT_TRUE(WriteCeinmsSubject(text, "s.xml", read->subject.muscles));
    } else {
      EXPECT_FALSE(read.error().message.empty());
    }
  }
}

// What the import changed and no fit touched is that of the file again; the byte-order mark stays.
TEST(CeinmsSubject, TheOriginalFileIsWrittenBack) {
  const std::string original = "\xEF\xBB\xBF" + Ceinms();
  std::vector<SubjectMuscle> muscles = ReadCeinmsSubject(Ceinms(), "s.xml")->subject.muscles;
  for (SubjectMuscle& muscle : muscles) muscle.c1 = muscle.c2 = 0;
  Subject imported = ReadCeinmsSubject(Ceinms(), "s.xml")->subject;
  imported.muscles = muscles;
  const auto same = WriteOriginalSubject(original, "s.xml", imported, muscles);
  ASSERT_TRUE(same) << same.error().message;
  EXPECT_EQ(*same, original);
  muscles[0].tendon_slack_length = 0.26;
  EXPECT_EQ(*WriteOriginalSubject(original, "s.xml", imported, muscles),
            Replaced(original, "<tendonSlackLength>0.25<", "<tendonSlackLength>0.26<"));
  muscles[0].c1 = -0.3;  // fitted after all
  muscles[0].c2 = -0.2;
  EXPECT_THAT(*WriteOriginalSubject(original, "s.xml", imported, muscles),
              testing::HasSubstr("<c1>-0.3</c1><c2>-0.2</c2>"));
  EXPECT_EQ(OriginalSubjectName("subject.xml"), "subject.original.xml");
}

}  // namespace
}  // namespace sinew
