#include "problems/contact/motion/marker_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "base/constants.h"
#include "base/median.h"
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

// Two-sided power density [s] of a curve of variance 1 with kPoseSpectrum, at a frequency [rad/s]: the
// Fourier transform of its correlation.
double PosePower(double frequency) {
  const double w = frequency * kPoseSpectrum.correlation_time;
  const double smooth = std::sqrt(2 * kPi) * std::exp(-0.5 * w * w);
  const double rough = 4 / std::pow(1 + w * w, 2);
  return kPoseSpectrum.correlation_time *
         ((1 - kPoseSpectrum.roughness) * smooth + kPoseSpectrum.roughness * rough);
}

// Of the noise from frame to frame, what smooth curves follow.
struct FollowedNoise {
  double share = 0;  // of the variance
  double time = 0;   // [s] its standard deviation over that of its rate
};

// The optimal smoother (Wiener) of an endless record: of a frequency it follows the share that is the
// curve's.
// @param ratio
// variance of the curve over that of one frame's noise @param rate [Hz] of frames
FollowedNoise Followed(double ratio, double rate) {
  constexpr int kFrequencies = 500;
  const double highest = kPi * rate;  // that frames show
  double values = 0;
  double rates = 0;
  for (int i = 0; i < kFrequencies; ++i) {
    const double frequency = (i + 0.5) / kFrequencies * highest;
    const double curve = ratio * PosePower(frequency);
    const double followed = std::pow(curve / (curve + 1 / rate), 2);
    values += followed;
    rates += frequency * frequency * followed;
  }
  return {values / kFrequencies, std::sqrt(values / rates)};
}

// Standard deviation of the noise from frame to frame along an axis: by second differences of the residuals,
// which hold little else, and their median, so that jumps do not count. 0: too few frames.
double MarkerNoise(const FootMarkers& markers, const FootMotion& foot) {
  constexpr double kNormalMedian = 0.6745;  // of the size of a standard normal value
  std::vector<double> sizes;
  for (const FootMarkers::Marker& marker : markers.markers) {
    const auto residual = [&](std::size_t t) {
      return FootMarkers::Residual(marker, foot.bodies[marker.body].motion[t], t);
    };
    for (std::size_t t = 1; t + 1 < foot.centre.size(); ++t) {
      const Vec3 bend = residual(t - 1) - 2 * residual(t) + residual(t + 1);
      if (!bend.allFinite()) continue;
      for (const double b : bend) sizes.push_back(std::abs(b));
    }
  }
  return sizes.empty() ? 0 : UpperMedian(sizes) / (kNormalMedian * std::sqrt(6.0));
}

// Curves of the pose, then three coordinates of the place of each marker.
class MarkerFit {
 public:
  MarkerFit(const std::vector<double>& times, const FootMotion& foot, const FootMarkers& markers)
      : foot_(foot), markers_(markers) {
    rate_ = static_cast<double>(times.size() - 1) / (times.back() - times.front());
    const DeviationCurves curves(times, times.front(), times.back(), rate_ / (2 * kFramesPerKnot));
    bases_.own = curves.With(kPoseSpectrum);
    for (int c = 0; c < (foot.has_joint ? kPoseComponents : kJointAngle); ++c) {
      PoseTerm term;
      term.direction.setZero();
      term.direction[c] = c <= kShiftZ ? kWideShift : c <= kTurnZ ? kWideTurn : kWideJoint;
      term.component = static_cast<PoseComponent>(c);
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

  /// Of the pose found. @param marker standard deviation of a marker's noise along an axis [m]
  [[nodiscard]] PoseNoise Noise(double marker) const {
    PoseNoise noise;
    noise.marker = marker;
    const auto frames = static_cast<double>(foot_.centre.size());
    PoseMatrix variance = PoseMatrix::Zero();  // of one frame's noise, for noise of the size assumed
    double of_shift = 0;                       // mean of the information on one axis
    for (std::size_t t = 0; t < foot_.centre.size(); ++t) {
      const PoseMatrix information = Information(t);
      const PoseMatrix inverse = (information + PoseMatrix::Identity()).inverse();
      variance += inverse * information * inverse / frames;
      of_shift += information.topLeftCorner<3, 3>().trace() / (3 * frames);
    }
    if (!(of_shift > 0)) return noise;
    const FollowedNoise followed = Followed(of_shift, rate_);
    noise.time = followed.time;
    for (const PoseTerm& term : curves_.terms) {
      const auto c = static_cast<std::size_t>(term.component);
      noise.deviation[c] = term.direction[term.component] * marker / kMarkerNoise *
                           std::sqrt(followed.share * variance(term.component, term.component));
    }
    return noise;
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

  using PoseMatrix = Eigen::Matrix<double, kPoseComponents, kPoseComponents>;

  // What the markers of an instant say of the pose, in units of its wide prior.
  [[nodiscard]] PoseMatrix Information(std::size_t t) const {
    PoseMatrix information = PoseMatrix::Zero();
    const PoseDeviation none;
    const FootTurn turn(none);
    for (const FootMarkers::Marker& marker : markers_.markers) {
      if (!marker.measured[t].allFinite()) continue;
      PoseJacobian jacobian;
      const BodyMotion body = DeviatedBody(foot_, marker.body, t, none, turn, &jacobian);
      const Vec3 arm = body.rotation * marker.location;
      Eigen::Matrix<double, 3, kPoseComponents> slopes = Eigen::Matrix<double, 3, kPoseComponents>::Zero();
      for (const PoseTerm& term : curves_.terms) {
        const Eigen::Matrix<double, 6, 1> moved =
            jacobian.topLeftCorner<6, kPoseComponents>() * term.direction;
        slopes.col(term.component) = (moved.head<3>() + Vec3(moved.tail<3>()).cross(arm)) / kMarkerNoise;
      }
      information += slopes.transpose() * slopes;
    }
    return information;
  }

  const FootMotion& foot_;
  const FootMarkers& markers_;
  StanceMotionErrors curves_;
  DeviationBases bases_;
  double rate_ = 0;  // [Hz] of the frames
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
  result.noise = MarkerFit(times, foot, markers).Noise(MarkerNoise(markers, foot));
  return result;
}

}  // namespace sinew
