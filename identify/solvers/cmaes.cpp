#include "identify/solvers/cmaes.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <vector>

#include "base/decompositions.h"
#include "base/random.h"
#include "identify/solvers/objective.h"

namespace sinew::solvers {
namespace {

constexpr double kFirstDeviation = 0.3;
constexpr double kSmallestDeviation = 1e-12;  // in the unit box; less is rounding
constexpr double kLargestCondition = 1e14;    // of the covariance; more is singular in double precision

// The point of [0, 1] that x is mapped to by reflection at 0 and 1.
Vector Mirrored(const Vector& x) {
  return x.unaryExpr([](double value) {
    const double folded = std::fmod(std::abs(value), 2.0);
    return folded > 1 ? 2 - folded : folded;
  });
}

// The sampling distribution and its adaptation; names as in the tutorial.
class Distribution {
 public:
  Distribution(const Vector& mean, double sigma)
      : n_(static_cast<double>(mean.size())),
        lambda_(4 + static_cast<int>(3 * std::log(n_))),
        mean_(mean),
        sigma_(sigma),
        p_c_(Vector::Zero(mean.size())),
        p_sigma_(Vector::Zero(mean.size())),
        covariance_(Matrix::Identity(mean.size(), mean.size())),
        basis_(covariance_),
        deviations_(Vector::Ones(mean.size())) {
    const int mu = lambda_ / 2;
    weights_.resize(mu);
    for (int i = 0; i < mu; ++i) weights_[i] = std::log((lambda_ + 1) / 2.0) - std::log(i + 1.0);
    weights_ /= weights_.sum();
    mu_eff_ = 1 / weights_.squaredNorm();
    c_sigma_ = (mu_eff_ + 2) / (n_ + mu_eff_ + 5);
    d_sigma_ = 1 + 2 * std::max(0.0, std::sqrt((mu_eff_ - 1) / (n_ + 1)) - 1) + c_sigma_;
    c_c_ = (4 + mu_eff_ / n_) / (n_ + 4 + 2 * mu_eff_ / n_);
    c_1_ = 2 / ((n_ + 1.3) * (n_ + 1.3) + mu_eff_);
    c_mu_ = std::min(1 - c_1_, 2 * (mu_eff_ - 2 + 1 / mu_eff_) / ((n_ + 2) * (n_ + 2) + mu_eff_));
    expected_norm_ = std::sqrt(n_) * (1 - 1 / (4 * n_) + 1 / (21 * n_ * n_));
  }

  [[nodiscard]] int lambda() const { return lambda_; }
  [[nodiscard]] double largest_deviation() const { return sigma_ * deviations_.maxCoeff(); }
  [[nodiscard]] double condition() const {
    const double ratio = deviations_.maxCoeff() / deviations_.minCoeff();
    return ratio * ratio;
  }

  [[nodiscard]] Vector Sample(Random& random) const {
    Vector z(mean_.size());
    for (double& value : z) value = random.Normal();
    return mean_ + sigma_ * (basis_ * deviations_.cwiseProduct(z));
  }

  /// @param best the better half of the generation, best first.
  void Update(const std::vector<Vector>& best, int generation) {
    Vector step = Vector::Zero(mean_.size());
    for (Eigen::Index i = 0; i < weights_.size(); ++i) {
      step += weights_[i] * (best[static_cast<std::size_t>(i)] - mean_) / sigma_;
    }
    const Vector whitened = basis_ * deviations_.cwiseInverse().cwiseProduct(basis_.transpose() * step);
    p_sigma_ = (1 - c_sigma_) * p_sigma_ + std::sqrt(c_sigma_ * (2 - c_sigma_) * mu_eff_) * whitened;
    const double decay = 1 - std::pow(1 - c_sigma_, 2 * (generation + 1));
    const bool steady = p_sigma_.norm() / std::sqrt(decay) < (1.4 + 2 / (n_ + 1)) * expected_norm_;
    p_c_ *= 1 - c_c_;
    if (steady) p_c_ += std::sqrt(c_c_ * (2 - c_c_) * mu_eff_) * step;

    const double stalled = steady ? 0 : c_c_ * (2 - c_c_);
    covariance_ *= 1 - c_1_ - c_mu_ + c_1_ * stalled;
    covariance_ += c_1_ * p_c_ * p_c_.transpose();
    for (Eigen::Index i = 0; i < weights_.size(); ++i) {
      const Vector y = (best[static_cast<std::size_t>(i)] - mean_) / sigma_;
      covariance_ += c_mu_ * weights_[i] * y * y.transpose();
    }
    mean_ += sigma_ * step;
    sigma_ *= std::exp(c_sigma_ / d_sigma_ * (p_sigma_.norm() / expected_norm_ - 1));

    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(covariance_);
    basis_ = eigen.eigenvectors();
    // Rounding errors can make an eigenvalue of a singular matrix negative; condition() then ends the search.
    const double floor = eigen.eigenvalues().maxCoeff() / (10 * kLargestCondition);
    deviations_ = eigen.eigenvalues().cwiseMax(floor).cwiseSqrt();
  }

 private:
  double n_;
  int lambda_;
  Vector weights_;
  double mu_eff_ = 0, c_sigma_ = 0, d_sigma_ = 0, c_c_ = 0, c_1_ = 0, c_mu_ = 0, expected_norm_ = 0;
  Vector mean_;
  double sigma_;
  Vector p_c_, p_sigma_;
  Matrix covariance_;
  Matrix basis_;       // eigenvectors of the covariance
  Vector deviations_;  // square roots of its eigenvalues
};

}  // namespace

Search CmaEs::DoSolve(Evaluator& evaluator, const Vector& start) const {
  Random random(seed_);
  Objective objective(evaluator);
  Distribution distribution(start, kFirstDeviation);
  const auto lambda = static_cast<std::size_t>(distribution.lambda());
  const std::size_t history = 10 + 30 * static_cast<std::size_t>(start.size()) / lambda;

  std::vector<Vector> points(lambda);
  std::vector<double> costs(lambda);
  std::vector<std::size_t> order(lambda);
  std::vector<Vector> best(lambda / 2);
  std::deque<double> best_costs;
  for (int generation = 0;; ++generation) {
    for (std::size_t i = 0; i < lambda; ++i) {
      points[i] = distribution.Sample(random);
      costs[i] = objective.Cost(Mirrored(points[i]));
      if (objective.stopped()) return {{}, generation, {}};
    }
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return costs[a] < costs[b]; });
    for (std::size_t i = 0; i < best.size(); ++i) best[i] = points[order[i]];
    distribution.Update(best, generation);

    best_costs.push_back(costs[order.front()]);
    if (best_costs.size() > history) best_costs.pop_front();
    const auto [lowest, highest] = std::minmax_element(best_costs.begin(), best_costs.end());
    const double spread = std::max(*highest - *lowest, costs[order.back()] - costs[order.front()]);
    const double allowed = cost_tolerance_ * std::abs(*lowest);
    if (best_costs.size() == history && spread <= allowed) {
      return {{Termination::kCostChange, fmt::format("costs of {} generations agree within {:.3g} <= {:.3g}",
                                                     history, spread, allowed)},
              generation + 1,
              {}};
    }
    if (distribution.largest_deviation() < kSmallestDeviation) {
      return {{Termination::kStepSize, fmt::format("standard deviation {:.3g} < {:.3g}",
                                                   distribution.largest_deviation(), kSmallestDeviation)},
              generation + 1,
              {}};
    }
    if (distribution.condition() > kLargestCondition) {
      return {{Termination::kStepSize, fmt::format("condition of the covariance {:.3g} > {:.3g}",
                                                   distribution.condition(), kLargestCondition)},
              generation + 1,
              {}};
    }
  }
}

}  // namespace sinew::solvers
