// What a user's formula is given: the parameters of one trial, and the inputs that were recorded in it.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace sinew {

/// A declared parameter, as a model keeps it; made by DeclaredProblem::parameter.
struct ParameterHandle {
  int slot = -1;
};

/// A declared input channel, made by DeclaredProblem::input.
struct InputHandle {
  int index = -1;
};

/// A declared condition of a trial (a speed, a load), made by DeclaredProblem::condition.
struct ConditionHandle {
  int index = -1;
};

/// An input channel of one trial: straight from sample to sample, constant beyond the outer ones.
struct SampledInput {
  std::vector<double> time;    ///< [M, s, increasing, M >= 1]
  std::vector<double> values;  ///< [M]

  [[nodiscard]] double At(double t) const;
};

/// @tparam T double, or Dual<N> where derivatives are wanted.
template <class T>
class Values {
 public:
  /// All must outlive this. @param parameters [slots] @param inputs, conditions of the trial
  Values(const std::vector<T>& parameters, const std::vector<SampledInput>& inputs,
         const std::vector<double>& conditions)
      : parameters_(&parameters), inputs_(&inputs), conditions_(&conditions) {}

  /// Throws std::out_of_range for a handle that was never declared.
  [[nodiscard]] const T& operator[](ParameterHandle handle) const {
    return (*parameters_)[Place(handle.slot, parameters_->size(), "parameter")];
  }
  /// An input at time t [s].
  [[nodiscard]] double input(InputHandle handle, double t) const {
    return (*inputs_)[Place(handle.index, inputs_->size(), "input")].At(t);
  }
  [[nodiscard]] double condition(ConditionHandle handle) const {
    return (*conditions_)[Place(handle.index, conditions_->size(), "condition")];
  }

 private:
  static std::size_t Place(int index, std::size_t count, const char* what) {
    if (index < 0 || static_cast<std::size_t>(index) >= count) {
      throw std::out_of_range(std::string(what) + " " + std::to_string(index) + " was never declared (" +
                              std::to_string(count) + " are)");
    }
    return static_cast<std::size_t>(index);
  }

  const std::vector<T>* parameters_;
  const std::vector<SampledInput>* inputs_;
  const std::vector<double>* conditions_;
};

}  // namespace sinew
