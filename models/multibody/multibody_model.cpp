#include "models/multibody/multibody_model.h"

#include <algorithm>

#include "base/text.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/kinematic_state.h"
#include "models/multibody/simbody_model.h"

namespace sinew {

struct MultibodyModel::Impl {
  std::unique_ptr<SimbodyModel> simbody;
  std::vector<std::string> coordinate_names;
  std::vector<std::string> marker_names;
  Vector default_values;
};

namespace {

Result<int> IndexOf(std::string_view name, const std::vector<std::string>& names, const char* kind) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    return Fail("the model has no {} '{}'{}", kind, name, Suggestion(std::string(name), names));
  return static_cast<int>(found - names.begin());
}

}  // namespace

MultibodyModel::MultibodyModel(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MultibodyModel::MultibodyModel(MultibodyModel&&) noexcept = default;
MultibodyModel& MultibodyModel::operator=(MultibodyModel&&) noexcept = default;
MultibodyModel::~MultibodyModel() = default;

Result<MultibodyModel> MultibodyModel::Build(const OsimModel& model) {
  auto impl = std::make_unique<Impl>();
  SINEW_ASSIGN(impl->simbody, BuildSimbodyModel(model));
  const SimbodyModel& built = *impl->simbody;
  for (const SimbodyModel::Marker& marker : built.markers) impl->marker_names.push_back(marker.name);
  impl->default_values.resize(static_cast<Eigen::Index>(built.coordinates.size()));
  for (const SimbodyModel::Coordinate& coordinate : built.coordinates) {
    impl->default_values[static_cast<Eigen::Index>(impl->coordinate_names.size())] =
        coordinate.description.default_value;
    impl->coordinate_names.push_back(coordinate.description.name);
  }
  ApplyCouplers(built, impl->default_values);
  try {
    impl->simbody->system.realizeTopology();
  } catch (const std::exception& problem) {
    return Fail("model '{}' cannot be built: {}", model.name, OneLine(problem.what()));
  }
  return MultibodyModel(std::move(impl));
}

const std::string& MultibodyModel::name() const {
  return impl_->simbody->name;
}
const std::vector<std::string>& MultibodyModel::coordinate_names() const {
  return impl_->coordinate_names;
}
const std::vector<std::string>& MultibodyModel::body_names() const {
  return impl_->simbody->body_names;
}
const std::vector<std::string>& MultibodyModel::marker_names() const {
  return impl_->marker_names;
}
double MultibodyModel::total_mass_kg() const {
  return impl_->simbody->total_mass_kg;
}
const std::vector<std::string>& MultibodyModel::notes() const {
  return impl_->simbody->notes;
}
const Vector& MultibodyModel::default_values() const {
  return impl_->default_values;
}
const SimbodyModel& MultibodyModel::simbody() const {
  return *impl_->simbody;
}

Result<int> MultibodyModel::BodyIndex(std::string_view name) const {
  return IndexOf(name, body_names(), "body");
}

Result<int> MultibodyModel::CoordinateIndex(std::string_view name) const {
  return IndexOf(name, coordinate_names(), "coordinate");
}

const OsimCoordinate& MultibodyModel::coordinate(int index) const {
  return impl_->simbody->coordinates.at(static_cast<std::size_t>(index)).description;
}

bool MultibodyModel::IsRotational(std::string_view name) const {
  const auto index = CoordinateIndex(name);
  return index && coordinate(*index).motion == MotionType::kRotational;
}

bool MultibodyModel::IsAngle(std::string_view name) const {
  const auto index = CoordinateIndex(name);
  return index && coordinate(*index).is_angle;
}

bool MultibodyModel::IsGroundCoordinate(int index) const {
  return impl_->simbody->coordinates.at(static_cast<std::size_t>(index)).on_ground;
}

bool MultibodyModel::IsDependent(int index) const {
  const auto& couplers = impl_->simbody->couplers;
  return std::any_of(couplers.begin(), couplers.end(),
                     [&](const SimbodyModel::Coupler& coupler) { return coupler.dependent == index; });
}

Result<std::vector<BodyMotion>> MultibodyModel::BodyMotionAt(const Vector& values, const Vector& rates,
                                                             const std::vector<int>& bodies,
                                                             const Vector& accelerations) const {
  const std::size_t n = coordinate_names().size();
  SINEW_TRY(CheckCoordinateVector(values, n, "values"));
  SINEW_TRY(CheckCoordinateVector(rates, n, "rates"));
  if (accelerations.size() > 0) SINEW_TRY(CheckCoordinateVector(accelerations, n, "accelerations"));
  KinematicState state(*impl_->simbody);
  const Vector none = Vector::Zero(values.size());
  return state.Motions({values, rates, accelerations.size() > 0 ? accelerations : none}, bodies);
}

Result<std::vector<std::vector<BodyMotion>>> MultibodyModel::BodyMotions(
    const std::vector<double>& times, const CoordinateTrajectory& trajectory,
    const std::vector<int>& bodies) const {
  KinematicState state(*impl_->simbody);
  std::vector<std::vector<BodyMotion>> motions;
  motions.reserve(times.size());
  for (const double time : times) {
    const CoordinateState coordinates = trajectory.At(time);
    SINEW_TRY(CheckCoordinateVector(coordinates.values, coordinate_names().size(), "values"));
    SINEW_ASSIGN(std::vector<BodyMotion> at_time, state.Motions(coordinates, bodies));
    motions.push_back(std::move(at_time));
  }
  return motions;
}

Result<std::vector<Vec3>> MultibodyModel::MarkerPositions(const Vector& values) const {
  SINEW_TRY(CheckCoordinateVector(values, coordinate_names().size(), "values"));
  KinematicState state(*impl_->simbody);
  return state.MarkerPositions(values);
}

}  // namespace sinew
