#include "problems/ankle_on_dynamometer/stepper.h"

#include <gtest/gtest.h>

#include "problems/ankle_on_dynamometer/laboratory/synthesis.h"
#include "tests/support/allocation_counter.h"

namespace sinew {
namespace {

const std::map<std::string, double> kTruth{{"attachment_inertia", 0.07},
                                           {"attachment_gravity", 3.1},
                                           {"attachment_gravity_angle", 0.2},
                                           {"attachment_friction", 0.3},
                                           {"sole_stiffness", 7e6},
                                           {"sole_friction", 0.25},
                                           {"strap_stiffness", 8e3},
                                           {"strap_exponent", 60},
                                           {"strap_pretension", 35},
                                           {"passive_stiffness", 14},
                                           {"passive_exponent", 4.5},
                                           {"passive_linear_stiffness", 4},
                                           {"passive_damping", 0.5},
                                           {"shape", -0.9},
                                           {"filter_time", 0.03},
                                           {"delay", 0.05},
                                           {"strength.triceps", 1.1},
                                           {"strength.dorsiflexors", 0.9},
                                           {"tendon_slack_length.triceps", 1.005},
                                           {"tendon_slack_length.dorsiflexors", 0.995}};

class Stepper : public testing::Test {
 protected:
  static constexpr double kRate = 1000;

  void SetUp() override {
    SynthesisRequest request;
    request.set = {{"duration", 2},         {"rate", kRate}, {"speeds", 1},
                   {"attachment_alone", 0}, {"passive", 0},  {"isometric", 0}};
    request.set.insert(kTruth.begin(), kTruth.end());
    request.noise = 0;
    auto made = SynthesizeAnkle(request);
    ASSERT_TRUE(made) << made.error().message;
    data_ = std::move(*made);
    const auto yaml =
        YamlReader::Parse(data_.files.at("ankle_on_dynamometer.yaml"), "ankle_on_dynamometer.yaml").value();
    settings_ = ReadAnkleSettings(yaml.At("ankle_on_dynamometer").value()).value();
    const Trial& trial = data_.trials.at("active_060");
    angle_ = trial.Find("machine_angle").channel->values;
    torque_ = trial.Find("machine_torque").channel->values;
    const Grid& emg = trial.grids.at("excitations");
    first_ = static_cast<std::size_t>(-emg.time.front() * kRate + 0.5);
    for (const AnkleMuscle& muscle : settings_.muscles)
      excitations_.push_back(emg.channels.at(muscle.excitation).values);
  }

  [[nodiscard]] std::vector<double> ExcitationsAt(std::size_t sample) const {
    std::vector<double> now;
    for (const auto& values : excitations_) now.push_back(values[first_ + sample]);
    return now;
  }

  Dataset data_;
  AnkleSettings settings_;
  std::vector<double> angle_;
  std::vector<double> torque_;
  std::vector<std::vector<double>> excitations_;
  std::size_t first_ = 0;
};

// The low-pass of 100 Hz delays the angle by 3 ms, the recorded excitations before the trial are not known to
// it.
TEST_F(Stepper, FollowsTheLaboratorySampleBySample) {
  auto stepper = AnkleStepper::Make(settings_, kTruth, kRate, 100);
  ASSERT_TRUE(stepper) << stepper.error().message;
  ASSERT_TRUE((*stepper)->Begin(angle_[0], ExcitationsAt(0).data()));
  double squares = 0;
  double size = 0;
  std::size_t count = 0;
  for (std::size_t i = 1; i < angle_.size(); ++i) {
    const auto torque = (*stepper)->Step(angle_[i], ExcitationsAt(i).data());
    ASSERT_TRUE(torque) << torque.error().message;
    if (i < 300) continue;
    squares += std::pow(*torque - torque_[i], 2);
    size += std::pow(torque_[i], 2);
    ++count;
  }
  EXPECT_LT(std::sqrt(squares / size), 0.03);
  std::printf("torque: error %.3f N m, size %.1f N m (root mean squares)\n",
              std::sqrt(squares / static_cast<double>(count)), std::sqrt(size / static_cast<double>(count)));
}

#ifdef SINEW_COUNTS_ALLOCATIONS
TEST_F(Stepper, AllocatesNothingAfterTheFirstStep) {
  auto stepper = AnkleStepper::Make(settings_, kTruth, kRate);
  ASSERT_TRUE(stepper) << stepper.error().message;
  const std::vector<double> excitations = ExcitationsAt(0);
  ASSERT_TRUE((*stepper)->Begin(angle_[0], excitations.data()));
  ASSERT_TRUE((*stepper)->Step(angle_[1], excitations.data()));
  const long before = Allocations();
  for (std::size_t i = 2; i < 200; ++i) ASSERT_TRUE((*stepper)->Step(angle_[i], excitations.data()));
  EXPECT_EQ(Allocations() - before, 0);
}
#endif

TEST_F(Stepper, WrongNumbersAreErrors) {
  EXPECT_FALSE(AnkleStepper::Make(settings_, {{"strap_stifness", 1e3}}, kRate));
  EXPECT_FALSE(AnkleStepper::Make(settings_, {{"strap_stiffness", -1}}, kRate));
  EXPECT_FALSE(AnkleStepper::Make(settings_, {}, 10));
  EXPECT_FALSE(AnkleStepper::Make(settings_, {}, kRate, 400));
  auto stepper = AnkleStepper::Make(settings_, {}, kRate);
  ASSERT_TRUE(stepper);
  EXPECT_FALSE((*stepper)->Step(0, ExcitationsAt(0).data())) << "before Begin";
}

}  // namespace
}  // namespace sinew
