// The motion of a foot was measured too: smooth deviations of its pose from the recorded one, as nuisance
// parameters of each stance with a prior in metres and radians.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "identify/parameter.h"
#include "models/contact/pose_deviation.h"
#include "problems/contact/motion/deviation_curves.h"

namespace sinew {

struct MotionErrorSettings {
  /// Standard deviations of the prior; without a number that of the foot's markers (FootMarkers).
  std::optional<double> position;  ///< along each axis [m]
  std::optional<double> rotation;  ///< about each axis [rad]
  std::optional<double> joint;     ///< of the angle of the foot's joint [rad]
  /// Standard deviation of what differs from step to step over that of what all steps have in common. Without
  /// a number it is chosen by the marginal likelihood of the fitted stances, if there are several.
  std::optional<double> between_steps;
  /// Of CurveSpectrum; without a number chosen likewise.
  std::optional<double> correlation_time;
  std::optional<double> roughness;
  double cutoff = 20;  ///< [Hz] highest frequency: knots are half its period apart
};

/// Of the map under `motion_errors`. Errors: unknown keys, numbers not above 0, with file and line.
Result<MotionErrorSettings> ReadMotionErrors(const YamlReader& yaml);

/// Range of the parameters of the prior, and where a search for them begins.
struct SpectrumRange {
  CurveSpectrum lowest;
  CurveSpectrum highest;
  CurveSpectrum start;
};
inline constexpr SpectrumRange kSpectrumRange{{0.02, 1e-6}, {1, 1}, {0.1, 0.01}};
/// The same of between_steps: least, most, start.
inline constexpr std::array<double, 3> kBetweenStepsRange{0.1, 10, 1};
inline constexpr int kSpectrumParameters = 3;

/// Whose deviation it is: of all stances, of the floor, whose velocity is known to some accuracy and the same
/// in all stances, or of one stance.
enum class DeviationOf { kAll, kFloor, kStance };

/// A smooth curve in one direction of the pose, or a constant rate of it relative to the floor.
struct PoseTerm {
  /// For a weight of one standard deviation [m, rad]; of the floor: for 1 m/s.
  Eigen::Matrix<double, kPoseComponents, 1> direction;
  PoseComponent component = kShiftX;  ///< that the curve describes, in the frame of the foot for kAll
  DeviationOf of = DeviationOf::kAll;
  int first = -1;  ///< index of its first weight
  int weights = 0;
};

/// Of the curves at one prior, and of the floor.
struct DeviationBases {
  std::shared_ptr<const CurveBasis> common;
  std::shared_ptr<const CurveBasis> floor;
  std::shared_ptr<const CurveBasis> own;
  [[nodiscard]] const CurveBasis& Of(const PoseTerm& term) const {
    return term.of == DeviationOf::kAll ? *common : term.of == DeviationOf::kFloor ? *floor : *own;
  }
};

/// Deviations of one stance: those that all stances have in common, the floor's, then its own.
struct StanceMotionErrors {
  std::vector<int> components;                      ///< of PoseComponent that may deviate; none: exact motion
  std::array<double, kPoseComponents> deviation{};  ///< standard deviation of each [m, rad]
  std::vector<PoseTerm> terms;                      ///< weights in increasing order
  int own = 0;                                      ///< index of the first own term
  int spectrum = -1;  ///< index of the first parameter of the prior (DeclareSpectrum)
  /// What the recorded pose has of its markers' noise, which is in the stance's own curves: its variance over
  /// that of `deviation`, and CurveSpectrum::noise_time.
  double noise = 0;
  double noise_time = 0.05;
  std::shared_ptr<const DeviationCurves> common_curves;  ///< at the stance's instants
  std::shared_ptr<const CurveBasis> floor;               ///< no value, rate 1
  std::shared_ptr<const DeviationCurves> own_curves;

  /// Indices of all weights, increasing.
  [[nodiscard]] std::vector<int> Columns() const;
  /// Number of all weights.
  [[nodiscard]] int weights() const;
  /// Indices of its own weights: from the first to before the second.
  [[nodiscard]] std::array<int, 2> OwnRange() const;

  /// @param of the stance, or all
  [[nodiscard]] CurveSpectrum SpectrumAt(const Vector& parameters, DeviationOf of) const;
  /// At the prior that the parameters [P] state.
  [[nodiscard]] DeviationBases BasesAt(const Vector& parameters) const;
  /// At one instant. @param bases at these parameters
  [[nodiscard]] PoseDeviation At(const DeviationBases& bases, const Vector& parameters, int instant) const;
  [[nodiscard]] PoseDeviation At(const Vector& parameters, int instant) const {
    return At(BasesAt(parameters), parameters, instant);
  }
};

/// Nuisance parameters of one curve, each a standard normal weight: NAME[k], and @STANCE after it if it is a
/// stance's own. @param trial empty: of all stances
[[nodiscard]] std::vector<Parameter> DeclareWeights(PoseComponent component, int weights,
                                                    const std::string& trial, const std::string& stance);

/// `floor_velocity_x` or `_z`: by how much the floor's velocity differs from the stated one, a nuisance
/// parameter.
/// @param error its standard deviation [m/s, > 0]
[[nodiscard]] Parameter DeclareFloorVelocity(PoseComponent along, double error);

/// `deviation_time`, `deviation_roughness` and `deviation_between_steps`: those that are set are held, the
/// others chosen; one stance does not tell the last one.
/// @param fitted number of fitted stances
[[nodiscard]] std::vector<Parameter> DeclareSpectrum(const MotionErrorSettings& settings, int fitted);

/// The directions, in ground axes, of components in the frame of a foot that looks along a heading, mirrored
/// for a left foot. @param forward horizontal unit vector @param side 1 or -1
[[nodiscard]] std::array<Eigen::Matrix<double, kPoseComponents, 1>, kPoseComponents> FootDirections(
    const Vec3& forward, double side);

/// "shift_x", ..., "turn_z", "joint".
[[nodiscard]] const char* ToString(PoseComponent component);

}  // namespace sinew
