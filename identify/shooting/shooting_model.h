// What multiple shooting sees of a model that is integrated: arcs, cut into windows.
#pragma once

#include <cstddef>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew::shooting {

/// One window, integrated from a state at its begin.
struct Shot {
  Vector residual;      ///< [m] weighted, of the samples from its begin up to, but not at, its end
  Matrix by_state;      ///< [m x n] derivatives for the state at its begin
  Matrix by_parameter;  ///< [m x p] and for the free parameters
  Vector end;           ///< [n] state at its end, where the next window begins; of the last one empty
  Matrix end_by_state;  ///< [n x n]
  Matrix end_by_parameter;  ///< [n x p]
};

/// An arc is a stretch of a trial that is to become one trajectory. Its windows follow each other without a
/// gap; every window begins with a state of its own.
class Model {
 public:
  Model() = default;
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Numbers of a state, n.
  [[nodiscard]] virtual int states() const = 0;
  [[nodiscard]] virtual std::size_t arcs() const = 0;
  [[nodiscard]] virtual std::size_t windows(std::size_t arc) const = 0;
  /// The state [n] at a window's begin, as measured: smoothed samples, their slopes.
  [[nodiscard]] virtual Vector MeasuredState(std::size_t arc, std::size_t window) const = 0;
  /// [n, > 0] Typical magnitude of each state.
  [[nodiscard]] virtual Vector TypicalState() const = 0;

  /// Integrates a window.
  /// @param parameters [P] @param free [p] indices of the parameters whose derivatives are wanted
  /// @param derivatives false: only `residual` and `end` are set
  /// Errors: the integration fails.
  virtual Status Shoot(std::size_t arc, std::size_t window, const Vector& parameters, const Vector& state,
                       const std::vector<int>& free, bool derivatives, Shot& shot) const = 0;
};

}  // namespace sinew::shooting
