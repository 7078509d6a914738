#include <gtest/gtest.h>

#include <functional>

#include "base/dual.h"
#include "models/dynamometer/strapped_foot_run.h"
#include "tests/models/dynamometer/strapped_person.h"

namespace sinew {
namespace {

constexpr double kEnd = 1.6;     // [s], a cycle of the plate
constexpr double kStep = 0.005;  // [s]

struct Motion {
  std::vector<double> torque;
  std::vector<double> ankle_angle;
  std::vector<double> fibre_length;  // of the soleus
};

class StrappedFootTest : public testing::Test {
 protected:
  /// see(run) after settling and after every 10 ms.
  template <class T, class See>
  Status Run(const StrappedFoot<T>& foot, double step, const See& see) {
    StrappedFootRun<T> run(geometry_, curves_, paths_, foot, solutions_);
    SINEW_TRY(run.Settle(0, SwingAt(0), BurstsAt<T>(0)));
    see(run, 0.0);
    const auto steps = std::lround(kEnd / step);
    const auto every = std::lround(0.01 / step);
    for (long i = 0; i < steps; ++i) {
      std::array<PlateMotion, ImplicitStep::kStages> plate;
      std::array<std::vector<T>, ImplicitStep::kStages> activation;
      for (std::size_t k = 0; k < plate.size(); ++k) {
        const double t = step * (static_cast<double>(i) + ImplicitStep::kNodes[k]);
        plate[k] = SwingAt(t);
        activation[k] = BurstsAt<T>(t);
      }
      SINEW_TRY(run.Step(step, plate.data(), activation.data()));
      if ((i + 1) % every == 0) see(run, step * static_cast<double>(i + 1));
    }
    return {};
  }

  Motion Simulate(const StrappedFoot<double>& foot, double step = kStep) {
    Motion motion;
    const auto status = Run<double>(foot, step, [&](const StrappedFootRun<double>& run, double t) {
      motion.torque.push_back(run.MachineTorque(SwingAt(t)));
      motion.ankle_angle.push_back(run.instant().ankle_angle);
      motion.fibre_length.push_back(run.fibre_lengths()[0]);
    });
    EXPECT_TRUE(status) << status.error().message;
    return motion;
  }

  const FootGeometry geometry_ = StrappedGeometry();
  const MuscleCurves curves_ = MuscleCurves::Default();
  const std::vector<MusclePath> paths_ = StrappedPaths();
  FootSolutions solutions_;
};

double Largest(const std::vector<double>& a) {
  double largest = 0;
  for (const double x : a) largest = std::max(largest, std::abs(x));
  return largest;
}

double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST_F(StrappedFootTest, SettlesWhereAllMomentsCancel) {
  auto foot = StrappedPerson();
  foot.antagonist = 3;
  for (const double plate : {-0.5, -0.1, 0.25}) {
    for (const double time : {0.0, 0.5}) {
      const auto activation = BurstsAt(time);
      StrappedFootRun<double> run(geometry_, curves_, paths_, foot, solutions_);
      const auto status = run.Settle(0, {plate, 0, 0}, activation);
      ASSERT_TRUE(status) << status.error().message;
      const auto& now = run.instant();
      const double q = now.ankle_angle;
      double muscles = -3 * activation[2];
      for (std::size_t m = 0; m < 2; ++m) {
        muscles += paths_[m].Arm(q) * run.tendon_forces()[m];
        const auto& muscle = foot.muscles[m];
        const double length = run.fibre_lengths()[m];
        EXPECT_NEAR(FibreForce(curves_, muscle, length, 0.0, activation[m]) *
                        PennationCosine(muscle, std::sin(muscle.pennation), length),
                    run.tendon_forces()[m], elastic_tendon::kHold * muscle.isometric_force);
      }
      const double weight = -1.1 * 9.81 * (geometry_.mass_x * std::cos(q) - geometry_.mass_y * std::sin(q));
      const auto boundary = BoundaryLoadAt(geometry_, foot.boundary, {plate, 0, q, 0, 0});
      EXPECT_NEAR(now.muscle_moment, muscles, 1e-9);
      EXPECT_NEAR(muscles + foot.passive.Moment(q, 0.0) + weight + boundary.on_foot, 0, 1e-7);
      EXPECT_EQ(now.torque, boundary.on_plate);
      EXPECT_NE(q, plate);
    }
  }
}

// Soft straps let a strong muscle turn the foot far from the plate.
TEST_F(StrappedFootTest, SettlesFarFromThePlateOrSaysThatItCannot) {
  auto foot = StrappedPerson();
  foot.boundary.strap_pretension = 5;
  foot.boundary.strap_stiffness = 20;
  const std::vector<double> pull = {0, 1, 0.5};  // the dorsiflexor alone
  double farthest = 0;
  bool refused = false;
  for (const double plate : {-0.5, -0.9, -1.5}) {
    if (plate == -1.5) foot.muscles[1].isometric_force *= 20;
    StrappedFootRun<double> run(geometry_, curves_, paths_, foot, solutions_);
    const auto status = run.Settle(0, {plate, 0, 0}, pull);
    if (!status) {
      EXPECT_NE(status.error().message.find("no equilibrium within"), std::string::npos)
          << status.error().message;
      refused = true;
      continue;
    }
    const double q = run.instant().ankle_angle;
    const double weight = -1.1 * 9.81 * (geometry_.mass_x * std::cos(q) - geometry_.mass_y * std::sin(q));
    const auto boundary = BoundaryLoadAt(geometry_, foot.boundary, {plate, 0, q, 0, 0});
    EXPECT_NEAR(run.instant().muscle_moment + foot.passive.Moment(q, 0.0) + weight + boundary.on_foot, 0,
                1e-7);
    farthest = std::max(farthest, q - plate);
  }
  EXPECT_GT(farthest, 0.55);
  EXPECT_TRUE(refused);
}

// The plate is at rest, the muscles are as they were: so is everything.
TEST_F(StrappedFootTest, StaysInEquilibrium) {
  const auto foot = StrappedPerson();
  StrappedFootRun<double> run(geometry_, curves_, paths_, foot, solutions_);
  const PlateMotion still[] = {{0.1, 0, 0}, {0.1, 0, 0}, {0.1, 0, 0}};
  const std::vector<double> activation[] = {BurstsAt(0.3), BurstsAt(0.3), BurstsAt(0.3)};
  ASSERT_TRUE(run.Settle(0, still[0], activation[0]));
  const double angle = run.instant().ankle_angle;
  const double torque = run.instant().torque;
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(run.Step(kStep, still, activation));
  EXPECT_NEAR(run.instant().ankle_angle, angle, 1e-9);
  EXPECT_NEAR(run.instant().torque, torque, 1e-5);
  EXPECT_NEAR(run.instant().ankle_velocity, 0, 1e-9);
}

// At the default step of 5 ms, while strips of the sole touch and let go: far below the noise of torques and
// angles; and smaller still with smaller steps.
TEST_F(StrappedFootTest, TheStepChangesLittle) {
  const auto foot = StrappedPerson();
  const Motion fine = Simulate(foot, 0.000625);
  ASSERT_GT(Largest(fine.torque), 50);
  const auto off = [&](double step) {
    const Motion motion = Simulate(foot, step);
    EXPECT_LT(LargestDifference(motion.fibre_length, fine.fibre_length), 1e-6) << step;
    return std::pair(LargestDifference(motion.torque, fine.torque),
                     LargestDifference(motion.ankle_angle, fine.ankle_angle));
  };
  const auto coarse = off(0.01);
  const auto usual = off(0.005);
  const auto half = off(0.0025);
  EXPECT_LT(usual.first, 0.005);  // N m, of 62
  EXPECT_LT(usual.second, 5e-6);  // rad
  EXPECT_LT(usual.first, coarse.first / 2);
  EXPECT_LT(half.first, usual.first / 2);
  EXPECT_LT(half.second, usual.second / 4);
}

TEST_F(StrappedFootTest, IsTheSameToTheLastBit) {
  const auto foot = StrappedPerson();
  const Motion once = Simulate(foot);
  Simulate(StrappedPerson(), 0.0025);  // other numbers in the memory of the stages
  const Motion again = Simulate(foot);
  EXPECT_EQ(once.torque, again.torque);
  EXPECT_EQ(once.ankle_angle, again.ankle_angle);
  EXPECT_EQ(once.fibre_length, again.fibre_length);
}

TEST_F(StrappedFootTest, SaysWhenNothingBalances) {
  auto foot = StrappedPerson();
  foot.muscles[0].strength = std::nan("");
  StrappedFootRun<double> run(geometry_, curves_, paths_, foot, solutions_);
  const auto status = run.Settle(1.25, SwingAt(0), BurstsAt(0));
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("t = 1.25 s"), std::string::npos) << status.error().message;
}

using D = Dual<8>;

struct Variable {
  const char* name;
  std::function<D&(StrappedFoot<D>&)> dual;
  std::function<double&(StrappedFoot<double>&)> plain;
};

template <class Field>
Variable Of(const char* name, Field field) {
  return {name, field, field};
}

// Derivatives of machine torque, ankle angle and fibre length against central differences.
class StrappedFootDerivatives : public StrappedFootTest {
 protected:
  void Compare(const StrappedFoot<double>& foot, const std::vector<Variable>& variables) {
    const Motion plain = Simulate(foot);
    StrappedFoot<D> dual = InDual(foot);
    for (std::size_t lane = 0; lane < variables.size(); ++lane) {
      D& variable = variables[lane].dual(dual);
      variable = D::Variable(variable.value, static_cast<int>(lane));
    }
    std::vector<D> torque;
    std::vector<D> angle;
    std::vector<D> length;
    const auto status = Run<D>(dual, kStep, [&](const StrappedFootRun<D>& run, double t) {
      torque.push_back(run.MachineTorque(SwingAt(t)));
      angle.push_back(run.instant().ankle_angle);
      length.push_back(run.fibre_lengths()[0]);
    });
    ASSERT_TRUE(status) << status.error().message;
    ASSERT_EQ(torque.size(), plain.torque.size());
    for (std::size_t i = 0; i < torque.size(); ++i) {
      ASSERT_NEAR(torque[i].value, plain.torque[i], 1e-9 * Largest(plain.torque)) << i;
      ASSERT_NEAR(angle[i].value, plain.ankle_angle[i], 1e-12) << i;
    }
    for (std::size_t lane = 0; lane < variables.size(); ++lane) {
      StrappedFoot<double> up = foot;
      StrappedFoot<double> down = foot;
      const double value = std::abs(variables[lane].plain(up));
      const double h = 1e-5 * (value > 0 ? value : 0.01);
      variables[lane].plain(up) += h;
      variables[lane].plain(down) -= h;
      const Motion above = Simulate(up);
      const Motion below = Simulate(down);
      const auto worst = [&](const std::vector<D>& found, const std::vector<double>& high,
                             const std::vector<double>& low) {
        double off = 0;
        double size = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
          const double expected = (high[i] - low[i]) / (2 * h);
          off = std::max(off, std::abs(found[i].d[lane] - expected));
          size = std::max(size, std::abs(expected));
        }
        EXPECT_GT(size, 0) << variables[lane].name;
        return off / size;
      };
      EXPECT_LT(worst(torque, above.torque, below.torque), 1e-3) << variables[lane].name;
      EXPECT_LT(worst(angle, above.ankle_angle, below.ankle_angle), 1e-3) << variables[lane].name;
      EXPECT_LT(worst(length, above.fibre_length, below.fibre_length), 1e-3) << variables[lane].name;
    }
  }

  static StrappedFoot<D> InDual(const StrappedFoot<double>& foot) {
    StrappedFoot<D> dual = Converted<D>(foot);
    const Attachment<double>& a = foot.attachment;
    dual.attachment = {a.inertia,          a.gravity,          a.gravity_angle, a.viscous_friction,
                       a.coulomb_friction, a.one_way_friction, a.load_friction, a.stiffness};
    return dual;
  }
};

TEST_F(StrappedFootDerivatives, OfTheBoundary) {
  Compare(StrappedPerson(),
          {Of(
               "boundary.sole_stiffness", [](auto& f) -> auto& { return f.boundary.sole_stiffness; }),
           Of(
               "boundary.sole_dissipation", [](auto& f) -> auto& { return f.boundary.sole_dissipation; }),
           Of(
               "boundary.friction", [](auto& f) -> auto& { return f.boundary.friction; }),
           Of(
               "boundary.strap_stiffness", [](auto& f) -> auto& { return f.boundary.strap_stiffness; }),
           Of(
               "boundary.strap_exponent", [](auto& f) -> auto& { return f.boundary.strap_exponent; }),
           Of(
               "boundary.strap_pretension", [](auto& f) -> auto& { return f.boundary.strap_pretension; }),
           Of(
               "boundary.axis_x", [](auto& f) -> auto& { return f.boundary.axis_x; }),
           Of(
               "boundary.axis_y", [](auto& f) -> auto& { return f.boundary.axis_y; })});
}

TEST_F(StrappedFootDerivatives, OfThePerson) {
  Compare(StrappedPerson(),
          {Of(
               "passive.stiffness", [](auto& f) -> auto& { return f.passive.stiffness; }),
           Of(
               "passive.exponent", [](auto& f) -> auto& { return f.passive.exponent; }),
           Of(
               "passive.damping", [](auto& f) -> auto& { return f.passive.damping; }),
           Of(
               "antagonist", [](auto& f) -> auto& { return f.antagonist; }),
           Of(
               "muscles[0].strength", [](auto& f) -> auto& { return f.muscles[0].strength; }),
           Of(
               "muscles[1].strength", [](auto& f) -> auto& { return f.muscles[1].strength; }),
           Of(
               "muscles[0].tendon_slack_length",
               [](auto& f) -> auto& { return f.muscles[0].tendon_slack_length; }),
           Of(
               "muscles[0].optimal_length", [](auto& f) -> auto& { return f.muscles[0].optimal_length; })});
}

TEST_F(StrappedFootDerivatives, OfEffects) {
  auto foot = StrappedPerson();
  foot.boundary.bent_sole = true;
  foot.boundary.sole_exponent = 0.2;
  foot.passive_relaxation = {20, 0.4};
  foot.boundary_relaxation = {30, 0.3};
  foot.history.assign(2, {0.2, 0.1});
  foot.remembers = true;
  Compare(
      foot,
      {Of(
           "boundary.sole_exponent", [](auto& f) -> auto& { return f.boundary.sole_exponent; }),
       Of(
           "passive.hysteresis", [](auto& f) -> auto& { return f.passive.hysteresis; }),
       Of(
           "passive_relaxation.stiffness", [](auto& f) -> auto& { return f.passive_relaxation.stiffness; }),
       Of(
           "passive_relaxation.time", [](auto& f) -> auto& { return f.passive_relaxation.time; }),
       Of(
           "boundary_relaxation.stiffness", [](auto& f) -> auto& { return f.boundary_relaxation.stiffness; }),
       Of(
           "boundary_relaxation.time", [](auto& f) -> auto& { return f.boundary_relaxation.time; }),
       Of(
           "history[0].first", [](auto& f) -> auto& { return f.history[0].first; }),
       Of(
           "history[0].second", [](auto& f) -> auto& { return f.history[0].second; })});
}

}  // namespace
}  // namespace sinew
