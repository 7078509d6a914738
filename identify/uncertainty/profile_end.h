// One end of a profile-likelihood interval by Gauss-Newton models: few evaluations where the cost is smooth.
#pragma once

#include <atomic>
#include <optional>

#include "base/linear_algebra.h"
#include "identify/solvers/local_fit.h"
#include "identify/uncertainty/profile.h"

namespace sinew::uncertainty {

/// Where a search for an end begins, and what it may use.
struct EndQuestion {
  const Vector& minimum;                    ///< [n]
  double cost = 0;                          ///< there
  const solvers::BoxQuadraticModel& model;  ///< there
  const ProfileRequest& request;
  double sign = 1;           ///< -1: the lower end
  double end_tolerance = 0;  ///< share of the distance to which the end is found
  long max_evaluations = 0;
  const std::atomic<bool>* interrupt = nullptr;
};

/// The end is the point of the box that is farthest from the minimum in the held variable while the cost is
/// at most cost + rise (Venzon, Moolgavkar 1988; as a problem with one constraint Neale, Miller 1997). There
/// all other variables are at their best. Each step solves that problem exactly for the Gauss-Newton model of
/// the last point, bounds included (BoxMinimum), damped where the model is not good enough (Levenberg 1944,
/// Marquardt 1963), and evaluates the problem there: two or three evaluations where the model is nearly
/// linear, against dozens if the others are refitted at every distance. Where kinks keep the steps from
/// ending, the end is the farthest point that was met, at a share of its height above the allowed one.
/// nullopt: no convergence; then EndSearch of profile.cpp may still find it.
[[nodiscard]] std::optional<ProfileEnd> FindEnd(solvers::LocalFit& fit, const EndQuestion& question,
                                                LowestCost& lowest);

/// The same for the Gauss-Newton model of the minimum alone, without an evaluation: the point [n] to which
/// the held variable can move, at most to the bound. Values on a bound are free to leave it; for a linear
/// model this is the profile likelihood. nullopt: not found.
[[nodiscard]] std::optional<Vector> LinearEnd(const EndQuestion& question);

}  // namespace sinew::uncertainty
