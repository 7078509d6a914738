#include "models/multibody/simbody_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "base/text.h"

namespace sinew {
namespace {

// A PiecewisePolynomial as Simbody wants its functions; with no argument it is the constant f(0).
class JointFunction final : public SimTK::Function {
 public:
  JointFunction(PiecewisePolynomial function, int arguments)
      : function_(std::move(function)), arguments_(arguments) {}

  SimTK::Real calcValue(const SimTK::Vector& x) const override { return function_.At(Argument(x)).value; }
  SimTK::Real calcDerivative(const SimTK::Array_<int>& components, const SimTK::Vector& x) const override {
    if (arguments_ == 0) return 0;
    const auto value = function_.At(Argument(x));
    return components.size() == 1 ? value.first : value.second;
  }
  int getArgumentSize() const override { return arguments_; }
  int getMaxDerivativeOrder() const override { return 2; }
  JointFunction* clone() const override { return new JointFunction(*this); }

 private:
  SimTK::Real Argument(const SimTK::Vector& x) const { return arguments_ == 0 ? 0 : x[0]; }

  PiecewisePolynomial function_;
  int arguments_;
};

// f(independent) - dependent, which a coupler holds at zero.
class CouplerFunction final : public SimTK::Function {
 public:
  explicit CouplerFunction(PiecewisePolynomial function) : function_(std::move(function)) {}

  SimTK::Real calcValue(const SimTK::Vector& x) const override { return function_.At(x[0]).value - x[1]; }
  SimTK::Real calcDerivative(const SimTK::Array_<int>& components, const SimTK::Vector& x) const override {
    const bool by_dependent = std::find(components.begin(), components.end(), 1) != components.end();
    if (by_dependent) return components.size() == 1 ? -1 : 0;
    const auto value = function_.At(x[0]);
    return components.size() == 1 ? value.first : value.second;
  }
  int getArgumentSize() const override { return 2; }
  int getMaxDerivativeOrder() const override { return 2; }
  CouplerFunction* clone() const override { return new CouplerFunction(*this); }

 private:
  PiecewisePolynomial function_;
};

SimTK::Transform ToTransform(const OsimFrame& frame) {
  SimTK::Mat33 rotation;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rotation(i, j) = frame.rotation(i, j);
  }
  return {SimTK::Rotation(rotation), ToSimbody(frame.location)};
}

// Where a joint without coordinates holds its child.
OsimFrame ConstantMotion(const OsimJoint& joint) {
  OsimFrame motion;
  for (std::size_t i = 0; i < 3; ++i) {
    const OsimAxis& turn = joint.axes[i];
    const OsimAxis& move = joint.axes[i + 3];
    motion.rotation *=
        Eigen::AngleAxisd(turn.function.At(0).value, turn.axis.normalized()).toRotationMatrix();
    motion.location += move.function.At(0).value * move.axis.normalized();
  }
  return motion;
}

// Inertia about the body's origin. Moments that no mass distribution has (one larger than the sum of the
// other two) are found in published models; like OpenSim we go on, with a sphere of the same trace, and say
// so.
SimTK::Body::Rigid ToRigidBody(const OsimBody& body, std::vector<std::string>& notes) {
  if (body.mass_kg == 0)
    return SimTK::Body::Rigid(SimTK::MassProperties(0, SimTK::Vec3(0), SimTK::Inertia(0)));
  const Mat3& m = body.inertia;
  SimTK::SymMat33 moments(m(0, 0), m(1, 0), m(1, 1), m(2, 0), m(2, 1), m(2, 2));
  if (!SimTK::Inertia::isValidInertiaMatrix(moments)) {
    notes.push_back(
        fmt::format("body '{}' has impossible moments of inertia {}, {}, {} kg m2; a sphere of the "
                    "same trace is used",
                    body.name, m(0, 0), m(1, 1), m(2, 2)));
    moments = SimTK::SymMat33(std::abs(m.trace()) / 3);
  }
  const SimTK::Vec3 center = ToSimbody(body.mass_center);
  const SimTK::Inertia about_center(moments);
  return SimTK::Body::Rigid(
      SimTK::MassProperties(body.mass_kg, center, about_center.shiftFromMassCenter(center, body.mass_kg)));
}

class Builder {
 public:
  explicit Builder(const OsimModel& model) : model_(model), built_(std::make_unique<SimbodyModel>()) {}

  Result<std::unique_ptr<SimbodyModel>> Build() {
    built_->name = model_.name;
    const SimTK::Force::Gravity gravity(built_->forces, built_->matter, ToSimbody(model_.gravity));
    NameBodies();
    SINEW_TRY(CheckJoints());
    NumberCoordinates();
    SINEW_TRY(AddJoints());
    SINEW_TRY(AddCouplers());
    SINEW_TRY(AddMarkers());
    return std::move(built_);
  }

 private:
  void NameBodies() {
    built_->body_names.emplace_back(kGround);
    for (const OsimBody& body : model_.bodies) {
      built_->body_names.push_back(body.name);
      built_->total_mass_kg += body.mass_kg;
    }
    built_->bodies.resize(built_->body_names.size());
    built_->bodies.front() = SimTK::GroundIndex;
    for (std::size_t i = 0; i < built_->body_names.size(); ++i) body_index_[built_->body_names[i]] = i;
    placed_[kGround] = true;
  }

  Status CheckJoints() {
    std::map<std::string, std::string> moved_by;
    for (const OsimJoint& joint : model_.joints) {
      for (const std::string& body : {joint.parent.body, joint.child.body}) {
        if (body_index_.count(body) == 0) {
          return Fail("joint '{}' names body '{}', which the model lacks{}", joint.name, body,
                      Suggestion(body, built_->body_names));
        }
      }
      if (joint.child.body == kGround)
        return Fail("joint '{}' moves ground, which is not supported; expected ground as the parent",
                    joint.name);
      const auto [other, is_new] = moved_by.emplace(joint.child.body, joint.name);
      if (!is_new) {
        return Fail("body '{}' is moved by joints '{}' and '{}'; expected one (loops are not supported)",
                    joint.child.body, other->second, joint.name);
      }
    }
    for (const OsimBody& body : model_.bodies) {
      if (moved_by.count(body.name) == 0) return Fail("body '{}' has no joint", body.name);
    }
    return {};
  }

  void NumberCoordinates() {
    for (const OsimJoint& joint : model_.joints) {
      for (const OsimCoordinate& coordinate : joint.coordinates) {
        coordinate_index_[coordinate.name] = static_cast<int>(built_->coordinates.size());
        built_->coordinates.push_back({coordinate, {}, {}, joint.parent.body == kGround});
      }
    }
  }

  // Simbody wants parents before children, the file has joints in any order.
  Status AddJoints() {
    std::vector<const OsimJoint*> waiting;
    for (const OsimJoint& joint : model_.joints) waiting.push_back(&joint);
    while (!waiting.empty()) {
      std::vector<const OsimJoint*> still_waiting;
      for (const OsimJoint* joint : waiting) {
        if (placed_[joint->parent.body]) {
          AddJoint(*joint);
        } else {
          still_waiting.push_back(joint);
        }
      }
      if (still_waiting.size() == waiting.size())
        return Fail("joint '{}' hangs in a loop that never reaches ground", waiting.front()->name);
      waiting = std::move(still_waiting);
    }
    return {};
  }

  void AddJoint(const OsimJoint& joint) {
    SimTK::MobilizedBody& parent =
        built_->matter.updMobilizedBody(built_->bodies[body_index_[joint.parent.body]]);
    const std::size_t child = body_index_[joint.child.body];
    const SimTK::Body::Rigid body = ToRigidBody(model_.bodies[child - 1], built_->notes);
    const SimTK::Transform in_parent = ToTransform(joint.parent);
    const SimTK::Transform in_child = ToTransform(joint.child);
    if (joint.coordinates.empty()) {
      const SimTK::MobilizedBody::Weld weld(parent, in_parent * ToTransform(ConstantMotion(joint)), body,
                                            in_child);
      built_->bodies[child] = weld.getMobilizedBodyIndex();
    } else {
      built_->bodies[child] = AddMobilizer(joint, parent, in_parent, body, in_child);
    }
    placed_[joint.child.body] = true;
  }

  SimTK::MobilizedBodyIndex AddMobilizer(const OsimJoint& joint, SimTK::MobilizedBody& parent,
                                         const SimTK::Transform& in_parent, const SimTK::Body& body,
                                         const SimTK::Transform& in_child) {
    std::map<std::string, int> local;
    for (const OsimCoordinate& coordinate : joint.coordinates) {
      const int q = static_cast<int>(local.size());
      local[coordinate.name] = q;
    }
    SimTK::Array_<const SimTK::Function*> functions;  // the mobilizer will own them
    SimTK::Array_<SimTK::Array_<int>> arguments;
    SimTK::Array_<SimTK::Vec3> axes;
    for (const OsimAxis& axis : joint.axes) {
      const bool moves = !axis.coordinate.empty();
      functions.push_back(new JointFunction(axis.function, moves ? 1 : 0));
      arguments.push_back(moves ? SimTK::Array_<int>(1, local[axis.coordinate]) : SimTK::Array_<int>());
      axes.push_back(ToSimbody(axis.axis));
    }
    SimTK::MobilizedBody::FunctionBased mobilizer(parent, in_parent, body, in_child,
                                                  static_cast<int>(joint.coordinates.size()), functions,
                                                  arguments, axes);
    for (const auto& [name, q] : local) {
      SimbodyModel::Coordinate& coordinate =
          built_->coordinates[static_cast<std::size_t>(coordinate_index_[name])];
      coordinate.body = mobilizer.getMobilizedBodyIndex();
      coordinate.q = SimTK::MobilizerQIndex(q);
    }
    return mobilizer.getMobilizedBodyIndex();
  }

  Status AddCouplers() {
    std::map<int, SimbodyModel::Coupler> by_dependent;
    for (const OsimCoupler& coupler : model_.couplers) {
      for (const std::string& name : {coupler.independent, coupler.dependent}) {
        if (coordinate_index_.count(name) == 0)
          return Fail("coupler '{}' names coordinate '{}', which the model lacks", coupler.name, name);
      }
      const int independent = coordinate_index_[coupler.independent];
      const int dependent = coordinate_index_[coupler.dependent];
      if (!by_dependent.emplace(dependent, SimbodyModel::Coupler{independent, dependent, coupler.function})
               .second)
        return Fail("coordinate '{}' depends on two couplers", coupler.dependent);
      AddCouplerConstraint(independent, dependent, coupler.function);
    }
    while (!by_dependent.empty()) {
      const auto ready = std::find_if(by_dependent.begin(), by_dependent.end(), [&](const auto& entry) {
        return by_dependent.count(entry.second.independent) == 0;
      });
      if (ready == by_dependent.end()) return Fail("the model's couplers depend on each other in a circle");
      built_->couplers.push_back(ready->second);
      by_dependent.erase(ready);
    }
    return {};
  }

  void AddCouplerConstraint(int independent, int dependent, const PiecewisePolynomial& function) {
    SimTK::Array_<SimTK::MobilizedBodyIndex> bodies;
    SimTK::Array_<SimTK::MobilizerQIndex> qs;
    for (const int index : {independent, dependent}) {
      bodies.push_back(built_->coordinates[static_cast<std::size_t>(index)].body);
      qs.push_back(built_->coordinates[static_cast<std::size_t>(index)].q);
    }
    const SimTK::Constraint::CoordinateCoupler coupler(built_->matter, new CouplerFunction(function), bodies,
                                                       qs);
  }

  Status AddMarkers() {
    for (const OsimMarker& marker : model_.markers) {
      const auto body = body_index_.find(marker.body);
      if (body == body_index_.end())
        return Fail("marker '{}' names body '{}', which the model lacks", marker.name, marker.body);
      built_->markers.push_back({marker.name, built_->bodies[body->second], ToSimbody(marker.location)});
    }
    return {};
  }

  const OsimModel& model_;
  std::unique_ptr<SimbodyModel> built_;
  std::map<std::string, std::size_t> body_index_;
  std::map<std::string, bool> placed_;
  std::map<std::string, int> coordinate_index_;
};

}  // namespace

Mat3 FromSimbody(const SimTK::Mat33& m) {
  Mat3 copy;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) copy(i, j) = m(i, j);
  }
  return copy;
}

Result<std::unique_ptr<SimbodyModel>> BuildSimbodyModel(const OsimModel& model) {
  try {
    return Builder(model).Build();
  } catch (const std::exception& problem) {
    return Fail("model '{}' cannot be built: {}", model.name, OneLine(problem.what()));
  }
}

}  // namespace sinew
