#include "identify/solvers/annealing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/constants.h"

namespace sinew::solvers {
namespace {

// Between these shares of accepted moves a step length stays as it is (Corana et al., eq. for g).
constexpr double kTooManyAccepted = 0.6;
constexpr double kTooFewAccepted = 0.4;

class Annealer {
 public:
  Annealer(const AnnealingCost& cost, const Vector& lower, const Vector& upper, const Vector& start,
           double start_cost, const AnnealingSchedule& schedule, const std::function<double()>& uniform)
      : cost_(cost),
        lower_(lower),
        upper_(upper),
        schedule_(schedule),
        uniform_(uniform),
        x_(start),
        f_(start_cost),
        step_(schedule.step),
        accepted_(static_cast<std::size_t>(start.size()), 0),
        last_costs_(static_cast<std::size_t>(schedule.final_costs), kInfinity) {
    result_.x = start;
    result_.cost = start_cost;
    result_.temperature = schedule.temperature;
  }

  AnnealingResult Run() {
    while (OneTemperature()) {
      ++result_.temperatures;
      if (LastCostsAgree()) {
        result_.annealed = true;
        break;
      }
      result_.temperature *= schedule_.cooling;
      f_ = result_.cost;
      x_ = result_.x;
    }
    return result_;
  }

 private:
  // Returns false if the cost function stopped the search.
  bool OneTemperature() {
    for (int m = 0; m < schedule_.adjustments; ++m) {
      for (int j = 0; j < schedule_.cycles; ++j) {
        for (Eigen::Index h = 0; h < x_.size(); ++h) {
          if (!Move(h)) return false;
        }
      }
      AdjustSteps();
    }
    return true;
  }

  bool Move(Eigen::Index h) {
    trial_ = x_;
    trial_[h] += (uniform_() * 2 - 1) * step_[h];
    if (trial_[h] < lower_[h] || trial_[h] > upper_[h]) {
      trial_[h] = lower_[h] + (upper_[h] - lower_[h]) * uniform_();
      ++result_.out_of_bounds;
    }
    double f = kInfinity;
    if (!cost_(trial_, f)) return false;
    ++result_.moves;

    const bool accept = f <= f_ || uniform_() < std::exp((f_ - f) / result_.temperature);
    if (!accept) return true;
    x_ = trial_;
    f_ = f;
    ++result_.accepted;
    ++accepted_[static_cast<std::size_t>(h)];
    if (f < result_.cost) {
      result_.cost = f;
      result_.x = trial_;
    }
    return true;
  }

  void AdjustSteps() {
    for (Eigen::Index i = 0; i < step_.size(); ++i) {
      int& accepted = accepted_[static_cast<std::size_t>(i)];
      const double ratio = static_cast<double>(accepted) / schedule_.cycles;
      const double c = schedule_.step_control;
      if (ratio > kTooManyAccepted) {
        step_[i] *= 1 + c * (ratio - kTooManyAccepted) / (1 - kTooManyAccepted);
      } else if (ratio < kTooFewAccepted) {
        step_[i] /= 1 + c * (kTooFewAccepted - ratio) / kTooFewAccepted;
      }
      step_[i] = std::min(step_[i], upper_[i] - lower_[i]);
      accepted = 0;
    }
  }

  bool LastCostsAgree() {
    last_costs_.insert(last_costs_.begin(), f_);
    last_costs_.pop_back();
    result_.spread = f_ - result_.cost;
    for (const double last : last_costs_) result_.spread = std::max(result_.spread, std::abs(f_ - last));
    // The spread is infinite until enough temperatures are completed, and NaN if no point has a finite cost:
    // both fail the test.
    return result_.spread <= schedule_.tolerance + schedule_.relative_tolerance * std::abs(result_.cost);
  }

  const AnnealingCost& cost_;
  const Vector& lower_;
  const Vector& upper_;
  const AnnealingSchedule& schedule_;
  const std::function<double()>& uniform_;
  Vector x_;
  double f_;
  Vector trial_;
  Vector step_;
  std::vector<int> accepted_;       // since the last adjustment, per variable
  std::vector<double> last_costs_;  // at the end of the last temperatures, newest first
  AnnealingResult result_;
};

}  // namespace

AnnealingResult Anneal(const AnnealingCost& cost, const Vector& lower, const Vector& upper,
                       const Vector& start, double start_cost, const AnnealingSchedule& schedule,
                       const std::function<double()>& uniform) {
  return Annealer(cost, lower, upper, start, start_cost, schedule, uniform).Run();
}

}  // namespace sinew::solvers
