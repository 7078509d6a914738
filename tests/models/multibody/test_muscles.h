// A small OpenSim model with muscles, written out, whose lengths have closed forms.
#pragma once

#include <string>

#include "tests/models/multibody/test_models.h"

namespace sinew {

// A hinge about z at the origin; the arm hangs on it. `around` wraps in the plane over a cylinder (radius
// 0.05 m, axis z through the hinge) or sphere fixed to ground; `helix` also climbs along the axis; `through`
// has a point that is there only for bent angles; `sliding` ends in a point that moves along the arm with the
// angle; `coupled` ends on a sled that a coupler moves with the angle.
inline const std::string kMuscles3 = R"(<?xml version="1.0"?>
<OpenSimDocument Version="30000">
<Model name="hinge">
  <BodySet><objects>
    <Body name="ground"><WrapObjectSet><objects>
      <WrapCylinder name="drum"><active>true</active><quadrant>QUADRANT</quadrant>
        <xyz_body_rotation>0 0 0</xyz_body_rotation><translation>0 0 0</translation>
        <radius>0.05</radius><length>LENGTH</length></WrapCylinder>
      <WrapSphere name="ball"><quadrant>all</quadrant><radius>0.05</radius></WrapSphere>
      <WrapEllipsoid name="egg"><quadrant>all</quadrant><dimensions>0.1 0.2 0.3</dimensions></WrapEllipsoid>
      <WrapTorus name="idle"><active>false</active></WrapTorus>
    </objects></WrapObjectSet></Body>
    <Body name="arm"><mass>1</mass><inertia_xx>1</inertia_xx><inertia_yy>1</inertia_yy><inertia_zz>1</inertia_zz>
      <Joint><PinJoint name="hinge"><parent_body>ground</parent_body>
        <CoordinateSet><objects><Coordinate name="angle"><range>-3 2</range></Coordinate></objects></CoordinateSet>
      </PinJoint></Joint></Body>
    <Body name="sled"><mass>1</mass><inertia_xx>1</inertia_xx><inertia_yy>1</inertia_yy><inertia_zz>1</inertia_zz>
      <Joint><SliderJoint name="rail"><parent_body>ground</parent_body>
        <CoordinateSet><objects><Coordinate name="way"/></objects></CoordinateSet>
      </SliderJoint></Joint></Body>
  </objects></BodySet>
  <ConstraintSet><objects><CoordinateCouplerConstraint name="gear">
    <independent_coordinate_names>angle</independent_coordinate_names>
    <dependent_coordinate_name>way</dependent_coordinate_name>
    <coupled_coordinates_function><LinearFunction><coefficients>0.1 1</coefficients></LinearFunction></coupled_coordinates_function>
  </CoordinateCouplerConstraint></objects></ConstraintSet>
  <ForceSet><objects>
    <CoordinateLimitForce name="stop"/>
    <Thelen2003Muscle name="around"><GeometryPath>
      <PathPointSet><objects>
        <PathPoint name="a"><location>0.2 0 0</location><body>ground</body></PathPoint>
        <PathPoint name="b"><location>0.3 0 0</location><body>arm</body></PathPoint>
      </objects></PathPointSet>
      <PathWrapSet><objects><PathWrap name="w"><wrap_object>OBJECT</wrap_object><range>RANGE</range></PathWrap></objects></PathWrapSet>
    </GeometryPath></Thelen2003Muscle>
    <Schutte1993Muscle_Deprecated name="helix"><GeometryPath>
      <PathPointSet><objects>
        <PathPoint name="a"><location>0.2 0 -0.1</location><body>ground</body></PathPoint>
        <PathPoint name="b"><location>0.3 0 0.2</location><body>arm</body></PathPoint>
      </objects></PathPointSet>
      <PathWrapSet><objects>
        <PathWrap><wrap_object>drum</wrap_object></PathWrap>
        <PathWrap><wrap_object>idle</wrap_object></PathWrap>
      </objects></PathWrapSet>
    </GeometryPath></Schutte1993Muscle_Deprecated>
    <Millard2012EquilibriumMuscle name="through"><GeometryPath>
      <PathPointSet><objects>
        <PathPoint name="a"><location>0 0.4 0</location><body>ground</body></PathPoint>
        <ConditionalPathPoint name="via"><location>0.1 0.1 0</location><body>ground</body>
          <range>1 2</range><coordinate>angle</coordinate></ConditionalPathPoint>
        <PathPoint name="b"><location>0.3 0 0</location><body>arm</body></PathPoint>
      </objects></PathPointSet></GeometryPath></Millard2012EquilibriumMuscle>
    <PathActuator name="sliding"><GeometryPath>
      <PathPointSet><objects>
        <PathPoint name="a"><location>0 0 0</location><body>ground</body></PathPoint>
        <MovingPathPoint name="m"><body>arm</body>
          <x_location><PolynomialFunction><coefficients>0.1 0.2 0.3</coefficients></PolynomialFunction></x_location>
          <y_location><Constant><value>0</value></Constant></y_location>
          <z_location><Constant><value>0</value></Constant></z_location>
          <x_coordinate>angle</x_coordinate><y_coordinate>angle</y_coordinate><z_coordinate>angle</z_coordinate>
        </MovingPathPoint>
      </objects></PathPointSet></GeometryPath></PathActuator>
    <Thelen2003Muscle name="coupled"><GeometryPath>
      <PathPointSet><objects>
        <PathPoint name="a"><location>0 0 0</location><body>ground</body></PathPoint>
        <PathPoint name="b"><location>0.5 0 0</location><body>sled</body></PathPoint>
      </objects></PathPointSet></GeometryPath></Thelen2003Muscle>
  </objects></ForceSet>
</Model>
</OpenSimDocument>
)";

inline std::string MusclesOver(const std::string& object, const std::string& quadrant = "all",
                               const std::string& length = "1", const std::string& range = "-1 -1") {
  std::string text = Replaced(kMuscles3, "OBJECT", object);
  text = Replaced(text, "QUADRANT", quadrant);
  text = Replaced(text, "LENGTH", length);
  return Replaced(text, "RANGE", range);
}

}  // namespace sinew
