#include "models/multibody/muscle_geometry.h"

#include <Eigen/Geometry>
#include <map>
#include <numeric>

#include "models/multibody/kinematic_state.h"
#include "models/multibody/path_tracing.h"

namespace sinew {
namespace {

// dl of a path for the motion that the bodies and, by `values` and `rates`, the moving points have.
double LengtheningOf(const TracedMuscle& muscle, const std::vector<PathCorner>& corners,
                     const std::vector<BodyMotion>& bodies, const Vector& values, const Vector& rates) {
  const auto velocity = [&](const PathCorner& corner) -> Vec3 {
    const BodyMotion& body = bodies[static_cast<std::size_t>(corner.body)];
    Vec3 total = body.velocity + body.angular_velocity.cross(corner.place - body.position);
    if (corner.point < 0) return total;
    const int moving = muscle.points[static_cast<std::size_t>(corner.point)].moving;
    if (moving >= 0)
      total += body.rotation * VelocityOf(muscle.moving[static_cast<std::size_t>(moving)], values, rates);
    return total;
  };
  double sum = 0;
  Vec3 before = velocity(corners.front());
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vec3 here = velocity(corners[i]);
    const Vec3 piece = corners[i].place - corners[i - 1].place;
    const double length = piece.norm();
    if (!corners[i].after_arc && length > 0) sum += piece.dot(here - before) / length;
    before = here;
  }
  return sum;
}

// One evaluation after the other in one state.
class Evaluation {
 public:
  Evaluation(const MultibodyModel& model, const std::vector<TracedMuscle>& muscles)
      : model_(model), muscles_(muscles), state_(model.simbody()), bodies_(model.body_names().size()) {
    std::iota(bodies_.begin(), bodies_.end(), 0);
  }

  Result<MuscleGeometryState> At(CoordinateState coordinates, const std::vector<int>& wanted) {
    ApplyCouplers(model_.simbody(), coordinates);
    SINEW_TRY(state_.Place(coordinates.values));
    std::vector<BodyMotion> motions = state_.Poses(bodies_);
    std::vector<std::vector<PathCorner>> paths;
    MuscleGeometryState out;
    const auto count = static_cast<Eigen::Index>(muscles_.size());
    out.lengths.resize(count);
    out.velocities.resize(count);
    out.moment_arms.resize(count, static_cast<Eigen::Index>(wanted.size()));
    for (Eigen::Index m = 0; m < count; ++m) {
      SINEW_ASSIGN(TracedPath path,
                   TracePath(muscles_[static_cast<std::size_t>(m)], coordinates.values, motions));
      out.lengths[m] = LengthOf(path.corners);
      if (!path.settled) out.unsettled.push_back(static_cast<int>(m));
      paths.push_back(std::move(path.corners));
    }
    const auto lengthening = [&](const Vector& rates) {
      state_.SetVelocities(rates, bodies_, motions);
      Vector all(count);
      for (Eigen::Index m = 0; m < count; ++m) {
        const auto i = static_cast<std::size_t>(m);
        all[m] = LengtheningOf(muscles_[i], paths[i], motions, coordinates.values, rates);
      }
      return all;
    };
    out.velocities = lengthening(coordinates.rates);
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      coordinates.rates.setZero();
      coordinates.rates[wanted[c]] = 1;
      ApplyCouplers(model_.simbody(), coordinates);
      out.moment_arms.col(static_cast<Eigen::Index>(c)) = -lengthening(coordinates.rates);
    }
    return out;
  }

 private:
  const MultibodyModel& model_;
  const std::vector<TracedMuscle>& muscles_;
  KinematicState state_;
  std::vector<int> bodies_;
};

Status CheckCoordinates(const MultibodyModel& model, const std::vector<int>& coordinates) {
  const auto count = static_cast<int>(model.coordinate_names().size());
  for (const int c : coordinates) {
    if (c < 0 || c >= count) return Fail("coordinate index {}, expected 0..{}", c, count - 1);
    if (model.IsDependent(c)) {
      return Fail("coordinate '{}' follows from another one through a coupler; expected an independent one",
                  model.coordinate(c).name);
    }
  }
  return {};
}

}  // namespace

MuscleGeometry::MuscleGeometry(const MultibodyModel& model, std::vector<TracedMuscle> muscles)
    : model_(&model), muscles_(std::move(muscles)) {
  for (const TracedMuscle& muscle : muscles_) names_.push_back(muscle.name);
}
MuscleGeometry::MuscleGeometry(MuscleGeometry&&) noexcept = default;
MuscleGeometry& MuscleGeometry::operator=(MuscleGeometry&&) noexcept = default;
MuscleGeometry::~MuscleGeometry() = default;

Result<MuscleGeometry> MuscleGeometry::Build(const MultibodyModel& model,
                                             const std::vector<OsimMusclePath>& muscles) {
  std::map<std::string, int> object_numbers;
  std::vector<TracedMuscle> traced;
  for (const OsimMusclePath& path : muscles) {
    auto muscle = NumberPath(model, path, object_numbers);
    if (!muscle) return Fail("muscle '{}': {}", path.name, muscle.error().message);
    traced.push_back(std::move(*muscle));
  }
  return MuscleGeometry(model, std::move(traced));
}

Result<MuscleGeometryState> MuscleGeometry::At(const Vector& values, const Vector& rates,
                                               const std::vector<int>& coordinates) const {
  const std::size_t count = model_->coordinate_names().size();
  SINEW_TRY(CheckCoordinateVector(values, count, "values"));
  SINEW_TRY(CheckCoordinateVector(rates, count, "rates"));
  SINEW_TRY(CheckCoordinates(*model_, coordinates));
  return Evaluation(*model_, muscles_).At({values, rates, Vector::Zero(values.size())}, coordinates);
}

Result<MuscleGeometrySeries> MuscleGeometry::Along(const std::vector<double>& times,
                                                   const CoordinateTrajectory& trajectory,
                                                   const std::vector<int>& coordinates) const {
  SINEW_TRY(CheckCoordinates(*model_, coordinates));
  const auto rows = static_cast<Eigen::Index>(times.size());
  const auto columns = static_cast<Eigen::Index>(names_.size());
  MuscleGeometrySeries series{Matrix(rows, columns), Matrix(rows, columns),
                              std::vector<Matrix>(coordinates.size(), Matrix(rows, columns)),
                              std::vector<int>(names_.size(), 0)};
  Evaluation evaluation(*model_, muscles_);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double time = times[static_cast<std::size_t>(row)];
    auto state = evaluation.At(trajectory.At(time), coordinates);
    if (!state) return Fail("at t = {} s: {}", time, state.error().message);
    for (const int muscle : state->unsettled) ++series.unsettled[static_cast<std::size_t>(muscle)];
    series.lengths.row(row) = state->lengths;
    series.velocities.row(row) = state->velocities;
    for (std::size_t c = 0; c < coordinates.size(); ++c)
      series.moment_arms[c].row(row) = state->moment_arms.col(static_cast<Eigen::Index>(c));
  }
  return series;
}

}  // namespace sinew
