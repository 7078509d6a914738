#include "problems/declaration/declared_problem.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <set>

#include "base/text.h"

namespace sinew {
namespace {

std::vector<std::string> ChannelsOf(const Dataset& data) {
  std::set<std::string> names;
  for (const auto& [name, trial] : data.trials) {
    for (const std::string& channel : trial.ChannelNames()) names.insert(channel);
  }
  return {names.begin(), names.end()};
}

bool IsGap(double value) {
  return !std::isfinite(value);
}

// Sum of squares about the mean of the block itself.
double Deviations(const Block& block) {
  const Eigen::Map<const Vector> measured(block.measured.data(), block.samples());
  return (measured.array() - measured.mean()).square().sum();
}

}  // namespace

DeclaredProblem::DeclaredProblem(const Dataset& data) : data_(data) {
  for (const auto& [name, trial] : data_.trials) {
    DeclaredTrial declared;
    declared.name = name;
    trials_.push_back(std::move(declared));
  }
  if (trials_.empty()) Complain("the data set has no trial");
}

void DeclaredProblem::Complain(std::string what) {
  if (complaint_.empty()) complaint_ = std::move(what);
}

int DeclaredProblem::AddSlot(Parameter parameter, bool per_trial) {
  const int slot = static_cast<int>(bounded_.size());
  bounded_.push_back(false);
  started_.push_back(false);
  parameter.meaning = parameter.name;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    if (per_trial || t == 0) {
      Parameter p = parameter;
      if (per_trial) {
        p.name += "@" + trials_[t].name;
        p.trial = trials_[t].name;
      }
      parameters_.push_back(std::move(p));
    }
    trials_[t].parameter_of.push_back(static_cast<int>(parameters_.size()) - 1);
  }
  UpdateColumns();
  return slot;
}

int DeclaredProblem::AddTrialSlot(Parameter parameter, std::size_t trial) {
  const int slot = static_cast<int>(bounded_.size());
  bounded_.push_back(true);
  started_.push_back(true);
  parameter.name += "@" + trials_[trial].name;
  parameter.trial = trials_[trial].name;
  parameters_.push_back(std::move(parameter));
  for (DeclaredTrial& other : trials_) other.parameter_of.push_back(-1);
  trials_[trial].parameter_of.back() = static_cast<int>(parameters_.size()) - 1;
  UpdateColumns();
  return slot;
}

void DeclaredProblem::SetStart(int index, double start) {
  Parameter& p = parameters_[static_cast<std::size_t>(index)];
  p.start = std::clamp(start, p.lower, p.upper);
}

const std::string& DeclaredProblem::UnitOf(int slot) const {
  const int index = trials_.front().parameter_of[static_cast<std::size_t>(slot)];
  return parameters_[static_cast<std::size_t>(index)].unit;
}

ParameterBuilder DeclaredProblem::parameter(const std::string& name, const std::string& unit) {
  Parameter p;
  p.name = name;
  p.unit = unit;
  return {*this, AddSlot(std::move(p), false)};
}

ParameterBuilder DeclaredProblem::per_trial(const std::string& name, const std::string& unit) {
  Parameter p;
  p.name = name;
  p.unit = unit;
  p.kind = ParameterKind::kNuisance;
  return {*this, AddSlot(std::move(p), true)};
}

EffectBuilder DeclaredProblem::effect(const std::string& name, Level level) {
  for (const Effect& known : effects_) {
    if (known.name == name) Complain(fmt::format("effect '{}' is declared twice", name));
  }
  Effect added;
  added.name = name;
  added.level = level;
  effects_.push_back(std::move(added));
  return {*this, static_cast<int>(effects_.size()) - 1};
}

EffectBuilder DeclaredProblem::effect(const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    if (effects_[e].name == name) return {*this, static_cast<int>(e)};
    names.push_back(effects_[e].name);
  }
  Complain(fmt::format("effect '{}' was not declared before: expected effect(name, level) first{}", name,
                       names.empty() ? "" : Suggestion(name, names)));
  return effect(name, Level::kBoundary);
}

ParameterBuilder DeclaredProblem::AddEffectParameter(int effect, const std::string& name,
                                                     const std::string& unit) {
  Effect& of = effects_[static_cast<std::size_t>(effect)];
  Parameter p;
  p.name = name;
  p.unit = unit;
  p.kind = ParameterKind::kEffect;
  p.effect = of.name;
  const int slot = AddSlot(std::move(p), false);
  MarkStarted(slot);
  if (!trials_.empty()) of.parameters.push_back(trials_.front().parameter_of.back());
  return {*this, slot};
}

InputHandle DeclaredProblem::input(const std::string& channel, const std::string& unit) {
  InputHandle handle;
  for (DeclaredTrial& trial : trials_) {
    const auto found = data_.trials.at(trial.name).Find(channel);
    SampledInput sampled;
    if (!found) {
      Complain(fmt::format("trial '{}' has no channel '{}', which is an input of the model{}", trial.name,
                           channel, Suggestion(channel, ChannelsOf(data_))));
    } else if (found.channel->unit != unit) {
      Complain(fmt::format("trial '{}': input '{}' is in '{}', expected '{}'", trial.name, channel,
                           found.channel->unit, unit));
    } else {
      sampled.time = found.grid->time;
      sampled.values = found.channel->values;
      const auto gap = std::find_if(sampled.values.begin(), sampled.values.end(), IsGap);
      if (gap != sampled.values.end()) {
        const auto at = static_cast<std::size_t>(gap - sampled.values.begin());
        Complain(
            fmt::format("trial '{}': input '{}' has a gap at t = {:.6g} s; expected a value at every time "
                        "(sinew data cut takes a part without gaps)",
                        trial.name, channel, sampled.time[at]));
      }
    }
    if (sampled.time.empty()) sampled = {{0}, {0}};
    handle.index = static_cast<int>(trial.inputs.size());
    trial.inputs.push_back(std::move(sampled));
  }
  return handle;
}

ConditionHandle DeclaredProblem::condition(const std::string& name) {
  ConditionHandle handle;
  for (DeclaredTrial& trial : trials_) {
    const auto& conditions = data_.trials.at(trial.name).conditions;
    const auto found = conditions.find(name);
    if (found == conditions.end())
      Complain(fmt::format("trial '{}' has no condition '{}'", trial.name, name));
    handle.index = static_cast<int>(trial.conditions.size());
    trial.conditions.push_back(found == conditions.end() ? 0 : found->second);
  }
  return handle;
}

double DeclaredProblem::constant(const std::string& name) {
  const auto found = data_.constants.find(name);
  if (found != data_.constants.end()) return found->second.value;
  std::vector<std::string> names;
  for (const auto& [known, value] : data_.constants) names.push_back(known);
  Complain(
      fmt::format("the data set has no constant '{}'{}", name, names.empty() ? "" : Suggestion(name, names)));
  return 0;
}

int DeclaredProblem::AddChannel(const std::string& channel, const std::string& unit) {
  const int observation = static_cast<int>(channels_.size());
  if (std::find(channels_.begin(), channels_.end(), channel) != channels_.end())
    Complain(fmt::format("channel '{}' is observed twice", channel));
  channels_.push_back(channel);
  bool measured = false;
  for (DeclaredTrial& trial : trials_) {
    const Trial& of = data_.trials.at(trial.name);
    const auto found = of.Find(channel);
    if (!found) continue;
    if (found.channel->kind == ChannelKind::kInput) {
      Complain(
          fmt::format("trial '{}': channel '{}' is an input, expected a measured one", trial.name, channel));
    }
    if (!unit.empty() && found.channel->unit != unit) {
      Complain(fmt::format("trial '{}': channel '{}' is in '{}', expected '{}'", trial.name, channel,
                           found.channel->unit, unit));
    }
    Block block;
    block.trial = trial.name;
    block.channel = channel;
    block.unit = found.channel->unit;
    block.role = of.role == Role::kTrain ? BlockRole::kTrain : BlockRole::kValidate;
    block.prediction_time = found.grid->time;
    block.sigma = found.channel->sigma;
    for (std::size_t i = 0; i < found.channel->values.size(); ++i) {
      if (IsGap(found.channel->values[i])) continue;
      block.sample.push_back(static_cast<int>(i));
      block.measured.push_back(found.channel->values[i]);
    }
    if (block.measured.empty()) continue;
    measured = true;
    trial.blocks.push_back(static_cast<int>(layout_.size()));
    layout_.push_back(std::move(block));
    observation_of_.push_back(observation);
  }
  if (!measured) {
    Complain(
        fmt::format("no trial measures the channel '{}'{}", channel, Suggestion(channel, ChannelsOf(data_))));
  }
  UpdateColumns();
  UpdateWeights();
  return observation;
}

void DeclaredProblem::UpdateColumns() {
  for (DeclaredTrial& trial : trials_) {
    std::vector<int> columns = trial.parameter_of;
    std::sort(columns.begin(), columns.end());
    columns.erase(columns.begin(), std::upper_bound(columns.begin(), columns.end(), -1));
    trial.column_of.clear();
    for (const int index : trial.parameter_of) {
      const auto at = std::lower_bound(columns.begin(), columns.end(), index);
      trial.column_of.push_back(static_cast<int>(at - columns.begin()));
    }
    for (const int b : trial.blocks) layout_[static_cast<std::size_t>(b)].columns = columns;
  }
}

void DeclaredProblem::UpdateWeights() {
  for (Block& block : layout_) {
    bool all_sigma = block.sigma.has_value();
    double squares = 0;
    double samples = 0;
    for (const Block& other : layout_) {
      if (other.channel != block.channel || (other.role != BlockRole::kTrain && &other != &block)) continue;
      all_sigma = all_sigma && other.sigma;
      squares += Deviations(other);
      samples += other.samples();
    }
    const double deviation = std::sqrt(squares / samples);
    block.weight = all_sigma ? 1 / *block.sigma : deviation > 0 ? 1 / deviation : 1;
  }
}

std::vector<Problem::Signal> DeclaredProblem::ResidualCovariates(int b) const {
  const Block& block = layout_[static_cast<std::size_t>(b)];
  const Trial& trial = data_.trials.at(block.trial);
  std::vector<Signal> signals;
  for (const std::string& name : trial.ChannelNames()) {
    const auto found = trial.Find(name);
    SampledInput known;
    for (std::size_t i = 0; i < found.grid->time.size(); ++i) {
      if (IsGap(found.channel->values[i])) continue;
      known.time.push_back(found.grid->time[i]);
      known.values.push_back(found.channel->values[i]);
    }
    if (known.time.empty()) continue;
    Signal signal{name, found.channel->unit, {}};
    for (const int i : block.sample)
      signal.values.push_back(known.At(block.prediction_time[static_cast<std::size_t>(i)]));
    signals.push_back(std::move(signal));
  }
  return signals;
}

Status DeclaredProblem::CheckDeclaration() const {
  if (!complaint_.empty()) return Fail("{}", complaint_);
  for (std::size_t slot = 0; slot < bounded_.size(); ++slot) {
    if (bounded_[slot] && started_[slot]) continue;
    const int index = trials_.front().parameter_of[slot];
    const std::string& name = parameters_[static_cast<std::size_t>(index)].name;
    if (!bounded_[slot]) return Fail("parameter '{}' has no bounds: expected .bounds(lower, upper)", name);
    if (!started_[slot]) return Fail("parameter '{}' has no start: expected .start(value)", name);
  }
  if (layout_.empty()) return Fail("the model observes no channel: expected observe(channel, ...)");
  return {};
}

bool DeclaredProblem::Wants(const Query& query, const DeclaredTrial& trial) const {
  return std::any_of(trial.blocks.begin(), trial.blocks.end(),
                     [&](int b) { return query.blocks[static_cast<std::size_t>(b)]; });
}

Error DeclaredProblem::Failure(const Query& query, const DeclaredTrial& trial,
                               const std::string& what) const {
  std::string with;
  for (const int index : trial.parameter_of) {
    if (index < 0) continue;
    const Parameter& p = parameters_[static_cast<std::size_t>(index)];
    const double value = query.parameters[index];
    if (p.kind == ParameterKind::kEffect && value == p.null_value) continue;
    with += fmt::format("{}{} = {:.6g}", with.empty() ? "" : ", ", p.name, value);
  }
  return {fmt::format("trial '{}': {}; with {}", trial.name, what, with)};
}

Status DeclaredProblem::Guarded(const Query& query, const DeclaredTrial& trial,
                                const std::function<Status()>& run) const {
  try {
    const Status status = run();
    if (!status) return tl::unexpected(Failure(query, trial, status.error().message));
  } catch (const std::exception& exception) {
    return tl::unexpected(Failure(query, trial, "the model threw: " + OneLine(exception.what())));
  }
  return {};
}

Status DeclaredProblem::Finite(const Query& query, const DeclaredTrial& trial,
                               const Prediction& prediction) const {
  for (const int b : trial.blocks) {
    if (!query.blocks[static_cast<std::size_t>(b)]) continue;
    const auto values = prediction.values(b);
    if (values.allFinite()) continue;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (std::isfinite(values[i])) continue;
      const Block& block = layout_[static_cast<std::size_t>(b)];
      return tl::unexpected(Failure(
          query, trial,
          fmt::format("channel '{}', sample {} (t = {:.6g} s): the model's value is {}", block.channel, i,
                      block.prediction_time[static_cast<std::size_t>(i)], values[i])));
    }
  }
  return {};
}

Status DeclaredProblem::FiniteDerivatives(const Query& query, const DeclaredTrial& trial, int slot,
                                          const Prediction& prediction) const {
  const auto s = static_cast<std::size_t>(slot);
  for (const int b : trial.blocks) {
    if (!query.blocks[static_cast<std::size_t>(b)]) continue;
    const auto column = prediction.derivatives(b).col(trial.column_of[s]);
    if (column.allFinite()) continue;
    for (Eigen::Index i = 0; i < column.size(); ++i) {
      if (std::isfinite(column[i])) continue;
      const Block& block = layout_[static_cast<std::size_t>(b)];
      return tl::unexpected(
          Failure(query, trial,
                  fmt::format("channel '{}', sample {} (t = {:.6g} s): the derivative by '{}' is {}",
                              block.channel, i, block.prediction_time[static_cast<std::size_t>(i)],
                              parameters_[static_cast<std::size_t>(trial.parameter_of[s])].name, column[i])));
    }
  }
  return {};
}

}  // namespace sinew
