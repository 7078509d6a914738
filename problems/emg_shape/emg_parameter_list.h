// The list of an emg_shape problem's parameters while it is made, part by part.
#pragma once

#include <string>

#include "problems/emg_shape/emg_shape_parameters.h"

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
  EmgShapeParameters made;  ///< columns not in order yet

  [[nodiscard]] std::size_t muscles() const { return data.muscles.size(); }
  /// With one speed there is nothing that changes with it; a model that was fitted elsewhere has its laws.
  [[nodiscard]] bool Laws() const { return data.trained_speeds() != 1; }
  [[nodiscard]] double LogSpeed(const EmgShapeTrial& trial) const;
  [[nodiscard]] double Rhythm(const EmgShapeTrial& trial) const;

  /// Begins an effect.
  void Name(const std::string& name, Level level, const std::string& description,
            const std::string& revealing_experiment);
  /// @param effect empty: of the model @return its index
  int Add(Parameter p, const std::string& effect);
  /// @param deviation of its prior; 0: none
  int AddNuisance(Parameter p, double deviation);
  /// Touches all samples of a muscle's block in a trial.
  void Touch(std::size_t trial, std::size_t muscle, EmgColumn column);
};

// Laws of speed, of the model or as effects. @param effect its name; empty: of the model
void AddExponent(EmgParameterList& to, std::size_t m, const std::string& effect);
void AddLead(EmgParameterList& to, const std::string& effect);

/// Gains and timings of single bursts, of what the bursts of a cycle have in common, and of all muscles.
void AddCycles(EmgParameterList& to);

/// All effects, and the ports of unknown terms.
void AddEffects(EmgParameterList& to);

}  // namespace sinew
