#include "problems/contact/steps/shared_deviation.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace sinew {
namespace {

using Pose = Eigen::Matrix<double, kPoseComponents, 1>;
using Directions = Eigen::Matrix<double, kPoseComponents, kPoseComponents>;

Directions DirectionsOf(const Stance& stance) {
  const auto columns = FootDirections(stance.forward, stance.side);
  Directions directions;
  for (Eigen::Index c = 0; c < kPoseComponents; ++c) directions.col(c) = columns[static_cast<std::size_t>(c)];
  return directions;
}

// A stance's own deviation at an instant, in the frame of the foot.
Pose OwnDeviation(const Stance& stance, const Directions& directions, const Vector& parameters,
                  std::size_t instant) {
  const StanceMotionErrors& errors = stance.motion_errors;
  const DeviationBases bases = errors.BasesAt(parameters);
  Pose pose = Pose::Zero();
  for (std::size_t i = static_cast<std::size_t>(errors.own); i < errors.terms.size(); ++i) {
    const PoseTerm& term = errors.terms[i];
    pose += bases.Of(term)
                .value.row(static_cast<Eigen::Index>(instant))
                .dot(parameters.segment(term.first, term.weights)) *
            term.direction;
  }
  return directions.transpose() * pose;
}

// The same at a phase, linear between instants.
Pose OwnDeviationAt(const Stance& stance, const Directions& directions, const Vector& parameters,
                    double phase) {
  std::size_t after = 0;
  while (after + 1 < stance.time.size() && PhaseOf(stance, after) < phase) ++after;
  const Pose there = OwnDeviation(stance, directions, parameters, after);
  if (after == 0) return there;
  const double from = PhaseOf(stance, after - 1);
  const double length = PhaseOf(stance, after) - from;
  const double share = length > 0 ? std::clamp((phase - from) / length, 0.0, 1.0) : 1;
  return (1 - share) * OwnDeviation(stance, directions, parameters, after - 1) + share * there;
}

}  // namespace

double PhaseOf(const Stance& stance, std::size_t instant) {
  return std::clamp((stance.time[instant] - stance.loaded[0]) / (stance.loaded[1] - stance.loaded[0]), 0.0,
                    1.0);
}

void SetMeanDeviation(const std::vector<const Stance*>& others, const Stance& stance, Vector& parameters) {
  const auto instants = static_cast<Eigen::Index>(stance.time.size());
  Matrix mean = Matrix::Zero(instants, kPoseComponents);  // in ground axes
  const Directions directions = DirectionsOf(stance);
  for (const Stance* other : others) {
    const Directions of_other = DirectionsOf(*other);
    for (Eigen::Index t = 0; t < instants; ++t) {
      const double phase = PhaseOf(stance, static_cast<std::size_t>(t));
      mean.row(t) += (directions * OwnDeviationAt(*other, of_other, parameters, phase)).transpose() /
                     static_cast<double>(others.size());
    }
  }
  // Weights of curves that have these values; the weak prior decides what no instant sees.
  constexpr double kWeak = 1e-4;
  const StanceMotionErrors& errors = stance.motion_errors;
  const DeviationBases bases = errors.BasesAt(parameters);
  for (std::size_t i = static_cast<std::size_t>(errors.own); i < errors.terms.size(); ++i) {
    const PoseTerm& term = errors.terms[i];
    Eigen::Index component = 0;
    const double scale = term.direction.cwiseAbs().maxCoeff(&component);
    const Matrix& basis = bases.Of(term).value;
    const Matrix normal = basis.transpose() * basis + kWeak * Matrix::Identity(basis.cols(), basis.cols());
    parameters.segment(term.first, term.weights) =
        normal.llt().solve(basis.transpose() * mean.col(component) / scale);
  }
}

}  // namespace sinew
