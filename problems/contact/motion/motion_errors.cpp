#include "problems/contact/motion/motion_errors.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"

namespace sinew {
namespace {

constexpr int kOrder = 4;  // cubic

// Values and slopes of the four cubic B-splines that are not zero at u in [0, 1] between two knots, over
// knots one apart.
struct LocalSplines {
  std::array<double, kOrder> value;
  std::array<double, kOrder> slope;
};

LocalSplines SplinesAt(double u) {
  const double v = 1 - u;
  return {{v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6,
           u * u * u / 6},
          {-v * v / 2, (9 * u * u - 12 * u) / 6, -(9 * v * v - 12 * v) / 6, u * u / 2}};
}

// Between equidistant knots half a period of the cutoff apart.
int Intervals(double length, double cutoff) {
  return std::max(1, static_cast<int>(std::ceil(2 * cutoff * length - 1e-9)));
}

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
  SINEW_TRY(yaml.OnlyKeys({"position", "rotation", "joint", "between_steps", "correlation_time", "cutoff"}));
  MotionErrorSettings settings;
  SINEW_ASSIGN(settings.position, Positive(yaml, "position"));
  SINEW_ASSIGN(settings.rotation, Positive(yaml, "rotation"));
  SINEW_ASSIGN(settings.joint, Positive(yaml, "joint"));
  SINEW_ASSIGN(const auto correlation_time, Positive(yaml, "correlation_time"));
  SINEW_ASSIGN(const auto cutoff, Positive(yaml, "cutoff"));
  SINEW_ASSIGN(const auto between_steps, Positive(yaml, "between_steps"));
  settings.between_steps = between_steps.value_or(settings.between_steps);
  settings.correlation_time = correlation_time.value_or(settings.correlation_time);
  settings.cutoff = cutoff.value_or(settings.cutoff);
  constexpr double kHighest = 200;  // [Hz]: an hour of such curves would fill any memory
  if (settings.cutoff > kHighest)
    return FailAt(yaml.file(), yaml.line(), "cutoff: {} Hz, expected at most {}", settings.cutoff, kHighest);
  return settings;
}

MotionErrorBasis MotionErrorBasis::Splines(const std::vector<double>& times, double from, double to,
                                           double cutoff, double stretch) {
  const int intervals = Intervals(to - from, cutoff);
  const double spacing = (to - from) / intervals;
  const auto rows = static_cast<Eigen::Index>(times.size());
  MotionErrorBasis basis{Matrix::Zero(rows, intervals + kOrder - 1),
                         Matrix::Zero(rows, intervals + kOrder - 1)};
  for (Eigen::Index t = 0; t < rows; ++t) {
    const double time = times[static_cast<std::size_t>(t)];
    const double at = std::clamp((time - from) / spacing, 0.0, static_cast<double>(intervals));
    const int interval = std::min(static_cast<int>(at), intervals - 1);
    const LocalSplines local = SplinesAt(at - interval);
    const bool inside = time >= from && time <= to;
    for (int k = 0; k < kOrder; ++k) {
      basis.value(t, interval + k) = local.value[static_cast<std::size_t>(k)];
      if (inside) basis.rate(t, interval + k) = stretch * local.slope[static_cast<std::size_t>(k)] / spacing;
    }
  }
  return basis;
}

MotionErrorBasis MotionErrorBasis::Make(const std::vector<double>& times, double from, double to,
                                        double correlation_time, double cutoff, double stretch) {
  const int intervals = Intervals(to - from, cutoff);
  const double spacing = (to - from) / intervals;
  const int count = intervals + kOrder - 1;
  Matrix covariance(count, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double lag = std::sqrt(3.0) * spacing * std::abs(i - j) / correlation_time;
      covariance(i, j) = (1 + lag) * std::exp(-lag);
    }
  }
  const Matrix root = Eigen::LLT<Matrix>(covariance).matrixL();
  // Splines smooth what their weights do; the curve's mean variance is to be 1.
  constexpr int kGrid = 200;
  std::vector<double> grid;
  for (int i = 0; i < kGrid; ++i) grid.push_back(from + (i + 0.5) * (to - from) / kGrid);
  const double scale =
      std::sqrt(static_cast<double>(kGrid)) / (Splines(grid, from, to, cutoff).value * root).norm();
  MotionErrorBasis basis = Splines(times, from, to, cutoff, stretch);
  basis.value = scale * basis.value * root;
  basis.rate = scale * basis.rate * root;
  return basis;
}

std::vector<int> StanceMotionErrors::Columns() const {
  std::vector<int> columns;
  for (const PoseTerm& term : terms) {
    for (int k = 0; k < term.weights(); ++k) columns.push_back(term.first + k);
  }
  return columns;
}

int StanceMotionErrors::weights() const {
  int count = 0;
  for (const PoseTerm& term : terms) count += term.weights();
  return count;
}

std::array<int, 2> StanceMotionErrors::OwnRange() const {
  if (terms.empty()) return {0, 0};
  const PoseTerm& last = terms.back();
  return {terms[static_cast<std::size_t>(own)].first, last.first + last.weights()};
}

PoseDeviation StanceMotionErrors::At(const Vector& parameters, int instant) const {
  PoseDeviation pose;
  Eigen::Map<Eigen::Matrix<double, kPoseComponents, 1>> value(pose.value.data());
  Eigen::Map<Eigen::Matrix<double, kPoseComponents, 1>> rate(pose.rate.data());
  for (const PoseTerm& term : terms) {
    const auto weights_of = parameters.segment(term.first, term.weights());
    value += term.basis.value.row(instant).dot(weights_of) * term.direction;
    rate += term.basis.rate.row(instant).dot(weights_of) * term.direction;
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
