#include "problems/contact/motion/smooth_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <array>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "problems/contact/motion/deviation_curves.h"

namespace sinew {
namespace {

Vec3 RotationVector(const Mat3& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

// Position and rotation vector about the pose in the middle [T x 6].
Matrix PoseOf(const std::vector<BodyMotion>& motion) {
  const Mat3 reference = motion[motion.size() / 2].rotation;
  Matrix pose(static_cast<Eigen::Index>(motion.size()), 6);
  for (std::size_t t = 0; t < motion.size(); ++t) {
    pose.row(static_cast<Eigen::Index>(t)) << motion[t].position.transpose(),
        RotationVector(motion[t].rotation * reference.transpose()).transpose();
  }
  return pose;
}

// Generalised cross-validation of cubic splines with a knot at every sample, whose third derivative is
// penalised so that frequencies fall by 1 / (1 + (f / cutoff)^6).
class PenalisedSplines {
 public:
  PenalisedSplines(const std::vector<double>& times, const Matrix& values)
      : step_((times.back() - times.front()) / static_cast<double>(times.size() - 1)),
        values_(values),
        splines_(DeviationCurves(times, times.front(), times.back(), highest()).splines().value) {
    constexpr int kPenalised = 3;
    Matrix third = Matrix::Zero(splines_.cols() - kPenalised, splines_.cols());
    for (Eigen::Index i = 0; i < third.rows(); ++i) third.row(i).segment<kPenalised + 1>(i) << -1, 3, -3, 1;
    gram_ = splines_.transpose() * splines_;
    penalty_ = third.transpose() * third / std::pow(step_, 2 * kPenalised - 1);
  }

  /// Of the samples [Hz].
  [[nodiscard]] double highest() const { return 0.5 / step_; }

  [[nodiscard]] double Score(double cutoff) const {
    const Eigen::LLT<Matrix> factor(gram_ + penalty_ / (step_ * std::pow(2 * kPi * cutoff, 6)));
    const Matrix left = values_ - splines_ * factor.solve(splines_.transpose() * values_);
    const double spent = factor.solve(gram_).trace();
    return left.squaredNorm() / std::pow(static_cast<double>(values_.rows()) - spent, 2);
  }

 private:
  double step_;  // [s]
  const Matrix& values_;
  Matrix splines_;
  Matrix gram_;
  Matrix penalty_;
};

// Left-out samples are predicted best by splines that smooth what the samples could show.
bool HasNoise(const std::vector<double>& times, double lowest, const Matrix& pose) {
  constexpr double kRatio = 1.2;
  constexpr double kBeyond = 4;  // times the highest frequency, where no sample is changed
  const PenalisedSplines splines(times, pose);
  double least = splines.Score(kBeyond * splines.highest());
  bool found = false;
  for (double cutoff = lowest; cutoff < splines.highest(); cutoff *= kRatio) {
    const double score = splines.Score(cutoff);
    if (score >= least) continue;
    least = score;
    found = true;
  }
  return found;
}

// Of frequencies from the lowest on, the one whose splines predict left-out samples best: generalised
// cross-validation (Craven, Wahba 1979; for movements Woltring 1986).
double BestCutoff(const std::vector<double>& times, double lowest, const Matrix& pose) {
  constexpr std::array<double, 7> kMultiples{1, 1.2, 1.5, 1.8, 2.2, 2.6, 3.2};
  constexpr double kMostColumns = 0.85;  // of the samples
  const auto n = static_cast<double>(times.size());
  double best = lowest;
  double least = std::numeric_limits<double>::infinity();
  for (const double multiple : kMultiples) {
    const Matrix splines =
        DeviationCurves(times, times.front(), times.back(), multiple * lowest).splines().value;
    if (static_cast<double>(splines.cols()) > kMostColumns * n) break;
    const Matrix left = pose - splines * Eigen::ColPivHouseholderQR<Matrix>(splines).solve(pose);
    const double score = left.squaredNorm() / std::pow(n - static_cast<double>(splines.cols()), 2);
    if (score >= least) continue;
    least = score;
    best = multiple * lowest;
  }
  return best;
}

}  // namespace

void SmoothMotion(const std::vector<double>& times, double lowest, FootMotion& foot) {
  constexpr std::size_t kFewest = 5;  // fewer have no frequencies to speak of
  if (times.size() < kFewest) return;
  Matrix position = PoseOf(foot.bodies.front().motion);
  // Metres and radians on one scale, that of a foot's length.
  constexpr double kLever = 0.1;  // [m]
  position.rightCols<3>() *= kLever;
  if (!HasNoise(times, lowest, position)) return;
  const double cutoff = BestCutoff(times, lowest, position);
  const DeviationCurves curves(times, times.front(), times.back(), cutoff);
  const CurveBasis& splines = curves.splines();
  if (splines.value.cols() >= splines.value.rows()) return;  // slower sampling has no such frequencies
  const Eigen::ColPivHouseholderQR<Matrix> fit(splines.value);
  const FootMotion recorded = foot;
  const std::size_t middle = times.size() / 2;
  for (std::size_t b = 0; b < foot.bodies.size(); ++b) {
    std::vector<BodyMotion>& motion = foot.bodies[b].motion;
    const Mat3 reference = motion[middle].rotation;
    const Matrix pose = PoseOf(motion);
    const Matrix weights = fit.solve(pose);
    const Matrix value = splines.value * weights;
    const Matrix rate = splines.rate * weights;
    for (std::size_t t = 0; t < times.size(); ++t) {
      const auto row = static_cast<Eigen::Index>(t);
      PoseDeviation turn;
      for (int axis = 0; axis < 3; ++axis) {
        const auto component = static_cast<std::size_t>(kTurnX + axis);
        turn.value[component] = value(row, 3 + axis);
        turn.rate[component] = rate(row, 3 + axis);
      }
      const FootTurn rotation(turn);
      motion[t].position = value.row(row).head<3>();
      motion[t].velocity = rate.row(row).head<3>();
      motion[t].rotation = rotation.rotation() * reference;
      motion[t].angular_velocity = rotation.angular_velocity();
    }
  }
  for (std::size_t b = 0; b < foot.bodies.size(); ++b) {
    for (std::size_t t = 0; t < times.size(); ++t) {
      const BodyMotion& from = recorded.bodies.front().motion[t];
      const BodyMotion& to = foot.bodies.front().motion[t];
      const Mat3 turn = to.rotation * from.rotation.transpose();
      JointAxis& axis = foot.bodies[b].axis[t];
      axis.direction = turn * axis.direction;
      axis.point = to.position + turn * (axis.point - from.position);
    }
  }
  foot.PlaceCentre();
}

}  // namespace sinew
