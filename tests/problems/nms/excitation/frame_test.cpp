#include "problems/nms/excitation/frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/decompositions.h"
#include "base/random.h"

namespace sinew {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// F = strength (exp(A e) - 1) / (exp(A) - 1), A = 0: a straight line.
class ShapedMuscles final : public FrameMuscles {
 public:
  ShapedMuscles(std::vector<double> strength, double shape) : strength_(std::move(strength)), shape_(shape) {}
  [[nodiscard]] Result<ForceAt> Force(int muscle, double e) const override {
    const double most = strength_[static_cast<std::size_t>(muscle)];
    if (shape_ == 0) return ForceAt{most * e, most};
    const double bottom = std::expm1(shape_);
    return ForceAt{most * std::expm1(shape_ * e) / bottom, most * shape_ * std::exp(shape_ * e) / bottom};
  }

 private:
  std::vector<double> strength_;
  double shape_;
};

Vector Values(std::initializer_list<double> values) {
  Vector v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

ExcitationFrame Frame(const ExcitationWeights& weights, const Vector& moment, const Matrix& arms,
                      const Vector& measured) {
  return {weights, moment, arms, measured};
}

FrameSolution Solved(const ExcitationFrame& frame, const FrameMuscles& muscles, const Vector& start) {
  const auto solution = SolveFrame(frame, muscles, start);
  EXPECT_TRUE(solution) << solution.error().message;
  EXPECT_TRUE(solution->converged);
  EXPECT_GE(solution->excitation.minCoeff(), 0);
  EXPECT_LE(solution->excitation.maxCoeff(), 1);
  return *solution;
}

// Every way to rest at a bound or a kink or to be on one side of it; the best that stays inside.
double BruteForce(const Matrix& h, const Vector& g, double gamma, const Vector& measured) {
  const Eigen::Index n = g.size();
  const auto value = [&](const Vector& x) {
    double sum = 0.5 * x.dot(h * x) + g.dot(x);
    for (Eigen::Index m = 0; m < n; ++m)
      sum += std::isnan(measured[m]) ? 0 : gamma * std::abs(x[m] - measured[m]);
    return sum;
  };
  double best = std::numeric_limits<double>::infinity();
  for (int code = 0; code < std::pow(5, n); ++code) {
    Vector x = Vector::Zero(n);
    std::vector<Eigen::Index> free;
    Vector slope = g;
    int rest = code;
    bool possible = true;
    for (Eigen::Index m = 0; m < n; ++m, rest /= 5) {
      const int way = rest % 5;
      if (way < 2) x[m] = way;
      if (way == 2) x[m] = measured[m];
      if (way >= 2 && std::isnan(measured[m]) && way != 3) possible = false;
      if (way < 3) continue;
      free.push_back(m);
      if (!std::isnan(measured[m])) slope[m] += way == 3 ? gamma : -gamma;
    }
    if (!possible) continue;
    if (!free.empty()) {
      const Vector right = -(slope + h * x)(free);
      const Matrix curvature = h(free, free);
      const Vector at = curvature.ldlt().solve(right);
      x(free) = at;
    }
    if (x.minCoeff() >= 0 && x.maxCoeff() <= 1) best = std::min(best, value(x));
  }
  return best;
}

TEST(KinkedQuadratic, IsAsGoodAsEveryWayTried) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const Eigen::Index n = 4;
    Matrix factor(2, n);
    for (double& x : factor.reshaped()) x = random.Uniform(-8, 8);
    const Matrix h = factor.transpose() * factor + random.Uniform(0.01, 2) * Matrix::Identity(n, n);
    Vector g(n);
    Vector measured(n);
    Vector start(n);
    for (Eigen::Index m = 0; m < n; ++m) {
      g[m] = random.Uniform(-30, 10);
      measured[m] = random.Uniform() < 0.3 ? kNone : std::round(random.Uniform(0, 4)) / 4;
      start[m] = random.Uniform() < 0.3 && !std::isnan(measured[m]) ? measured[m] : random.Uniform();
    }
    const double gamma = random.Uniform(0, 10);
    // About `start`, the linear part is another one.
    const Vector found = SolveKinkedQuadratic(h, g + h * start, gamma, measured, start);
    double value = 0.5 * found.dot(h * found) + g.dot(found);
    for (Eigen::Index m = 0; m < n; ++m)
      value += std::isnan(measured[m]) ? 0 : gamma * std::abs(found[m] - measured[m]);
    const double best = BruteForce(h, g, gamma, measured);
    EXPECT_NEAR(value, best, 1e-10 * (1 + std::abs(best))) << round;
  }
}

TEST(ExcitationFrame, LikeMusclesShareAlike) {
  const ShapedMuscles muscles({800, 800, 500}, -1.5);
  Matrix arms(1, 3);
  arms << 0.04, 0.04, -0.03;
  const ExcitationFrame frame = Frame({1, 2, 0}, Values({20}), arms, Values({kNone, kNone, kNone}));
  const FrameSolution found = Solved(frame, muscles, Values({0.9, 0.1, 0.5}));
  EXPECT_NEAR(found.excitation[0], found.excitation[1], 1e-9);
  EXPECT_GT(found.excitation[0], 0.1);
  EXPECT_EQ(found.excitation[2], 0) << "what works against the moment only costs";
  EXPECT_LT(found.slope, 1e-6);
}

TEST(ExcitationFrame, GreatGammaKeepsWhatWasMeasured) {
  const ShapedMuscles muscles({800, 700}, -1);
  Matrix arms(1, 2);
  arms << 0.04, 0.05;
  const Vector measured = Values({0.37, 0.11});
  const FrameSolution found =
      Solved(Frame({1, 2, 1e9}, Values({40}), arms, measured), muscles, Values({0.9, 0.9}));
  EXPECT_EQ(found.excitation, measured);
}

TEST(ExcitationFrame, AlphaAloneMatchesMomentsThatCanBe) {
  const ShapedMuscles muscles({800, 700, 900, 400}, -2);
  Matrix arms(2, 4);
  arms << 0.04, 0.05, -0.03, 0, 0.02, 0, 0.01, -0.04;
  const Vector moment = Values({17, -6});
  const ExcitationFrame frame = Frame({1, 0, 0}, moment, arms, Values({0.1, 0.2, kNone, kNone}));
  const FrameSolution found = Solved(frame, muscles, Values({0.1, 0.2, 0.3, 0.4}));
  EXPECT_LT(found.objective, 1e-12);
}

TEST(ExcitationFrame, MomentsOutOfReachLeaveExcitationsAtTheirBounds) {
  const ShapedMuscles muscles({800, 700}, 0);
  Matrix arms(1, 2);
  arms << 0.04, -0.05;
  const FrameSolution found =
      Solved(Frame({1, 1, 1}, Values({500}), arms, Values({0.3, 0.4})), muscles, Values({0.3, 0.4}));
  EXPECT_EQ(found.excitation, Values({1, 0}));
}

TEST(ExcitationFrame, WithoutAMomentEffortAndMeasurementDecide) {
  const ShapedMuscles muscles({800, 700, 600}, -1);
  const FrameSolution found =
      Solved(Frame({1, 2, 1}, Values({0}), Matrix::Zero(1, 3), Values({0.1, 0.7, kNone})), muscles,
             Values({0.5, 0.5, 0.5}));
  EXPECT_EQ(found.excitation[0], 0.1);            // 2 beta e < gamma
  EXPECT_NEAR(found.excitation[1], 0.25, 1e-12);  // gamma / (2 beta)
  EXPECT_NEAR(found.excitation[2], 0, 1e-12);
}

// Convex in the forces: wherever the search begins it ends at the same objective.
TEST(ExcitationFrame, WithoutGammaEveryStartEndsAlike) {
  Random random(4);
  for (int round = 0; round < 100; ++round) {
    const int n = 8;
    std::vector<double> strength;
    Matrix arms(2, n);
    for (int m = 0; m < n; ++m) {
      strength.push_back(random.Uniform(300, 3000));
      arms(0, m) = random.Uniform(-0.05, 0.05);
      arms(1, m) = random.Uniform(-0.05, 0.05);
    }
    const ShapedMuscles muscles(strength, random.Uniform(-3, 0));
    const ExcitationFrame frame =
        Frame({1, random.Uniform(0.01, 50), 0}, Values({random.Uniform(-80, 80), random.Uniform(-80, 80)}),
              arms, Vector::Constant(n, kNone));
    double first = 0;
    for (int start = 0; start < 6; ++start) {
      Vector from(n);
      for (double& e : from) e = random.Uniform();
      const double objective = Solved(frame, muscles, from).objective;
      if (start == 0) first = objective;
      EXPECT_NEAR(objective, first, 1e-8 * first) << round;
    }
  }
}

// Far harder than measured gait: weak muscles, measured excitations that mean nothing, a great gamma. One
// start and its jumps against 30 starts; what is certain by its gap is so.
TEST(ExcitationFrame, JumpsOutOfMostLocalMinima) {
  Random random(11);
  constexpr int kRounds = 400;
  int missed = 0;
  int certain = 0;
  for (int round = 0; round < kRounds; ++round) {
    const int n = 6;
    const double scale = std::pow(10, random.Uniform(-2, 0.5));
    std::vector<double> strength;
    Matrix arms(2, n);
    Vector measured(n);
    for (int m = 0; m < n; ++m) {
      strength.push_back(scale * random.Uniform(300, 3000));
      arms(0, m) = random.Uniform(-0.05, 0.05);
      arms(1, m) = random.Uniform(-0.05, 0.05);
      measured[m] = random.Uniform() < 0.2 ? kNone : random.Uniform();
    }
    const ShapedMuscles muscles(strength, random.Uniform(-3, 0));
    const ExcitationFrame frame =
        Frame({1, random.Uniform(0, 5), random.Uniform(0, 30)},
              Values({scale * random.Uniform(-80, 80), scale * random.Uniform(-80, 80)}), arms, measured);
    const auto found = SearchFrame(frame, muscles, {measured.array().isNaN().select(0, measured)});
    double best = found->objective;
    for (int start = 0; start < 30; ++start) {
      Vector from(n);
      for (double& e : from) e = random.Uniform();
      best = std::min(best, SolveFrame(frame, muscles, from)->objective);
    }
    missed += found->objective > best * (1 + 1e-6) ? 1 : 0;
    if (found->gap > 1e-7 * found->objective) continue;
    ++certain;
    EXPECT_LE(found->objective, best * (1 + 1e-5)) << round;
  }
  EXPECT_LE(missed, kRounds / 100);
  EXPECT_GT(certain, kRounds / 3);
}

}  // namespace
}  // namespace sinew
