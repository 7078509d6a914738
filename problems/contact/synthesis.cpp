#include "problems/contact/synthesis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "models/contact/contact_sums.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_reader.h"
#include "problems/contact/effect_load.h"
#include "problems/contact/nao_like_osim.h"
#include "problems/contact/stepping_robot.h"
#include "problems/contact/truth.h"
#include "problems/kit/experiment_settings.h"

namespace sinew {
namespace {

constexpr double kPlateRate = 960;  // [Hz]
constexpr int kEvery = 16;          // the export keeps 60 Hz
constexpr double kMargin = 0.2;     // [s] of motion before and after the stance
constexpr double kTransitionVelocity = 0.01;
const Vec3 kSoleSize(0.16, 0.02, 0.09);
const Vec3 kSolePosition(0.02, -0.04519, 0);

const char* const kSettingsText =
    R"(# How the contact problem sees this robot: one box per sole, both with the same parameters.
contact:
  model: model.osim
  floor_height: 0.0
  transition_velocity: 0.01
  objective: thesis
  fit: [force_y]
  regions:
    - name: right_sole
      body: calcn_r
      plate: right
      position: [0.02, -0.04519, 0.0]
      mesh: {box: {size: [0.16, 0.02, 0.09], strips: [12, 7]}}
    - name: left_sole
      body: calcn_l
      plate: left
      position: [0.02, -0.04519, 0.0]
      mesh: {box: {size: [0.16, 0.02, 0.09], strips: [12, 7]}}
  parameters:
    stiffness: {lower: 1.0e4, upper: 1.0e7, start: 1.0e5}
    dissipation: {lower: 0, upper: 600, start: 10}
)";

constexpr ExperimentSetting kSettings[] = {
    {"stiffness", 9e5, 1e4, 1e7, "true stiffness [N/m3]"},
    {"dissipation", 30, 0, 600, "true dissipation [s/m]"},
    {"static_friction", 0.9, 0, 15, "true static friction"},
    {"dynamic_friction", 0.6, 0, 15, "true dynamic friction"},
    {"viscous_friction", 0.5, 0, 15, "true viscous friction [s/m]"},
    {"train", 3, 1, 20, "number of training stances"},
    {"validate", 2, 0, 20, "number of validation stances"},
    {"slip", 0.05, 0, 0.5, "speed of sliding after strike and at push-off [m/s]"},
    {"force_noise", 0.9, 0, 100, "of the vertical force [N]; a half of it along x and z"},
    {"marker_noise", 2e-5, 0, 0.01, "of every marker coordinate [m]"},
    {"encoders", 0, 0, 1, "1: the coordinates are recorded too, without noise (joint encoders)"},
    {"fine", 1, 0, 1,
     "0: the truth is the fitted model itself, its mesh and a motion known 60 times a second"},
};

using Values = std::map<std::string, double>;

Step DrawStep(Random& random, bool right, double slip) {
  Step step;
  step.right = right;
  step.walking_speed *= random.Uniform(0.9, 1.1);
  step.depth *= random.Uniform(0.93, 1.07);
  step.strike_pitch *= random.Uniform(0.8, 1.2);
  step.push_off_pitch *= random.Uniform(0.8, 1.2);
  step.slip_speed = slip * random.Uniform(0.8, 1.2);
  step.roll *= random.Uniform(0.5, 1.5);
  return step;
}

// Coordinates of the robot, `rate` times a second from -kMargin to the end of the stance plus kMargin.
struct Motion {
  std::vector<double> time;
  Matrix values;  // [time x coordinates of the model]
};

Result<Motion> Move(const Step& step, const MultibodyModel& model, double rate) {
  Motion motion;
  const int count = static_cast<int>(std::floor((step.duration + 2 * kMargin) * rate + 1e-9)) + 1;
  const auto& names = model.coordinate_names();
  motion.values.resize(count, static_cast<Eigen::Index>(names.size()));
  for (int i = 0; i < count; ++i) {
    motion.time.push_back(-kMargin + i / rate);
    SINEW_ASSIGN(const auto pose, SteppingPose(step, motion.time.back()));
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto found = pose.find(names[k]);
      motion.values(i, static_cast<Eigen::Index>(k)) = found != pose.end() ? found->second : 0;
    }
  }
  return motion;
}

// The floor's slope leaves its height alone between the feet, in the middle of their length.
constexpr std::array<double, 2> kTiltPivot{0.02, 0};
constexpr double kEdgeShare = 0.2;  // of the sole's length that a strip beyond its end has

EffectRegion Prepare(const ContactRegion& region, const std::vector<BodyMotion>& motion) {
  EffectRegion prepared{0, ComputeContactKinematics(region, motion, {}), {}, {}};
  for (const BodyMotion& body : motion) {
    prepared.turning_x.push_back(body.angular_velocity.x());
    prepared.turning_z.push_back(body.angular_velocity.z());
  }
  return prepared;
}

// The true load on the plate at the given times.
Result<std::vector<ContactLoad>> TrueLoads(const MultibodyModel& model, const CoordinateTrajectory& motion,
                                           bool right, const Values& values, const ContactTruth& hidden,
                                           const std::vector<double>& times) {
  SINEW_ASSIGN(const int body, model.BodyIndex(right ? "calcn_r" : "calcn_l"));
  SINEW_ASSIGN(const auto motions, model.BodyMotions(times, motion, {body}));
  std::vector<BodyMotion> of_foot;
  for (const auto& bodies : motions) of_foot.push_back(bodies.front());
  ContactRegion region;
  const bool fine = values.at("fine") != 0;
  SINEW_ASSIGN(region.mesh, BoxMesh(kSoleSize, fine ? 36 : 12, fine ? 20 : 7));
  region.position = kSolePosition;
  region.springs = SpringFaces::kBottom;
  const ElasticFoundation truth{values.at("stiffness"), values.at("dissipation"),
                                values.at("static_friction"), values.at("dynamic_friction"),
                                values.at("viscous_friction")};
  std::vector<ContactLoad> loads(times.size(), ContactLoad::Zero());
  const ContactEffectValues effects = hidden.EffectsOn(right);
  if (std::all_of(effects.begin(), effects.end(), [](double value) { return value == 0; })) {
    const ContactKinematics kinematics = ComputeContactKinematics(region, of_foot, {});
    const ContactSums sums({&kinematics}, kTransitionVelocity);
    auto workspace = sums.NewWorkspace();
    for (std::size_t i = 0; i < times.size(); ++i)
      sums.Add(static_cast<int>(i), truth, WrenchParts::kAll, workspace, loads[i], nullptr);
    return loads;
  }

  EffectKinematics kinematics;
  kinematics.regions.push_back(Prepare(region, of_foot));
  for (const std::size_t edge : {0U, 1U}) {
    const std::array<int, 2> strips{fine ? 12 : 4, fine ? 20 : 7};
    SINEW_ASSIGN(const ContactRegion strip,
                 EdgeRegion(region, edge == 0, kEdgeShare * kSoleSize.x(), strips));
    kinematics.edges[edge].push_back(Prepare(strip, of_foot));
  }
  for (const BodyMotion& foot : of_foot) {
    kinematics.foot_position.push_back(foot.position);
    kinematics.foot_acceleration.push_back(foot.acceleration);
  }
  kinematics.tilt_reference = kTiltPivot;
  kinematics.transition_velocity = kTransitionVelocity;
  EffectLoad load;
  load.by_part.resize(1);
  for (std::size_t i = 0; i < times.size(); ++i) {
    ComputeEffectLoad(kinematics, static_cast<int>(i), {truth}, effects, {}, load);
    loads[i] = load.load;
  }
  return loads;
}

// The force along each axis at the times at which the plate takes it for that of `time`.
Result<std::array<std::vector<double>, 3>> SeenForces(const MultibodyModel& model,
                                                      const CoordinateTrajectory& motion, bool right,
                                                      const Values& values, const ContactTruth& hidden,
                                                      const std::vector<double>& time) {
  std::array<std::vector<double>, 3> forces;
  const auto& plate = hidden.plates[right ? 0 : 1];
  std::vector<ContactLoad> loads;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis == 0 || plate[axis].time_offset != plate[axis - 1].time_offset) {
      std::vector<double> measured_at;
      for (const double t : time) measured_at.push_back(t - plate[axis].time_offset);
      SINEW_ASSIGN(loads, TrueLoads(model, motion, right, values, hidden, measured_at));
    }
    for (const ContactLoad& load : loads) forces[axis].push_back(load[static_cast<Eigen::Index>(axis)]);
  }
  return forces;
}

Channel NewChannel(const std::string& unit, double sigma) {
  Channel channel;
  channel.unit = unit;
  if (sigma > 0) channel.sigma = sigma;
  return channel;
}

Grid RecordForces(const std::array<std::vector<double>, 3>& forces, const std::vector<double>& time,
                  bool right, const Values& values, const ContactTruth& hidden, Random& random) {
  Grid grid;
  const double noise = values.at("force_noise");
  const std::array<double, 3> noise_of{0.5 * noise, noise, 0.5 * noise};
  std::array<Channel, 3> channels;
  for (std::size_t axis = 0; axis < 3; ++axis) channels[axis] = NewChannel("N", noise_of[axis]);
  const double middle = 0.5 * (time.front() + time.back());
  for (std::size_t i = 0; i < time.size(); ++i) {
    // The plate measures every sample; the export keeps one in sixteen.
    std::array<double, 3> error{};
    for (double& e : error) e = random.Normal();
    if (i % kEvery != 0) continue;
    grid.time.push_back(time[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const PlateDistortion& plate = hidden.plates[right ? 0 : 1][axis];
      channels[axis].values.push_back(plate.gain * forces[axis][i] + plate.offset +
                                      plate.drift * (time[i] - middle) + noise_of[axis] * error[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.channels[std::string(right ? "right" : "left") + "_force_" + "xyz"[axis]] =
        std::move(channels[axis]);
  }
  return grid;
}

Result<Grid> RecordMarkers(const MultibodyModel& model, const Motion& motion, double noise, Random& random) {
  Grid grid;
  grid.time = motion.time;
  for (Eigen::Index i = 0; i < motion.values.rows(); ++i) {
    SINEW_ASSIGN(const auto positions, model.MarkerPositions(motion.values.row(i).transpose()));
    for (std::size_t m = 0; m < positions.size(); ++m) {
      for (int axis = 0; axis < 3; ++axis) {
        Channel& channel = grid.channels[model.marker_names()[m] + "_" + "xyz"[axis]];
        channel.unit = "m";
        channel.values.push_back(positions[m][axis] + noise * random.Normal());
      }
    }
  }
  return grid;
}

Result<Trial> RecordStance(const MultibodyModel& model, const Step& step, const Values& values,
                           const ContactTruth& hidden, Random& random) {
  const double seen_rate = kPlateRate / kEvery;
  SINEW_ASSIGN(const Motion true_motion, Move(step, model, values.at("fine") != 0 ? kPlateRate : seen_rate));
  SINEW_ASSIGN(
      const auto trajectory,
      CoordinateTrajectory::Fit(model, true_motion.time, model.coordinate_names(), true_motion.values));
  std::vector<double> plate_time;
  for (double t = 0; t < step.duration - 0.5 / kPlateRate; t += 1 / kPlateRate) plate_time.push_back(t);
  SINEW_ASSIGN(const auto forces, SeenForces(model, trajectory, step.right, values, hidden, plate_time));

  Trial trial;
  trial.task = step.right ? "right stance" : "left stance";
  trial.conditions["walking_speed_m_per_s"] = step.walking_speed;
  trial.grids["forces"] = RecordForces(forces, plate_time, step.right, values, hidden, random);
  SINEW_ASSIGN(const Motion seen_motion, Move(step, model, seen_rate));
  SINEW_ASSIGN(trial.grids["markers"], RecordMarkers(model, seen_motion, values.at("marker_noise"), random));
  if (values.at("encoders") != 0) {
    Grid& grid = trial.grids["coordinates"];
    grid.time = seen_motion.time;
    for (std::size_t k = 0; k < model.coordinate_names().size(); ++k) {
      const std::string& name = model.coordinate_names()[k];
      const auto column = seen_motion.values.col(static_cast<Eigen::Index>(k));
      grid.channels[name] = {model.IsAngle(name) ? "rad" : "m", ChannelKind::kInput, std::nullopt,
                             std::vector<double>(column.data(), column.data() + column.size())};
    }
  }
  return trial;
}

}  // namespace

Result<Dataset> SynthesizeContact(const SynthesisRequest& request) {
  SINEW_ASSIGN(const Values values, ReadExperiment(kSettings, {"force_noise", "marker_noise"}, request));
  SINEW_ASSIGN(const ContactTruth hidden, ReadContactTruth(request.effects));
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(kNaoLikeOsim, "nao_like.osim"));
  SINEW_ASSIGN(const MultibodyModel model, MultibodyModel::Build(osim));

  Dataset data;
  data.title = "a small humanoid robot stepping";
  data.subject = "robot with the proportions of NAO, 5.8 kg, 0.573 m";
  data.source = fmt::format("sinew data synthesize contact --seed {}", request.seed);
  data.licence = "Apache-2.0";
  data.synthetic = true;
  data.constants["body_mass"] = {model.total_mass_kg(), "kg"};
  data.files["model.osim"] = kNaoLikeOsim;
  data.files["contact.yaml"] = kSettingsText;

  Random random(request.seed);
  const int train = static_cast<int>(values.at("train"));
  const int stances = train + static_cast<int>(values.at("validate"));
  for (int i = 0; i < stances; ++i) {
    const Step step = DrawStep(random, i % 2 == 0, values.at("slip"));
    SINEW_ASSIGN(Trial trial, RecordStance(model, step, values, hidden, random));
    trial.role = i < train ? Role::kTrain : Role::kValidate;
    data.trials[SyntheticTrialName(static_cast<std::size_t>(i), static_cast<std::size_t>(train))] =
        std::move(trial);
  }
  SINEW_TRY(data.Check());
  return data;
}

std::vector<std::pair<std::string, std::string>> ContactExperiment() {
  return DescribeSettings(kSettings);
}

}  // namespace sinew
