#include "identify/observation/sensor_effects.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "identify/observation/low_pass.h"
#include "identify/unmeasured_estimate.h"

namespace sinew {

// Scratch memory of one thread; vectors have the size of the longest block.
struct SensorEffects::SensorWorkspace final : Problem::Workspace {
  std::unique_ptr<Problem::Workspace> inner;
  Prediction prediction;
  Vector inner_parameters;
  std::vector<bool> inner_differentiate;
  LowPass low_pass;
  Vector spline;     // second derivatives
  Vector delayed;    // the signal after low-pass and time offset
  Vector slope;      // its time derivative
  Vector lag_slope;  // its derivative with respect to the low-pass
  Vector column;     // any other signal
  Vector unused;     // a time derivative that is not needed
  Vector later;      // change of the sums that are read later, and its derivative for the time offset
  Vector later_slope;
  Vector factor;      // d reading / d delayed
  Vector clip_slope;  // d observed / d saturation where it is clipped
  std::vector<bool> clipped;

  SensorWorkspace(const Problem& problem, Eigen::Index longest)
      : inner(problem.NewWorkspace()),
        prediction(problem.layout()),
        inner_parameters(static_cast<Eigen::Index>(problem.parameters().size())),
        inner_differentiate(problem.parameters().size()),
        spline(longest),
        delayed(longest),
        slope(longest),
        lag_slope(longest),
        column(longest),
        unused(longest),
        later(longest),
        later_slope(longest),
        factor(longest),
        clip_slope(longest),
        clipped(static_cast<std::size_t>(longest)) {}
};

// The sensor parameters of one block at one point, and the derivatives that are needed.
struct SensorEffects::Observation {
  double offset = 0;
  double drift = 0;
  double gain = 1;
  double delay = 0;
  double low_pass = 0;
  double saturation = 0;
  double quantisation = 0;
  double shared_gain = 1;
  double trial_gain = 1;
  bool want_slope = false;      // the slope is needed for the time offset
  bool want_lag_slope = false;  // for the low-pass
  bool any_clipped = false;

  Observation(const Query& query, int first, int first_of_trial) {
    const auto value = [&](int effect) { return query.parameters[first + effect]; };
    offset = value(kOffset);
    drift = value(kDrift);
    shared_gain = value(kGain);
    delay = value(kTimeOffset);
    low_pass = value(kLowPass);
    saturation = value(kSaturation);
    quantisation = value(kQuantisation);
    want_slope = query.Differentiates(first + kTimeOffset);
    want_lag_slope = query.Differentiates(first + kLowPass);
    if (first_of_trial >= 0) {
      offset += query.parameters[first_of_trial + kOffset];
      drift += query.parameters[first_of_trial + kDrift];
      trial_gain = query.parameters[first_of_trial + kGain];
      delay += query.parameters[first_of_trial + kTimeOffset];
      want_slope = want_slope || query.Differentiates(first_of_trial + kTimeOffset);
    }
    gain = shared_gain * trial_gain;
  }
};

SensorEffects::SensorEffects(std::unique_ptr<Problem> inner)
    : inner_(std::move(inner)),
      inner_parameters_(static_cast<Eigen::Index>(inner_->parameters().size())),
      parameters_(inner_->parameters()),
      effects_(inner_->effects()),
      ports_(inner_->ports()),
      layout_(inner_->layout()),
      observed_(layout_.size()) {
  for (std::size_t b = 0; b < layout_.size(); ++b) {
    observed_[b].of_inner = static_cast<Eigen::Index>(layout_[b].columns.size());
    longest_ = std::max<Eigen::Index>(longest_, layout_[b].predictions());
  }
  for (std::size_t b = 0; b < layout_.size(); ++b) {
    if (layout_[b].role != BlockRole::kPredicted && observed_[b].sensor < 0) AddSensor(layout_[b].channel);
  }
  for (Constraint constraint : inner_->constraints()) {
    const Eigen::Index old = constraint.coefficients.size();
    constraint.coefficients.conservativeResize(static_cast<Eigen::Index>(parameters_.size()));
    constraint.coefficients.tail(constraint.coefficients.size() - old).setZero();
    constraints_.push_back(std::move(constraint));
  }
}

void SensorEffects::AddSensor(const std::string& channel) {
  const ChannelSummary summary = Summarise(layout_, channel);
  Sensor sensor;
  sensor.first = AddSensorEffects(summary, parameters_, effects_);
  std::map<std::string, int> of_trial;
  if (summary.train_trials.size() > 1) {
    for (const std::string& trial : summary.train_trials) {
      of_trial[trial] = AddTrialEffects(summary, trial, parameters_, effects_);
    }
  }
  const ReadingPort port(*inner_, summary, parameters_);
  if (!port.terms().empty()) ports_.push_back(port.port());
  sensor.terms = port.terms();

  for (std::size_t b = 0; b < layout_.size(); ++b) {
    Block& block = layout_[b];
    if (block.channel != channel || block.role == BlockRole::kPredicted) continue;
    ObservedBlock& observed = observed_[b];
    observed.sensor = static_cast<int>(sensors_.size());
    observed.middle = 0.5 * (block.prediction_time.front() + block.prediction_time.back());
    observed.delay.emplace_back(block.prediction_time);
    for (int effect = 0; effect < kSensorEffects; ++effect) block.columns.push_back(sensor.first + effect);
    const auto alone = of_trial.find(block.trial);
    if (alone != of_trial.end()) {
      observed.first_of_trial = alone->second;
      for (int effect = 0; effect < kTrialEffects; ++effect) block.columns.push_back(alone->second + effect);
    }
    for (const ReadingPort::Term& term : sensor.terms) {
      for (std::size_t k = 0; k < term.knots.size(); ++k)
        block.columns.push_back(term.first_weight + static_cast<int>(k));
    }
  }
  sensors_.push_back(std::move(sensor));
}

std::unique_ptr<Problem::Workspace> SensorEffects::NewWorkspace() const {
  return std::make_unique<SensorWorkspace>(*inner_, longest_);
}

Query SensorEffects::InnerQuery(const Query& query, SensorWorkspace& scratch) const {
  scratch.inner_parameters = query.parameters.head(inner_parameters_);
  Query inner{scratch.inner_parameters, query.blocks, query.derivatives, nullptr};
  if (query.differentiate != nullptr) {
    std::copy_n(query.differentiate->begin(), inner_parameters_, scratch.inner_differentiate.begin());
    inner.differentiate = &scratch.inner_differentiate;
  }
  return inner;
}

Status SensorEffects::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<SensorWorkspace&>(workspace);
  SINEW_TRY(inner_->Predict(InnerQuery(query, scratch), *scratch.inner, scratch.prediction));
  ObserveAll(query, scratch, prediction);
  return {};
}

Result<bool> SensorEffects::PredictWithInputNoise(const Query& query, std::uint64_t draw,
                                                  Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<SensorWorkspace&>(workspace);
  SINEW_ASSIGN(const bool drawn, inner_->PredictWithInputNoise(InnerQuery(query, scratch), draw,
                                                               *scratch.inner, scratch.prediction));
  if (drawn) ObserveAll(query, scratch, prediction);
  return drawn;
}

// What the sensors read of the wrapped problem's prediction.
void SensorEffects::ObserveAll(const Query& query, SensorWorkspace& scratch, Prediction& observed) const {
  for (std::size_t b = 0; b < layout_.size(); ++b) {
    if (query.blocks[b]) Observe(query, static_cast<int>(b), scratch, observed);
  }
}

void SensorEffects::Observe(const Query& query, int b, SensorWorkspace& scratch, Prediction& observed) const {
  const ObservedBlock& block = observed_[static_cast<std::size_t>(b)];
  const Prediction& inner = scratch.prediction;
  auto values = observed.values(b);
  values = inner.values(b);
  auto derivatives = observed.derivatives(b);
  const auto& columns = layout_[static_cast<std::size_t>(b)].columns;
  for (Eigen::Index c = 0; c < block.of_inner; ++c) {
    if (query.Differentiates(columns[static_cast<std::size_t>(c)])) {
      derivatives.col(c) = inner.derivatives(b).col(c);
    }
  }
  if (block.sensor < 0) return;
  Observation o(query, sensors_[static_cast<std::size_t>(block.sensor)].first, block.first_of_trial);
  ObserveValues(query, b, o, scratch, values);
  if (query.derivatives) ObserveDerivatives(query, b, o, scratch, derivatives);
}

const std::vector<LaterReadings::Sum>& SensorEffects::LaterSums(int block) const {
  static const std::vector<LaterReadings::Sum> kNone;
  const auto& later = layout_[static_cast<std::size_t>(block)].later;
  return later ? later->sums() : kNone;
}

void SensorEffects::ReadLater(int b, double delay, SensorWorkspace& scratch) const {
  const auto& later = layout_[static_cast<std::size_t>(b)].later;
  if (!later) return;
  const auto sums = static_cast<Eigen::Index>(later->sums().size());
  later->At(delay, scratch.later.head(sums), scratch.later_slope.head(sums));
}

void SensorEffects::ObserveValues(const Query& query, int b, Observation& o, SensorWorkspace& scratch,
                                  Eigen::Ref<Vector> values) const {
  const ObservedBlock& block = observed_[static_cast<std::size_t>(b)];
  const auto& time = layout_[static_cast<std::size_t>(b)].prediction_time;
  const Eigen::Index n = values.size();

  auto lag_slope = scratch.lag_slope.head(n);
  if (o.low_pass > 0 || o.want_lag_slope) {
    scratch.low_pass.Set(time, o.low_pass);
    if (o.want_lag_slope) scratch.low_pass.Differentiate(values, lag_slope);
    if (o.low_pass > 0) scratch.low_pass.Apply(values);
  }
  if (o.delay != 0 || o.want_slope) {
    Delay(b, o.delay, scratch, values, scratch.slope.head(n));
    ReadLater(b, o.delay, scratch);
  }
  if (o.delay != 0 && o.want_lag_slope) Delay(b, o.delay, scratch, lag_slope, scratch.unused.head(n));
  const auto delayed = scratch.delayed.head(n);
  scratch.delayed.head(n) = values;

  if (o.gain != 1) values *= o.gain;
  if (o.offset != 0) values.array() += o.offset;
  if (o.drift != 0) {
    for (Eigen::Index i = 0; i < n; ++i)
      values[i] += o.drift * (time[static_cast<std::size_t>(i)] - block.middle);
  }
  if (o.delay != 0) {
    // What is read later has drifted further.
    Eigen::Index k = 0;
    for (const LaterReadings::Sum& sum : LaterSums(b))
      values[sum.prediction] += o.drift * o.delay - scratch.later[k++];
  }
  scratch.factor.head(n).setConstant(o.gain);
  for (const ReadingPort::Term& term : sensors_[static_cast<std::size_t>(block.sensor)].terms) {
    const auto weights =
        query.parameters.segment(term.first_weight, static_cast<Eigen::Index>(term.knots.size()));
    if ((weights.array() == 0).all()) continue;
    for (Eigen::Index i = 0; i < n; ++i) {
      const LinearBasis basis = term.At(b, i, delayed[i]);
      const double left = weights[basis.first];
      const double right = basis.right != 0 ? weights[basis.first + 1] : 0;
      values[i] += basis.left * left + basis.right * right;
      if (term.of_reading) scratch.factor[i] += basis.left_slope * (left - right);
    }
  }

  if (o.saturation > 0) {
    const double limit = 1 / o.saturation;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool clips = std::abs(values[i]) > limit;
      scratch.clipped[static_cast<std::size_t>(i)] = clips;
      if (!clips) continue;
      o.any_clipped = true;
      values[i] = std::copysign(limit, values[i]);
      scratch.clip_slope[i] = -values[i] * limit;
    }
  }
  if (o.quantisation > 0) {
    for (double& value : values) value = o.quantisation * std::round(value / o.quantisation);
  }
}

void SensorEffects::Delay(int b, double delay, SensorWorkspace& scratch, Eigen::Ref<Vector> signal,
                          Eigen::Ref<Vector> slope) const {
  const DelayLine& line = observed_[static_cast<std::size_t>(b)].delay.front();
  auto spline = scratch.spline.head(signal.size());
  auto delayed = scratch.column.head(signal.size());
  line.Fit(signal, spline);
  line.Evaluate(delay, signal, spline, delayed, slope);
  if (delay == 0) return;
  for (const LaterReadings::Sum& sum : LaterSums(b)) delayed[sum.prediction] = signal[sum.prediction];
  signal = delayed;
}

void SensorEffects::ObserveDerivatives(const Query& query, int b, const Observation& o,
                                       SensorWorkspace& scratch, Eigen::Ref<Matrix> derivatives) const {
  const ObservedBlock& block = observed_[static_cast<std::size_t>(b)];
  const Sensor& sensor = sensors_[static_cast<std::size_t>(block.sensor)];
  const Block& in_layout = layout_[static_cast<std::size_t>(b)];
  const auto& time = in_layout.prediction_time;
  const Eigen::Index n = derivatives.rows();
  const auto factor = scratch.factor.head(n).array();

  for (Eigen::Index c = 0; c < block.of_inner; ++c) {
    if (!query.Differentiates(in_layout.columns[static_cast<std::size_t>(c)])) continue;
    auto column = derivatives.col(c);
    if (o.low_pass > 0) scratch.low_pass.Apply(column);
    if (o.delay != 0) Delay(b, o.delay, scratch, column, scratch.unused.head(n));
    column.array() *= factor;
  }

  const std::vector<LaterReadings::Sum>& later = LaterSums(b);
  Eigen::Index c = block.of_inner;
  const auto sensor_column = [&](int effect) {
    auto column = derivatives.col(c);
    switch (effect) {
      case kOffset:
        column.setOnes();
        break;
      case kDrift:
        for (Eigen::Index i = 0; i < n; ++i) column[i] = time[static_cast<std::size_t>(i)] - block.middle;
        for (const LaterReadings::Sum& sum : later) column[sum.prediction] += o.delay;
        break;
      case kGain:
        column = scratch.delayed.head(n);
        break;
      case kTimeOffset:
        column.array() = -factor * scratch.slope.head(n).array();
        for (std::size_t k = 0; k < later.size(); ++k)
          column[later[k].prediction] = o.drift - scratch.later_slope[static_cast<Eigen::Index>(k)];
        break;
      case kLowPass:
        column.array() = factor * scratch.lag_slope.head(n).array();
        break;
      default:  // saturation changes only clipped samples; for quantisation see the class
        column.setZero();
        break;
    }
  };
  for (int effect = 0; effect < kSensorEffects; ++effect, ++c) {
    if (!query.Differentiates(sensor.first + effect)) continue;
    sensor_column(effect);
    if (effect == kGain) derivatives.col(c) *= o.trial_gain;
  }
  for (int effect = 0; block.first_of_trial >= 0 && effect < kTrialEffects; ++effect, ++c) {
    if (!query.Differentiates(block.first_of_trial + effect)) continue;
    sensor_column(effect);
    if (effect == kGain) derivatives.col(c) *= o.shared_gain;
  }
  for (const ReadingPort::Term& term : sensor.terms) {
    const auto knots = static_cast<int>(term.knots.size());
    for (int k = 0; k < knots; ++k, ++c) {
      if (!query.Differentiates(term.first_weight + k)) continue;
      for (Eigen::Index i = 0; i < n; ++i) {
        const LinearBasis basis = term.At(b, i, scratch.delayed[i]);
        derivatives(i, c) = basis.first == k ? basis.left : (basis.first + 1 == k ? basis.right : 0);
      }
    }
  }

  if (!o.any_clipped) return;
  for (std::size_t j = 0; j < in_layout.columns.size(); ++j) {
    const int parameter = in_layout.columns[j];
    if (!query.Differentiates(parameter)) continue;
    auto column = derivatives.col(static_cast<Eigen::Index>(j));
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!scratch.clipped[static_cast<std::size_t>(i)]) continue;
      column[i] = parameter == sensor.first + kSaturation ? scratch.clip_slope[i] : 0;
    }
  }
}

std::optional<Vector> SensorEffects::ImprovedStart(const std::vector<int>& free,
                                                   const std::vector<bool>& compared,
                                                   const Vector& parameters) const {
  const auto own = std::lower_bound(free.begin(), free.end(), static_cast<int>(inner_parameters_));
  const auto improved =
      inner_->ImprovedStart({free.begin(), own}, compared, parameters.head(inner_parameters_));
  if (!improved) return {};
  Vector all = parameters;
  all.head(inner_parameters_) = *improved;
  return all;
}

std::vector<AlternativePrediction> SensorEffects::Alternatives(const Vector& parameters) const {
  auto alternatives = inner_->Alternatives(parameters.head(inner_parameters_));
  for (AlternativePrediction& alternative : alternatives) {
    if (alternative.parameters.size() == 0) continue;
    Vector all = parameters;
    all.head(inner_parameters_) = alternative.parameters;
    alternative.parameters = std::move(all);
  }
  return alternatives;
}

Vector SensorEffects::AtPriors(const Vector& parameters, const Vector& priors, CarryOver how) const {
  Vector all = parameters;
  all.head(inner_parameters_) =
      inner_->AtPriors(parameters.head(inner_parameters_), priors.head(inner_parameters_), how);
  return all;
}

std::optional<UnmeasuredEstimate> SensorEffects::EstimateUnmeasured(const Vector& parameters) const {
  auto estimate = inner_->EstimateUnmeasured(parameters.head(inner_parameters_));
  if (!estimate) return {};
  Vector all = parameters;
  all.head(inner_parameters_) = estimate->parameters;
  estimate->parameters = std::move(all);
  return estimate;
}

Status SensorEffects::WriteDetails(const Vector& parameters, Hdf5Node& details) const {
  return inner_->WriteDetails(parameters.head(inner_parameters_), details);
}

}  // namespace sinew
