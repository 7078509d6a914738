#include "problems/contact/laboratory/synthesis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/random.h"
#include "models/contact/contact_sums.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_reader.h"
#include "problems/contact/laboratory/smooth_errors.h"
#include "problems/contact/laboratory/stepping_body.h"
#include "problems/contact/laboratory/truth.h"
#include "problems/contact/load/plate_channels.h"
#include "problems/contact/load/sheared_load.h"
#include "problems/contact/motion/loaded_span.h"
#include "problems/kit/experiment_settings.h"

namespace sinew {
namespace {

constexpr double kPlateRate = 960;  // [Hz]
constexpr int kEvery = 16;          // the export keeps 60 Hz
constexpr double kMargin = 0.2;     // [s] of motion before and after the stance
constexpr double kTransitionVelocity = 0.01;
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
    {"person", 0, 0, 1,
     "1: feet and load of a person (70 kg, sole of 0.26 m, 10 mm deep); then the defaults are stiffness "
     "1.9e6, dissipation 2.5, force_noise 3, moments 1, cop_noise 0.001, moment_noise 0.3"},
    {"moments", 0, 0, 1, "1: centre of pressure and free moment are recorded too"},
    {"cop_noise", 5e-4, 0, 0.1, "of the centre of pressure [m]"},
    {"moment_noise", 0.02, 0, 100, "of the free moment [N m]"},
    {"full_rate", 0, 0, 1, "1: the plates' record keeps all of its 960 samples a second, not 60"},
    {"motion_error", 0, 0, 0.05,
     "standard deviation of smooth errors of the recorded foot's position along each axis [m]"},
    {"rotation_error", 0, 0, 0.3, "the same of its rotation about each axis [rad]"},
    {"shared_error", 0, 0, 1,
     "share of the variance of such errors that all stances have in common, mirrored for the other foot"},
    {"error_correlation", 0.2, 0.02, 10, "time after which such errors have a correlation of 0.61 [s]"},
};

using Values = std::map<std::string, double>;

struct Laboratory {
  SteppingBody body;
  MultibodyModel model;
  Values values;
  ContactTruth hidden;
  std::optional<SmoothErrors> shared;  // of the recorded foot in every stance
};

// Of a stance: its own errors, and what all stances have in common.
struct StanceErrors {
  const SmoothErrors& own;
  const Laboratory& lab;
  double side = 1;

  [[nodiscard]] FootError At(double time) const {
    FootError error = own.At(time);
    if (!lab.shared) return error;
    const double share = lab.values.at("shared_error");
    FootError common = lab.shared->At(time);
    common.shift.z() *= side;
    common.turn.x() *= side;
    common.turn.y() *= side;
    return {std::sqrt(1 - share) * error.shift + std::sqrt(share) * common.shift,
            std::sqrt(1 - share) * error.turn + std::sqrt(share) * common.turn};
  }
};

Step DrawStep(Random& random, Step step, bool right, double slip) {
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

Result<Motion> Move(const Step& step, const MultibodyModel& model, double rate,
                    const StanceErrors* errors = nullptr) {
  Motion motion;
  const int count = static_cast<int>(std::floor((step.duration + 2 * kMargin) * rate + 1e-9)) + 1;
  const auto& names = model.coordinate_names();
  motion.values.resize(count, static_cast<Eigen::Index>(names.size()));
  for (int i = 0; i < count; ++i) {
    motion.time.push_back(-kMargin + i / rate);
    const FootError error = errors == nullptr ? FootError{} : errors->At(motion.time.back());
    SINEW_ASSIGN(const auto pose, SteppingPose(step, motion.time.back(), error));
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto found = pose.find(names[k]);
      motion.values(i, static_cast<Eigen::Index>(k)) = found != pose.end() ? found->second : 0;
    }
  }
  return motion;
}

// The floor's slope leaves its height alone between the feet, in the middle of their length.
constexpr std::array<double, 2> kTiltPivot{0.02, 0};
constexpr std::size_t kInstantsAtOnce = 32;
constexpr double kEdgeShare = 0.2;  // of the sole's length that a strip beyond its end has

EffectRegion Prepare(const ContactRegion& region, const std::vector<BodyMotion>& motion) {
  EffectRegion prepared;
  prepared.kinematics = ComputeContactKinematics(region, motion, {});
  for (const BodyMotion& body : motion) {
    prepared.turning_x.push_back(body.angular_velocity.x());
    prepared.turning_z.push_back(body.angular_velocity.z());
  }
  return prepared;
}

// Where every spring is under the sole: ahead of its middle, and outward.
void SetPlaces(const ContactRegion& sole, const SteppingBody& body, bool right, EffectRegion& region) {
  std::vector<double> outward;
  for (const int face : sole.SpringFaceIndices()) {
    const Vec3 from_middle = sole.position + sole.rotation * sole.mesh.Centre(face) - body.sole_position;
    region.ahead.push_back(from_middle.x());
    outward.push_back((right ? 1 : -1) * from_middle.z());
  }
  region.stiffness_modes = StiffnessModesOf(region.ahead, outward, body.sole_size.x(), body.sole_size.z());
}

bool HasShape(const ContactEffectValues& effects) {
  return std::any_of(effects.begin() + kFirstShape, effects.begin() + kLastShape + 1,
                     [](double value) { return value != 0; });
}

// From when to when the load of a sole that is not displaced is seen in the export: by it the phase is
// counted.
std::array<double, 2> SpanSeen(const std::vector<ContactLoad>& loads, const std::vector<double>& times) {
  std::vector<double> seen;
  std::vector<double> force;
  for (std::size_t i = 0; i < times.size(); i += kEvery) {
    seen.push_back(times[i]);
    force.push_back(loads[i][kForceY]);
  }
  return LoadedSpan(seen, force, seen.front(), seen.back(), 0)
      .value_or(std::array<double, 2>{seen.front(), seen.back()});
}

// The true load on the plate at the given times.
Result<std::vector<ContactLoad>> TrueLoads(const Laboratory& lab, const CoordinateTrajectory& motion,
                                           bool right, const std::vector<double>& times) {
  const MultibodyModel& model = lab.model;
  const Values& values = lab.values;
  SINEW_ASSIGN(const int body, model.BodyIndex(right ? "calcn_r" : "calcn_l"));
  SINEW_ASSIGN(const auto motions, model.BodyMotions(times, motion, {body}));
  std::vector<BodyMotion> of_foot;
  for (const auto& bodies : motions) of_foot.push_back(bodies.front());
  ContactRegion region;
  const bool fine = values.at("fine") != 0;
  const auto& coarse = lab.body.squares;
  SINEW_ASSIGN(region.mesh, BoxMesh(lab.body.sole_size, fine ? 36 : coarse[0], fine ? 20 : coarse[1]));
  region.position = lab.body.sole_position;
  region.springs = SpringFaces::kBottom;
  const ElasticFoundation truth{values.at("stiffness"), values.at("dissipation"),
                                values.at("static_friction"), values.at("dynamic_friction"),
                                values.at("viscous_friction")};
  std::vector<ContactLoad> loads(times.size(), ContactLoad::Zero());
  const ContactEffectValues effects = lab.hidden.EffectsOn(right);
  if (std::all_of(effects.begin(), effects.end(), [](double value) { return value == 0; })) {
    // A few instants at a time: all of a fine mesh would take hundreds of megabytes.
    for (std::size_t first = 0; first < times.size(); first += kInstantsAtOnce) {
      const std::size_t end = std::min(first + kInstantsAtOnce, times.size());
      const auto at = [&](std::size_t i) { return of_foot.begin() + static_cast<std::ptrdiff_t>(i); };
      const ContactKinematics kinematics = ComputeContactKinematics(region, {at(first), at(end)}, {});
      const ContactSums sums({&kinematics}, kTransitionVelocity);
      auto workspace = sums.NewWorkspace();
      for (std::size_t i = first; i < end; ++i)
        sums.Add(static_cast<int>(i - first), truth, WrenchParts::kAll, workspace, loads[i], nullptr);
    }
    return loads;
  }

  EffectKinematics kinematics;
  kinematics.regions.push_back(Prepare(region, of_foot));
  for (const std::size_t edge : {0U, 1U}) {
    const std::array<int, 2> strips{fine ? 12 : 4, fine ? 20 : 7};
    SINEW_ASSIGN(const ContactRegion strip,
                 EdgeRegion(region, edge == 0, kEdgeShare * lab.body.sole_size.x(), strips));
    kinematics.edges[edge].push_back(Prepare(strip, of_foot));
    SetPlaces(strip, lab.body, right, kinematics.edges[edge].back());
  }
  SetPlaces(region, lab.body, right, kinematics.regions.front());
  for (const BodyMotion& foot : of_foot) {
    kinematics.foot_position.push_back(foot.position);
    kinematics.foot_acceleration.push_back(foot.acceleration);
  }
  kinematics.tilt_reference = kTiltPivot;
  kinematics.transition_velocity = kTransitionVelocity;
  const auto compute = [&]() -> Status {
    EffectLoad load;
    load.by_part.resize(1);
    SoleShear shear;
    shear.Begin(effects[kShearCompliance]);
    for (std::size_t i = 0; i < times.size(); ++i) {
      EffectLoadQuery query;
      query.derivatives = false;
      shear.Next(times[i]);
      if (!FindShearVelocity(kinematics, static_cast<int>(i), {truth}, effects, shear, load,
                             query.shear_velocity))
        return Fail("no friction was found that agrees with a shear compliance of {} m/N",
                    shear.compliance());
      ComputeEffectLoad(kinematics, static_cast<int>(i), {truth}, effects, query, load);
      AcceptShear(query.shear_velocity, shear, load);
      loads[i] = load.load;
    }
    return {};
  };
  SINEW_TRY(compute());
  if (!HasShape(effects)) return loads;
  const auto loaded = SpanSeen(loads, times);
  for (const double t : times) kinematics.phase.push_back(PhaseShareAt(t, loaded));
  SINEW_TRY(compute());
  return loads;
}

// The load along each axis at the times at which the plate takes it for that of `time`.
using SeenLoads = std::array<std::vector<ContactLoad>, 3>;
Result<SeenLoads> LoadsSeen(const Laboratory& lab, const CoordinateTrajectory& motion, bool right,
                            const std::vector<double>& time) {
  SeenLoads loads;
  const auto& plate = lab.hidden.plates[right ? 0 : 1];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis > 0 && plate[axis].time_offset == plate[axis - 1].time_offset) {
      loads[axis] = loads[axis - 1];
      continue;
    }
    std::vector<double> measured_at;
    for (const double t : time) measured_at.push_back(t - plate[axis].time_offset);
    SINEW_ASSIGN(loads[axis], TrueLoads(lab, motion, right, measured_at));
  }
  return loads;
}

// Of the plate's samples one in so many is exported.
std::size_t EveryOf(const Laboratory& lab) {
  return lab.values.at("full_rate") != 0 ? 1 : kEvery;
}

Channel NewChannel(const std::string& unit, double sigma) {
  Channel channel;
  channel.unit = unit;
  if (sigma > 0) channel.sigma = sigma;
  return channel;
}

Grid RecordForces(const Laboratory& lab, const SeenLoads& loads, const std::vector<double>& time, bool right,
                  Random& random) {
  Grid grid;
  const double noise = lab.values.at("force_noise");
  const std::array<double, 3> noise_of{0.5 * noise, noise, 0.5 * noise};
  std::array<Channel, 3> channels;
  for (std::size_t axis = 0; axis < 3; ++axis) channels[axis] = NewChannel("N", noise_of[axis]);
  const double middle = 0.5 * (time.front() + time.back());
  for (std::size_t i = 0; i < time.size(); ++i) {
    // The plate measures every sample, whatever is exported.
    std::array<double, 3> error{};
    for (double& e : error) e = random.Normal();
    if (i % EveryOf(lab) != 0) continue;
    grid.time.push_back(time[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const PlateDistortion& plate = lab.hidden.plates[right ? 0 : 1][axis];
      const double force = loads[axis][i][static_cast<Eigen::Index>(axis)];
      channels[axis].values.push_back(plate.gain * force + plate.offset + plate.drift * (time[i] - middle) +
                                      noise_of[axis] * error[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.channels[std::string(right ? "right" : "left") + "_force_" + "xyz"[axis]] =
        std::move(channels[axis]);
  }
  return grid;
}

// Centre of pressure and free moment, with the clock of the vertical force; gaps under a light foot.
void RecordMoments(const Laboratory& lab, const SeenLoads& loads, bool right, Random& random, Grid& grid) {
  constexpr double kLightShare = 0.02;  // of the greatest vertical force
  const std::vector<ContactLoad>& vertical = loads[kForceY];
  double most = 0;
  for (const ContactLoad& load : vertical) most = std::max(most, load[kForceY]);
  const std::array<const char*, 3> names{"cop_x", "cop_z", "moment_y"};
  const std::array<PlateChannel, 3> channels{kCopX, kCopZ, kFreeMoment};
  for (std::size_t c = 0; c < names.size(); ++c) {
    const bool is_cop = channels[c] != kFreeMoment;
    const double noise = lab.values.at(is_cop ? "cop_noise" : "moment_noise");
    Channel channel = NewChannel(is_cop ? "m" : "N*m", noise);
    for (std::size_t i = 0; i < vertical.size(); i += EveryOf(lab)) {
      const double error = noise * random.Normal();
      const bool light = !(vertical[i][kForceY] > kLightShare * most);
      channel.values.push_back(light ? std::nan("")
                                     : PlateChannels(vertical[i], {0, 0}).value[channels[c]] + error);
    }
    grid.channels[std::string(right ? "right_" : "left_") + names[c]] = std::move(channel);
  }
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

Result<Trial> RecordStance(const Laboratory& lab, const Step& step, Random& random, Random& own_random) {
  const MultibodyModel& model = lab.model;
  const Values& values = lab.values;
  const double seen_rate = kPlateRate / kEvery;
  SINEW_ASSIGN(const Motion true_motion, Move(step, model, values.at("fine") != 0 ? kPlateRate : seen_rate));
  SINEW_ASSIGN(
      const auto trajectory,
      CoordinateTrajectory::Fit(model, true_motion.time, model.coordinate_names(), true_motion.values));
  std::vector<double> plate_time;
  for (double t = 0; t < step.duration - 0.5 / kPlateRate; t += 1 / kPlateRate) plate_time.push_back(t);
  SINEW_ASSIGN(const SeenLoads loads, LoadsSeen(lab, trajectory, step.right, plate_time));

  Trial trial;
  trial.task = step.right ? "right stance" : "left stance";
  trial.conditions["walking_speed_m_per_s"] = step.walking_speed;
  trial.grids["forces"] = RecordForces(lab, loads, plate_time, step.right, random);
  if (values.at("moments") != 0) RecordMoments(lab, loads, step.right, own_random, trial.grids["forces"]);
  const SmoothErrors own(values.at("motion_error"), values.at("rotation_error"),
                         values.at("error_correlation"), own_random);
  const StanceErrors errors{own, lab, step.right ? 1.0 : -1.0};
  SINEW_ASSIGN(const Motion seen_motion, Move(step, model, seen_rate, &errors));
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
  const auto person = request.set.find("person");
  SteppingBody body =
      person != request.set.end() && person->second != 0 ? PersonThatSteps() : RobotThatSteps();
  SynthesisRequest with_defaults = request;
  for (const auto& [name, value] : body.defaults) with_defaults.set.emplace(name, value);
  SINEW_ASSIGN(
      Values values,
      ReadExperiment(kSettings, {"force_noise", "marker_noise", "cop_noise", "moment_noise"}, with_defaults));
  SINEW_ASSIGN(ContactTruth hidden, ReadContactTruth(request.effects));
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(body.osim, "nao_like.osim"));
  SINEW_ASSIGN(MultibodyModel model, MultibodyModel::Build(osim));
  Laboratory lab{std::move(body), std::move(model), std::move(values), std::move(hidden), {}};
  if (lab.values.at("shared_error") > 0) {
    constexpr std::uint64_t kShared = 1U << 20U;  // a stream that no stance has
    Random random(Random::StreamSeed(request.seed, kShared));
    lab.shared.emplace(lab.values.at("motion_error"), lab.values.at("rotation_error"),
                       lab.values.at("error_correlation"), random);
  }

  Dataset data;
  data.title = lab.body.title;
  data.subject = lab.body.subject;
  data.source = fmt::format("sinew data synthesize contact --seed {}", request.seed);
  data.licence = "Apache-2.0";
  data.synthetic = true;
  data.constants["body_mass"] = {lab.model.total_mass_kg(), "kg"};
  data.files["model.osim"] = lab.body.osim;
  data.files["contact.yaml"] = lab.body.settings;

  Random random(request.seed);
  const int train = static_cast<int>(lab.values.at("train"));
  const int stances = train + static_cast<int>(lab.values.at("validate"));
  for (int i = 0; i < stances; ++i) {
    const Step step = DrawStep(random, lab.body.step, i % 2 == 0, lab.values.at("slip"));
    // What may be recorded besides leaves the rest of the data as it is.
    Random own_random(Random::StreamSeed(request.seed, static_cast<std::uint64_t>(i)));
    SINEW_ASSIGN(Trial trial, RecordStance(lab, step, random, own_random));
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
