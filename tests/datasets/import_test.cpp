#include "datasets/io/import.h"

#include <cmath>

#include "base/constants.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const char* const kForces =
    "grf\nendheader\n"
    "time\tground_force_vx\tground_force_vy\tground_force_vz\tground_force_px\tground_force_py\tground_force_"
    "pz\t"
    "1_ground_force_vx\t1_ground_force_vy\t1_ground_force_vz\tground_torque_x\tground_torque_y\tground_"
    "torque_z\n"
    "0\t1\t2\t3\t4\t5\t6\t7\t8\t9\t10\t11\t12\n0.1\t1\t2\t3\t4\t5\t6\t7\t8\t9\t10\t11\t12\n";
const char* const kAngles =
    "Coordinates\ninDegrees=yes\nendheader\ntime\tknee_angle_r\tpelvis_ty\tpatella\n0\t90\t0.9\t5\n1\t180\t0."
    "8\t6\n";
const char* const kMarkers =
    "PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n10\t2\t1\tmm\nFrame#\tTime\tR."
    "ASIS\n\t\tX1\tY1\tZ1\n\n"
    "1\t0\t1\t2\t3\n2\t0.1\t4\t5\t\n";
const char* const kLog = "t,q,u,mode\n0,90,1,on\n100,45,2,off\n";

class ImportTest : public testing::Test {
 protected:
  Status Import(const std::vector<std::string>& paths) {
    notes_.clear();
    return ImportFiles(paths, options_, dataset_, notes_);
  }
  void UseMap(const std::string& text) {
    auto map = ParseImportMap(text, "map.yaml");
    ASSERT_TRUE(map) << ErrorOf(map);
    options_.map = *map;
  }
  const Channel& At(const std::string& grid, const std::string& channel) {
    return dataset_.trials.at("walk").grids.at(grid).channels.at(channel);
  }

  TemporaryFolder folder_;
  ImportOptions options_;
  Dataset dataset_;
  std::vector<std::string> notes_;
};

TEST_F(ImportTest, ATableWithoutTimesGetsThemFromItsRate) {
  UseMap("time: {rate: 8}\nchannels: {position: {column: q, unit: m}}\n");
  ASSERT_EQ(ErrorOf(Import({folder_.Write("walk.csv", "q\n1\n2\n4\n")})), "");
  EXPECT_THAT(dataset_.trials.at("walk").grids.at("walk").time, ElementsAre(0, 0.125, 0.25));
  EXPECT_THAT(At("walk", "position").values, ElementsAre(1, 2, 4));
}

TEST_F(ImportTest, DegreesCelsiusBecomeKelvinAndTheirNoiseStaysADifference) {
  UseMap(
      "time: {rate: 8}\nchannels: {temperature: {column: q, unit: degC, kind: input, scale: 10, sigma: "
      "0.5}}\n"
      "constants: {room: {value: 20, unit: degC}}\n");
  ASSERT_EQ(ErrorOf(Import({folder_.Write("walk.csv", "q\n1\n2\n")})), "");
  const Channel& temperature = At("walk", "temperature");
  EXPECT_EQ(temperature.unit, "K");
  EXPECT_THAT(temperature.values, ElementsAre(283.15, 293.15));
  EXPECT_EQ(temperature.sigma, 0.5);
  EXPECT_EQ(dataset_.constants.at("room").value, 293.15);
}

TEST_F(ImportTest, MarkersForcesAndAnglesMakeOneTrial) {
  options_.plates = *ParsePlates("right=ground_,left=1_ground_");
  options_.role = Role::kValidate;
  ASSERT_EQ(ErrorOf(Import({folder_.Write("walk.trc", kMarkers), folder_.Write("grf.mot", kForces),
                            folder_.Write("ik.mot", kAngles), folder_.Write("m.osim", "<x/>"),
                            folder_.Write("contact.yaml", "a: 1\n")})),
            "");
  EXPECT_EQ(dataset_.trials.at("walk").role, Role::kValidate);
  EXPECT_THAT(At("markers", "R.ASIS_x").values, ElementsAre(0.001, 0.004));
  EXPECT_EQ(At("markers", "R.ASIS_x").unit, "m");
  EXPECT_TRUE(std::isnan(At("markers", "R.ASIS_z").values[1]));
  EXPECT_EQ(At("forces", "right_force_y").values[0], 2);
  EXPECT_EQ(At("forces", "right_force_y").unit, "N");
  EXPECT_EQ(At("forces", "right_cop_z").values[0], 6);
  EXPECT_EQ(At("forces", "right_cop_z").unit, "m");
  EXPECT_EQ(At("forces", "right_moment_y").values[0], 11);
  EXPECT_EQ(At("forces", "right_moment_y").unit, "N*m");
  EXPECT_EQ(At("forces", "left_force_x").values[0], 7);
  EXPECT_DOUBLE_EQ(At("coordinates", "knee_angle_r").values[0], kPi / 2);
  EXPECT_EQ(At("coordinates", "knee_angle_r").unit, "rad");
  EXPECT_EQ(At("coordinates", "knee_angle_r").kind, ChannelKind::kInput);
  EXPECT_THAT(At("coordinates", "pelvis_ty").values, ElementsAre(0.9, 0.8));
  EXPECT_EQ(At("coordinates", "pelvis_ty").unit, "m");
  EXPECT_EQ(dataset_.files.at("model.osim"), "<x/>");
  EXPECT_EQ(dataset_.files.at("contact.yaml"), "a: 1\n");
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("plate 'left' has no columns for its centre of pressure"),
                                  HasSubstr("plate 'left' has no columns for its moment")));
}

TEST_F(ImportTest, TheModelDecidesWhichCoordinatesAreAngles) {
  options_.trial = "walk";
  options_.coordinate_kind = [](const std::string& name) -> std::optional<CoordinateKind> {
    if (name == "patella") return CoordinateKind::kLength;
    if (name == "knee_angle_r") return CoordinateKind::kAngle;
    return std::nullopt;
  };
  ASSERT_EQ(ErrorOf(Import({folder_.Write("ik.mot", kAngles)})), "");
  EXPECT_EQ(At("coordinates", "patella").unit, "m");
  EXPECT_EQ(At("coordinates", "patella").values[0], 5);
  EXPECT_DOUBLE_EQ(At("coordinates", "knee_angle_r").values[1], kPi);
  EXPECT_EQ(At("coordinates", "pelvis_ty").unit, "m");
}

TEST_F(ImportTest, ExternalLoadsNameThePlates) {
  options_.trial = "walk";
  options_.external_loads = {{"foot", "calcn_r", "ground_force_v", "ground_force_p", "ground_torque_"}};
  ASSERT_EQ(ErrorOf(Import({folder_.Write("grf.mot", kForces)})), "");
  EXPECT_EQ(At("forces", "foot_moment_z").values[0], 12);
  EXPECT_EQ(At("forces", "1_ground_force_vx").unit, "N");
  EXPECT_THAT(
      notes_,
      ElementsAre(HasSubstr("forces that no plate was named for keep their names: 1_ground_force_v*")));
}

TEST_F(ImportTest, PlatesThatNoFileHasAreErrors) {
  options_.plates = *ParsePlates("right=graund_");
  EXPECT_THAT(
      ErrorOf(Import({folder_.Write("grf.mot", kForces)})),
      HasSubstr("plate 'right': no file has columns graund_force_vx; did you mean 'ground_force_vx'?"));
  options_.plates = *ParsePlates("right=ground_,left=ground_");
  EXPECT_THAT(ErrorOf(Import({folder_.Write("grf.mot", kForces)})), HasSubstr("would belong to two plates"));
}

TEST_F(ImportTest, CsvNeedsAMapAndFollowsIt) {
  const std::string log = folder_.Write("log.csv", kLog);
  options_.trial = "walk";
  EXPECT_THAT(ErrorOf(Import({log})),
              HasSubstr("needs a map that assigns its columns to channels (they are t, q, u, mode)"));
  UseMap(
      "time: {column: t, unit: ms}\n"
      "channels: {position: {column: q, unit: deg, sigma: 1}, voltage: {column: u, unit: V, kind: input, "
      "scale: 2}}\n"
      "constants: {gear_ratio: {value: 120, unit: \"1\"}}\nconditions: {load_kg: 2}\ntask: swing\nsource: "
      "us\n");
  ASSERT_EQ(ErrorOf(Import({log})), "");
  EXPECT_THAT(dataset_.trials.at("walk").grids.at("log").time, ElementsAre(0, 0.1));
  EXPECT_DOUBLE_EQ(At("log", "position").values[0], kPi / 2);
  EXPECT_DOUBLE_EQ(*At("log", "position").sigma, kPi / 180);
  EXPECT_THAT(At("log", "voltage").values, ElementsAre(2, 4));
  EXPECT_EQ(At("log", "voltage").kind, ChannelKind::kInput);
  EXPECT_EQ(dataset_.constants.at("gear_ratio").value, 120);
  EXPECT_EQ(dataset_.trials.at("walk").conditions.at("load_kg"), 2);
  EXPECT_EQ(dataset_.trials.at("walk").task, "swing");
  EXPECT_EQ(dataset_.source, "us");
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("columns that the map does not name were left out: mode")));
}

TEST_F(ImportTest, WhatTheMapAndTheCsvDisagreeOnIsAnErrorWithItsLine) {
  const std::string log = folder_.Write("log.csv", kLog);
  const std::string bad = folder_.Write("bad.csv", "t,q\n0,1\n1,fast\n");
  const std::string time = "time: {column: t, unit: s}\n";
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {log, "channels: {x: {column: q, unit: m}}\n", "map.yaml: has no time"},
      {log, time, "map.yaml: names no channels"},
      {log, time + "channels:\n  x: {column: qq, unit: m}\n",
       "map.yaml:3: " + log + " has no column 'qq'; did you mean 'q'?"},
      {log, time + "channels:\n  x: {column: q}\n", "map.yaml:3: channel 'x' has no unit"},
      {log, "time: {column: tt}\nchannels: {x: {column: q, unit: m}}\n", "has no column 'tt'"},
      {bad, time + "channels: {x: {column: q, unit: m}}\n", bad + ":3: column 'q': 'fast' is not a number"},
      {log, time + "channels: {x: {column: q, unit: m}}\nmarkers: {A: B}\n",
       "map.yaml:3: no file has a marker 'A'"},
  };
  for (const auto& [path, map, message] : cases) {
    UseMap(map);
    EXPECT_THAT(ErrorOf(Import({path})), HasSubstr(message)) << map;
    EXPECT_TRUE(dataset_.trials.empty());
  }
}

TEST_F(ImportTest, TheMapRenamesMarkersAndColumns) {
  UseMap(
      "markers: {R.ASIS: RASI}\n"
      "channels: {knee: {column: knee_angle_r}, excitation: {column: soleus, unit: \"%\", kind: input}}\n");
  ASSERT_EQ(ErrorOf(Import({folder_.Write("walk.trc", kMarkers), folder_.Write("ik.mot", kAngles),
                            folder_.Write("out.sto", "x\nendheader\ntime\tsoleus\tother\n0\t50\t1\n")})),
            "");
  EXPECT_EQ(At("markers", "RASI_y").values[0], 0.002);
  EXPECT_DOUBLE_EQ(At("coordinates", "knee").values[0], kPi / 2);
  EXPECT_EQ(At("out", "excitation").values[0], 0.5);
  EXPECT_EQ(At("out", "excitation").kind, ChannelKind::kInput);
  EXPECT_EQ(dataset_.trials.at("walk").grids.at("coordinates").channels.count("knee_angle_r"), 0U);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("has no unit for other")));

  UseMap("channels:\n  knee: {column: knee_angel_r}\n");
  options_.trial = "other";
  EXPECT_THAT(ErrorOf(Import({folder_.Write("ik.mot", kAngles)})),
              HasSubstr("map.yaml:2: no file has a column 'knee_angel_r'; did you mean 'knee_angle_r'?"));
}

TEST_F(ImportTest, OpenSim4PathsBecomeNames) {
  options_.trial = "walk";
  ASSERT_EQ(ErrorOf(Import({folder_.Write(
                "states.sto",
                "states\ninDegrees=yes\nendheader\n"
                "time\t/jointset/hip_r/hip_flexion_r/value\t/jointset/hip_r/hip_flexion_r/speed\t"
                "/forceset/soleus_r/activation\t/forceset/soleus_r|length\n0\t180\t360\t0.5\t0.3\n")})),
            "");
  EXPECT_DOUBLE_EQ(At("coordinates", "hip_flexion_r").values[0], kPi);
  EXPECT_DOUBLE_EQ(At("coordinates", "hip_flexion_r_speed").values[0], 2 * kPi);
  EXPECT_EQ(At("coordinates", "hip_flexion_r_speed").unit, "rad/s");
  EXPECT_EQ(At("coordinates", "soleus_r_activation").values[0], 0.5);
  EXPECT_EQ(At("coordinates", "soleus_r_length").unit, "m");
}

// OpenSim converts neither its values nor its unit: it is in rad whatever inDegrees says.
TEST_F(ImportTest, ACoupledAngleIsNotInDegrees) {
  const std::string text =
      "Coordinates\ninDegrees=yes\nendheader\ntime\tknee_angle_r\tknee_angle_r_beta\n0\t90\t1.5\n";
  for (const bool with_model : {true, false}) {
    options_.trial = "walk";
    dataset_ = {};
    options_.coordinate_kind = {};
    if (with_model) {
      options_.coordinate_kind = [](const std::string& name) -> std::optional<CoordinateKind> {
        return name == "knee_angle_r" ? CoordinateKind::kAngle : CoordinateKind::kCoupledAngle;
      };
    }
    ASSERT_EQ(ErrorOf(Import({folder_.Write("ik.mot", text)})), "");
    EXPECT_DOUBLE_EQ(At("coordinates", "knee_angle_r").values[0], kPi / 2);
    EXPECT_EQ(At("coordinates", "knee_angle_r_beta").unit, "rad") << with_model;
    EXPECT_EQ(At("coordinates", "knee_angle_r_beta").values[0], 1.5);
  }
}

TEST_F(ImportTest, WithoutInDegreesAnglesAreRadians) {
  options_.trial = "walk";
  const std::string rows = "endheader\ntime\tknee_angle_r\tpelvis_ty\n0\t1.5\t0.9\n";
  ASSERT_EQ(ErrorOf(Import({folder_.Write("ik.sto", "Coordinates\n" + rows)})), "");
  EXPECT_EQ(At("coordinates", "knee_angle_r").values[0], 1.5);
  EXPECT_EQ(At("coordinates", "knee_angle_r").unit, "rad");
  EXPECT_EQ(At("coordinates", "pelvis_ty").unit, "m");
  EXPECT_THAT(notes_,
              ElementsAre(HasSubstr("has no inDegrees: its angles are taken as radians, as OpenSim does")));
}

// Moments may be named after their joints; and 80 are no radians.
TEST_F(ImportTest, WithoutInDegreesMomentsAreNoAngles) {
  options_.trial = "walk";
  const std::string rows = "endheader\ntime\tknee_angle_r\thip_flexion_r\n0\t1.5\t0.9\n";
  ASSERT_EQ(ErrorOf(Import({folder_.Write("torques.sto", "x\n" + rows)})), "");
  EXPECT_EQ(At("torques", "knee_angle_r").unit, "1");
  options_.append = true;
  ASSERT_EQ(ErrorOf(Import(
                {folder_.Write("big.sto", "x\nendheader\ntime\tknee_angle_r\thip_flexion_r\n0\t80\t0.9\n")})),
            "");
  EXPECT_EQ(At("big", "knee_angle_r").unit, "1");
  EXPECT_THAT(notes_,
              testing::Contains(HasSubstr("big.sto: its columns are named like coordinates, but it has no "
                                          "inDegrees")));
}

TEST_F(ImportTest, DegreesOfFilesWithoutCoordinatesAreNotConverted) {
  options_.trial = "walk";
  ASSERT_EQ(
      ErrorOf(Import({folder_.Write("emg.mot", "emg\ninDegrees=yes\nendheader\ntime\tsoleus_r\n0\t0.5\n"),
                      folder_.Write("x.sto", "x\ninDegrees=yes\nendheader\ntime\tsoleus_force\n0\t90\n")})),
      "");
  EXPECT_EQ(At("emg", "soleus_r").values[0], 0.5);
  EXPECT_EQ(At("emg", "soleus_r").kind, ChannelKind::kInput);
  EXPECT_EQ(At("x", "soleus_force").values[0], 90);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("has inDegrees=yes, but its columns are no coordinates")));
}

TEST_F(ImportTest, ATrialIsNeverOverwritten) {
  const std::string walk = folder_.Write("walk.trc", kMarkers);
  ASSERT_EQ(ErrorOf(Import({walk})), "");
  EXPECT_THAT(ErrorOf(Import({walk})), HasSubstr("there is a trial 'walk' already"));
  options_.append = true;
  EXPECT_THAT(ErrorOf(Import({walk})),
              HasSubstr("trial 'walk' has a channel 'R.ASIS_x' on grid 'markers' already"));
  options_.trial = "walk";
  EXPECT_EQ(ErrorOf(Import({folder_.Write("ik.mot", kAngles)})), "");
  EXPECT_THAT(ErrorOf(Import({folder_.Write(
                  "ik2.mot", "Coordinates\ninDegrees=no\nendheader\ntime\thip_angle\n5\t1\n")})),
              HasSubstr("trial 'walk' has a grid 'coordinates' with other times already"));
  EXPECT_EQ(dataset_.trials.at("walk").grids.size(), 2U);
}

TEST_F(ImportTest, ConstantsAndTextsThatContradictAreErrors) {
  dataset_.constants["gear_ratio"] = {100, "1"};
  dataset_.files["model.osim"] = "<y/>";
  EXPECT_THAT(ErrorOf(Import({folder_.Write("m.osim", "<x/>")})),
              HasSubstr("has another text 'model.osim' already"));
  EXPECT_EQ(ErrorOf(Import({folder_.Write("m.osim", "<y/>")})), "");
  UseMap("constants: {gear_ratio: {value: 120, unit: \"1\"}}\n");
  EXPECT_THAT(ErrorOf(Import({folder_.Write("walk.trc", kMarkers)})),
              HasSubstr("map.yaml: constant 'gear_ratio' is 120 1, the dataset has 100 1 already"));
}

TEST_F(ImportTest, OtherBadFilesAreErrors) {
  EXPECT_THAT(ErrorOf(Import({folder_.Write("walk.c3d", "x")})),
              HasSubstr("walk.c3d: cannot be imported, expected .trc"));
  EXPECT_THAT(ErrorOf(Import({folder_.Path("no.trc")})), HasSubstr("no.trc: no such file"));
  EXPECT_THAT(ErrorOf(Import({folder_.Write("gaps.sto", "x\nendheader\ntime\ta\n0\tnan\n1\tnan\n")})),
              HasSubstr("gaps.sto: holds no numbers, only gaps"));
  EXPECT_THAT(ErrorOf(Import({folder_.Write("m.osim", std::string("a\0b", 3))})), HasSubstr("not text"));
}

TEST_F(ImportTest, ChannelsThatShareANameAreReported) {
  options_.trial = "walk";
  ASSERT_EQ(ErrorOf(Import({folder_.Write("Length.sto", "Length\nendheader\ntime\tsoleus_r\n0\t0.3\n"),
                            folder_.Write("emg.mot", "emg\nendheader\ntime\tsoleus_r\n0\t0.5\n")})),
            "");
  EXPECT_EQ(At("Length", "soleus_r").unit, "m");
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("1 channel names are on several grids, such as 'soleus_r'")));
}

}  // namespace
}  // namespace sinew
