#include "problems/contact/motion/marker_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "problems/contact/motion/motion_errors.h"

namespace sinew {
namespace {

constexpr double kMarkerNoise = 0.002;  // [m] from frame to frame: noise, and what a shoe gives
constexpr double kPlaceError = 0.01;    // [m] between a marker's place on the foot and on its model
// Wide: the markers are to decide wherever they can.
constexpr double kWideShift = 0.02;
constexpr double kWideTurn = 0.2;
constexpr double kWideJoint = 0.3;
// A foot moves smoothly but for its landing. A rough prior lets through what markers err by from frame to
// frame, which friction turns into tens of newtons: of four that were tried, this one has the largest
// marginal likelihood on real and on synthetic stances.
constexpr CurveSpectrum kPoseSpectrum{0.1, 0.01};
// Of the frames: the foot stops within a few of them.
constexpr double kFramesPerKnot = 2;

// Curves of the pose, then three coordinates of the place of each marker.
class MarkerFit {
 public:
  MarkerFit(const std::vector<double>& times, const FootMotion& foot, const FootMarkers& markers)
      : foot_(foot), markers_(markers) {
    const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    const DeviationCurves curves(times, times.front(), times.back(), 1 / (2 * kFramesPerKnot * step));
    bases_.own = curves.With(kPoseSpectrum);
    for (int c = 0; c < (foot.has_joint ? kPoseComponents : kJointAngle); ++c) {
      PoseTerm term;
      term.direction.setZero();
      term.direction[c] = c <= kShiftZ ? kWideShift : c <= kTurnZ ? kWideTurn : kWideJoint;
      term.of = DeviationOf::kStance;
      term.first = static_cast<int>(size_);
      term.weights = curves.weights();
      size_ += term.weights;
      curves_.terms.push_back(std::move(term));
    }
    places_ = size_;
    size_ += 3 * static_cast<Eigen::Index>(markers.markers.size());
  }

  [[nodiscard]] PoseDeviation At(const Vector& x, std::size_t instant) const {
    return curves_.At(bases_, x, static_cast<int>(instant));
  }
  [[nodiscard]] Vec3 Place(const Vector& x, std::size_t marker) const {
    return markers_.markers[marker].location +
           kPlaceError * Vec3(x.segment<3>(places_ + 3 * static_cast<Eigen::Index>(marker)));
  }

  /// Gauss-Newton: positions are nearly linear in the weights.
  [[nodiscard]] Vector Solve() const {
    constexpr int kIterations = 6;
    Vector x = Vector::Zero(size_);
    for (int i = 0; i < kIterations; ++i) {
      Matrix normal = Matrix::Identity(size_, size_);
      Vector pull = -x;
      for (std::size_t t = 0; t < foot_.centre.size(); ++t) AddInstant(x, t, normal, pull);
      x += normal.llt().solve(pull);
    }
    return x;
  }

 private:
  void AddInstant(const Vector& x, std::size_t t, Matrix& normal, Vector& pull) const {
    const PoseDeviation deviation = At(x, t);
    const FootTurn turn(deviation);
    Matrix rows = Matrix::Zero(3, size_);
    for (std::size_t m = 0; m < markers_.markers.size(); ++m) {
      const FootMarkers::Marker& marker = markers_.markers[m];
      if (!marker.measured[t].allFinite()) continue;
      PoseJacobian jacobian;
      const BodyMotion body = DeviatedBody(foot_, marker.body, t, deviation, turn, &jacobian);
      const Vec3 arm = body.rotation * Place(x, m);
      rows.setZero();
      for (const PoseTerm& term : curves_.terms) {
        const Eigen::Matrix<double, 6, 1> moved =
            jacobian.topLeftCorner<6, kPoseComponents>() * term.direction;
        const Vec3 slope = moved.head<3>() + Vec3(moved.tail<3>()).cross(arm);
        rows.middleCols(term.first, term.weights) =
            slope / kMarkerNoise * bases_.own->value.row(static_cast<Eigen::Index>(t));
      }
      rows.middleCols<3>(places_ + 3 * static_cast<Eigen::Index>(m)) =
          kPlaceError / kMarkerNoise * body.rotation;
      const Vec3 residual = (body.position + arm - marker.measured[t]) / kMarkerNoise;
      normal.noalias() += rows.transpose() * rows;
      pull.noalias() -= rows.transpose() * residual;
    }
  }

  const FootMotion& foot_;
  const FootMarkers& markers_;
  StanceMotionErrors curves_;
  DeviationBases bases_;
  Eigen::Index places_ = 0;
  Eigen::Index size_ = 0;
};

// The foot with its joints' axes and centre, moved.
FootMotion Moved(const FootMotion& foot, const MarkerFit& fit, const Vector& x) {
  FootMotion moved = foot;
  for (std::size_t t = 0; t < foot.centre.size(); ++t) {
    const PoseDeviation deviation = fit.At(x, t);
    const FootTurn turn(deviation);
    const Vec3 shift(deviation.value[kShiftX], deviation.value[kShiftY], deviation.value[kShiftZ]);
    for (std::size_t b = 0; b < foot.bodies.size(); ++b) {
      moved.bodies[b].motion[t] = DeviatedBody(foot, b, t, deviation, turn, nullptr);
      JointAxis& axis = moved.bodies[b].axis[t];
      axis.point = foot.centre[t] + shift + turn.rotation() * (axis.point - foot.centre[t]);
      axis.direction = turn.rotation() * axis.direction;
    }
  }
  moved.PlaceCentre();
  return moved;
}

}  // namespace

MarkerPose MoveToMarkers(const std::vector<double>& times, FootMotion& foot, FootMarkers& markers) {
  MarkerPose result;
  if (markers.markers.empty() || times.size() < 2) return result;
  const MarkerFit fit(times, foot, markers);
  const Vector x = fit.Solve();
  result.residual_recorded = AccuracyOf(markers, foot).residual;
  for (std::size_t t = 0; t < times.size(); ++t) {
    const PoseDeviation deviation = fit.At(x, t);
    for (int c = 0; c < kJointAngle; ++c)
      (c <= kShiftZ ? result.shift : result.turn) +=
          std::pow(deviation.value[static_cast<std::size_t>(c)], 2) /
          (3.0 * static_cast<double>(times.size()));
  }
  result.shift = std::sqrt(result.shift);
  result.turn = std::sqrt(result.turn);
  FootMotion moved = Moved(foot, fit, x);
  for (std::size_t m = 0; m < markers.markers.size(); ++m) markers.markers[m].location = fit.Place(x, m);
  foot = std::move(moved);
  result.residual = AccuracyOf(markers, foot).residual;
  return result;
}

}  // namespace sinew
