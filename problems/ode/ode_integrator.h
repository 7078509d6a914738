// Integrates ordinary differential equations from one instant to others: the method of Dormand and Prince,
// order 5 with an error estimate of order 4, for plain and for dual numbers.
//
// Source: Dormand, Prince, A family of embedded Runge-Kutta formulae, J. Comput. Appl. Math. 6 (1980).
//
// Between two stops the step is the distance of the stops divided by a power of two; it is halved where the
// estimated error is too large and doubled where it is far below. Steps are found for plain numbers alone and
// repeated for dual ones: derivatives are the exact ones of the computed solution, and values do not depend
// on whether derivatives are wanted.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/dual.h"
#include "base/error.h"

namespace sinew {

/// One accepted step.
struct OdeStep {
  double begin = 0;   ///< [s]
  double length = 0;  ///< [s]
  int stop = -1;      ///< index of the stop that it ends at; -1: none
};

/// How accurately to integrate.
template <std::size_t N>
struct OdeAccuracy {
  /// Estimated error of one step, of each state relative to its largest magnitude so far, or to `typical` if
  /// that is larger.
  double relative = 1e-9;
  std::array<double, N> typical{};  ///< [unit of each state, >= 0]
  std::size_t most_steps = 2000000;
};

/// Stages of one step.
template <class T, std::size_t N>
struct OdeStages {
  std::array<std::array<T, N>, 7> slope;  // the first is known before, the last belongs to the next step
  std::array<T, N> next;

  /// @param f(t, state, rate) the right-hand side. @pre slope[0] = f at (t, x).
  template <class F>
  void Step(const F& f, double t, double h, const std::array<T, N>& x) {
    constexpr double kNode[7] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
    constexpr double kWeight[7][6] = {
        {},
        {1.0 / 5},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    for (std::size_t stage = 1; stage < 7; ++stage) {
      for (std::size_t i = 0; i < N; ++i) {
        T sum = (h * kWeight[stage][0]) * slope[0][i];
        for (std::size_t k = 1; k < stage; ++k) {
          if (kWeight[stage][k] != 0) sum += (h * kWeight[stage][k]) * slope[k][i];
        }
        next[i] = x[i] + sum;
      }
      f(t + kNode[stage] * h, next, slope[stage]);
    }
  }

  /// Estimated error of the step [N]. @pre T is double.
  [[nodiscard]] std::array<double, N> Error(double h) const {
    constexpr double kDifference[7] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                       -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    std::array<double, N> error{};
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t k = 0; k < 7; ++k) error[i] += h * kDifference[k] * Value(slope[k][i]);
    }
    return error;
  }
};

/// Finds the steps from `begin` to the last stop and calls sink(stop, state) at each.
/// @param stops [s, strictly increasing, none before begin] @param state at begin
/// Errors: the state is not finite; the equations are too stiff for an explicit method.
template <std::size_t N, class F, class Sink>
Status IntegrateOde(const F& f, double begin, const std::vector<double>& stops, std::array<double, N> state,
                    const OdeAccuracy<N>& accuracy, std::vector<OdeStep>& steps, const Sink& sink) {
  constexpr int kMostHalvings = 20;
  // Doubling a step multiplies the estimate by 32.
  constexpr double kFarBelow = 1.0 / 64;
  steps.clear();
  OdeStages<double, N> stages;
  f(begin, state, stages.slope[0]);
  double from = begin;
  int halvings = 0;
  std::array<double, N> largest = accuracy.typical;
  for (std::size_t stop = 0; stop < stops.size(); ++stop) {
    const double span = stops[stop] - from;
    if (span > 0) {
      long place = 0;
      while (place < (1L << halvings)) {
        const double h = std::ldexp(span, -halvings);
        const double t = from + static_cast<double>(place) * h;
        stages.Step(f, t, h, state);
        const std::array<double, N> error = stages.Error(h);
        double worst = 0;
        for (std::size_t i = 0; i < N; ++i) {
          const double scale = std::max({std::abs(state[i]), std::abs(stages.next[i]), largest[i], 1e-300});
          const double share = std::abs(error[i]) / (accuracy.relative * scale);
          worst = std::isfinite(share) ? std::max(worst, share) : INFINITY;
        }
        if (!(worst <= 1)) {
          if (++halvings > kMostHalvings) {
            if (!std::isfinite(worst)) return Fail("the state is not finite after t = {:.6g} s", t);
            return Fail(
                "the equations are too stiff, or their solution ends, at t = {:.6g} s: a step of {:.2g} s is "
                "too long",
                t, h);
          }
          place *= 2;
          continue;
        }
        if (steps.size() >= accuracy.most_steps)
          return Fail("the equations are too stiff: {} steps until t = {:.6g} s", steps.size(), t);
        ++place;
        const bool arrived = place == (1L << halvings);
        steps.push_back({t, h, arrived ? static_cast<int>(stop) : -1});
        state = stages.next;
        for (std::size_t i = 0; i < N; ++i) largest[i] = std::max(largest[i], std::abs(state[i]));
        stages.slope[0] = stages.slope[6];
        if (worst < kFarBelow && halvings > 0 && place % 2 == 0) {
          --halvings;
          place /= 2;
        }
      }
    }
    from = stops[stop];
    sink(static_cast<int>(stop), state);
  }
  return {};
}

/// The same steps again, for another scalar. @param begin, stops as before
template <std::size_t N, class T, class F, class Sink>
void RepeatOde(const F& f, double begin, const std::vector<double>& stops, std::array<T, N> state,
               const std::vector<OdeStep>& steps, const Sink& sink) {
  OdeStages<T, N> stages;
  f(begin, state, stages.slope[0]);
  if (!stops.empty() && stops.front() == begin) sink(0, state);
  for (const OdeStep& step : steps) {
    stages.Step(f, step.begin, step.length, state);
    state = stages.next;
    stages.slope[0] = stages.slope[6];
    if (step.stop >= 0) sink(step.stop, state);
  }
}

}  // namespace sinew
