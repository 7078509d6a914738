// The motion of all coordinates of a model over time, as smooth functions.
#pragma once

#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "base/spline.h"

namespace sinew {

class MultibodyModel;

/// All coordinates of a model at one time, in the model's order.
struct CoordinateState {
  Vector values;         ///< [rad or m]
  Vector rates;          ///< [per s]
  Vector accelerations;  ///< [per s2]
};

/// Natural cubic splines of the coordinates, with their exact first and second derivatives.
class CoordinateTrajectory {
 public:
  /// @param times   [N, s, increasing, N >= 2]; @param names  of the columns, in any order, others than the
  /// model's coordinates are left unused; @param values  [N x names, rad or m].
  /// Errors: sizes differ, no column is a coordinate of the model (both sets of names are shown), a
  /// coordinate has a gap, two columns of one name.
  static Result<CoordinateTrajectory> Fit(const MultibodyModel& model, const std::vector<double>& times,
                                          const std::vector<std::string>& names, const Matrix& values);

  /// @param time  [s]; outside the samples each coordinate goes on at constant rate.
  [[nodiscard]] CoordinateState At(double time) const;

  /// Coordinates that no column gives: held at the model's default, not moving. Those that a coupler decides
  /// are not among them.
  [[nodiscard]] const std::vector<std::string>& held() const { return held_; }
  /// Columns that are no coordinate of the model.
  [[nodiscard]] const std::vector<std::string>& unused() const { return unused_; }
  [[nodiscard]] double first_time() const { return splines_.front().spline.first_time(); }
  [[nodiscard]] double last_time() const { return splines_.front().spline.last_time(); }

 private:
  struct Moving {
    int coordinate;
    NaturalCubicSpline spline;
  };

  CoordinateTrajectory() = default;

  std::vector<Moving> splines_;  // at least one
  Vector defaults_;
  std::vector<std::string> held_;
  std::vector<std::string> unused_;
};

}  // namespace sinew
