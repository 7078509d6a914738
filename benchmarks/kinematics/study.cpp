// Inverse kinematics judged on published recordings: cost beside published coordinates, the same answer from
// random first poses, and wide random motions whose truth is known.
//   kinematics_study FOLDER_OF_DATA [POSES [MOTIONS]]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <limits>

#include "base/constants.h"
#include "base/random.h"
#include "recording.h"

namespace sinew::kinematics_study {
namespace {

const std::vector<RecordingFiles> kRecordings = {
    {"gait_subject01", "Gait10dof18musc_subject01.osim", "ExperimentalData_subject01_walk.trc",
     "IK_walk_Setup_IK.xml", "IK_subject01_walk_IK.mot"},
    {"gait_walk3d", "subject_walk_scaled.osim", "markers_walk.trc", "ik_tasks_walk.xml", "coordinates.sto"}};

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

IkResult Solve(const MultibodyModel& model, const MarkerTrajectories& markers, const IkSetup* setup,
               std::uint64_t seed = 1) {
  IkOptions options;
  options.seed = seed;
  auto result = SolveInverseKinematics(model, markers, setup, options);
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(*result);
}

// Free angles anywhere in their range, or within half a turn; lengths within a metre of their default.
OsimModel WithRandomDefaults(OsimModel model, const MultibodyModel& built, std::uint64_t seed,
                             bool within_ranges = false) {
  Random random(seed);
  for (OsimJoint& joint : model.joints) {
    for (OsimCoordinate& coordinate : joint.coordinates) {
      const int index = *built.CoordinateIndex(coordinate.name);
      if (coordinate.locked || built.IsDependent(index)) continue;
      const bool turns = coordinate.motion == MotionType::kRotational;
      double lower = turns ? -kPi : coordinate.default_value - 1;
      double upper = turns ? kPi : coordinate.default_value + 1;
      if (coordinate.clamped || (within_ranges && turns)) {
        lower = std::max(lower, coordinate.lower);
        upper = std::min(upper, coordinate.upper);
      }
      coordinate.default_value = random.Uniform(lower, upper);
    }
  }
  return model;
}

double Difference(const IkResult& a, const IkResult& b, const MultibodyModel& model, std::string& where) {
  double worst = 0;
  for (Eigen::Index i = 0; i < a.coordinates.rows(); ++i) {
    for (Eigen::Index c = 0; c < a.coordinates.cols(); ++c) {
      const std::string& name = a.coordinate_names[static_cast<std::size_t>(c)];
      if (std::find(a.undetermined.begin(), a.undetermined.end(), name) != a.undetermined.end()) continue;
      const double unit = model.IsRotational(name) ? 180 / kPi : 1e3;
      const double difference = unit * std::abs(a.coordinates(i, c) - b.coordinates(i, c));
      if (difference > worst) where = fmt::format("{}, frame {}", name, i);
      worst = std::max(worst, difference);
    }
  }
  return worst;
}

double TotalCost(const MultibodyModel& model, const IkSetup& setup, const MarkerTrajectories& markers,
                 const IkResult& result) {
  double sum = 0;
  for (std::size_t i = 0; i < markers.times.size(); ++i)
    sum += Cost(model, setup, markers.names, markers.positions[i],
                result.coordinates.row(static_cast<Eigen::Index>(i)));
  return sum;
}

void CompareCosts(const Recording& recording, const MultibodyModel& model, const MarkerTrajectories& markers,
                  const IkResult& result, const char* words) {
  int above = 0;
  int compared = 0;
  double most = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    const auto frame = std::find_if(markers.times.begin(), markers.times.end(),
                                    [&](double time) { return std::abs(time - recording.times[i]) < 1e-6; });
    if (frame == markers.times.end()) continue;
    const auto index = static_cast<std::size_t>(frame - markers.times.begin());
    const Vector ours = result.coordinates.row(static_cast<Eigen::Index>(index));
    const Vector theirs = PublishedPose(model, recording, static_cast<Eigen::Index>(i), ours);
    const double our_cost = Cost(model, recording.setup, markers.names, markers.positions[index], ours);
    const double ratio =
        our_cost / Cost(model, recording.setup, markers.names, markers.positions[index], theirs);
    ++compared;
    above += ratio > 1 + 1e-12 ? 1 : 0;
    most = std::max(most, ratio);
    least = std::min(least, ratio);
  }
  fmt::print("  {}: {} instants, ours above theirs at {}; ours / theirs {:.9f} to {:.9f}\n", words, compared,
             above, least, most);
}

void JudgePoses(const Recording& recording, const MultibodyModel& model, const IkResult& result, int poses) {
  double worst = 0;
  double slowest = 0;
  int same = 0;
  const double cost = TotalCost(model, recording.setup, recording.markers, result);
  for (int pose = 1; pose <= poses; ++pose) {
    const MultibodyModel drawn = Build(WithRandomDefaults(recording.model, model, 1000 + pose));
    const double start = Seconds();
    const IkResult again = Solve(drawn, recording.markers, &recording.setup, pose);
    slowest = std::max(slowest, Seconds() - start);
    std::string where;
    const double difference = Difference(result, again, model, where);
    const double ratio = TotalCost(model, recording.setup, recording.markers, again) / cost;
    same += difference < 1e-3 ? 1 : 0;
    if (difference >= 1e-3)
      fmt::print("    pose {}: {:.3g} deg or mm ({}), cost {:.9f} of ours, {} of {} starts agree\n", pose,
                 difference, where, ratio, again.agreeing_starts, again.starts);
    worst = std::max(worst, difference);
  }
  fmt::print(
      "  random first poses and seeds: {} of {} the same; largest difference {:.3g} deg or mm; {:.2f} s at "
      "most\n",
      same, poses, worst, slowest);
}

struct Motion {
  std::vector<Vector> truth;
  MarkerTrajectories markers;
};

// From the default pose to a random one and on to another in 200 frames. The markers of the person sit 15 mm
// from those of the model, each is lost for a fifth of a second now and then, and each is noisy by 1 mm.
Motion DrawMotion(const Recording& recording, const MultibodyModel& model, std::uint64_t seed) {
  constexpr int kFrames = 200;
  constexpr double kPlacement = 0.015;
  constexpr double kNoise = 1e-3;
  constexpr double kLoss = 0.005;  // of a marker in a frame
  constexpr int kLostFrames = 20;
  Random random(seed);
  OsimModel person = recording.model;
  for (OsimMarker& marker : person.markers)
    marker.location += kPlacement * Vec3(random.Normal(), random.Normal(), random.Normal());
  const MultibodyModel body = Build(person);
  const Vector& first = model.default_values();
  const MultibodyModel second =
      Build(WithRandomDefaults(recording.model, model, random.Index(1U << 30), true));
  const MultibodyModel third =
      Build(WithRandomDefaults(recording.model, model, random.Index(1U << 30), true));
  Motion motion;
  motion.markers.names = model.marker_names();
  std::vector<int> lost_until(motion.markers.names.size(), -1);
  for (int i = 0; i < kFrames; ++i) {
    const double share = 0.5 - 0.5 * std::cos(kPi * std::fmod(2.0 * i / kFrames, 1.0));
    const bool later = 2 * i >= kFrames;
    motion.truth.push_back((1 - share) * (later ? second.default_values() : first) +
                           share * (later ? third : second).default_values());
    motion.markers.times.push_back(0.01 * i);
    motion.markers.positions.push_back(*body.MarkerPositions(motion.truth.back()));
    for (std::size_t m = 0; m < lost_until.size(); ++m) {
      Vec3& position = motion.markers.positions.back()[m];
      position += kNoise * Vec3(random.Normal(), random.Normal(), random.Normal());
      if (random.Uniform() < kLoss) lost_until[m] = i + kLostFrames;
      if (i < lost_until[m]) position.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return motion;
}

// The lowest cost known of one frame: a search of its own, one of whose starts is the truth.
double LowestCost(const Recording& recording, const MultibodyModel& model, const Motion& motion,
                  std::size_t i) {
  OsimModel at_truth = recording.model;
  for (OsimJoint& joint : at_truth.joints) {
    for (OsimCoordinate& coordinate : joint.coordinates)
      coordinate.default_value = motion.truth[i][*model.CoordinateIndex(coordinate.name)];
  }
  MarkerTrajectories frame;
  frame.names = motion.markers.names;
  frame.times = {0};
  frame.positions = {motion.markers.positions[i]};
  const IkResult result = Solve(Build(at_truth), frame, &recording.setup, 77);
  return Cost(model, recording.setup, frame.names, frame.positions[0], result.coordinates.row(0));
}

// Every 25th frame beside a search of its own.
void JudgeMotions(const Recording& recording, const MultibodyModel& model, int motions) {
  constexpr double kAbove = 1 + 1e-5;
  constexpr std::size_t kEvery = 25;
  int frames = 0;
  int above = 0;
  int below = 0;
  int failed = 0;
  std::size_t redone = 0;
  double seconds = 0;
  for (int number = 1; number <= motions; ++number) {
    const Motion motion = DrawMotion(recording, model, static_cast<std::uint64_t>(number));
    const double start = Seconds();
    const IkResult result = Solve(model, motion.markers, &recording.setup, 1);
    seconds += Seconds() - start;
    redone += result.redone.size();
    std::vector<std::string> wrong;
    for (std::size_t i = 0; i < motion.truth.size(); i += kEvery) {
      const double lowest = LowestCost(recording, model, motion, i);
      const double ours = Cost(model, recording.setup, motion.markers.names, motion.markers.positions[i],
                               result.coordinates.row(static_cast<Eigen::Index>(i)));
      if (ours > kAbove * lowest) wrong.push_back(fmt::format("{} ({:.5f})", i, ours / lowest));
      below += kAbove * ours < lowest ? 1 : 0;
      ++frames;
    }
    above += static_cast<int>(wrong.size());
    failed += wrong.empty() ? 0 : 1;
    if (!wrong.empty())
      fmt::print("    motion {}: frames above their lowest cost: {}\n", number, fmt::join(wrong, ", "));
  }
  fmt::print(
      "  wide motions: {} of {} frames above the lowest cost known ({} of {} motions), {} below; {} redone; "
      "{:.2f} s each\n",
      above, frames, failed, motions, below, redone, seconds / std::max(1, motions));
}

int Run(const std::string& folder, int poses, int motions) {
  for (const RecordingFiles& files : kRecordings) {
    const Recording recording = ReadRecording(folder + "/" + files.name, files);
    const MultibodyModel model = Build(recording.model);
    const double start = Seconds();
    const IkResult result = Solve(model, recording.markers, &recording.setup);
    fmt::print("{}: {} frames, {:.2f} s, {} of {} starts agree, {} redone\n", recording.name,
               result.times.size(), Seconds() - start, result.agreeing_starts, result.starts,
               result.redone.size());
    CompareCosts(recording, model, recording.markers, result, "at common instants");
    if (recording.times.size() > recording.markers.times.size()) {
      const MarkerTrajectories dense = Resampled(recording.markers, recording.times);
      CompareCosts(recording, model, dense, Solve(model, dense, &recording.setup),
                   "markers interpolated to every instant");
    }
    JudgePoses(recording, model, result, poses);
    JudgeMotions(recording, model, motions);
  }
  return 0;
}

}  // namespace
}  // namespace sinew::kinematics_study

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw std::runtime_error("usage: kinematics_study FOLDER_OF_DATA [POSES [MOTIONS]]");
    return sinew::kinematics_study::Run(argv[1], argc > 2 ? std::atoi(argv[2]) : 20,
                                        argc > 3 ? std::atoi(argv[3]) : 0);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
