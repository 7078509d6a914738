#include "problems/free_body/free_body_effects.h"

#include <cmath>
#include <string>
#include <utility>

#include "base/text.h"

namespace sinew {
namespace {

constexpr double kFirstDepth = 0.1;      // of the body's size
constexpr double kStiffnessRange = 300;  // both ways
constexpr const char* kHunt = "Hunt, Crossley 1975";
constexpr const char* kHollars = "Hollars; Sherman et al. 2011";

class Builder {
 public:
  explicit Builder(FreeBodyParameterList& list) : list_(list) { list_.index.fill(-1); }

  void Base(FreeBodySlot slot, Parameter p, const char* source, Scale scale = Scale::kLinear) {
    p.source = source;
    p.scale = scale;
    Add(slot, std::move(p));
  }

  Builder& Name(const std::string& name, Level level, const std::string& description,
                const std::string& revealing_experiment) {
    list_.effects.push_back({name, level, description, revealing_experiment, {}});
    return *this;
  }
  Builder& Number(FreeBodySlot slot, const std::string& name, const char* unit, const char* meaning,
                  double lower, double upper, const char* source = "") {
    Effect& effect = list_.effects.back();
    Parameter p = EffectParameter(name, unit, meaning, lower, upper, 0, effect.name);
    p.source = source;
    effect.parameters.push_back(Add(slot, std::move(p)));
    return *this;
  }

  void Term(const std::string& port, const std::string& unit, const std::string& meaning,
            const std::string& signal, int first, const std::vector<double>& knots, double reach) {
    DiscrepancyPort made{port, unit, meaning, {}};
    DiscrepancyTerm term{port + "(" + signal + ")", signal, "m/s", knots, {}};
    for (int k = 0; k < kFreeBodyKnots; ++k) {
      Parameter p = EffectParameter(fmt::format("{}[{}]", term.name, k), unit,
                                    fmt::format("{} where {} is knot {}", meaning, signal, k), -reach, reach,
                                    0, term.name);
      term.parameters.push_back(Add(static_cast<FreeBodySlot>(first + k), std::move(p)));
    }
    made.terms.push_back(std::move(term));
    list_.ports.push_back(std::move(made));
  }

 private:
  int Add(FreeBodySlot slot, Parameter p) {
    list_.index[slot] = static_cast<int>(list_.parameters.size());
    list_.parameters.push_back(std::move(p));
    return list_.index[slot];
  }
  FreeBodyParameterList& list_;
};

void AddBase(const FreeBody& body, double speed, Builder& add) {
  // Where half of the kinetic energy is stored in the spring under one corner. An elastic foundation that a
  // corner enters by x is pressed over a pyramid: the force grows with x^3.
  const double depth = kFirstDepth * body.size;
  const double energy = 0.25 * body.mass * speed * speed;
  const bool vertices = body.contact == FreeBodyContact::kVertices;
  const double stiffness = vertices ? 2.5 * energy / std::pow(depth, 2.5) : 4.6 * energy / std::pow(depth, 4);
  add.Base(kStiffness,
           BaseParameter("stiffness", vertices ? "N/m^1.5" : "N/m3",
                         vertices ? "force of a corner per depth^1.5" : "pressure per depth",
                         stiffness / kStiffnessRange, stiffness * kStiffnessRange, stiffness),
           vertices ? kHunt : "thesis eq 5.1", Scale::kLog);
  add.Base(kDissipation,
           BaseParameter("dissipation", "s/m", "share of the force per speed of approach", 0.01, 20, 1),
           kHunt, Scale::kLog);
  add.Base(kFriction, BaseParameter("friction", "1", "friction force per normal force", 0, 2, 0.3), kHollars);
}

void AddContact(const FreeBody& body, double speed, Builder& add) {
  add.Name("static_friction", Level::kBoundary, "friction is larger before it slips",
           "slow pulls from rest, or slow rotation about an edge")
      .Number(kStaticExcess, "static_friction_excess", "1", "friction coefficient beyond that of slip", 0, 2,
              kHollars);
  add.Name("viscous_slip", Level::kBoundary, "friction grows with the speed of slip",
           "fast slides at several speeds")
      .Number(kViscousSlip, "viscous_slip", "s/m", "friction coefficient per speed of slip", 0, 5 / speed,
              kHollars);
  add.Name("rebound_loss", Level::kBoundary,
           "contact loses a fixed share of its force on the way out, whatever the speed of impact",
           "drops from several heights: the share of the speed that comes back stays the same")
      .Number(kReboundLoss, "rebound_loss", "1", "share of the force that is lost on the way out", 0, 0.99,
              "Walton, Braun 1986");
  add.Name("contact_exponent", Level::kBoundary, "the force does not grow with the stated power of the depth",
           "pressing the body on the table slowly, force against depth")
      .Number(kExponent, "contact_exponent", "1", "power of the depth beyond that of the model, 1 mm fixed",
              -0.9, 2);
  if (body.contact == FreeBodyContact::kVertices) {
    add.Name("rounded_corners", Level::kRobot, "the corners are balls, not points",
             "a photograph of a corner")
        .Number(kCornerRadius, "corner_radius", "m", "radius of the corners", 0, 0.5 * body.size);
  }
}

void AddBody(const FreeBody& body, Builder& add) {
  const double way = 0.3 * body.size;
  add.Name("size_error", Level::kRobot, "the body is not as large as stated", "a calliper")
      .Number(kSizeError, "size_error", "1", "edges beyond the stated ones, as a share", -0.2, 0.2);
  add.Name("inertia_error", Level::kRobot, "the moments of inertia are not what was stated",
           "swinging the body on two threads")
      .Number(kInertiaShare, "inertia_error", "1", "moments of inertia beyond the stated ones, as a share",
              -0.7, 1.5);
  add.Name("mass_centre_offset", Level::kRobot, "the mass centre is not in the middle of the body",
           "balancing the body on an edge")
      .Number(kMassCentreX, "mass_centre_x", "m", "mass centre from the middle, along x of the body", -way,
              way)
      .Number(kMassCentreY, "mass_centre_y", "m", "mass centre from the middle, along y of the body", -way,
              way)
      .Number(kMassCentreZ, "mass_centre_z", "m", "mass centre from the middle, along z of the body", -way,
              way);
  add.Name("air_drag", Level::kBoundary, "the air holds the body back", "drops from a great height")
      .Number(kAirDrag, "air_drag", "1/m", "deceleration per squared speed", 0, 2);
}

void AddWorld(const FreeBody& body, Builder& add) {
  add.Name("gravity_error", Level::kBoundary, "gravity is not what was stated",
           "a drop whose height is known by other means")
      .Number(kGravityShare, "gravity_error", "1", "gravity beyond the stated one, as a share", -0.3, 0.3);
  add.Name("tilted_axes", Level::kSensor, "the cameras' z axis is not vertical",
           "a plumb line in the cameras' view")
      .Number(kGravityTiltX, "gravity_x", "1", "share of gravity along x", -0.2, 0.2)
      .Number(kGravityTiltY, "gravity_y", "1", "share of gravity along y", -0.2, 0.2);
  add.Name("table_height", Level::kSensor, "the table is not at z = 0",
           "the body at rest, measured by other means")
      .Number(kTableHeight, "table_height", "m", "of the table at x = y = 0", -0.3 * body.size,
              0.3 * body.size);
  add.Name("tilted_table", Level::kSensor, "the table is not level in the cameras' axes",
           "the body at rest in several places of the table")
      .Number(kTableSlopeX, "table_slope_x", "1", "rise of the table along x", -0.1, 0.1)
      .Number(kTableSlopeY, "table_slope_y", "1", "rise of the table along y", -0.1, 0.1);
}

void AddCamera(const FreeBody& body, Builder& add) {
  const double way = 0.3 * body.size;
  add.Name("length_scale", Level::kSensor, "the recorded lengths are too large by a factor",
           "two marks at a known distance")
      .Number(kLengthShare, "length_scale", "1", "recorded lengths beyond the true ones, as a share", -0.2,
              0.2);
  add.Name("clock_rate", Level::kSensor, "the cameras' clock runs slow", "a clock in the cameras' view")
      .Number(kClockShare, "clock_rate", "1", "true time beyond the recorded one, as a share", -0.1, 0.1);
  add.Name("pose.low_pass", Level::kSensor, "the recorded pose was smoothed by a first-order low-pass",
           "a hard impact, recorded before and after the filter")
      .Number(kPoseLowPass, "pose.low_pass", "s", "time constant of the smoothing", 0, 0.05);
  add.Name("turned_body_axes", Level::kSensor, "the recorded axes of the body are not those of its edges",
           "the body at rest on each of its faces")
      .Number(kFrameTurnX, "body_turn_x", "rad", "turn of the recorded axes about x of the body", -0.3, 0.3)
      .Number(kFrameTurnY, "body_turn_y", "rad", "turn of the recorded axes about y of the body", -0.3, 0.3)
      .Number(kFrameTurnZ, "body_turn_z", "rad", "turn of the recorded axes about z of the body", -0.3, 0.3);
  add.Name("body_point_offset", Level::kSensor, "the recorded point is not the middle of the body",
           "the body at rest on each of its faces")
      .Number(kFramePointX, "body_point_x", "m", "recorded point from the middle, along x of the body", -way,
              way)
      .Number(kFramePointY, "body_point_y", "m", "recorded point from the middle, along y of the body", -way,
              way)
      .Number(kFramePointZ, "body_point_z", "m", "recorded point from the middle, along z of the body", -way,
              way);
}

}  // namespace

FreeBodyParameterList ListFreeBodyParameters(const FreeBody& body, double speed) {
  FreeBodyParameterList list;
  Builder add(list);
  AddBase(body, speed, add);
  AddContact(body, speed, add);
  AddBody(body, add);
  AddWorld(body, add);
  AddCamera(body, add);
  add.Term("friction_coefficient", "1", "unknown friction coefficient", "slip_speed", kSlipTerm,
           body.knots[0], 2);
  add.Term("contact_force", "1", "unknown share of the normal force", "approach_speed", kApproachTerm,
           body.knots[1], 5);
  return list;
}

}  // namespace sinew
