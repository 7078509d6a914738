#include "identify/observation/sensor_effects.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/spline.h"

namespace sinew {
namespace {

struct SensorWorkspace final : Problem::Workspace {
  std::unique_ptr<Problem::Workspace> inner;
  Prediction prediction;
  explicit SensorWorkspace(const Problem& problem)
      : inner(problem.NewWorkspace()), prediction(problem.layout()) {}
};

// Largest magnitude and longest duration over the blocks of a channel: the bounds of its offset and drift.
struct Extent {
  double magnitude = 0;
  double duration = 0;
};

Extent ExtentOf(const Layout& layout, const std::string& channel) {
  Extent extent;
  for (const Block& block : layout) {
    if (block.channel != channel) continue;
    for (const double value : block.measured) extent.magnitude = std::max(extent.magnitude, std::abs(value));
    extent.duration = std::max(extent.duration, block.prediction_time.back() - block.prediction_time.front());
  }
  if (extent.magnitude == 0) extent.magnitude = 1;
  if (extent.duration == 0) extent.duration = 1;
  return extent;
}

// A column at t - delay, and its time derivative there.
struct Delayed {
  Vector value;
  Vector slope;
};

Result<Delayed> Delay(const std::vector<double>& time, const Eigen::Ref<const Vector>& column, double delay) {
  SINEW_ASSIGN(
      const auto spline,
      NaturalCubicSpline::Fit(time, std::vector<double>(column.data(), column.data() + column.size())));
  Delayed delayed{Vector(column.size()), Vector(column.size())};
  for (Eigen::Index i = 0; i < column.size(); ++i) {
    const auto at = spline.At(time[static_cast<std::size_t>(i)] - delay);
    delayed.value[i] = at.value;
    delayed.slope[i] = at.first;
  }
  return delayed;
}

}  // namespace

SensorEffects::SensorEffects(std::unique_ptr<Problem> inner)
    : inner_(std::move(inner)),
      inner_parameters_(static_cast<Eigen::Index>(inner_->parameters().size())),
      parameters_(inner_->parameters()),
      effects_(inner_->effects()),
      layout_(inner_->layout()) {
  std::map<std::string, int> sensor_of_channel;
  for (const Block& block : layout_) {
    const bool compared = block.role != BlockRole::kPredicted;
    if (compared && sensor_of_channel.count(block.channel) == 0) {
      sensor_of_channel[block.channel] = static_cast<int>(sensors_.size());
      AddSensor(block.channel);
    }
  }
  for (Block& block : layout_) {
    const auto found = sensor_of_channel.find(block.channel);
    sensor_of_.push_back(
        found == sensor_of_channel.end() || block.role == BlockRole::kPredicted ? -1 : found->second);
    if (sensor_of_.back() < 0) continue;
    const Sensor& sensor = sensors_[static_cast<std::size_t>(sensor_of_.back())];
    block.columns.insert(block.columns.end(), {sensor.offset, sensor.drift, sensor.gain, sensor.time_offset});
  }
  for (Constraint constraint : inner_->constraints()) {
    const Eigen::Index old = constraint.coefficients.size();
    constraint.coefficients.conservativeResize(static_cast<Eigen::Index>(parameters_.size()));
    constraint.coefficients.tail(constraint.coefficients.size() - old).setZero();
    constraints_.push_back(std::move(constraint));
  }
}

void SensorEffects::AddSensor(const std::string& channel) {
  const auto block =
      std::find_if(layout_.begin(), layout_.end(), [&](const Block& b) { return b.channel == channel; });
  const std::string& unit = block->unit;
  const Extent extent = ExtentOf(layout_, channel);
  const auto add = [&](const std::string& kind, const std::string& of_unit, double reach, double null,
                       const std::string& says, const std::string& exposed_by) {
    Parameter p;
    p.name = channel + "." + kind;
    p.unit = of_unit;
    p.meaning = says;
    p.lower = null - reach;
    p.upper = null + reach;
    p.start = null;
    p.null_value = null;
    p.kind = ParameterKind::kEffect;
    p.effect = p.name;
    const int index = static_cast<int>(parameters_.size());
    effects_.push_back({p.name, Level::kSensor, channel + ": " + says, exposed_by, {index}});
    parameters_.push_back(std::move(p));
    return index;
  };
  Sensor sensor;
  sensor.offset = add("offset", unit, extent.magnitude, 0, "the sensor reads too much by a constant",
                      "a rest phase, where the true value is known");
  sensor.drift =
      add("drift", unit + "/s", extent.magnitude / extent.duration, 0,
          "the sensor's reading drifts with time", "rest phases at the begin and at the end of a long trial");
  sensor.gain =
      add("gain", "1", 0.9, 1, "the sensor reads too much by a factor", "a known load on the sensor");
  sensor.time_offset =
      add("time_offset", "s", 0.1, 0, "the sensor's clock is late against the other instruments",
          "one sharp event that all instruments see, at a high sampling rate");
  sensors_.push_back(sensor);
}

std::unique_ptr<Problem::Workspace> SensorEffects::NewWorkspace() const {
  return std::make_unique<SensorWorkspace>(*inner_);
}

Status SensorEffects::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<SensorWorkspace&>(workspace);
  const Vector inner_parameters = query.parameters.head(inner_parameters_);
  SINEW_TRY(inner_->Predict({inner_parameters, query.blocks, query.derivatives, query.unknown_term},
                            *scratch.inner, scratch.prediction));
  for (std::size_t b = 0; b < layout_.size(); ++b) {
    if (!query.blocks[b]) continue;
    const int block = static_cast<int>(b);
    if (sensor_of_[b] >= 0) {
      SINEW_TRY(Observe(query, block, sensors_[static_cast<std::size_t>(sensor_of_[b])], scratch.prediction,
                        prediction));
      continue;
    }
    prediction.values(block) = scratch.prediction.values(block);
    if (query.derivatives) prediction.derivatives(block) = scratch.prediction.derivatives(block);
  }
  return {};
}

Status SensorEffects::Observe(const Query& query, int b, const Sensor& sensor, const Prediction& inner,
                              Prediction& observed) const {
  const Block& block = layout_[static_cast<std::size_t>(b)];
  const double offset = query.parameters[sensor.offset];
  const double drift = query.parameters[sensor.drift];
  const double gain = query.parameters[sensor.gain];
  const double delay = query.parameters[sensor.time_offset];
  const auto& time = block.prediction_time;
  const double middle = 0.5 * (time.front() + time.back());

  auto values = observed.values(b);
  values = inner.values(b);
  Vector slope;
  if (delay != 0 || (query.derivatives && time.size() > 1)) {
    SINEW_ASSIGN(Delayed delayed, Delay(time, inner.values(b), delay));
    slope = std::move(delayed.slope);
    if (delay != 0) values = delayed.value;
  }
  const Vector undistorted = values;
  if (gain != 1) values *= gain;
  if (offset != 0) values.array() += offset;
  if (drift != 0) {
    for (Eigen::Index i = 0; i < values.size(); ++i)
      values[i] += drift * (time[static_cast<std::size_t>(i)] - middle);
  }
  if (!query.derivatives) return {};

  const auto inner_derivatives = inner.derivatives(b);
  auto derivatives = observed.derivatives(b);
  const Eigen::Index inner_columns = inner_derivatives.cols();
  derivatives.leftCols(inner_columns) = inner_derivatives;
  for (Eigen::Index c = 0; delay != 0 && c < inner_columns; ++c) {
    SINEW_ASSIGN(const Delayed delayed, Delay(time, inner_derivatives.col(c), delay));
    derivatives.col(c) = delayed.value;
  }
  if (gain != 1) derivatives.leftCols(inner_columns) *= gain;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    derivatives(i, inner_columns) = 1;
    derivatives(i, inner_columns + 1) = time[static_cast<std::size_t>(i)] - middle;
    derivatives(i, inner_columns + 2) = undistorted[i];
    derivatives(i, inner_columns + 3) = slope.size() > 0 ? -gain * slope[i] : 0;
  }
  return {};
}

Status SensorEffects::Describe(const Vector& parameters, Hdf5Node& details) const {
  return inner_->Describe(parameters.head(inner_parameters_), details);
}

}  // namespace sinew
