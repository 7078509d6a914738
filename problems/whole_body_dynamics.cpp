#include "problems/whole_body_dynamics.h"

#include <algorithm>
#include <cmath>

#include "models/dynamometer/smooth_angle.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/whole_body_load.h"
#include "problems/contact/motion/loaded_span.h"
#include "problems/contact/motion/trial_motion.h"

namespace sinew {
namespace {

constexpr double kLittleMass = 0.05;  // share of the body's that a missing coordinate may move

Channel NewChannel(const char* unit) {
  Channel channel;
  channel.unit = unit;
  return channel;
}

// A motion in other units than rad and m falls, or flies, by its own account.
Status CheckUnits(const std::vector<WholeBodyLoad>& loads, double weight) {
  constexpr double kFarthest = 100;  // [m] from the origin of ground
  constexpr double kMostShare = 0.5;
  double sum = 0;
  for (const WholeBodyLoad& load : loads) {
    if (load.mass_centre.norm() > kFarthest)
      return Fail("the mass centre is {:.4g} m from the origin: are its coordinates in mm?",
                  load.mass_centre.norm());
    sum += load.force.y();
  }
  const double share = sum / static_cast<double>(loads.size()) / weight;
  if (std::abs(share - 1) > kMostShare)
    return Fail(
        "the ground would carry {:.3g} times the body's weight on average: is the motion in rad and m, and "
        "up along y?",
        share);
  return {};
}

Grid ToGrid(const std::vector<double>& time, const std::vector<WholeBodyLoad>& loads) {
  Grid grid;
  grid.time = time;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string end = std::string("_") + "xyz"[axis];
    Channel force = NewChannel("N");
    Channel moment = NewChannel("N*m");
    Channel centre = NewChannel("m");
    for (const WholeBodyLoad& load : loads) {
      force.values.push_back(load.force[axis]);
      moment.values.push_back(load.moment[axis]);
      centre.values.push_back(load.mass_centre[axis]);
    }
    grid.channels[kWholeBodyForce + end] = std::move(force);
    grid.channels[kWholeBodyMoment + end] = std::move(moment);
    grid.channels[kMassCentre + end] = std::move(centre);
  }
  return grid;
}

Result<WholeBodyDynamics> AddTo(Trial& trial, const MultibodyModel& model, const Vec3& gravity,
                                double cutoff) {
  SINEW_ASSIGN(const TrialMotion recorded, FitTrialMotion(trial, model));
  WholeBodyDynamics done;
  for (const std::string& name : recorded.trajectory.held()) {
    SINEW_ASSIGN(const int index, model.CoordinateIndex(name));
    if (model.coordinate(index).locked) continue;
    SINEW_ASSIGN(const double share, MassMovedBy(model, name));
    if (share > kLittleMass)
      return Fail("no data for coordinate '{}', which moves {:.0f} % of the body's mass", name, 100 * share);
    done.held.push_back(name);
  }
  SINEW_ASSIGN(const double rate, FrameRate(recorded));

  std::vector<std::string> names;
  for (const std::string& name : model.coordinate_names()) {
    const auto& held = recorded.trajectory.held();
    if (std::find(held.begin(), held.end(), name) == held.end()) names.push_back(name);
  }
  const auto frames = static_cast<Eigen::Index>(recorded.time.size());
  Matrix values(frames, static_cast<Eigen::Index>(names.size()));
  std::vector<int> column;
  for (const std::string& name : names) {
    SINEW_ASSIGN(const int index, model.CoordinateIndex(name));
    column.push_back(index);
  }
  for (Eigen::Index t = 0; t < frames; ++t) {
    const CoordinateState at = recorded.trajectory.At(recorded.time[static_cast<std::size_t>(t)]);
    for (std::size_t c = 0; c < column.size(); ++c)
      values(t, static_cast<Eigen::Index>(c)) = at.values[column[c]];
  }
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    const Vector samples = values.col(c);
    auto smooth = SmoothedAngle({samples.begin(), samples.end()}, rate, cutoff);
    if (!smooth)
      return Fail("coordinate '{}': {}", names[static_cast<std::size_t>(c)], smooth.error().message);
    for (Eigen::Index t = 0; t < frames; ++t) values(t, c) = smooth->values[static_cast<std::size_t>(t)];
  }

  SINEW_ASSIGN(const auto motion, CoordinateTrajectory::Fit(model, recorded.time, names, values));
  SINEW_ASSIGN(const auto loads, WholeBodyLoads(model, gravity, recorded.time, motion));
  const double weight = model.total_mass_kg() * gravity.norm();
  SINEW_TRY(CheckUnits(loads, weight));
  done.frames = loads.size();
  done.mass = model.total_mass_kg();
  for (const WholeBodyLoad& load : loads)
    done.weight_share += load.force.y() / weight / static_cast<double>(loads.size());
  trial.grids[kDynamicsGrid] = ToGrid(recorded.time, loads);
  return done;
}

bool HoldsCoordinates(const Trial& trial, const MultibodyModel& model) {
  return std::any_of(trial.grids.begin(), trial.grids.end(), [&](const auto& grid) {
    return std::any_of(model.coordinate_names().begin(), model.coordinate_names().end(),
                       [&](const std::string& name) { return grid.second.channels.count(name) > 0; });
  });
}

}  // namespace

Result<std::vector<WholeBodyDynamics>> AddWholeBodyDynamics(const OsimModel& osim, double cutoff,
                                                            Dataset& data) {
  SINEW_ASSIGN(const MultibodyModel model, MultibodyModel::Build(osim));
  if (!(model.total_mass_kg() > 0))
    return Fail("the bodies of model '{}' have no mass: what the ground must carry is not known",
                model.name());
  std::vector<WholeBodyDynamics> all;
  for (auto& [name, trial] : data.trials) {
    if (!HoldsCoordinates(trial, model)) continue;
    if (WindowOf(trial) && trial.grids.count(kDynamicsGrid) > 0) {
      WholeBodyDynamics before;
      before.trial = name;
      before.kept = true;
      all.push_back(std::move(before));
      continue;
    }
    auto done = AddTo(trial, model, osim.gravity, cutoff);
    if (!done) return Fail("trial '{}': {}", name, done.error().message);
    done->trial = name;
    all.push_back(std::move(*done));
  }
  return all;
}

}  // namespace sinew
