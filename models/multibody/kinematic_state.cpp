#include "models/multibody/kinematic_state.h"

#include "base/text.h"

namespace sinew {

Status CheckCoordinateVector(const Vector& vector, std::size_t size, const char* what) {
  if (static_cast<std::size_t>(vector.size()) != size)
    return Fail("{} coordinate {}, expected {}", vector.size(), what, size);
  if (!vector.allFinite()) return Fail("coordinate {} are not finite", what);
  return {};
}

void ApplyCouplers(const SimbodyModel& model, Vector& values) {
  for (const SimbodyModel::Coupler& coupler : model.couplers)
    values[coupler.dependent] = coupler.function.At(values[coupler.independent]).value;
}

void ApplyCouplers(const SimbodyModel& model, CoordinateState& coordinates) {
  for (const SimbodyModel::Coupler& coupler : model.couplers) {
    const auto f = coupler.function.At(coordinates.values[coupler.independent]);
    const double rate = coordinates.rates[coupler.independent];
    coordinates.values[coupler.dependent] = f.value;
    coordinates.rates[coupler.dependent] = f.first * rate;
    coordinates.accelerations[coupler.dependent] =
        f.second * rate * rate + f.first * coordinates.accelerations[coupler.independent];
  }
}

KinematicState::KinematicState(const SimbodyModel& model)
    : model_(model), state_(model.system.getDefaultState()) {
  model_.system.realize(state_, SimTK::Stage::Model);
  for (const SimbodyModel::Coordinate& coordinate : model_.coordinates) {
    const SimTK::QIndex first = model_.matter.getMobilizedBody(coordinate.body).getFirstQIndex(state_);
    q_index_.emplace_back(first + coordinate.q);
  }
  coordinates_of_body_.resize(static_cast<std::size_t>(model_.matter.getNumBodies()));
  for (std::size_t i = 0; i < model_.coordinates.size(); ++i)
    coordinates_of_body_[model_.coordinates[i].body].push_back(static_cast<int>(i));
}

void KinematicState::SetValues(const Vector& values) {
  SimTK::Vector& q = state_.updQ();
  for (std::size_t i = 0; i < q_index_.size(); ++i) q[q_index_[i]] = values[static_cast<Eigen::Index>(i)];
  model_.system.realize(state_, SimTK::Stage::Position);
}

Status KinematicState::Place(const Vector& values) {
  try {
    SetValues(values);
  } catch (const std::exception& problem) {
    return Fail("kinematics of model '{}' failed: {}", model_.name, OneLine(problem.what()));
  }
  return {};
}

std::vector<BodyMotion> KinematicState::Poses(const std::vector<int>& bodies) const {
  std::vector<BodyMotion> motions(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const SimTK::MobilizedBody& body =
        model_.matter.getMobilizedBody(model_.bodies[static_cast<std::size_t>(bodies[i])]);
    motions[i].position = FromSimbody(body.getBodyOriginLocation(state_));
    motions[i].rotation = FromSimbody(body.getBodyRotation(state_).asMat33());
  }
  return motions;
}

void KinematicState::SetVelocities(const Vector& rates, const std::vector<int>& bodies,
                                   std::vector<BodyMotion>& motions) const {
  SimTK::Vector u(state_.getNU(), 0.0);
  for (std::size_t i = 0; i < q_index_.size(); ++i) u[q_index_[i]] = rates[static_cast<Eigen::Index>(i)];
  SimTK::Vector_<SimTK::SpatialVec> velocities;
  model_.matter.multiplyBySystemJacobian(state_, u, velocities);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const SimTK::SpatialVec& velocity = velocities[model_.bodies[static_cast<std::size_t>(bodies[i])]];
    motions[i].angular_velocity = FromSimbody(velocity[0]);
    motions[i].velocity = FromSimbody(velocity[1]);
  }
}

Vec3 KinematicState::MarkerPosition(std::size_t marker) const {
  const SimbodyModel::Marker& m = model_.markers[marker];
  return FromSimbody(model_.matter.getMobilizedBody(m.body).findStationLocationInGround(state_, m.location));
}

// A joint's speed moves what hangs on it as a rigid body, by Simbody's H at the origin of the joint's body.
Matrix KinematicState::MarkerJacobian(const std::vector<std::size_t>& markers) const {
  Matrix jacobian =
      Matrix::Zero(static_cast<Eigen::Index>(3 * markers.size()), static_cast<Eigen::Index>(q_index_.size()));
  Eigen::Index row = 0;
  for (const std::size_t marker : markers) {
    const SimbodyModel::Marker& m = model_.markers[marker];
    // By reference: copies of Simbody's handles count their uses, which threads must not do at once.
    const SimTK::MobilizedBody* body = &model_.matter.getMobilizedBody(m.body);
    const SimTK::Vec3 position = body->findStationLocationInGround(state_, m.location);
    for (; !body->isGround(); body = &body->getParentMobilizedBody()) {
      const SimTK::Vec3 arm = position - body->getBodyOriginLocation(state_);
      for (const int column : coordinates_of_body_[body->getMobilizedBodyIndex()]) {
        const SimTK::MobilizerQIndex q = model_.coordinates[static_cast<std::size_t>(column)].q;
        const SimTK::SpatialVec by_speed = body->getHCol(state_, SimTK::MobilizerUIndex(q));
        jacobian.block<3, 1>(row, column) = FromSimbody(by_speed[1] + by_speed[0] % arm);
      }
    }
    row += 3;
  }
  return jacobian;
}

Result<std::vector<BodyMotion>> KinematicState::Motions(CoordinateState coordinates,
                                                        const std::vector<int>& bodies) {
  for (const int body : bodies) {
    if (body < 0 || body >= static_cast<int>(model_.bodies.size()))
      return Fail("body index {}, expected 0..{}", body, model_.bodies.size() - 1);
  }
  ApplyCouplers(model_, coordinates);
  try {
    SetValues(coordinates.values);
    SimTK::Vector& u = state_.updU();
    SimTK::Vector udot(state_.getNU());
    for (std::size_t i = 0; i < q_index_.size(); ++i) {
      u[q_index_[i]] = coordinates.rates[static_cast<Eigen::Index>(i)];
      udot[q_index_[i]] = coordinates.accelerations[static_cast<Eigen::Index>(i)];
    }
    model_.system.realize(state_, SimTK::Stage::Velocity);
    SimTK::Vector_<SimTK::SpatialVec> accelerations;
    model_.matter.calcBodyAccelerationFromUDot(state_, udot, accelerations);

    std::vector<BodyMotion> motions;
    motions.reserve(bodies.size());
    for (const int body : bodies) {
      const SimTK::MobilizedBodyIndex index = model_.bodies[static_cast<std::size_t>(body)];
      const SimTK::MobilizedBody& mobilized = model_.matter.getMobilizedBody(index);
      const SimTK::SpatialVec& velocity = mobilized.getBodyVelocity(state_);
      motions.push_back({FromSimbody(mobilized.getBodyOriginLocation(state_)),
                         FromSimbody(mobilized.getBodyRotation(state_).asMat33()), FromSimbody(velocity[1]),
                         FromSimbody(velocity[0]), FromSimbody(accelerations[index][1]),
                         FromSimbody(accelerations[index][0])});
    }
    return motions;
  } catch (const std::exception& problem) {
    return Fail("kinematics of model '{}' failed: {}", model_.name, OneLine(problem.what()));
  }
}

Result<std::vector<Vec3>> KinematicState::MarkerPositions(Vector values) {
  ApplyCouplers(model_, values);
  try {
    SetValues(values);
    std::vector<Vec3> positions;
    for (std::size_t i = 0; i < model_.markers.size(); ++i) positions.push_back(MarkerPosition(i));
    return positions;
  } catch (const std::exception& problem) {
    return Fail("kinematics of model '{}' failed: {}", model_.name, OneLine(problem.what()));
  }
}

}  // namespace sinew
