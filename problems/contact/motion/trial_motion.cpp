#include "problems/contact/motion/trial_motion.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew {

Result<TrialMotion> FitTrialMotion(const Trial& trial, const MultibodyModel& model) {
  const Grid* best = nullptr;
  std::vector<std::string> best_names;
  for (const auto& [grid_name, grid] : trial.grids) {
    std::vector<std::string> names;
    for (const std::string& name : model.coordinate_names()) {
      if (grid.channels.count(name) > 0) names.push_back(name);
    }
    if (names.size() > best_names.size()) {
      best = &grid;
      best_names = names;
    }
  }
  if (best == nullptr) {
    return Fail("has no coordinate of the model ({}, ...); run `sinew data kinematics` on its markers first",
                model.coordinate_names().empty() ? "none" : model.coordinate_names().front());
  }
  const auto complete = [&](std::size_t i) {
    return std::all_of(best_names.begin(), best_names.end(), [&](const std::string& name) {
      return std::isfinite(best->channels.at(name).values[i]);
    });
  };
  std::size_t first = 0;
  std::size_t last = best->time.size();
  while (first < last && !complete(first)) ++first;
  while (last > first && !complete(last - 1)) --last;
  Matrix values(static_cast<Eigen::Index>(last - first), static_cast<Eigen::Index>(best_names.size()));
  for (std::size_t i = first; i < last; ++i) {
    if (!complete(i))
      return Fail("the motion has a gap at t = {:.4g} s; cut the trial so that it lies outside",
                  best->time[i]);
    for (std::size_t k = 0; k < best_names.size(); ++k) {
      values(static_cast<Eigen::Index>(i - first), static_cast<Eigen::Index>(k)) =
          best->channels.at(best_names[k]).values[i];
    }
  }
  const std::vector<double> time(best->time.begin() + static_cast<std::ptrdiff_t>(first),
                                 best->time.begin() + static_cast<std::ptrdiff_t>(last));
  SINEW_ASSIGN(auto trajectory, CoordinateTrajectory::Fit(model, time, best_names, values));
  return TrialMotion{std::move(trajectory), time};
}

Result<double> FrameRate(const TrialMotion& motion) {
  const std::vector<double>& time = motion.time;
  constexpr std::size_t kFewest = 10;
  constexpr double kUnequal = 0.05;
  if (time.size() < kFewest)
    return Fail("{} frames of the motion, expected at least {}", time.size(), kFewest);
  const double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (std::abs(time[i] - time[i - 1] - step) > kUnequal * step)
      return Fail("the frames of the motion are not equally spaced at t = {:.4g} s: they cannot be filtered",
                  time[i]);
  }
  return 1 / step;
}

}  // namespace sinew
