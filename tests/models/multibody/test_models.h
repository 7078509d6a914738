// Small OpenSim models written out, and files of the shared data.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_reader.h"

namespace sinew {

inline const std::string kSharedData = SINEW_SHARED_DATA;
inline const std::string kGaitModel = kSharedData + "/gait_subject01/Gait10dof18musc_subject01.osim";

/// Empty if there is no such file.
inline std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline MultibodyModel BuildModel(const std::string& text) {
  auto read = ReadOsim(text, "test.osim");
  if (!read) throw std::runtime_error(read.error().message);
  auto built = MultibodyModel::Build(*read);
  if (!built) throw std::runtime_error(built.error().message);
  return std::move(*built);
}

inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("the test text lacks " + from);
  return text.replace(at, from.size(), to);
}

// A double pendulum that hangs from (0, 1, 0) and swings in the x-y plane: links of 0.5 m and 0.4 m, a marker
// at the tip; the lower joint frame is turned and shifted back, which must cancel. Angle zero hangs down.
inline const std::string kPendulum3 = R"(<?xml version="1.0"?>
<OpenSimDocument Version="30000">
<Model name="pendulum">
  <gravity> 0 -9.81 0</gravity>
  <BodySet><objects>
    <Body name="ground"><mass>0</mass><Joint /></Body>
    <Body name="upper">
      <mass>2</mass><mass_center>0 -0.25 0</mass_center>
      <inertia_xx>0.05</inertia_xx><inertia_yy>0.001</inertia_yy><inertia_zz>0.05</inertia_zz>
      <inertia_xy>0</inertia_xy><inertia_xz>0</inertia_xz><inertia_yz>0</inertia_yz>
      <Joint><PinJoint name="shoulder">
        <parent_body>ground</parent_body>
        <location_in_parent>0 1 0</location_in_parent><orientation_in_parent>0 0 0</orientation_in_parent>
        <location>0 0 0</location><orientation>0 0 0</orientation>
        <CoordinateSet><objects><Coordinate name="shoulder_angle">
          <motion_type>rotational</motion_type><default_value>0.3</default_value><range>-3 3</range>
          <clamped>true</clamped><locked>false</locked>
        </Coordinate></objects></CoordinateSet>
        <reverse>false</reverse>
      </PinJoint></Joint>
    </Body>
    <Body name="lower">
      <mass>1.5e+000</mass><mass_center>0 -0.2 0</mass_center>
      <inertia_xx>0.02</inertia_xx><inertia_yy>0.001</inertia_yy><inertia_zz>0.02</inertia_zz>
      <Joint><CustomJoint name="elbow">
        <parent_body>upper</parent_body>
        <location_in_parent>0 -0.5 0</location_in_parent><orientation_in_parent>0.1 0.2 0.7</orientation_in_parent>
        <location>0 0 0</location><orientation>0.1 0.2 0.7</orientation>
        <CoordinateSet><objects><Coordinate name="elbow_angle"><range>-3 3</range></Coordinate></objects></CoordinateSet>
        <SpatialTransform>
          <TransformAxis name="rotation1">
            <coordinates>elbow_angle</coordinates><axis>AXIS</axis>
            <function><LinearFunction><coefficients> 1 0</coefficients></LinearFunction></function>
          </TransformAxis>
          <TransformAxis name="rotation2"><coordinates></coordinates><axis>0 1 0</axis>
            <function><Constant><value>0</value></Constant></function></TransformAxis>
          <TransformAxis name="rotation3"><coordinates></coordinates><axis>1 0 0</axis></TransformAxis>
        </SpatialTransform>
      </CustomJoint></Joint>
    </Body>
  </objects></BodySet>
  <MarkerSet><objects>
    <Marker name="tip"><body>lower</body><location>0 -0.4 0</location></Marker>
    <Marker name="joint"><body>upper</body><location>0 -0.5 0</location></Marker>
  </objects></MarkerSet>
</Model>
</OpenSimDocument>
)";

// The same in the format of OpenSim 4, its joints in the wrong order, its frames in several ways.
inline const std::string kPendulum4 = R"(<?xml version="1.0"?>
<OpenSimDocument Version="40000">
<Model name="pendulum">
  <gravity>0 -9.81 0</gravity>
  <BodySet name="bodyset"><objects>
    <Body name="upper"><mass>2</mass><mass_center>0 -0.25 0</mass_center><inertia>0.05 0.001 0.05 0 0 0</inertia>
      <components><PhysicalOffsetFrame name="distal"><socket_parent>..</socket_parent></PhysicalOffsetFrame></components>
    </Body>
    <Body name="lower"><mass>1.5</mass><mass_center>0 -0.2 0</mass_center><inertia>0.02 0.001 0.02 0 0 0</inertia></Body>
  </objects></BodySet>
  <JointSet name="jointset"><objects>
    <CustomJoint name="elbow">
      <socket_parent_frame>upper_offset</socket_parent_frame>
      <socket_child_frame>/jointset/elbow/lower_offset</socket_child_frame>
      <coordinates><Coordinate name="elbow_angle"><range>-3 3</range></Coordinate></coordinates>
      <frames>
        <PhysicalOffsetFrame name="upper_end"><socket_parent>/bodyset/upper</socket_parent>
          <translation>0 -0.5 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>
        <PhysicalOffsetFrame name="upper_offset"><socket_parent>upper_end</socket_parent>
          <translation>0 0 0</translation><orientation>0.1 0.2 0.7</orientation></PhysicalOffsetFrame>
        <PhysicalOffsetFrame name="lower_offset"><socket_parent>/bodyset/lower</socket_parent>
          <translation>0 0 0</translation><orientation>0.1 0.2 0.7</orientation></PhysicalOffsetFrame>
      </frames>
      <SpatialTransform>
        <TransformAxis name="rotation1"><coordinates>elbow_angle</coordinates><axis>AXIS</axis>
          <LinearFunction name="function"><coefficients> 1 0</coefficients></LinearFunction></TransformAxis>
        <TransformAxis name="rotation2"><coordinates></coordinates><axis>0 1 0</axis>
          <Constant name="function"><value>0</value></Constant></TransformAxis>
        <TransformAxis name="rotation3"><coordinates></coordinates><axis>1 0 0</axis></TransformAxis>
      </SpatialTransform>
    </CustomJoint>
    <PinJoint name="shoulder">
      <socket_parent_frame>ground_offset</socket_parent_frame>
      <socket_child_frame>/bodyset/upper</socket_child_frame>
      <coordinates><Coordinate name="shoulder_angle"><default_value>0.3</default_value><range>-3 3</range>
        <clamped>true</clamped></Coordinate></coordinates>
      <frames><PhysicalOffsetFrame name="ground_offset"><socket_parent>/ground</socket_parent>
        <translation>0 1 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame></frames>
    </PinJoint>
  </objects></JointSet>
  <MarkerSet><objects>
    <Marker name="tip"><socket_parent_frame>/bodyset/lower</socket_parent_frame><location>0 -0.4 0</location></Marker>
    <Marker name="joint"><socket_parent_frame>/bodyset/upper/distal</socket_parent_frame><location>0 -0.5 0</location></Marker>
  </objects></MarkerSet>
</Model>
</OpenSimDocument>
)";

// The z axis of the body in the turned joint frame, so that the elbow moves in the plane: the third row of
// the rotation that x-y-z angles 0.1, 0.2, 0.7 make.
inline std::string ElbowAxis() {
  const double a = 0.1;
  const double b = 0.2;
  const double c = 0.7;
  std::ostringstream text;
  text.precision(17);
  text << std::sin(a) * std::sin(c) - std::cos(a) * std::sin(b) * std::cos(c) << " "
       << std::sin(a) * std::cos(c) + std::cos(a) * std::sin(b) * std::sin(c) << " "
       << std::cos(a) * std::cos(b);
  return text.str();
}

inline std::string PendulumText3() {
  return Replaced(kPendulum3, "AXIS", ElbowAxis());
}
inline std::string PendulumText4() {
  return Replaced(kPendulum4, "AXIS", ElbowAxis());
}

// A free pelvis, a ball hip, a knee whose translation follows its angle, a patella coupled to the knee, a
// locked ankle and a toe that no marker sees.
inline const std::string kLeg = R"(<?xml version="1.0"?>
<OpenSimDocument Version="40000">
<Model name="leg">
  <BodySet><objects>
    <Body name="pelvis"><mass>10</mass><inertia>0.1 0.1 0.1 0 0 0</inertia></Body>
    <Body name="femur"><mass>8</mass><inertia>0.1 0.02 0.1 0 0 0</inertia></Body>
    <Body name="tibia"><mass>3</mass><inertia>0.05 0.005 0.05 0 0 0</inertia></Body>
    <Body name="patella"><mass>0.1</mass><inertia>0.001 0.001 0.001 0 0 0</inertia></Body>
    <Body name="foot"><mass>1</mass><inertia>0.001 0.002 0.002 0 0 0</inertia></Body>
    <Body name="toe"><mass>0.2</mass><inertia>0.001 0.001 0.01 0 0 0</inertia></Body>
  </objects></BodySet>
  <JointSet><objects>
    <FreeJoint name="root"><socket_parent_frame>/ground</socket_parent_frame>
      <socket_child_frame>/bodyset/pelvis</socket_child_frame>
      <coordinates><Coordinate name="rx"/><Coordinate name="ry"/><Coordinate name="rz"/>
        <Coordinate name="tx"/><Coordinate name="ty"/><Coordinate name="tz"/></coordinates></FreeJoint>
    <BallJoint name="hip"><socket_parent_frame>socket</socket_parent_frame>
      <socket_child_frame>/bodyset/femur</socket_child_frame>
      <coordinates><Coordinate name="hip_x"/><Coordinate name="hip_y"/><Coordinate name="hip_z"/></coordinates>
      <frames><PhysicalOffsetFrame name="socket"><socket_parent>/bodyset/pelvis</socket_parent>
        <translation>-0.07 -0.06 0.08</translation></PhysicalOffsetFrame></frames></BallJoint>
    <CustomJoint name="knee"><socket_parent_frame>/bodyset/femur</socket_parent_frame>
      <socket_child_frame>/bodyset/tibia</socket_child_frame>
      <coordinates><Coordinate name="knee"><range>-2 0.2</range><clamped>true</clamped></Coordinate></coordinates>
      <SpatialTransform>
        <TransformAxis name="rotation1"><coordinates>knee</coordinates><axis>0 0 1</axis></TransformAxis>
        <TransformAxis name="rotation2"><axis>0 1 0</axis></TransformAxis>
        <TransformAxis name="rotation3"><axis>1 0 0</axis></TransformAxis>
        <TransformAxis name="translation1"><coordinates>knee</coordinates><axis>1 0 0</axis>
          <SimmSpline name="function"><x>-2.1 -1.2 -0.7 -0.2 0.2 2</x>
            <y>-0.003 0.004 0.002 -0.003 -0.005 -0.005</y></SimmSpline></TransformAxis>
        <TransformAxis name="translation2"><axis>0 1 0</axis>
          <MultiplierFunction name="function"><function><Constant><value>-0.2</value></Constant></function>
            <scale>2</scale></MultiplierFunction></TransformAxis>
      </SpatialTransform></CustomJoint>
    <CustomJoint name="patellofemoral"><socket_parent_frame>/bodyset/femur</socket_parent_frame>
      <socket_child_frame>/bodyset/patella</socket_child_frame>
      <coordinates><Coordinate name="knee_beta"/></coordinates>
      <SpatialTransform>
        <TransformAxis name="rotation1"><coordinates>knee_beta</coordinates><axis>0 0 1</axis>
          <PolynomialFunction name="function"><coefficients>0.1 0.8 0.05</coefficients></PolynomialFunction>
          </TransformAxis>
        <TransformAxis name="rotation2"><axis>0 1 0</axis></TransformAxis>
        <TransformAxis name="rotation3"><axis>1 0 0</axis></TransformAxis>
      </SpatialTransform></CustomJoint>
    <PinJoint name="ankle"><socket_parent_frame>shank_end</socket_parent_frame>
      <socket_child_frame>/bodyset/foot</socket_child_frame>
      <coordinates><Coordinate name="ankle"><default_value>0.1</default_value><locked>true</locked></Coordinate>
        </coordinates>
      <frames><PhysicalOffsetFrame name="shank_end"><socket_parent>/bodyset/tibia</socket_parent>
        <translation>0 -0.4 0</translation></PhysicalOffsetFrame></frames></PinJoint>
    <PinJoint name="mtp"><socket_parent_frame>/bodyset/foot</socket_parent_frame>
      <socket_child_frame>/bodyset/toe</socket_child_frame>
      <coordinates><Coordinate name="mtp"><default_value>0.2</default_value></Coordinate></coordinates></PinJoint>
  </objects></JointSet>
  <ConstraintSet><objects>
    <CoordinateCouplerConstraint name="patella_follows">
      <isEnforced>true</isEnforced>
      <coupled_coordinates_function><PiecewiseLinearFunction><x>-3 -1 3</x><y>-3.5 -1.1 2.9</y>
        </PiecewiseLinearFunction></coupled_coordinates_function>
      <independent_coordinate_names>knee</independent_coordinate_names>
      <dependent_coordinate_name>knee_beta</dependent_coordinate_name>
      <scale_factor>0.9</scale_factor>
    </CoordinateCouplerConstraint>
    <PointConstraint name="unused"><isEnforced>false</isEnforced></PointConstraint>
  </objects></ConstraintSet>
  <MarkerSet><objects>
    <Marker name="RASI"><socket_parent_frame>/bodyset/pelvis</socket_parent_frame><location>0.02 0.03 0.13</location></Marker>
    <Marker name="LASI"><socket_parent_frame>/bodyset/pelvis</socket_parent_frame><location>0.02 0.03 -0.13</location></Marker>
    <Marker name="SACR"><socket_parent_frame>/bodyset/pelvis</socket_parent_frame><location>-0.16 0.04 0</location></Marker>
    <Marker name="THI1"><socket_parent_frame>/bodyset/femur</socket_parent_frame><location>0.02 -0.2 0.1</location></Marker>
    <Marker name="THI2"><socket_parent_frame>/bodyset/femur</socket_parent_frame><location>0.08 -0.25 0.01</location></Marker>
    <Marker name="THI3"><socket_parent_frame>/bodyset/femur</socket_parent_frame><location>0.01 -0.31 0.05</location></Marker>
    <Marker name="PAT"><socket_parent_frame>/bodyset/patella</socket_parent_frame><location>0.05 0.03 0</location></Marker>
    <Marker name="SHA1"><socket_parent_frame>/bodyset/tibia</socket_parent_frame><location>0.03 -0.1 0.05</location></Marker>
    <Marker name="HEEL"><socket_parent_frame>/bodyset/foot</socket_parent_frame><location>-0.05 -0.05 0.01</location></Marker>
  </objects></MarkerSet>
</Model>
</OpenSimDocument>
)";

}  // namespace sinew
