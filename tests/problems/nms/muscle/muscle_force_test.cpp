#include "problems/nms/muscle/muscle_force.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "datasets/io/storage_file.h"
#include "problems/nms/ceinms/subject.h"

namespace sinew {
namespace {

MuscleSignals Signals(double rate = 100) {
  MuscleSignals signals;
  for (int k = -60; k <= 1000; ++k) {
    const double t = 0.001 * k;
    signals.excitation_time.push_back(t);
    signals.excitation.push_back(0.05 + 0.8 * std::pow(std::sin(4 * t), 4));
  }
  for (int i = 0; i <= static_cast<int>(rate); ++i) {
    const double t = i / rate;
    signals.time.push_back(t);
    signals.unit_length.push_back(0.3 + 0.01 * std::sin(5 * t));
  }
  return signals;
}

std::array<double, kMuscleSlots> Soleus(bool as_ceinms) {
  return {as_ceinms ? -0.5 : 0.015,
          as_ceinms ? 0.04 : 0.1,
          -1.2,
          0.015,
          0.05,
          0.25,
          3549,
          1.1,
          0.436,
          0.15,
          0.1,
          10};
}

// With something of every effect.
std::array<double, kMuscleSlots> WithEffects(std::array<double, kMuscleSlots> at) {
  at[kEmgGain] = 0.1;
  at[kEmgDrift] = 0.03;
  at[kCoContraction] = 0.02;
  at[kCrossTalk] = 0.1;
  at[kEnhancement] = 0.6;
  at[kDepression] = 0.4;
  at[kTendonCompliance] = 0.5;
  at[kAngleOffset] = 0.05;
  return at;
}

struct Mode {
  TendonMode tendon;
  bool as_ceinms;
};
const Mode kModes[] = {{TendonMode::kRigid, false},       {TendonMode::kRigid, true},
                       {TendonMode::kEquilibrium, false}, {TendonMode::kEquilibrium, true},
                       {TendonMode::kElastic, false},     {TendonMode::kElastic, true}};

TEST(MuscleForceTest, DerivativesAreThoseOfDifferences) {
  const MuscleCurves curves = MuscleCurves::Default();
  MuscleSignals signals = Signals();
  for (const double t : signals.excitation_time) signals.others.push_back(0.1 + 0.1 * std::cos(3 * t));
  signals.number_of_others = 3;
  signals.arms.emplace_back();
  signals.arm_slopes.emplace_back();
  for (const double t : signals.time) {
    signals.arms[0].push_back(0.04 + 0.01 * std::cos(5 * t));
    signals.arm_slopes[0].push_back(0.02 * std::sin(3 * t));
  }
  using Lanes = Dual<kMuscleSlots>;
  for (const Mode& mode : kModes) {
    const MuscleModel model{mode.tendon, ActivationShape::kExponential, mode.as_ceinms};
    const auto at = WithEffects(Soleus(mode.as_ceinms));
    std::array<Lanes, kMuscleSlots> lanes;
    for (int i = 0; i < kMuscleSlots; ++i) lanes[i] = Lanes::Variable(at[static_cast<std::size_t>(i)], i);
    MuscleTrace<Lanes> exact;
    ASSERT_TRUE(ComputeMuscleForce(curves, model, lanes, signals, exact));
    MuscleTrace<double> plain;
    ASSERT_TRUE(ComputeMuscleForce(curves, model, at, signals, plain));
    for (std::size_t slot = 0; slot < at.size(); ++slot) {
      if (mode.as_ceinms && slot == kDelay) continue;  // whole samples: not smooth
      if (slot > kAngleOffset) continue;               // of joints that the muscle does not cross
      if (mode.tendon != TendonMode::kRigid && slot == kTendonCompliance) continue;  // not asked for
      auto up = at;
      auto down = at;
      // Between two samples of the excitation, straight lines have a slope.
      const double step = slot == kDelay ? 1e-7 : 1e-5 * std::abs(at[slot]);
      const double shift = slot == kDelay ? 3e-4 : 0;
      up[slot] += shift + step;
      down[slot] += shift - step;
      std::array<Lanes, kMuscleSlots> moved = lanes;
      moved[slot].value += shift;
      MuscleTrace<Lanes> there;
      MuscleTrace<double> above;
      MuscleTrace<double> below;
      ASSERT_TRUE(ComputeMuscleForce(curves, model, moved, signals, there));
      ASSERT_TRUE(ComputeMuscleForce(curves, model, up, signals, above));
      ASSERT_TRUE(ComputeMuscleForce(curves, model, down, signals, below));
      double largest = 0;
      double worst = 0;
      for (std::size_t i = 0; i < signals.time.size(); ++i) {
        const double slope = (above.tendon_force[i] - below.tendon_force[i]) / (2 * step);
        largest = std::max(largest, std::abs(slope));
        worst = std::max(worst, std::abs(there.tendon_force[i].d[slot] - slope));
      }
      EXPECT_LT(worst, 2e-4 * largest) << "slot " << slot << " mode " << static_cast<int>(mode.tendon)
                                       << (mode.as_ceinms ? " as CEINMS" : "");
      EXPECT_GT(largest, 0) << slot;
    }
    for (std::size_t i = 0; i < signals.time.size(); ++i)
      EXPECT_NEAR(exact.tendon_force[i].value, plain.tendon_force[i], 1e-6);
  }
}

// Two implicit ways to the same fibre.
TEST(MuscleForceTest, EquilibriumAndIntegratedTendonAgree) {
  const MuscleCurves curves = MuscleCurves::Default();
  const MuscleSignals signals = Signals(1000);
  MuscleTrace<double> spline;
  MuscleTrace<double> integrated;
  ASSERT_TRUE(ComputeMuscleForce(curves, {TendonMode::kEquilibrium}, Soleus(false), signals, spline));
  ASSERT_TRUE(ComputeMuscleForce(curves, {TendonMode::kElastic}, Soleus(false), signals, integrated));
  const double peak = *std::max_element(spline.tendon_force.begin(), spline.tendon_force.end());
  for (std::size_t i = 20; i < signals.time.size(); ++i)
    EXPECT_NEAR(spline.tendon_force[i], integrated.tendon_force[i], 2e-3 * peak) << i;
}

// Electromechanical delay: the same force, later.
TEST(MuscleForceTest, ADelayShiftsTheActivation) {
  const MuscleCurves curves = MuscleCurves::Default();
  const MuscleSignals signals = Signals();
  auto late = Soleus(false);
  late[kDelay] += 0.02;
  MuscleTrace<double> first;
  MuscleTrace<double> second;
  ASSERT_TRUE(ComputeMuscleForce(curves, {}, Soleus(false), signals, first));
  ASSERT_TRUE(ComputeMuscleForce(curves, {}, late, signals, second));
  for (std::size_t i = 5; i + 2 < signals.time.size(); ++i)
    EXPECT_NEAR(second.activation[i + 2], first.activation[i], 1e-9) << i;
}

// CEINMS's own output for its own project.
class AgainstCeinms : public testing::TestWithParam<int> {
 protected:
  static std::string Path(const std::string& name) { return SINEW_SHARED_DATA "/ceinms_example/" + name; }
  void SetUp() override {
    if (!std::filesystem::exists(Path("true.xml"))) GTEST_SKIP() << "needs the shared data";
    std::ifstream file(Path("true.xml"));
    std::stringstream text;
    text << file.rdbuf();
    auto read = ReadCeinmsSubject(text.str(), "true.xml");
    ASSERT_TRUE(read) << read.error().message;
    subject_ = std::move(read->subject);
  }

  [[nodiscard]] MuscleCurves Curves(bool natural) const {
    if (!natural) return MuscleCurves::Default();
    const auto curve = [&](SubjectCurve which) {
      return *MuscleCurve::Natural(subject_.curves[which].x, subject_.curves[which].y);
    };
    return {curve(kActiveForceLength), curve(kPassiveForceLength), curve(kForceVelocity),
            curve(kTendonForceStrain)};
  }

  static Storage Table(const std::string& name) {
    auto table = ReadStorage(Path(name));
    EXPECT_TRUE(table) << table.error().message;
    return *table;
  }

  /// Largest root mean square difference of a joint's torque, as a share of its range.
  double Difference(const MuscleModel& model, const MuscleCurves& curves, const std::string& output) const {
    const std::string trial = "trial" + std::to_string(GetParam());
    const Storage lengths = Table(trial + "/Length.sto");
    const Storage emg = Table(trial + "/emg.mot");
    const Storage torques =
        Table("reference_output/" + output + "_" + std::to_string(GetParam()) + "/Torques.sto");
    double worst = 0;
    for (const auto& [dof, muscles] : subject_.dofs) {
      const Storage arms = Table(trial + "/MomentArm_" + dof + ".sto");
      std::vector<double> torque(lengths.time.size(), 0);
      for (const std::string& name : muscles) {
        const SubjectMuscle& m = *subject_.Find(name);
        MuscleSignals signals;
        signals.excitation_time = emg.time;
        signals.excitation = *emg.Find(name);
        signals.time = lengths.time;
        signals.unit_length = *lengths.Find(name);
        for (double& e : signals.excitation) e = std::clamp(e, 0.0, 1.0);
        const double mean = 0.5 * (m.c1 + m.c2);
        const double spread = std::pow(0.5 * (m.c1 - m.c2) / (1 + mean), 2);
        const std::array<double, kMuscleSlots> p{mean,
                                                 spread,
                                                 m.shape_factor,
                                                 m.delay,
                                                 m.optimal_fibre_length,
                                                 m.tendon_slack_length,
                                                 m.maximal_isometric_force,
                                                 m.strength_coefficient,
                                                 m.pennation_angle,
                                                 m.percentage_change,
                                                 m.damping,
                                                 m.maximal_contraction_velocity};
        MuscleTrace<double> trace;
        const Status status = ComputeMuscleForce(curves, model, p, signals, trace);
        EXPECT_TRUE(status) << status.error().message;
        for (std::size_t i = 0; i < torque.size(); ++i)
          torque[i] += (*arms.Find(name))[i] * trace.tendon_force[i];
      }
      const std::vector<double>& reference = *torques.Find(dof);
      double squares = 0;
      for (std::size_t i = 0; i < reference.size(); ++i) squares += std::pow(torque[i] - reference[i], 2);
      const auto [low, high] = std::minmax_element(reference.begin(), reference.end());
      const double share = std::sqrt(squares / static_cast<double>(reference.size())) / (*high - *low);
      RecordProperty(output + "_" + dof, std::to_string(100 * share) + " %");
      worst = std::max(worst, share);
    }
    return worst;
  }

  Subject subject_;
};

TEST_P(AgainstCeinms, RigidTendonAsCeinms) {
  EXPECT_LT(
      Difference({TendonMode::kRigid, ActivationShape::kExponential, true}, Curves(true), "out_true_stiff"),
      2e-4);
}

TEST_P(AgainstCeinms, EquilibriumTendonAsCeinms) {
  EXPECT_LT(Difference({TendonMode::kEquilibrium, ActivationShape::kExponential, true}, Curves(true),
                       "out_true_equilibriumElastic"),
            2e-4);
}

TEST_P(AgainstCeinms, RigidTendonWithOurCurves) {
  EXPECT_LT(
      Difference({TendonMode::kRigid, ActivationShape::kExponential, true}, Curves(false), "out_true_stiff"),
      1e-2);
}

TEST_P(AgainstCeinms, EquilibriumTendonWithOurCurves) {
  EXPECT_LT(Difference({TendonMode::kEquilibrium, ActivationShape::kExponential, true}, Curves(false),
                       "out_true_equilibriumElastic"),
            1e-2);
}

INSTANTIATE_TEST_SUITE_P(Trials, AgainstCeinms, testing::Values(1, 2, 3));

}  // namespace
}  // namespace sinew
