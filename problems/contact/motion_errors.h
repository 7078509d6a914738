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
  double correlation_time = 0.2;   ///< [s] after which errors have a correlation of 0.48
  double cutoff = 10;              ///< [Hz] highest frequency: knots are half its period apart
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

  /// @param times [T, increasing, T >= 2]
  static MotionErrorBasis Make(const std::vector<double>& times, double correlation_time, double cutoff);
};

/// Deviations of one stance.
struct StanceMotionErrors {
  std::vector<int> components;                      ///< of PoseComponent that may deviate
  std::array<double, kPoseComponents> deviation{};  ///< standard deviation of each [m, rad]
  MotionErrorBasis basis;
  int first = -1;  ///< index of the first parameter; they follow component by component

  [[nodiscard]] int weights() const { return static_cast<int>(basis.value.cols()); }
  [[nodiscard]] int parameters() const { return static_cast<int>(components.size()) * weights(); }

  /// At one instant. @param parameters [P]
  [[nodiscard]] PoseDeviation At(const Vector& parameters, int instant) const;

  /// Nuisance parameters COMPONENT[k]@STANCE in the order above, each a standard normal weight.
  /// @param stance as messages call it: trial and plate
  [[nodiscard]] std::vector<Parameter> Declare(const std::string& trial, const std::string& stance) const;
};

/// "shift_x", ..., "turn_z", "joint".
[[nodiscard]] const char* ToString(PoseComponent component);

}  // namespace sinew
