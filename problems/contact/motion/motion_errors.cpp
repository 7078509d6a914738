#include "problems/contact/motion/motion_errors.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"

namespace sinew {
namespace {

Result<std::optional<double>> Positive(const YamlReader& yaml, const std::string& key) {
  if (!yaml.Has(key)) return std::optional<double>();
  SINEW_ASSIGN(const YamlReader entry, yaml.At(key));
  SINEW_ASSIGN(const double value, entry.Number());
  if (!(value > 0)) return FailAt(entry.file(), entry.line(), "{}: {}, expected above 0", key, value);
  return std::optional(value);
}

}  // namespace

const char* ToString(PoseComponent component) {
  static constexpr std::array<const char*, kPoseComponents> kNames{"shift_x", "shift_y", "shift_z", "turn_x",
                                                                   "turn_y",  "turn_z",  "joint"};
  return kNames[static_cast<std::size_t>(component)];
}

Result<MotionErrorSettings> ReadMotionErrors(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys(
      {"position", "rotation", "joint", "between_steps", "correlation_time", "roughness", "cutoff"}));
  MotionErrorSettings settings;
  SINEW_ASSIGN(settings.position, Positive(yaml, "position"));
  SINEW_ASSIGN(settings.rotation, Positive(yaml, "rotation"));
  SINEW_ASSIGN(settings.joint, Positive(yaml, "joint"));
  SINEW_ASSIGN(const auto correlation_time, Positive(yaml, "correlation_time"));
  SINEW_ASSIGN(const auto cutoff, Positive(yaml, "cutoff"));
  SINEW_ASSIGN(settings.between_steps, Positive(yaml, "between_steps"));
  settings.correlation_time = correlation_time;
  SINEW_ASSIGN(settings.roughness, Positive(yaml, "roughness"));
  if (settings.roughness && *settings.roughness > 1) {
    SINEW_ASSIGN(const YamlReader entry, yaml.At("roughness"));
    return FailAt(entry.file(), entry.line(), "roughness: {}, expected at most 1", *settings.roughness);
  }
  settings.cutoff = cutoff.value_or(settings.cutoff);
  constexpr double kHighest = 200;  // [Hz]: an hour of such curves would fill any memory
  if (settings.cutoff > kHighest)
    return FailAt(yaml.file(), yaml.line(), "cutoff: {} Hz, expected at most {}", settings.cutoff, kHighest);
  return settings;
}

std::vector<int> StanceMotionErrors::Columns() const {
  std::vector<int> columns;
  for (const PoseTerm& term : terms) {
    for (int k = 0; k < term.weights; ++k) columns.push_back(term.first + k);
  }
  return columns;
}

int StanceMotionErrors::weights() const {
  int count = 0;
  for (const PoseTerm& term : terms) count += term.weights;
  return count;
}

std::array<int, 2> StanceMotionErrors::OwnRange() const {
  if (terms.empty()) return {0, 0};
  const PoseTerm& last = terms.back();
  return {terms[static_cast<std::size_t>(own)].first, last.first + last.weights};
}

CurveSpectrum StanceMotionErrors::SpectrumAt(const Vector& parameters, DeviationOf of) const {
  const double between_steps = parameters[spectrum + 2];
  const double common = 1 / std::hypot(1.0, between_steps);
  CurveSpectrum curve;
  curve.correlation_time = parameters[spectrum];
  curve.roughness = parameters[spectrum + 1];
  curve.scale = common;
  if (of == DeviationOf::kStance) {
    curve.scale = between_steps * common;
    curve.noise = noise / (curve.scale * curve.scale);
    curve.noise_time = noise_time;
  }
  return curve;
}

DeviationBases StanceMotionErrors::BasesAt(const Vector& parameters) const {
  if (terms.empty()) return {};
  return {common_curves->With(SpectrumAt(parameters, DeviationOf::kAll)), floor,
          own_curves->With(SpectrumAt(parameters, DeviationOf::kStance))};
}

PoseDeviation StanceMotionErrors::At(const DeviationBases& bases, const Vector& parameters,
                                     int instant) const {
  PoseDeviation pose;
  Eigen::Map<Eigen::Matrix<double, kPoseComponents, 1>> value(pose.value.data());
  Eigen::Map<Eigen::Matrix<double, kPoseComponents, 1>> rate(pose.rate.data());
  for (const PoseTerm& term : terms) {
    const auto weights_of = parameters.segment(term.first, term.weights);
    const CurveBasis& basis = bases.Of(term);
    value += basis.value.row(instant).dot(weights_of) * term.direction;
    rate += basis.rate.row(instant).dot(weights_of) * term.direction;
  }
  return pose;
}

std::vector<Parameter> DeclareWeights(PoseComponent component, int weights, const std::string& trial,
                                      const std::string& stance) {
  constexpr double kReach = 8;  // standard deviations
  std::vector<Parameter> declared;
  for (int k = 0; k < weights; ++k) {
    Parameter p = BaseParameter(
        fmt::format("{}[{}]{}", ToString(component), k, stance.empty() ? "" : "@" + stance), "1",
        "weight of a curve by which the foot's pose differs from the recorded one", -kReach, kReach, 0);
    p.kind = ParameterKind::kNuisance;
    p.trial = trial;
    p.prior = GaussianPrior{0, 1};
    declared.push_back(std::move(p));
  }
  return declared;
}

Parameter DeclareFloorVelocity(PoseComponent along, double error) {
  constexpr double kReach = 8;  // standard deviations
  Parameter p =
      BaseParameter(along == kShiftX ? "floor_velocity_x" : "floor_velocity_z", "m/s",
                    "velocity of the floor, from the stated one", -kReach * error, kReach * error, 0);
  p.kind = ParameterKind::kNuisance;
  p.prior = GaussianPrior{0, error};
  return p;
}

std::vector<Parameter> DeclareSpectrum(const MotionErrorSettings& settings, int fitted) {
  const auto make = [](std::string name, std::string unit, std::string meaning, double lower, double upper,
                       double start, std::optional<double> set, std::vector<double> others) {
    Parameter p = BaseParameter(std::move(name), std::move(unit), std::move(meaning), lower, upper,
                                set.value_or(start));
    p.kind = ParameterKind::kPrior;
    p.scale = Scale::kLog;
    p.source = "Rasmussen and Williams 2006, eq. 4.9, 4.17 and 5.30";
    p.lower = std::min(p.lower, p.start);
    p.upper = std::max(p.upper, p.start);
    if (!set) p.other_starts = std::move(others);
    return p;
  };
  const auto& [lowest, highest, start] = kSpectrumRange;
  return {
      make("deviation_time", "s", "standard deviation of the pose's errors over that of their rates",
           lowest.correlation_time, highest.correlation_time, start.correlation_time,
           settings.correlation_time, {0.2, 0.1}),
      make("deviation_roughness", "1", "share of the variance of the pose's errors whose rate may jump",
           lowest.roughness, highest.roughness, start.roughness, settings.roughness, {1e-4, 1}),
      make("deviation_between_steps", "1",
           "standard deviation of what of the pose's errors differs from step to step, over that of the rest",
           kBetweenStepsRange[0], kBetweenStepsRange[1], kBetweenStepsRange[2], settings.between_steps,
           fitted > 1 ? std::vector<double>{3, kBetweenStepsRange[2]} : std::vector<double>{})};
}

std::array<Eigen::Matrix<double, kPoseComponents, 1>, kPoseComponents> FootDirections(const Vec3& forward,
                                                                                      double side) {
  // Forward, up and to the side; a mirror turns the third axis of a position, the others of a rotation.
  const Vec3 up = Vec3::UnitY();
  const std::array<Vec3, 3> axes{forward, up, forward.cross(up)};
  std::array<Eigen::Matrix<double, kPoseComponents, 1>, kPoseComponents> directions;
  for (auto& direction : directions) direction.setZero();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    directions[kShiftX + a].segment<3>(kShiftX) = (axis == 2 ? side : 1) * axes[a];
    directions[kTurnX + a].segment<3>(kTurnX) = (axis == 2 ? 1 : side) * axes[a];
  }
  directions[kJointAngle][kJointAngle] = 1;
  return directions;
}

}  // namespace sinew
