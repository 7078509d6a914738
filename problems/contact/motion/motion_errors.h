// The motion of a foot was measured too: smooth deviations of its pose from the recorded one, as nuisance
// parameters of each stance with a prior in metres and radians.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "identify/parameter.h"
#include "models/contact/pose_deviation.h"

namespace sinew {

struct MotionErrorSettings {
  /// Standard deviations of the prior; without a number that of the foot's markers (FootMarkers).
  std::optional<double> position;  ///< along each axis [m]
  std::optional<double> rotation;  ///< about each axis [rad]
  std::optional<double> joint;     ///< of the angle of the foot's joint [rad]
  /// Standard deviation of what differs from step to step over that of what all steps have in common.
  double between_steps = 1;
  double correlation_time = 0.2;  ///< [s] after which errors have a correlation of 0.48
  double cutoff = 20;             ///< [Hz] highest frequency: knots are half its period apart
};

/// Of the map under `motion_errors`. Errors: unknown keys, numbers not above 0, with file and line.
Result<MotionErrorSettings> ReadMotionErrors(const YamlReader& yaml);

/// Cubic B-splines with equidistant knots, weighted so that independent standard normal weights make a curve
/// with unit variance and the correlation (1 + s) exp(-s), s = sqrt(3) lag / correlation_time (Matern, order
/// 3/2: errors have a rate, which may jump). Sources: de Boor, A Practical Guide to Splines (1978), ch. IX;
/// Rasmussen, Williams, Gaussian Processes for Machine Learning (2006), eq. 4.17.
struct MotionErrorBasis {
  Matrix value;  ///< [T x K]
  Matrix rate;   ///< [T x K, 1/s]

  /// @param times [T, increasing, s] within `from` .. `to`; those outside have the value at that end, and no
  /// rate @param stretch by which `rate` is multiplied, for times that are phases of a movement
  static MotionErrorBasis Make(const std::vector<double>& times, double from, double to,
                               double correlation_time, double cutoff, double stretch = 1);
  /// The splines themselves, without weights: values, and rates times `stretch`.
  static MotionErrorBasis Splines(const std::vector<double>& times, double from, double to, double cutoff,
                                  double stretch = 1);
};

/// A smooth curve in one direction of the pose.
struct PoseTerm {
  Eigen::Matrix<double, kPoseComponents, 1> direction;  ///< for a weight of one standard deviation [m, rad]
  MotionErrorBasis basis;                               ///< at the stance's instants
  int first = -1;                                       ///< index of its first weight
  [[nodiscard]] int weights() const { return static_cast<int>(basis.value.cols()); }
};

/// Deviations of one stance: those that all stances have in common, then its own.
struct StanceMotionErrors {
  std::vector<int> components;                      ///< of PoseComponent that may deviate; none: exact motion
  std::array<double, kPoseComponents> deviation{};  ///< standard deviation of each, of its own part [m, rad]
  std::array<double, kPoseComponents> common{};     ///< of the part that all stances have in common
  std::vector<PoseTerm> terms;                      ///< weights in increasing order
  int own = 0;                                      ///< index of the first own term

  /// Indices of all weights, increasing.
  [[nodiscard]] std::vector<int> Columns() const;
  /// Number of all weights.
  [[nodiscard]] int weights() const;
  /// Indices of its own weights: from the first to before the second.
  [[nodiscard]] std::array<int, 2> OwnRange() const;

  /// At one instant. @param parameters [P] @param own false: only what all stances have in common
  [[nodiscard]] PoseDeviation At(const Vector& parameters, int instant) const;
};

/// Nuisance parameters of one curve, each a standard normal weight: NAME[k], and @STANCE after it if it is a
/// stance's own. @param trial empty: of all stances
[[nodiscard]] std::vector<Parameter> DeclareWeights(PoseComponent component, int weights,
                                                    const std::string& trial, const std::string& stance);

/// The directions, in ground axes, of components in the frame of a foot that looks along a heading, mirrored
/// for a left foot. @param forward horizontal unit vector @param side 1 or -1
[[nodiscard]] std::array<Eigen::Matrix<double, kPoseComponents, 1>, kPoseComponents> FootDirections(
    const Vec3& forward, double side);

/// "shift_x", ..., "turn_z", "joint".
[[nodiscard]] const char* ToString(PoseComponent component);

}  // namespace sinew
