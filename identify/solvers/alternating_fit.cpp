#include "identify/solvers/alternating_fit.h"

#include <utility>

#include "identify/solvers/residual_whitening.h"

namespace sinew::solvers {
namespace {

constexpr int kMostRounds = 6;
constexpr double kLeastFall = 0.01;
constexpr long kEvaluationsOfEach = 200;
// Of the whitened cost, half a sum of squares of unit variance.
constexpr LocalFit::Tolerance kWhitenedCostTolerance{0, 1e-6};

}  // namespace

LocalFit::Outcome AlternatingFit(LeastSquares& fit, const Vector& x, LocalFit::Tolerance tolerance,
                                 const std::function<bool()>& stop) {
  fit.set_transform(nullptr);
  LocalFit first(fit);
  LocalFit::Outcome lowest = first.Minimize(x, -1, tolerance, kEvaluationsOfEach);
  for (int round = 0; lowest.failure.empty() && round < kMostRounds && !stop(); ++round) {
    const auto whitening = ResidualWhitening(fit, fit.Parameters(lowest.x));
    if (!whitening) break;
    fit.set_transform(whitening.get());
    const LocalFit::Outcome whitened =
        LocalFit(fit).Minimize(lowest.x, -1, kWhitenedCostTolerance, kEvaluationsOfEach);
    fit.set_transform(nullptr);
    if (!whitened.failure.empty() || stop()) break;
    // With the same penalty, so that costs can be compared.
    LocalFit::Outcome plain =
        LocalFit(fit, first.penalty()).Minimize(whitened.x, -1, tolerance, kEvaluationsOfEach);
    const bool falls = plain.failure.empty() && plain.cost < (1 - kLeastFall) * lowest.cost;
    if (!falls) break;
    lowest = std::move(plain);
  }
  return lowest;
}

}  // namespace sinew::solvers
