#!/usr/bin/env python3
"""Writes nao_like.osim: a synthetic small humanoid with the proportions of Aldebaran's NAO.

Link lengths and joint ranges are the published ones (Aldebaran documentation, "H25 - Links" and
"H25 - Joints", V3.3/V4; the left side's ranges on both sides). Masses are rounded, and each body is one
homogeneous simple solid, so that every inertia is physical. It is a stand-in with which data can be made, not
a model of the product.

Left out: the coupling of the two hip yaws (here a plain hip_rotation for each leg), the head's pitch, the yaw
of elbow and wrist, the elbow's sideways offset and the hands' opening.

Axes are OpenSim's: x forward, y up, z right. Units: m, kg, rad. Standard library only.

Usage: make_nao_like.py [OUT.osim]     (default: nao_like.osim beside this file)
"""

import math
import pathlib
import sys
import xml.etree.ElementTree as ET
from typing import NamedTuple

TOTAL_MASS_KG = 5.8
HEIGHT_M = 0.573

# The published names, in NAO's own axes (its y is left, its z is up), from the torso's origin.
HIP_OFFSET_Z = 0.085
HIP_OFFSET_Y = 0.050
THIGH = 0.100
TIBIA = 0.1029
FOOT_HEIGHT = 0.04519
SHOULDER_OFFSET_Z = 0.100
SHOULDER_OFFSET_Y = 0.098
UPPER_ARM = 0.105
LOWER_ARM = 0.05595
HAND = 0.05775
NECK_OFFSET_Z = 0.1265

FOREARM_AND_HAND = LOWER_ARM + HAND
HIP_HEIGHT = THIGH + TIBIA + FOOT_HEIGHT
HEAD_HEIGHT = HEIGHT_M - (HIP_HEIGHT + HIP_OFFSET_Z + NECK_OFFSET_Z)

SOLE_BACK, SOLE_FRONT, SOLE_HALF_WIDTH = -0.060, 0.100, 0.045
FOOT_TOP = -0.010
HEAD_SEMI_AXES = (0.065, HEAD_HEIGHT / 2, 0.060)

COMMENT = """
\t\tA synthetic stand-in with the proportions of Aldebaran's NAO, not a model of the product. Link lengths and
\t\tjoint ranges are the published ones; masses are rounded and inertias are those of homogeneous solids.
\t\tx forward, y up, z right. 25 independent coordinates: base 6, legs 2 x 6, head 1, arms 2 x 3.
\t\tWritten by make_nao_like.py: change that file, not this one.
\t"""

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
ORIGIN = (0, 0, 0)


class Box(NamedTuple):
    """Edges along x, y, z."""

    edges: tuple

    def inertia(self, mass):
        x, y, z = (edge * edge for edge in self.edges)
        return tuple(mass / 12 * sum_of_squares for sum_of_squares in (y + z, x + z, x + y))


class Ellipsoid(NamedTuple):
    """Semi-axes along x, y, z."""

    semi_axes: tuple

    def inertia(self, mass):
        x, y, z = (axis * axis for axis in self.semi_axes)
        return tuple(mass / 5 * sum_of_squares for sum_of_squares in (y + z, x + z, x + y))


class UprightCylinder(NamedTuple):
    """Axis along y."""

    radius: float
    length: float

    def inertia(self, mass):
        across = mass * (3 * self.radius**2 + self.length**2) / 12
        return (across, mass * self.radius**2 / 2, across)


class Body(NamedTuple):
    name: str
    mass: float
    centre: tuple
    solid: object


class Coordinate(NamedTuple):
    name: str
    lower: float
    upper: float
    default: float = 0


class Joint(NamedTuple):
    """Rotations follow one another, each a (coordinate, axis), in the parent's frame placed at `offset`.

    Without coordinates the joint is a weld. The child's frame is the child body's own.
    """

    name: str
    parent: str
    child: str
    offset: tuple
    rotations: tuple = ()
    translations: tuple = ()


class Marker(NamedTuple):
    name: str
    body: str
    location: tuple


def scaled(axis, factor):
    return tuple(factor * component for component in axis)


def trunk_bodies():
    torso_bottom = -0.0265
    torso_height = NECK_OFFSET_Z - torso_bottom
    pelvis_height = HIP_OFFSET_Z + torso_bottom
    return [
        Body("pelvis", 0.40, (0, pelvis_height / 2, 0), Box((0.080, pelvis_height, 0.120))),
        Body("torso", 1.50, (0, torso_bottom + torso_height / 2, 0), Box((0.090, torso_height, 0.140))),
        Body("head", 0.62, (0, HEAD_HEIGHT / 2, 0), Ellipsoid(HEAD_SEMI_AXES)),
    ]


def leg_bodies(side):
    foot_edges = (SOLE_FRONT - SOLE_BACK, FOOT_TOP + FOOT_HEIGHT, 2 * SOLE_HALF_WIDTH)
    foot_centre = ((SOLE_BACK + SOLE_FRONT) / 2, (FOOT_TOP - FOOT_HEIGHT) / 2, 0)
    return [
        Body(f"femur_{side}", 0.46, (0, -THIGH / 2, 0), Box((0.070, THIGH, 0.060))),
        Body(f"tibia_{side}", 0.34, (0, -TIBIA / 2, 0), UprightCylinder(0.033, TIBIA)),
        Body(f"calcn_{side}", 0.28, foot_centre, Box(foot_edges)),
    ]


def arm_bodies(side):
    return [
        Body(f"humerus_{side}", 0.30, (0, -UPPER_ARM / 2, 0), UprightCylinder(0.026, UPPER_ARM)),
        Body(
            f"forearm_{side}", 0.26, (0, -FOREARM_AND_HAND / 2, 0), UprightCylinder(0.024, FOREARM_AND_HAND)
        ),
    ]


def trunk_joints():
    base_rotations = (
        (Coordinate("pelvis_tilt", -math.pi / 2, math.pi / 2), Z),
        (Coordinate("pelvis_list", -math.pi / 2, math.pi / 2), X),
        (Coordinate("pelvis_rotation", -math.pi, math.pi), Y),
    )
    base_translations = (
        Coordinate("pelvis_tx", -5, 5),
        Coordinate("pelvis_ty", -1, 2, default=HIP_HEIGHT),
        Coordinate("pelvis_tz", -3, 3),
    )
    return [
        Joint("ground_pelvis", "ground", "pelvis", ORIGIN, base_rotations, base_translations),
        Joint("waist", "pelvis", "torso", (0, HIP_OFFSET_Z, 0)),
    ]


def leg_joints(side, right):
    """`right` is +1 on the right, -1 on the left: it mirrors the positions, and the axes x and y, so that a
    positive angle means the same on both sides."""
    hip = (
        (Coordinate(f"hip_flexion_{side}", -0.484090, 1.535889), Z),
        (Coordinate(f"hip_adduction_{side}", -0.790477, 0.379472), scaled(X, right)),
        (Coordinate(f"hip_rotation_{side}", -1.145303, 0.740810), scaled(Y, right)),
    )
    knee = ((Coordinate(f"knee_angle_{side}", -2.112528, 0.092346), Z),)
    ankle = (
        (Coordinate(f"ankle_angle_{side}", -0.922747, 1.189516), Z),
        (Coordinate(f"subtalar_angle_{side}", -0.769001, 0.397880), scaled(X, right)),
    )
    return [
        Joint(f"hip_{side}", "pelvis", f"femur_{side}", (0, 0, right * HIP_OFFSET_Y), hip),
        Joint(f"knee_{side}", f"femur_{side}", f"tibia_{side}", (0, -THIGH, 0), knee),
        Joint(f"ankle_{side}", f"tibia_{side}", f"calcn_{side}", (0, -TIBIA, 0), ankle),
    ]


def neck_joint():
    rotation = ((Coordinate("head_yaw", -2.0857, 2.0857), Y),)
    return Joint("neck", "torso", "head", (0, NECK_OFFSET_Z, 0), rotation)


def arm_joints(side, right):
    # NAO's shoulder pitch is zero with the arm forward; here, as in OpenSim, zero is the hanging arm.
    shoulder = (
        (Coordinate(f"arm_flex_{side}", math.pi / 2 - 2.0857, math.pi / 2 + 2.0857), Z),
        (Coordinate(f"arm_add_{side}", -1.3265, 0.3142), scaled(X, right)),
    )
    # NAO's elbow stops 2 degrees before it is straight; here it may be straight, so that zero is in range.
    elbow = ((Coordinate(f"elbow_flex_{side}", 0, 1.5446), Z),)
    shoulder_offset = (0, SHOULDER_OFFSET_Z, right * SHOULDER_OFFSET_Y)
    return [
        Joint(f"acromial_{side}", "torso", f"humerus_{side}", shoulder_offset, shoulder),
        Joint(f"elbow_{side}", f"humerus_{side}", f"forearm_{side}", (0, -UPPER_ARM, 0), elbow),
    ]


def on_head(direction):
    """The point of the head's surface that lies from its centre in `direction`, in the head's frame."""
    reach = 1 / math.sqrt(sum((d / a) ** 2 for d, a in zip(direction, HEAD_SEMI_AXES)))
    x, y, z = scaled(direction, reach)
    return (x, y + HEAD_HEIGHT / 2, z)


def trunk_markers():
    markers = [
        Marker("C7", "torso", (-0.045, 0.115, 0)),
        Marker("T10", "torso", (-0.045, 0.045, 0)),
        Marker("CLAV", "torso", (0.045, 0.105, 0)),
        Marker("STRN", "torso", (0.045, 0.035, 0)),
    ]
    for letter, right in (("R", 1), ("L", -1)):
        markers += [
            Marker(f"{letter}FHD", "head", on_head((1, 0.5, 0.6 * right))),
            Marker(f"{letter}BHD", "head", on_head((-1, 0.4, 0.6 * right))),
            Marker(f"{letter}ASI", "pelvis", (0.040, 0.045, 0.050 * right)),
            Marker(f"{letter}PSI", "pelvis", (-0.040, 0.045, 0.025 * right)),
        ]
    return markers


def limb_markers(side, right):
    letter = side.upper()
    return [
        Marker(f"{letter}UPA", f"humerus_{side}", (0, -0.045, 0.026 * right)),
        Marker(f"{letter}ELB", f"humerus_{side}", (0, -UPPER_ARM, 0.026 * right)),
        Marker(f"{letter}WRI", f"forearm_{side}", (0, -0.085, 0.024 * right)),
        Marker(f"{letter}THI", f"femur_{side}", (0.035, -0.045, 0)),
        Marker(f"{letter}KNE", f"femur_{side}", (0, -THIGH, 0.030 * right)),
        Marker(f"{letter}KNM", f"femur_{side}", (0, -THIGH, -0.030 * right)),
        Marker(f"{letter}TIB", f"tibia_{side}", (0.033, -0.050, 0)),
        Marker(f"{letter}ANK", f"tibia_{side}", (0, -TIBIA, 0.033 * right)),
        Marker(f"{letter}MED", f"tibia_{side}", (0, -TIBIA, -0.033 * right)),
        Marker(f"{letter}HEE", f"calcn_{side}", (SOLE_BACK, -0.025, 0)),
        Marker(f"{letter}TOE", f"calcn_{side}", (SOLE_FRONT, -0.030, 0)),
        Marker(f"{letter}MT1", f"calcn_{side}", (0.060, -0.025, -SOLE_HALF_WIDTH * right)),
        Marker(f"{letter}MT5", f"calcn_{side}", (0.050, -0.025, SOLE_HALF_WIDTH * right)),
    ]


def text_of(value):
    """Nine digits: below a micrometre, and free of the last bits of binary arithmetic."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (tuple, list)):
        return " ".join(text_of(item) for item in value)
    return value if isinstance(value, str) else f"{value + 0:.9g}"


def add(parent, tag, value=None, name=None):
    element = ET.SubElement(parent, tag, {"name": name} if name else {})
    if value is not None:
        element.text = text_of(value)
    return element


def add_set(parent, tag):
    """An OpenSim set; the caller fills the list that is returned."""
    container = add(parent, tag, name=tag.lower())
    objects = add(container, "objects")
    add(container, "groups")
    return objects


def add_body(objects, body):
    element = add(objects, "Body", name=body.name)
    add(element, "mass", body.mass)
    add(element, "mass_center", body.centre)
    add(element, "inertia", (*body.solid.inertia(body.mass), 0, 0, 0))


def add_coordinate(parent, coordinate):
    element = add(parent, "Coordinate", name=coordinate.name)
    add(element, "default_value", coordinate.default)
    add(element, "default_speed_value", 0)
    add(element, "range", (coordinate.lower, coordinate.upper))
    add(element, "clamped", False)
    add(element, "locked", False)
    add(element, "prescribed_function")
    add(element, "prescribed", False)


def add_offset_frame(parent, body, translation):
    frame = add(parent, "PhysicalOffsetFrame", name=f"{body}_offset")
    add(frame, "socket_parent", "/ground" if body == "ground" else f"/bodyset/{body}")
    add(frame, "translation", translation)
    add(frame, "orientation", ORIGIN)


def add_transform_axis(parent, name, axis, coordinate):
    element = add(parent, "TransformAxis", name=name)
    add(element, "coordinates", coordinate.name if coordinate else "")
    add(element, "axis", axis)
    if coordinate:
        add(add(element, "LinearFunction", name="function"), "coefficients", (1, 0))
    else:
        add(add(element, "Constant", name="function"), "value", 0)


def unused_axes(rotations):
    """Axes for the rotations that a joint does not have: those of x, y, z that no rotation is about."""
    used = {tuple(map(abs, axis)) for _, axis in rotations}
    return [axis for axis in (X, Y, Z) if axis not in used]


def add_spatial_transform(parent, joint):
    element = add(parent, "SpatialTransform")
    rotations = [*joint.rotations, *((None, axis) for axis in unused_axes(joint.rotations))]
    for number, (coordinate, axis) in enumerate(rotations, start=1):
        add_transform_axis(element, f"rotation{number}", axis, coordinate)
    translations = joint.translations or (None, None, None)
    for number, (coordinate, axis) in enumerate(zip(translations, (X, Y, Z)), start=1):
        add_transform_axis(element, f"translation{number}", axis, coordinate)


def add_joint(objects, joint):
    coordinates = [*(coordinate for coordinate, _ in joint.rotations), *joint.translations]
    element = add(objects, "CustomJoint" if coordinates else "WeldJoint", name=joint.name)
    add(element, "socket_parent_frame", f"{joint.parent}_offset")
    add(element, "socket_child_frame", f"{joint.child}_offset")
    if coordinates:
        coordinate_list = add(element, "coordinates")
        for coordinate in coordinates:
            add_coordinate(coordinate_list, coordinate)
    frames = add(element, "frames")
    add_offset_frame(frames, joint.parent, joint.offset)
    add_offset_frame(frames, joint.child, ORIGIN)
    if coordinates:
        add_spatial_transform(element, joint)


def add_marker(objects, marker):
    element = add(objects, "Marker", name=marker.name)
    add(element, "socket_parent_frame", f"/bodyset/{marker.body}")
    add(element, "location", marker.location)
    add(element, "fixed", True)


def build_document():
    bodies = [*trunk_bodies(), *leg_bodies("r"), *leg_bodies("l"), *arm_bodies("r"), *arm_bodies("l")]
    joints = [*trunk_joints(), *leg_joints("r", 1), *leg_joints("l", -1), neck_joint()]
    joints += [*arm_joints("r", 1), *arm_joints("l", -1)]
    markers = [*trunk_markers(), *limb_markers("r", 1), *limb_markers("l", -1)]

    total = math.fsum(body.mass for body in bodies)
    if not math.isclose(total, TOTAL_MASS_KG, rel_tol=1e-12):
        raise ValueError(f"the masses of the bodies sum to {total} kg, expected {TOTAL_MASS_KG} kg")

    document = ET.Element("OpenSimDocument", {"Version": "40000"})
    document.append(ET.Comment(COMMENT))
    model = add(document, "Model", name="nao_like")
    add(model, "Ground", name="ground")
    add(model, "gravity", (0, -9.80665, 0))
    add(model, "credits", "Synthetic: the proportions of Aldebaran's NAO, not a model of the product.")
    add(model, "length_units", "meters")
    add(model, "force_units", "N")
    sets = (
        ("BodySet", add_body, bodies),
        ("JointSet", add_joint, joints),
        ("MarkerSet", add_marker, markers),
    )
    for tag, add_item, items in sets:
        objects = add_set(model, tag)
        for item in items:
            add_item(objects, item)
    return ET.ElementTree(document)


def main():
    default = pathlib.Path(__file__).resolve().parent / "nao_like.osim"
    path = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default
    document = build_document()
    ET.indent(document, space="\t")
    with path.open("wb") as file:
        document.write(file, encoding="UTF-8", xml_declaration=True)
        file.write(b"\n")


if __name__ == "__main__":
    main()
