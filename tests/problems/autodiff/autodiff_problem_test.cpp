#include "problems/autodiff/autodiff_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/check_problem.h"
#include "identify/identification/identification.h"
#include "problems/own_model.h"
#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

using testing::HasSubstr;

constexpr double kGravity = 9.81;

/// Two swings of a pendulum of 1 m and its shadow on a wall, which is the sum of all angles so far.
Dataset Swings() {
  Dataset data;
  for (const char* name : {"a", "b"}) {
    Trial& trial = data.trials[name];
    trial.role = data.trials.size() == 1 ? Role::kTrain : Role::kValidate;
    Grid& grid = trial.grids["camera"];
    Channel angle{"rad", ChannelKind::kMeasured, std::nullopt, {}};
    Channel sum = angle;
    double total = 0;
    for (int i = 0; i < 80; ++i) {
      const double t = 0.05 * i;
      grid.time.push_back(t);
      angle.values.push_back((name[0] == 'a' ? 0.3 : 0.2) * std::exp(-0.15 * t) *
                             std::cos(std::sqrt(kGravity) * t));
      total += angle.values.back();
      sum.values.push_back(total);
    }
    grid.channels["angle"] = angle;
    grid.channels["sum"] = sum;
  }
  return data;
}

class Pendulum final : public AutoDiffProblem {
 public:
  explicit Pendulum(const Dataset& data) : AutoDiffProblem(data) {
    length_ = parameter("length", "m").bounds(0.1, 2).start(0.95).meaning("from pivot to mass");
    damping_ = parameter("damping", "1/s").bounds(0, 2).start(0.1).prior(0.1, 1);
    amplitude_ = per_trial("amplitude", "rad").bounds(0.01, 1).start(0.25);
    observe("angle", [this](const auto& p, double t) { return Angle(p, t); });
    observe_signal("sum", [this](const auto& p, const std::vector<double>& time, auto& values) {
      for (std::size_t i = 0; i < time.size(); ++i) {
        values[i] = Angle(p, time[i]);
        if (i > 0) values[i] += values[i - 1];
      }
      if (cut) values.pop_back();
      if (nan) values[5] = 0.0 * p[length_] + std::nan("");
    });
  }

  bool cut = false;
  bool nan = false;

 private:
  template <class P>
  auto Angle(const P& p, double t) const {
    return p[amplitude_] * exp(-p[damping_] * t) * cos(sqrt(kGravity / p[length_]) * t);
  }
  ParameterHandle length_, damping_, amplitude_;
};

TEST(AutoDiffProblem, DerivativesAgreeWithDifferences) {
  const Pendulum pendulum(Swings());
  const auto report = CheckJacobian(pendulum);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->wrong.empty());
  EXPECT_EQ(report->compared, report->columns);
  EXPECT_LT(report->worst, 1e-5);
}

TEST(AutoDiffProblem, FindsParametersAndValuesOfEachTrial) {
  const auto bound = BindModel<Pendulum>(Swings(), false);
  ASSERT_TRUE(bound) << bound.error().message;
  const auto found = Identify(**bound, MakeFitSetup(**bound, {}).value(), {});
  ASSERT_TRUE(found) << found.error().message;
  // The prior pulls the damping by less than this.
  EXPECT_NEAR(found->parameters[0], 1, 1e-3);
  EXPECT_NEAR(found->parameters[1], 0.15, 1e-3);
  EXPECT_NEAR(found->parameters[2], 0.3, 1e-3);
  EXPECT_NEAR(found->parameters[3], 0.2, 1e-3) << "of the validation trial";
  EXPECT_EQ((*bound)->parameters()[3].name, "amplitude@b");
}

TEST(AutoDiffProblem, ATooShortSignalAndAValueThatIsNotFiniteAreNamed) {
  Pendulum pendulum(Swings());
  pendulum.nan = true;
  EXPECT_EQ(ErrorOf(CheckProblem(pendulum)),
            "no prediction at the start values: trial 'a': channel 'sum', sample 5 (t = 0.25 s): the model's "
            "value is nan; with length = 0.95, damping = 0.1, amplitude@a = 0.25");
  pendulum.nan = false;
  pendulum.cut = true;
  EXPECT_THAT(ErrorOf(CheckProblem(pendulum)),
              HasSubstr("trial 'a': channel 'sum': the model returned 79 values, expected 80"));
}

}  // namespace
}  // namespace sinew
