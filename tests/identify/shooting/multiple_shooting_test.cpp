#include "identify/shooting/multiple_shooting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "identify/shooting/trajectory_plan.h"
#include "tests/identify/support/error_of.h"

namespace sinew::shooting {
namespace {

using testing::ElementsAre;

constexpr double kInterval = 0.1;  // [s]

/// x' = v, v' = rate^2 x: small differences grow by exp(rate t). x is measured, and v is if asked for.
class Saddle final : public Model {
 public:
  Saddle(std::size_t samples, double rate, double noise, bool measures_v) : measures_v_(measures_v) {
    // A solution that stays small: what grows is hardly in it.
    Random random(3);
    for (std::size_t i = 0; i < samples; ++i) {
      const double t = kInterval * static_cast<double>(i);
      const double grows = std::exp(rate * (t - kInterval * static_cast<double>(samples - 1)));
      const double decays = std::exp(-rate * t);
      truth_.emplace_back(Eigen::Vector2d(grows + decays, rate * (grows - decays)));
      measured_.push_back(truth_.back()[0] + noise * random.Normal());
    }
  }

  [[nodiscard]] int states() const override { return 2; }
  [[nodiscard]] std::size_t trials() const override { return 1; }
  [[nodiscard]] std::size_t stops(std::size_t /*trial*/) const override { return measured_.size(); }
  [[nodiscard]] std::vector<std::size_t> ComparedStops(std::size_t /*trial*/) const override {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < measured_.size(); ++i) all.push_back(i);
    return all;
  }
  [[nodiscard]] Vector MeasuredState(std::size_t /*trial*/, std::size_t stop) const override {
    Vector state = truth_[stop];
    state[0] = known ? state[0] : measured_[stop];
    if (!measures_v_ && stop > 0) state[1] = std::nan("");
    return state;
  }
  [[nodiscard]] bool IsKnown(std::size_t /*trial*/, int component) const override {
    return known && component == 0;
  }
  [[nodiscard]] Vector TypicalState() const override { return Vector::Constant(2, 1.0); }
  Status Shoot(const Window& window, const Vector& parameters, const Vector& state,
               const std::vector<int>& free, bool derivatives, Shot& shot) const override {
    const double k = parameters[0];
    const auto m = static_cast<Eigen::Index>(window.end - window.first);
    shot.Prepare(m, 2, static_cast<Eigen::Index>(free.size()), window.joined, derivatives);
    for (Eigen::Index i = 0; i < m + (window.joined ? 1 : 0); ++i) {
      const double t = kInterval * static_cast<double>(i);
      const double c = std::cosh(k * t);
      const double s = std::sinh(k * t);
      const double x = c * state[0] + s / k * state[1];
      const double v = k * s * state[0] + c * state[1];
      const double x_by_k = t * s * state[0] + (t * c / k - s / (k * k)) * state[1];
      const double v_by_k = (s + k * t * c) * state[0] + t * s * state[1];
      if (i < m) {
        shot.residual[i] = x - measured_[window.first + static_cast<std::size_t>(i)];
        if (!derivatives) continue;
        shot.by_state.row(i) << c, s / k;
        if (!free.empty()) shot.by_parameter(i, 0) = x_by_k;
        continue;
      }
      shot.end << x, v;
      if (!derivatives) continue;
      shot.end_by_state << c, s / k, k * s, c;
      if (!free.empty()) shot.end_by_parameter << x_by_k, v_by_k;
    }
    if (!shot.IsFinite()) return Fail("not finite");
    return {};
  }

  [[nodiscard]] const std::vector<Eigen::Vector2d>& truth() const { return truth_; }

  bool known = false;

 private:
  bool measures_v_;
  std::vector<Eigen::Vector2d> truth_;
  std::vector<double> measured_;
};

Arc Every(std::size_t samples, std::size_t length) {
  Arc arc{0, {}, samples};
  for (std::size_t at = 0; at + length <= samples; at += length) arc.begins.push_back(at);
  return arc;
}

std::vector<Parameter> Rate(double start) {
  return {BaseParameter("rate", "1/s", "growth", 0.5, 20, start)};
}

TEST(MultipleShooting, FollowsATrajectoryThatASingleShotWouldLose) {
  // exp(3 * 10) is 1e13.
  const Saddle saddle(101, 3, 1e-3, true);
  const auto all = Rate(4);
  const auto found = Solve(saddle, {Every(101, 5)}, all, {0}, Vector::Constant(1, 4.0));
  ASSERT_TRUE(found.has_value()) << ErrorOf(found);
  EXPECT_NEAR(found->parameters[0], 3, 5e-3);
  EXPECT_LT(found->largest_gap, 1e-8);
  EXPECT_NEAR(found->residual_rms, 1e-3, 1.5e-4);
  // One trajectory: every window begins where the one before ends.
  Shot shot;
  for (std::size_t w = 0; w + 1 < 20; ++w) {
    const auto at = static_cast<Eigen::Index>(w);
    ASSERT_TRUE(saddle.Shoot({0, 5 * w, 5 * w + 5, true}, found->parameters, found->states[0].col(at), {},
                             false, shot));
    EXPECT_LT((shot.end - found->states[0].col(at + 1)).norm(), 1e-9);
  }
}

TEST(MultipleShooting, IsTheLeastSquaresSolutionOfTheSingleTrajectory) {
  // Where a single window can be solved too, both are the same minimum.
  const Saddle saddle(31, 1.2, 1e-2, true);
  const auto all = Rate(1.5);
  const auto windows = Solve(saddle, {Every(31, 5)}, all, {0}, Vector::Constant(1, 1.5));
  const auto single = Solve(saddle, {{0, {0}, 31}}, all, {0}, Vector::Constant(1, 1.5));
  ASSERT_TRUE(windows.has_value() && single.has_value());
  EXPECT_NEAR(windows->parameters[0], single->parameters[0], 1e-6);
  EXPECT_NEAR(windows->cost, single->cost, 1e-6 * single->cost);
  EXPECT_LT((windows->states[0].col(0) - single->states[0].col(0)).norm(), 1e-6);
}

TEST(MultipleShooting, StatesThatAreNotMeasuredFollowTheModel) {
  const Saddle saddle(101, 3, 1e-3, false);
  const auto tracked = TrackedStates(saddle, {Every(101, 5)}, Vector::Constant(1, 3.3));
  ASSERT_TRUE(tracked.has_value()) << ErrorOf(tracked);
  for (Eigen::Index w = 0; w < tracked->front().cols(); ++w)
    EXPECT_NEAR(tracked->front()(1, w), saddle.truth()[static_cast<std::size_t>(5 * w)][1], 0.3) << w;
  const auto found = Solve(saddle, {Every(101, 5)}, Rate(3.3), {0}, Vector::Constant(1, 3.3));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->parameters[0], 3, 5e-3);
}

TEST(MultipleShooting, AKnownComponentStays) {
  Saddle saddle(31, 1.2, 1e-2, true);
  saddle.known = true;
  const auto found = Solve(saddle, {Every(31, 5)}, Rate(1.5), {0}, Vector::Constant(1, 1.5));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->states[0](0, 0), saddle.truth()[0][0], 1e-9);
}

TEST(MultipleShooting, BoundsHold) {
  const Saddle saddle(31, 1.2, 1e-2, true);
  auto all = Rate(2);
  all[0].lower = 1.6;
  const auto found = Solve(saddle, {Every(31, 5)}, all, {0}, Vector::Constant(1, 2.0));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->parameters[0], 1.6);
}

TEST(TrajectoryPlan, GrowthIsThatOfTheEquations) {
  const Saddle saddle(41, 2, 0, true);
  const Arc arc = Every(41, 5);
  const auto transitions = Transitions(saddle, arc, Vector::Constant(1, 2.0), Matrix::Zero(2, 8));
  ASSERT_TRUE(transitions.has_value());
  ASSERT_EQ(transitions->size(), 7U);
  // Over 3.5 s, in the norm that is 1 for the identity.
  const double c = std::cosh(2 * 3.5);
  const double s = std::sinh(2 * 3.5);
  EXPECT_NEAR(LargestGrowth(*transitions), std::sqrt((2 * c * c + 4 * s * s + s * s / 4) / 2), 1e-6 * c);
  // 0.5 s each; growth above 10 after 1.5 s.
  EXPECT_THAT(Join(*transitions, 20, 100), ElementsAre(0, 3, 6));
  EXPECT_THAT(Join(*transitions, 1e9, 2), ElementsAre(0, 2, 4, 6));
}

TEST(TrajectoryPlan, NothingIsPlannedWhereNothingGrows) {
  const Saddle saddle(31, 0.6, 1e-2, true);
  const Plan plan = MakePlan(saddle, {true}, Rate(0.7), {0}, Vector::Constant(1, 0.7), {});
  EXPECT_FALSE(plan.needed);
}

TEST(TrajectoryPlan, CutsWhereDifferencesHaveGrownTooMuch) {
  const Saddle saddle(161, 3, 1e-3, true);
  PlanOptions how;
  how.max_growth = 1e5;
  const Plan plan = MakePlan(saddle, {true}, Rate(4), {0}, Vector::Constant(1, 4.0), how);
  ASSERT_TRUE(plan.needed);
  EXPECT_GT(plan.growth, 1e15);
  // ln(1e5) / 3 is 3.8 s of 16 s.
  EXPECT_GE(plan.arcs.size(), 4U);
  EXPECT_LE(plan.arcs.size(), 7U);
  EXPECT_NEAR(plan.parameters[0], 3, 1e-2);
  for (std::size_t a = 1; a < plan.arcs.size(); ++a)
    EXPECT_EQ(plan.arcs[a].begins.front(), plan.arcs[a - 1].end);
  EXPECT_EQ(plan.arcs.back().end, 161U);
}

}  // namespace
}  // namespace sinew::shooting
