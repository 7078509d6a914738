#include "problems/ankle_study/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "models/emg/butterworth.h"
#include "problems/nms/ceinms/subject.h"

namespace sinew {
namespace {

constexpr double kHighest = 15 * kPi / 180;
constexpr double kLowest = -30 * kPi / 180;
constexpr double kTurn = 0.15;           // [s] to reach the speed
constexpr double kFloor = 0.02;          // of excitations
constexpr double kHeightScatter = 0.25;  // from cycle to cycle
constexpr double kTimeScatter = 0.02;    // of the cycle
constexpr double kSlowest = 30 * kPi / 180;
constexpr double kAmplifierNoise = 2e-6;    // [V]
constexpr double kConverterStep = 0x1p-20;  // [V] about 1 uV

}  // namespace

// Forces and lengths of the right leg of gait2392 (Delp et al. 1990), moment arms near those of its geometry
// (dorsiflexion is positive). The knee is bent: gastrocnemii are shorter than at their best.
const std::array<StudyMuscle, kStudyMuscles>& StudyMuscles() {
  static const std::array<StudyMuscle, kStudyMuscles> kMuscles{{
      {"lat_gas_r", 683, 0.064, 0.380, 0.140, 0.92, {-0.046, -0.010, 0.030}, 0.35, 0.26, 0.08},
      {"med_gas_r", 1558, 0.060, 0.390, 0.297, 0.90, {-0.047, -0.011, 0.030}, 0.45, 0.22, 0.09},
      {"soleus_r", 3549, 0.050, 0.250, 0.436, 1.00, {-0.045, -0.010, 0.030}, 0.50, 0.24, 0.11},
      {"tib_ant_r", 905, 0.098, 0.223, 0.087, 0.95, {0.041, -0.006, -0.020}, 0.55, 0.75, 0.10},
      {"per_long_r", 943, 0.049, 0.345, 0.175, 0.95, {-0.012, -0.004, 0.010}, 0.35, 0.20, 0.13},
      {"per_brev_r", 435, 0.050, 0.161, 0.087, 0.95, {-0.009, -0.003, 0.010}, 0.30, 0.30, 0.12},
      {"per_tert_r", 180, 0.079, 0.100, 0.227, 0.95, {0.028, -0.004, -0.010}, 0.40, 0.71, 0.12},
  }};
  return kMuscles;
}

double MomentArm(const StudyMuscle& muscle, double angle) {
  return muscle.arm[0] + angle * (muscle.arm[1] + angle * muscle.arm[2]);
}

double UnitLength(const StudyMuscle& muscle, double angle) {
  const double fibre = muscle.fibre * muscle.optimal_length;
  const double thickness = muscle.optimal_length * std::sin(muscle.pennation);
  const double at_zero = muscle.slack_length + std::sqrt(fibre * fibre - thickness * thickness);
  return at_zero - angle * (muscle.arm[0] + angle * (muscle.arm[1] / 2 + angle * muscle.arm[2] / 3));
}

double StudyMotion::cycle() const {
  return 2 * ((kHighest - kLowest) / speed + kTurn);
}

StudyMotion::At StudyMotion::Get(double time) const {
  const double half = 0.5 * cycle();
  const double halves = std::floor(time / half);
  const double since = time - halves * half;
  const bool down = std::fmod(std::abs(halves), 2) == 0;
  // Of the way down: a ramp, constant speed, a ramp.
  const auto ramp = [](double t) { return 0.5 * (t - kTurn / kPi * std::sin(kPi * t / kTurn)); };
  const auto ramp_velocity = [](double t) { return 0.5 * (1 - std::cos(kPi * t / kTurn)); };
  const auto ramp_acceleration = [](double t) { return 0.5 * kPi / kTurn * std::sin(kPi * t / kTurn); };
  At at;
  double way = 0;
  if (since < kTurn) {
    way = speed * ramp(since);
    at.velocity = speed * ramp_velocity(since);
    at.acceleration = speed * ramp_acceleration(since);
  } else if (since > half - kTurn) {
    way = (kHighest - kLowest) - speed * ramp(half - since);
    at.velocity = speed * ramp_velocity(half - since);
    at.acceleration = -speed * ramp_acceleration(half - since);
  } else {
    way = speed * (ramp(kTurn) + since - kTurn);
    at.velocity = speed;
  }
  at.angle = down ? kHighest - way : kLowest + way;
  if (down) {
    at.velocity = -at.velocity;
    at.acceleration = -at.acceleration;
  }
  return at;
}

std::vector<std::vector<double>> DrawExcitations(const StudyMotion& motion, double first, std::size_t count,
                                                 double rate, Random& random) {
  const double cycle = motion.cycle();
  const int first_cycle = static_cast<int>(std::floor(first / cycle)) - 1;
  const int last_cycle = static_cast<int>(std::ceil((first + static_cast<double>(count) / rate) / cycle));
  // Faster movements are pushed harder.
  const double effort = 0.8 + 0.2 * (motion.speed - kSlowest) / (3 * kSlowest);
  std::vector<std::vector<double>> excitations;
  for (const StudyMuscle& muscle : StudyMuscles()) {
    std::vector<double> e(count, kFloor);
    for (int k = first_cycle; k <= last_cycle; ++k) {
      const double height = effort * muscle.amplitude * std::max(0.2, 1 + kHeightScatter * random.Normal());
      const double centre = (k + muscle.centre + kTimeScatter * random.Normal()) * cycle;
      const double width = muscle.width * cycle;
      for (std::size_t i = 0; i < count; ++i) {
        const double away = (first + static_cast<double>(i) / rate - centre) / width;
        if (std::abs(away) < 6) e[i] += height * std::exp(-0.5 * away * away);
      }
    }
    for (double& value : e) value = std::min(value, 1.0);
    excitations.push_back(std::move(e));
  }
  return excitations;
}

std::vector<double> DrawRawEmg(const std::vector<double>& excitation, Random& random) {
  static const FilterSections kBand = ButterworthBandPass(2, 20, 400, kStudyEmgRate).value();
  CausalFilter filter(kBand);
  constexpr int kWarmUp = 500;
  for (int i = 0; i < kWarmUp; ++i) filter.Next(random.Normal());
  std::vector<double> raw;
  double square = 0;
  for (std::size_t i = 0; i < excitation.size(); ++i) {
    raw.push_back(filter.Next(random.Normal()));
    square += raw.back() * raw.back();
  }
  // The mean size of normal noise is sqrt(2 / pi) of its standard deviation.
  const double scale =
      kStudyFullEmg / std::sqrt(2 / kPi * square / static_cast<double>(std::max<std::size_t>(raw.size(), 1)));
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const double volts = excitation[i] * scale * raw[i] + kAmplifierNoise * random.Normal();
    raw[i] = kConverterStep * std::round(volts / kConverterStep);
  }
  return raw;
}

std::vector<double> StudyTimes(double first, double rate, std::size_t count) {
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(first + static_cast<double>(i) / rate);
  return times;
}

Channel StudyInput(const char* unit, std::vector<double> values) {
  return {unit, ChannelKind::kInput, {}, std::move(values)};
}

std::string StudySubjectXml(const std::vector<std::string>& muscles) {
  const auto list = [](const std::vector<double>& values) {
    return fmt::format("{}", fmt::join(values, " "));
  };
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<subject>\n  <mtuDefault>\n    <emDelay>0.04</emDelay>\n"
      "    <percentageChange>0.15</percentageChange>\n    <damping>0.1</damping>\n";
  for (int which = 0; which < kSubjectCurves; ++which) {
    const CurvePoints& points = CeinmsCurvePoints()[static_cast<std::size_t>(which)];
    text += fmt::format(
        "    <curve>\n      <name>{}</name>\n      <xPoints>{}</xPoints>\n      <yPoints>{}</yPoints>\n"
        "    </curve>\n",
        CeinmsCurveName(static_cast<SubjectCurve>(which)), list(points.x), list(points.y));
  }
  text += "  </mtuDefault>\n  <mtuSet>\n";
  std::string names;
  for (const StudyMuscle& m : StudyMuscles()) {
    if (!muscles.empty() && std::find(muscles.begin(), muscles.end(), m.name) == muscles.end()) continue;
    text += fmt::format(
        "    <mtu>\n      <name>{}</name>\n      <c1>-0.7</c1>\n      <c2>-0.7</c2>\n"
        "      <shapeFactor>-0.5</shapeFactor>\n      <optimalFibreLength>{}</optimalFibreLength>\n"
        "      <pennationAngle>{}</pennationAngle>\n      <tendonSlackLength>{}</tendonSlackLength>\n"
        "      <maxIsometricForce>{}</maxIsometricForce>\n      "
        "<strengthCoefficient>1</strengthCoefficient>\n"
        "    </mtu>\n",
        m.name, m.optimal_length, m.pennation, m.slack_length, m.isometric_force);
    names += (names.empty() ? "" : " ") + std::string(m.name);
  }
  text += fmt::format(
      "  </mtuSet>\n  <dofSet>\n    <dof>\n      <name>{}</name>\n      <mtuNameSet>{}</mtuNameSet>\n"
      "    </dof>\n  </dofSet>\n</subject>\n",
      kStudyJoint, names);
  return text;
}

std::string StudyNmsSettings(const StudyNmsChoice& choice) {
  constexpr const char* kText = R"(# {comment}
nms:
  subject: subject.xml
  tendon: rigid
  joints: [ankle_angle_r]
  parameters:
    strength:
      groups:
        triceps: [lat_gas_r, med_gas_r, soleus_r]
        peronei: [{peronei}]
        dorsiflexors: [{dorsiflexors}]
      lower: {lower}
      upper: {upper}
    shape:
      groups:
        plantarflexors: [lat_gas_r, med_gas_r, soleus_r, {peronei}]
        dorsiflexors: [{dorsiflexors}]
      lower: -3
      upper: 0
    tendon_slack_length:
      groups:
        triceps: [lat_gas_r, med_gas_r, soleus_r]
        dorsiflexors: [{dorsiflexors}]
      lower: 0.95
      upper: 1.05
      relative: true
)";
  return fmt::format(kText, fmt::arg("comment", choice.comment), fmt::arg("peronei", choice.peronei),
                     fmt::arg("dorsiflexors", choice.dorsiflexors), fmt::arg("lower", choice.lower),
                     fmt::arg("upper", choice.upper));
}

}  // namespace sinew
