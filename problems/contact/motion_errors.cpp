#include "problems/contact/motion_errors.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
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
  SINEW_TRY(yaml.OnlyKeys({"position", "rotation", "joint", "correlation_time", "cutoff"}));
  MotionErrorSettings settings;
  SINEW_ASSIGN(settings.position, Positive(yaml, "position"));
  SINEW_ASSIGN(settings.rotation, Positive(yaml, "rotation"));
  SINEW_ASSIGN(settings.joint, Positive(yaml, "joint"));
  SINEW_ASSIGN(const auto correlation_time, Positive(yaml, "correlation_time"));
  SINEW_ASSIGN(const auto cutoff, Positive(yaml, "cutoff"));
  settings.correlation_time = correlation_time.value_or(settings.correlation_time);
  settings.cutoff = cutoff.value_or(settings.cutoff);
  constexpr double kHighest = 200;  // [Hz]: an hour of such curves would fill any memory
  if (settings.cutoff > kHighest)
    return FailAt(yaml.file(), yaml.line(), "cutoff: {} Hz, expected at most {}", settings.cutoff, kHighest);
  return settings;
}

MotionErrorBasis MotionErrorBasis::Make(const std::vector<double>& times, double correlation_time,
                                        double cutoff) {
  const double first = times.front();
  const double length = times.back() - first;
  const int intervals = std::max(1, static_cast<int>(std::ceil(2 * cutoff * length)));
  const double spacing = length / intervals;
  const int count = intervals + kOrder - 1;
  const auto rows = static_cast<Eigen::Index>(times.size());
  Matrix value = Matrix::Zero(rows, count);
  Matrix rate = Matrix::Zero(rows, count);
  for (Eigen::Index t = 0; t < rows; ++t) {
    const double at = (times[static_cast<std::size_t>(t)] - first) / spacing;
    const int interval = std::clamp(static_cast<int>(at), 0, intervals - 1);
    const LocalSplines local = SplinesAt(at - interval);
    for (int k = 0; k < kOrder; ++k) {
      value(t, interval + k) = local.value[static_cast<std::size_t>(k)];
      rate(t, interval + k) = local.slope[static_cast<std::size_t>(k)] / spacing;
    }
  }
  Matrix covariance(count, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double lag = std::sqrt(3.0) * spacing * std::abs(i - j) / correlation_time;
      covariance(i, j) = (1 + lag) * std::exp(-lag);
    }
  }
  const Matrix root = Eigen::LLT<Matrix>(covariance).matrixL();
  MotionErrorBasis basis{value * root, rate * root};
  // Splines smooth what their weights do; the curve's mean variance is to be 1.
  const double scale = std::sqrt(static_cast<double>(rows)) / basis.value.norm();
  basis.value *= scale;
  basis.rate *= scale;
  return basis;
}

PoseDeviation StanceMotionErrors::At(const Vector& parameters, int instant) const {
  PoseDeviation pose;
  Eigen::Index at = first;
  for (const int component : components) {
    const auto weights_of = parameters.segment(at, weights());
    const auto c = static_cast<std::size_t>(component);
    pose.value[c] = deviation[c] * basis.value.row(instant).dot(weights_of);
    pose.rate[c] = deviation[c] * basis.rate.row(instant).dot(weights_of);
    at += weights();
  }
  return pose;
}

std::vector<Parameter> StanceMotionErrors::Declare(const std::string& trial,
                                                   const std::string& stance) const {
  constexpr double kReach = 8;  // standard deviations
  std::vector<Parameter> declared;
  for (const int component : components) {
    const char* name = ToString(static_cast<PoseComponent>(component));
    for (int k = 0; k < weights(); ++k) {
      Parameter p = BaseParameter(fmt::format("{}[{}]@{}", name, k, stance), "1",
                                  "weight of a curve by which the foot's pose differs from the recorded one",
                                  -kReach, kReach, 0);
      p.kind = ParameterKind::kNuisance;
      p.trial = trial;
      p.prior = GaussianPrior{0, 1};
      declared.push_back(std::move(p));
    }
  }
  return declared;
}

}  // namespace sinew
