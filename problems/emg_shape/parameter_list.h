// The list of an emg_shape problem's parameters while it is made, part by part.
#pragma once

#include <string>
#include <utility>

#include "problems/emg_shape/parameters.h"

namespace sinew {

constexpr double kMaxTiming = 0.25;  ///< [cycle]; further would be another burst
constexpr double kMaxGain = 2;       ///< of the logarithm

class EmgParameterList {
 public:
  EmgParameterList(const EmgShapeSettings& of, const EmgShapeData& from) : settings(of), data(from) {
    made.columns.resize(data.layout.size());
  }

  const EmgShapeSettings& settings;
  const EmgShapeData& data;
  EmgShapeParameters made;          ///< columns not in order yet
  ParameterListBuilder list{made};  ///< for effects and ports; parameters are added by the functions below

  [[nodiscard]] std::size_t muscles() const { return data.muscles.size(); }
  /// With one speed there is nothing that changes with it; a model that was fitted elsewhere has its laws.
  [[nodiscard]] bool Laws() const { return data.trained_speeds() != 1; }
  [[nodiscard]] double LogSpeed(const EmgShapeTrial& trial) const;
  [[nodiscard]] double Rhythm(const EmgShapeTrial& trial) const;

  /// Of the model. @return its index
  int Add(Parameter p);
  /// Of the effect that was begun last. @return its index
  int AddNumber(Parameter p);
  /// Of the model, or of that effect. @return its index
  int AddOf(bool effect, Parameter p) { return effect ? AddNumber(std::move(p)) : Add(std::move(p)); }
  /// Of the term that was begun last. @return its index
  int AddKnot(Parameter p);
  /// @param deviation of its prior; 0: none
  int AddNuisance(Parameter p, double deviation);
  /// Touches all samples of a muscle's block in a trial.
  void Touch(std::size_t trial, std::size_t muscle, EmgColumn column);
};

// Laws of speed, of the model or of the effect that was begun last.
void AddExponent(EmgParameterList& to, std::size_t m, bool effect);
void AddLead(EmgParameterList& to, bool effect);

/// Gains and timings of single bursts, of what the bursts of a cycle have in common, and of all muscles.
void AddCycles(EmgParameterList& to);

/// All effects, and the ports of unknown terms.
void AddEffects(EmgParameterList& to);

}  // namespace sinew
