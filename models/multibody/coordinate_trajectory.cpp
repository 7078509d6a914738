#include "models/multibody/coordinate_trajectory.h"

#include <algorithm>
#include <cmath>

#include "models/multibody/multibody_model.h"
#include "models/multibody/name_lists.h"

namespace sinew {

Result<CoordinateTrajectory> CoordinateTrajectory::Fit(const MultibodyModel& model,
                                                       const std::vector<double>& times,
                                                       const std::vector<std::string>& names,
                                                       const Matrix& values) {
  if (static_cast<std::size_t>(values.rows()) != times.size() ||
      static_cast<std::size_t>(values.cols()) != names.size()) {
    return Fail("coordinate values are {} x {}, expected {} times x {} names", values.rows(), values.cols(),
                times.size(), names.size());
  }
  CoordinateTrajectory trajectory;
  trajectory.defaults_ = model.default_values();
  const std::vector<std::string>& wanted = model.coordinate_names();
  std::vector<bool> given(wanted.size(), false);
  for (std::size_t column = 0; column < names.size(); ++column) {
    const auto coordinate = std::find(wanted.begin(), wanted.end(), names[column]) - wanted.begin();
    const auto index = static_cast<std::size_t>(coordinate);
    if (index == wanted.size()) {
      trajectory.unused_.push_back(names[column]);
      continue;
    }
    if (given[index]) return Fail("two columns are named '{}'", names[column]);
    given[index] = true;
    const Vector samples = values.col(static_cast<Eigen::Index>(column));
    for (Eigen::Index i = 0; i < samples.size(); ++i) {
      if (!std::isfinite(samples[i])) {
        return Fail("coordinate '{}' has a gap at t = {} s; cut the trial to a window without gaps",
                    names[column], times[static_cast<std::size_t>(i)]);
      }
    }
    auto spline = NaturalCubicSpline::Fit(times, {samples.begin(), samples.end()});
    if (!spline) return Fail("coordinate '{}': {}", names[column], spline.error().message);
    trajectory.splines_.push_back({static_cast<int>(coordinate), std::move(*spline)});
  }
  if (trajectory.splines_.empty()) {
    return Fail("motion and model share no coordinate: the model has {}, the motion has {}",
                ShowNames(wanted), ShowNames(names));
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!given[i] && !model.IsDependent(static_cast<int>(i))) trajectory.held_.push_back(wanted[i]);
  }
  return trajectory;
}

CoordinateState CoordinateTrajectory::At(double time) const {
  const Vector still = Vector::Zero(defaults_.size());
  CoordinateState state{defaults_, still, still};
  for (const Moving& moving : splines_) {
    const auto at = moving.spline.At(time);
    state.values[moving.coordinate] = at.value;
    state.rates[moving.coordinate] = at.first;
    state.accelerations[moving.coordinate] = at.second;
  }
  return state;
}

}  // namespace sinew
