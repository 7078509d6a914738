// What multiple shooting sees of a model that is integrated: trials, cut into arcs, cut into windows.
#pragma once

#include <cstddef>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew::shooting {

/// A stretch of a trial that is to be one trajectory, and the windows that it is cut into while it is sought.
/// A stop is an instant of a trial at which something is predicted.
struct Arc {
  std::size_t trial = 0;
  std::vector<std::size_t>
      begins;           ///< stops at which a window begins, increasing; the first is the arc's own
  std::size_t end = 0;  ///< stop after its last

  [[nodiscard]] std::size_t windows() const { return begins.size(); }
  [[nodiscard]] bool IsLast(std::size_t window) const { return window + 1 == begins.size(); }
  [[nodiscard]] std::size_t EndOf(std::size_t window) const {
    return IsLast(window) ? end : begins[window + 1];
  }
};

/// One window of an arc, integrated from a state at its begin.
struct Window {
  std::size_t trial = 0;
  std::size_t first = 0;  ///< stop at which it begins
  std::size_t end = 0;    ///< stop after its last sample
  bool joined = false;    ///< the next window begins at `end`: the state there is wanted
};

struct Shot {
  Vector residual;          ///< [m] weighted, of the compared samples from `first` to before `end`
  Matrix by_state;          ///< [m x n] derivatives for the state at `first`
  Matrix by_parameter;      ///< [m x p] and for the free parameters
  Vector end;               ///< [n] state at `end`; empty if the window is not joined
  Matrix end_by_state;      ///< [n x n]
  Matrix end_by_parameter;  ///< [n x p]

  /// Sizes everything; derivatives are zero.
  void Prepare(Eigen::Index m, Eigen::Index n, Eigen::Index p, bool joined, bool derivatives);
  [[nodiscard]] bool IsFinite() const;
};

class Model {
 public:
  Model() = default;
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Numbers of a state, n.
  [[nodiscard]] virtual int states() const = 0;
  [[nodiscard]] virtual std::size_t trials() const = 0;
  [[nodiscard]] virtual std::size_t stops(std::size_t trial) const = 0;
  /// Stops of a trial at which something is compared, increasing.
  [[nodiscard]] virtual std::vector<std::size_t> ComparedStops(std::size_t trial) const = 0;
  /// The state [n] at a stop as measured: smoothed samples, their slopes. NaN where it is not measured, but
  /// not at the first stop.
  [[nodiscard]] virtual Vector MeasuredState(std::size_t trial, std::size_t stop) const = 0;
  /// The state at the begin of this trial is known in this component, and does not change.
  [[nodiscard]] virtual bool IsKnown(std::size_t /*trial*/, int /*component*/) const { return false; }
  /// [n, > 0] Typical magnitude of a change of each component.
  [[nodiscard]] virtual Vector TypicalState() const = 0;

  /// Integrates a window.
  /// @param parameters [P] @param free [p] indices of the parameters whose derivatives are wanted
  /// @param derivatives false: only `residual` and `end` are set
  /// Errors: the integration fails, or something is not finite.
  virtual Status Shoot(const Window& window, const Vector& parameters, const Vector& state,
                       const std::vector<int>& free, bool derivatives, Shot& shot) const = 0;
};

}  // namespace sinew::shooting
