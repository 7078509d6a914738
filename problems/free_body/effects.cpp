#include "problems/free_body/effects.h"

#include <cmath>
#include <utility>

namespace sinew {
namespace {

constexpr double kFirstDepth = 0.1;      // of the body's size
constexpr double kStiffnessRange = 300;  // both ways
constexpr const char* kHunt = "Hunt, Crossley 1975";
constexpr const char* kHollars = "Hollars; Sherman et al. 2011";

using Builder = ParameterListBuilder;

void Base(Builder& add, FreeBodySlot slot, Parameter p, const char* source, Scale scale = Scale::kLinear) {
  p.source = source;
  p.scale = scale;
  add.Add(std::move(p), slot);
}

void AddBase(const FreeBody& body, double speed, Builder& add) {
  // Where half of the kinetic energy is stored in the spring under one corner. An elastic foundation that a
  // corner enters by x is pressed over a pyramid: the force grows with x^3.
  const double depth = kFirstDepth * body.size;
  const double energy = 0.25 * body.mass * speed * speed;
  const bool vertices = body.contact == FreeBodyContact::kVertices;
  const double stiffness = vertices ? 2.5 * energy / std::pow(depth, 2.5) : 4.6 * energy / std::pow(depth, 4);
  Base(add, kStiffness,
       BaseParameter("stiffness", vertices ? "N/m^1.5" : "N/m3",
                     vertices ? "force of a corner per depth^1.5" : "pressure per depth",
                     stiffness / kStiffnessRange, stiffness * kStiffnessRange, stiffness),
       vertices ? kHunt : "thesis eq 5.1", Scale::kLog);
  Base(add, kDissipation,
       BaseParameter("dissipation", "s/m", "share of the force per speed of approach", 0.01, 20, 1), kHunt,
       Scale::kLog);
  Base(add, kFriction, BaseParameter("friction", "1", "friction force per normal force", 0, 2, 0.3),
       kHollars);
}

void AddContact(const FreeBody& body, double speed, Builder& add) {
  add.BeginEffect("static_friction", Level::kBoundary, "friction is larger before it slips",
                  "slow pulls from rest, or slow rotation about an edge", kHollars)
      .Number(kStaticExcess, "static_friction_excess", "1", "friction coefficient beyond that of slip", 0, 2);
  add.BeginEffect("viscous_slip", Level::kBoundary, "friction grows with the speed of slip",
                  "fast slides at several speeds", kHollars)
      .Number(kViscousSlip, "viscous_slip", "s/m", "friction coefficient per speed of slip", 0, 5 / speed);
  add.BeginEffect("rebound_loss", Level::kBoundary,
                  "contact loses a fixed share of its force on the way out, whatever the speed of impact",
                  "drops from several heights: the share of the speed that comes back stays the same",
                  "Walton, Braun 1986")
      .Number(kReboundLoss, "rebound_loss", "1", "share of the force that is lost on the way out", 0, 0.99);
  // Down to a force that is linear in the depth of a corner: a power below 1 would be infinitely stiff at the
  // first touch. (The elements of an elastic foundation are entered one after the other.)
  add.BeginEffect("contact_exponent", Level::kBoundary,
                  "the force does not grow with the stated power of the depth",
                  "pressing the body on the table slowly, force against depth")
      .Number(kExponent, "contact_exponent", "1", "power of the depth beyond that of the model, 1 mm fixed",
              -0.5, 2);
  if (body.contact == FreeBodyContact::kVertices) {
    add.BeginEffect("rounded_corners", Level::kRobot, "the corners are balls, not points",
                    "a photograph of a corner")
        .Number(kCornerRadius, "corner_radius", "m", "radius of the corners", 0, 0.5 * body.size);
  }
}

void AddBody(const FreeBody& body, Builder& add) {
  const double way = 0.3 * body.size;
  add.BeginEffect("size_error", Level::kRobot, "the body is not as large as stated", "a calliper")
      .Number(kSizeError, "size_error", "1", "edges beyond the stated ones, as a share", -0.2, 0.2);
  add.BeginEffect("inertia_error", Level::kRobot, "the moments of inertia differ from the stated ones",
                  "swinging the body on two threads")
      .Number(kInertiaShare, "inertia_error", "1", "moments of inertia beyond the stated ones, as a share",
              -0.7, 1.5);
  add.BeginEffect("mass_centre_offset", Level::kRobot, "the mass centre is not in the middle of the body",
                  "balancing the body on an edge")
      .Number(kMassCentreX, "mass_centre_x", "m", "mass centre from the middle, along x of the body", -way,
              way)
      .Number(kMassCentreY, "mass_centre_y", "m", "mass centre from the middle, along y of the body", -way,
              way)
      .Number(kMassCentreZ, "mass_centre_z", "m", "mass centre from the middle, along z of the body", -way,
              way);
  add.BeginEffect("air_drag", Level::kBoundary, "the air resists the motion", "drops from a great height")
      .Number(kAirDrag, "air_drag", "1/m", "deceleration per squared speed", 0, 2);
}

void AddWorld(const FreeBody& body, Builder& add) {
  add.BeginEffect("gravity_error", Level::kBoundary, "gravity differs from the stated one",
                  "a drop whose height is known by other means")
      .Number(kGravityShare, "gravity_error", "1", "gravity beyond the stated one, as a share", -0.3, 0.3);
  add.BeginEffect("tilted_axes", Level::kSensor, "the cameras' z axis is not vertical",
                  "a plumb line in the cameras' view")
      .Number(kGravityTiltX, "gravity_x", "1", "share of gravity along x", -0.2, 0.2)
      .Number(kGravityTiltY, "gravity_y", "1", "share of gravity along y", -0.2, 0.2);
  add.BeginEffect("table_height", Level::kSensor, "the table is not at z = 0",
                  "the body at rest, measured by other means")
      .Number(kTableHeight, "table_height", "m", "of the table at x = y = 0", -0.3 * body.size,
              0.3 * body.size);
  add.BeginEffect("tilted_table", Level::kSensor, "the table is not level in the cameras' axes",
                  "the body at rest in several places of the table")
      .Number(kTableSlopeX, "table_slope_x", "1", "rise of the table along x", -0.1, 0.1)
      .Number(kTableSlopeY, "table_slope_y", "1", "rise of the table along y", -0.1, 0.1);
}

void AddCamera(const FreeBody& body, Builder& add) {
  const double way = 0.3 * body.size;
  add.BeginEffect("length_scale", Level::kSensor, "the recorded lengths are too large by a factor",
                  "two marks at a known distance")
      .Number(kLengthShare, "length_scale", "1", "recorded lengths beyond the true ones, as a share", -0.2,
              0.2);
  add.BeginEffect("clock_rate", Level::kSensor, "the cameras' clock runs slow",
                  "a clock in the cameras' view")
      .Number(kClockShare, "clock_rate", "1", "true time beyond the recorded one, as a share", -0.1, 0.1);
  add.BeginEffect("pose.low_pass", Level::kSensor, "the recorded pose was smoothed by a first-order low-pass",
                  "a hard impact, recorded before and after the filter")
      .Number(kPoseLowPass, "pose.low_pass", "s", "time constant of the smoothing", 0, 0.05);
  add.BeginEffect("turned_body_axes", Level::kSensor,
                  "the recorded axes of the body are not those of its edges",
                  "the body at rest on each of its faces")
      .Number(kFrameTurnX, "body_turn_x", "rad", "turn of the recorded axes about x of the body", -0.3, 0.3)
      .Number(kFrameTurnY, "body_turn_y", "rad", "turn of the recorded axes about y of the body", -0.3, 0.3)
      .Number(kFrameTurnZ, "body_turn_z", "rad", "turn of the recorded axes about z of the body", -0.3, 0.3);
  add.BeginEffect("body_point_offset", Level::kSensor, "the recorded point is not the middle of the body",
                  "the body at rest on each of its faces")
      .Number(kFramePointX, "body_point_x", "m", "recorded point from the middle, along x of the body", -way,
              way)
      .Number(kFramePointY, "body_point_y", "m", "recorded point from the middle, along y of the body", -way,
              way)
      .Number(kFramePointZ, "body_point_z", "m", "recorded point from the middle, along z of the body", -way,
              way);
}

}  // namespace

ParameterList ListFreeBodyParameters(const FreeBody& body, double speed) {
  ParameterList list;
  Builder add(list, kFreeBodySlots);
  AddBase(body, speed, add);
  AddContact(body, speed, add);
  AddBody(body, add);
  AddWorld(body, add);
  AddCamera(body, add);
  add.BeginPort("friction_coefficient", "1", "unknown friction coefficient");
  add.Term("slip_speed", "m/s", body.knots[0], -2, 2, "unknown friction coefficient", kSlipTerm);
  add.BeginPort("contact_force", "1", "unknown share of the normal force");
  add.Term("approach_speed", "m/s", body.knots[1], -5, 5, "unknown share of the normal force", kApproachTerm);
  return list;
}

}  // namespace sinew
