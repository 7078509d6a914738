// Equations whose solutions lose each other: multiple shooting finds them, and says where it cuts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "identify/identification/identification.h"
#include "problems/ode/ode_problem.h"
#include "problems/own_model.h"
#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr double kNoise = 0.2;
constexpr double kSigma = 10;
constexpr double kRho = 28;
constexpr double kBeta = 8.0 / 3;

/// E. N. Lorenz, Deterministic nonperiodic flow (1963). Small differences grow by exp(0.9 t). Only x is
/// measured.
class Lorenz final : public OdeProblem<Lorenz, 3> {
 public:
  explicit Lorenz(const Dataset& data) : OdeProblem(data) {
    sigma_ = parameter("sigma", "1/s").bounds(2, 30).start(12);
    rho_ = parameter("rho", "1").bounds(5, 60).start(25);
    beta_ = parameter("beta", "1/s").bounds(0.5, 10).start(2.2);
    observe("x", state(0));
    initial(1, "y", "1").bounds(-40, 40).start(0);
    initial(2, "z", "1").bounds(0, 60).start(20);
  }
  template <class T>
  void derivative(const Values<T>& p, double /*t*/, const State<T>& x, State<T>& dx) const {
    dx[0] = p[sigma_] * (x[1] - x[0]);
    dx[1] = x[0] * (p[rho_] - x[2]) - x[1];
    dx[2] = x[0] * x[1] - p[beta_] * x[2];
  }

 private:
  ParameterHandle sigma_, rho_, beta_;
};

/// By the classical Runge-Kutta method with short steps, from a point on the attractor.
/// @param noise if not null: gets the root mean square of the noise of the training trial
Dataset Recording(double duration, double interval, std::uint64_t seed, double* noise = nullptr) {
  using Point = std::array<double, 3>;
  const auto rate = [](const Point& x) {
    return Point{kSigma * (x[1] - x[0]), x[0] * (kRho - x[2]) - x[1], x[0] * x[1] - kBeta * x[2]};
  };
  const auto along = [](const Point& x, const Point& v, double h) {
    return Point{x[0] + h * v[0], x[1] + h * v[1], x[2] + h * v[2]};
  };
  constexpr int kSteps = 200;  // per interval
  Random random(seed);
  Dataset data;
  for (const char* name : {"first", "second"}) {
    Trial& trial = data.trials[name];
    trial.role = name == std::string("first") ? Role::kTrain : Role::kValidate;
    Grid& grid = trial.grids["record"];
    std::vector<double> measured;
    double squares = 0;
    Point x{random.Uniform(-10, 10), random.Uniform(-10, 10), random.Uniform(15, 35)};
    const int warm_up = static_cast<int>(5 / interval);
    for (int i = -warm_up; i * interval <= duration; ++i) {
      if (i >= 0) {
        grid.time.push_back(i * interval);
        measured.push_back(x[0] + kNoise * random.Normal());
        squares += std::pow(measured.back() - x[0], 2);
      }
      const double h = interval / kSteps;
      for (int k = 0; k < kSteps; ++k) {
        const Point a = rate(x);
        const Point b = rate(along(x, a, h / 2));
        const Point c = rate(along(x, b, h / 2));
        const Point d = rate(along(x, c, h));
        for (std::size_t s = 0; s < 3; ++s) x[s] += h / 6 * (a[s] + 2 * b[s] + 2 * c[s] + d[s]);
      }
    }
    if (noise != nullptr && trial.role == Role::kTrain)
      *noise = std::sqrt(squares / static_cast<double>(measured.size()));
    grid.channels["x"] = {"1", ChannelKind::kMeasured, kNoise, measured};
  }
  return data;
}

IdentificationOptions WithoutProfiles() {
  IdentificationOptions how;
  how.profiles = false;
  return how;
}

double Rmse(const Problem& problem, const Identification& found, BlockRole role) {
  double sum = 0;
  double count = 0;
  for (std::size_t b = 0; b < problem.layout().size(); ++b) {
    const Block& block = problem.layout()[b];
    if (block.role != role) continue;
    for (std::size_t i = 0; i < block.sample.size(); ++i) {
      sum += std::pow(found.prediction.values[b][block.sample[i]] - block.measured[i], 2);
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

TEST(ChaoticOde, ALorenzRecordingIsFittedAtItsNoiseFromOneMeasuredState) {
  double noise = 0;
  const auto problem = BindModel<Lorenz>(Recording(30, 0.04, 1, &noise), false);
  ASSERT_TRUE(problem.has_value()) << ErrorOf(problem);
  // exp(0.9 * 30) is 5e11: one trajectory cannot be computed, let alone fitted.
  const Vector rest = RestPoint(**problem);
  EXPECT_THAT((*problem)->WarningsAt(rest),
              Contains(testing::Field(&Warning::message, HasSubstr("trial 'first' is predicted as"))));
  auto setup = MakeFitSetup(**problem, {});
  ASSERT_TRUE(setup.has_value());
  auto found = Identify(**problem, *setup, WithoutProfiles());
  ASSERT_TRUE(found.has_value()) << ErrorOf(found);
  EXPECT_TRUE(found->result.stop.converged());
  // What is fitted is nearer to the data than the truth is.
  EXPECT_LT(Rmse(**problem, *found, BlockRole::kTrain), noise);
  EXPECT_GT(Rmse(**problem, *found, BlockRole::kTrain), 0.95 * noise);
  EXPECT_LT(Rmse(**problem, *found, BlockRole::kValidate), 1.1 * kNoise);
  const double truth[] = {kSigma, kRho, kBeta};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found->parameters[i], truth[i], 5e-3 * truth[i]);
}

TEST(ChaoticOde, DerivativesForTheStatesOfEveryTrajectoryAreThoseOfDifferences) {
  const auto problem = BindModel<Lorenz>(Recording(24, 0.04, 2), false);
  ASSERT_TRUE(problem.has_value()) << ErrorOf(problem);
  const auto& parameters = (*problem)->parameters();
  ASSERT_GT(parameters.size(), 3U + 2 * 3);
  const Vector rest = RestPoint(**problem);
  const std::vector<bool> all((*problem)->layout().size(), true);
  const auto workspace = (*problem)->NewWorkspace();
  Prediction here((*problem)->layout());
  Prediction above((*problem)->layout());
  Prediction below((*problem)->layout());
  ASSERT_TRUE((*problem)->Predict({rest, all, true, nullptr}, *workspace, here));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].kind != ParameterKind::kNuisance) continue;
    constexpr double kStep = 1e-5;
    Vector moved = rest;
    moved[static_cast<Eigen::Index>(i)] += kStep;
    ASSERT_TRUE((*problem)->Predict({moved, all, false, nullptr}, *workspace, above));
    moved[static_cast<Eigen::Index>(i)] -= 2 * kStep;
    ASSERT_TRUE((*problem)->Predict({moved, all, false, nullptr}, *workspace, below));
    for (std::size_t b = 0; b < (*problem)->layout().size(); ++b) {
      const auto block = static_cast<int>(b);
      const auto& columns = (*problem)->layout()[b].columns;
      const auto column = std::find(columns.begin(), columns.end(), static_cast<int>(i));
      const Vector change = (above.values(block) - below.values(block)) / (2 * kStep);
      if (column == columns.end()) {
        EXPECT_EQ(change.norm(), 0) << parameters[i].name;
        continue;
      }
      const Vector slope = here.derivatives(block).col(column - columns.begin());
      for (Eigen::Index row = 0; row < slope.size(); ++row) {
        // Where a difference has grown a thousandfold, differences are no longer straight.
        if (std::abs(slope[row]) > 1e3) break;
        ASSERT_NEAR(slope[row], change[row],
                    1e-4 * (1 + std::abs(slope[row])) + 1e-6 * slope.head(row + 1).squaredNorm())
            << parameters[i].name << ", row " << row;
      }
    }
  }
}

TEST(ChaoticOde, AShortRecordingStaysOneTrajectory) {
  const auto problem = BindModel<Lorenz>(Recording(8, 0.02, 3), false);
  ASSERT_TRUE(problem.has_value()) << ErrorOf(problem);
  EXPECT_EQ((*problem)->parameters().size(), 3U + 2 * 3);
  auto setup = MakeFitSetup(**problem, {});
  ASSERT_TRUE(setup.has_value());
  auto found = Identify(**problem, *setup, WithoutProfiles());
  ASSERT_TRUE(found.has_value()) << ErrorOf(found);
  EXPECT_LT(Rmse(**problem, *found, BlockRole::kTrain), 1.1 * kNoise);
  EXPECT_LT(Rmse(**problem, *found, BlockRole::kValidate), 1.1 * kNoise);
}

}  // namespace
}  // namespace sinew
