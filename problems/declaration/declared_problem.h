// A problem that declares itself in its constructor: parameters, effects, inputs and the channels that it
// predicts. The data set has trials, roles, times, measured values and noise; OdeProblem and
// AutoDiffProblem add the physics.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/dual.h"
#include "base/error.h"
#include "datasets/dataset.h"
#include "identify/problem.h"
#include "problems/declaration/builders.h"
#include "problems/declaration/values.h"

namespace sinew {

/// One trial of a declared problem.
struct DeclaredTrial {
  std::string name;
  std::vector<int> parameter_of;     ///< [slots] index into Problem::parameters(); -1: of another trial alone
  std::vector<int> column_of;        ///< [slots] column of every block of this trial
  std::vector<SampledInput> inputs;  ///< by InputHandle
  std::vector<double> conditions;    ///< by ConditionHandle
  std::vector<int> blocks;           ///< of the layout
};

/// The base of OdeProblem and AutoDiffProblem. Trials are those of the data set that measure at least one
/// observed channel; a gap (NaN) of a measured channel is left out of the comparison. The weight of a block
/// is the inverse of its noise level if the data state one for every training trial of the channel, else of
/// the channel's standard deviation.
///
/// Whatever is wrong with a declaration (a channel that no trial has, a parameter without bounds) is kept and
/// returned by CheckDeclaration and by every Predict.
class DeclaredProblem : public Problem {
 public:
  [[nodiscard]] const std::vector<Parameter>& parameters() const final { return parameters_; }
  [[nodiscard]] const Layout& layout() const final { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const final { return effects_; }
  /// Every channel of the block's trial, straight between its samples.
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override;

  /// The first thing that is wrong with the declaration. OdeProblem adds checks of its own.
  [[nodiscard]] virtual Status CheckDeclaration() const;

  /// What is to be done once when everything is declared. Default: nothing. BindModel calls it.
  virtual Status Prepare() { return {}; }

 protected:
  /// Derivatives are computed for so many parameters at once.
  static constexpr int kLanes = 8;
  using Lanes = Dual<kLanes>;

  explicit DeclaredProblem(const Dataset& data);

  /// A base parameter, which all trials share.
  ParameterBuilder parameter(const std::string& name, const std::string& unit);
  /// A value that every trial has of its own (an offset, a phase): NAME@TRIAL, fitted but no finding.
  ParameterBuilder per_trial(const std::string& name, const std::string& unit);
  /// A new effect, or one that was declared before.
  EffectBuilder effect(const std::string& name, Level level);
  EffectBuilder effect(const std::string& name);
  /// A channel that drives the model; every trial must have it, without gaps.
  InputHandle input(const std::string& channel, const std::string& unit);
  /// A number that every trial has (Trial::conditions).
  ConditionHandle condition(const std::string& name);
  /// A number of the data set (Dataset::constants), in its unit.
  double constant(const std::string& name);

  [[nodiscard]] const Dataset& data() const { return data_; }
  [[nodiscard]] const std::vector<DeclaredTrial>& trials() const { return trials_; }

  // For the two bases.

  /// Blocks for a predicted channel. @param unit checked against the data's; empty: whatever that is
  /// @return index of the observation, which ObservationOf returns for its blocks
  int AddChannel(const std::string& channel, const std::string& unit);
  [[nodiscard]] int ObservationOf(int block) const {
    return observation_of_[static_cast<std::size_t>(block)];
  }
  /// Parameter of a slot in a trial, to be changed.
  Parameter& ParameterOf(int slot, std::size_t trial) {
    return parameters_[static_cast<std::size_t>(trials_[trial].parameter_of[static_cast<std::size_t>(slot)])];
  }
  /// A value of one trial, NAME@TRIAL, with its bounds and start. @return its slot
  int AddTrialSlot(Parameter parameter, std::size_t trial);
  void SetStart(int index, double start);
  [[nodiscard]] const std::string& UnitOf(int slot) const;
  void MarkBounded(int slot) { bounded_[static_cast<std::size_t>(slot)] = true; }
  void MarkStarted(int slot) { started_[static_cast<std::size_t>(slot)] = true; }
  /// Keeps what is wrong with the declaration, if it is the first thing.
  void Complain(std::string what);

  /// Predicts the wanted blocks trial by trial. @param run(trial index, Values<T>, set) for T = double and
  /// T = Lanes; it calls set(block, row, value) for every prediction time of the wanted blocks of the trial.
  ///
  /// Errors: the declaration's; what `run` returns or throws; a value or derivative that is not finite. They
  /// name the trial, the channel, the sample and the parameters.
  template <class Run>
  Status PredictTrials(const Query& query, Prediction& prediction, const Run& run) const;

 private:
  friend class ParameterBuilder;
  friend class EffectBuilder;

  int AddSlot(Parameter parameter, bool per_trial);
  ParameterBuilder AddEffectParameter(int effect, const std::string& name, const std::string& unit);
  void UpdateColumns();
  void UpdateWeights();
  [[nodiscard]] bool Wants(const Query& query, const DeclaredTrial& trial) const;
  [[nodiscard]] Status Finite(const Query& query, const DeclaredTrial& trial,
                              const Prediction& prediction) const;
  [[nodiscard]] Status FiniteDerivatives(const Query& query, const DeclaredTrial& trial, int slot,
                                         const Prediction& prediction) const;
  [[nodiscard]] Error Failure(const Query& query, const DeclaredTrial& trial, const std::string& what) const;
  Status Guarded(const Query& query, const DeclaredTrial& trial, const std::function<Status()>& run) const;

  Dataset data_;
  std::vector<Parameter> parameters_;
  std::vector<Effect> effects_;
  std::vector<DeclaredTrial> trials_;
  std::vector<bool> bounded_;  // [slots] bounds were stated
  std::vector<bool> started_;  // [slots] a start was stated
  std::vector<std::string> channels_;
  Layout layout_;
  std::vector<int> observation_of_;  // [blocks]
  std::string complaint_;
};

template <class Run>
Status DeclaredProblem::PredictTrials(const Query& query, Prediction& prediction, const Run& run) const {
  SINEW_TRY(CheckDeclaration());
  std::vector<double> plain;
  std::vector<Lanes> dual;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const DeclaredTrial& trial = trials_[t];
    if (!Wants(query, trial)) continue;
    const std::size_t slots = trial.parameter_of.size();
    plain.resize(slots);
    for (std::size_t s = 0; s < slots; ++s)
      plain[s] = trial.parameter_of[s] < 0 ? 0 : query.parameters[trial.parameter_of[s]];
    for (const int b : trial.blocks) {
      if (query.blocks[static_cast<std::size_t>(b)])
        prediction.values(b).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    SINEW_TRY(Guarded(query, trial, [&] {
      return run(t, Values<double>(plain, trial.inputs, trial.conditions),
                 [&](int block, Eigen::Index row, double value) { prediction.values(block)[row] = value; });
    }));
    SINEW_TRY(Finite(query, trial, prediction));
    std::vector<int> wanted;
    for (std::size_t s = 0; s < slots; ++s) {
      if (trial.parameter_of[s] >= 0 && query.Differentiates(trial.parameter_of[s]))
        wanted.push_back(static_cast<int>(s));
    }
    for (std::size_t first = 0; first < wanted.size(); first += kLanes) {
      const std::size_t count = std::min<std::size_t>(kLanes, wanted.size() - first);
      std::array<Eigen::Index, kLanes> columns{};
      dual.assign(plain.begin(), plain.end());
      for (std::size_t lane = 0; lane < count; ++lane) {
        const auto slot = static_cast<std::size_t>(wanted[first + lane]);
        dual[slot] = Lanes::Variable(plain[slot], static_cast<int>(lane));
        columns[lane] = trial.column_of[slot];
      }
      SINEW_TRY(Guarded(query, trial, [&] {
        return run(t, Values<Lanes>(dual, trial.inputs, trial.conditions),
                   [&](int block, Eigen::Index row, const Lanes& value) {
                     auto derivatives = prediction.derivatives(block);
                     for (std::size_t lane = 0; lane < count; ++lane)
                       derivatives(row, columns[lane]) = value.d[lane];
                   });
      }));
      for (std::size_t lane = 0; lane < count; ++lane)
        SINEW_TRY(FiniteDerivatives(query, trial, wanted[first + lane], prediction));
    }
  }
  return {};
}

}  // namespace sinew
