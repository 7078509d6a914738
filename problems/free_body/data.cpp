#include "problems/free_body/data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"

namespace sinew {

const std::array<const char*, kPoseChannels> kPoseNames{"position_x",    "position_y",    "position_z",
                                                        "orientation_w", "orientation_x", "orientation_y",
                                                        "orientation_z"};

namespace {

constexpr std::size_t kMinFrames = 6;
constexpr double kUnitLength = 0.05;  // by which a quaternion's length may be off
constexpr double kJump = 0.3;  // of the body's size, or rad: a frame that jumps so far and back is wrong
constexpr std::size_t kLongestJump = 3;  // frames
constexpr double kFalls = 2;             // [m/s2] by which a flight's acceleration may differ from gravity
constexpr double kNoiseFactor = 2;       // the same, in deviations of the noise
constexpr double kExpected = 0.01;       // of the body's size, or rad: errors after the first touch
constexpr double kMinNoise = 1e-3;       // of that: no camera is better
constexpr double kRest = 0.005;          // of the body's size, or rad: the body is at rest
constexpr double kOverTable = 0.05;      // of the body's size: in flight for certain

using Frames = std::vector<std::pair<double, Pose>>;

double Quaternion(const Pose& pose, std::size_t i) {
  return pose[3 + i];
}

double Along(const Pose& a, const Pose& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += Quaternion(a, i) * Quaternion(b, i);
  return sum;
}

Result<Frames> ReadFrames(const Trial& trial) {
  std::array<const Channel*, kPoseChannels> channels{};
  const Grid* grid = nullptr;
  for (std::size_t c = 0; c < kPoseNames.size(); ++c) {
    const Trial::Found found = trial.Find(kPoseNames[c]);
    if (!found) return Fail("has no channel '{}'", kPoseNames[c]);
    if (grid != nullptr && found.grid != grid)
      return Fail("channel '{}' lies on a grid of its own", kPoseNames[c]);
    const char* unit = c < 3 ? "m" : "1";
    if (found.channel->unit != unit)
      return Fail("channel '{}' has the unit {}, expected {}", kPoseNames[c], found.channel->unit, unit);
    grid = found.grid;
    channels[c] = found.channel;
  }
  Frames frames;
  for (std::size_t i = 0; i < grid->time.size(); ++i) {
    Pose pose{};
    bool whole = true;
    for (std::size_t c = 0; c < pose.size(); ++c) {
      pose[c] = channels[c]->values[i];
      whole = whole && std::isfinite(pose[c]);
    }
    if (!whole) continue;
    const double length = std::sqrt(Along(pose, pose));
    if (!(std::abs(length - 1) < kUnitLength))
      return Fail("orientation at t = {} s has the length {:.3g}, expected 1", grid->time[i], length);
    const double sign = frames.empty() || Along(frames.back().second, pose) >= 0 ? 1 : -1;
    for (std::size_t c = 3; c < pose.size(); ++c) pose[c] *= sign / length;
    frames.emplace_back(grid->time[i], pose);
  }
  if (frames.size() < kMinFrames)
    return Fail("has {} frames with a pose, expected {}", frames.size(), kMinFrames);
  return frames;
}

// How far each of `count` frames lies from the straight line between those around them, at least; as a share
// of a jump that counts, which is farther the longer it lasts.
double JumpOf(const Frames& frames, std::size_t first, std::size_t count, double size) {
  const auto& [t0, a] = frames[first - 1];
  const auto& [t2, c] = frames[first + count];
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i < first + count; ++i) {
    const auto& [t1, b] = frames[i];
    const double share = (t1 - t0) / (t2 - t0);
    double place = 0;
    double turn = 0;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const double away = b[k] - (1 - share) * a[k] - share * c[k];
      (k < 3 ? place : turn) += away * away;
    }
    least = std::min(least, std::max(std::sqrt(place) / (kJump * size), 2 * std::sqrt(turn) / kJump));
  }
  return least / (0.5 * static_cast<double>(count + 1));
}

// Up to three frames that are far from where those around them are, and more so than those that share a frame
// or a neighbour with them.
int DropOutliers(double size, Frames& frames) {
  int dropped = 0;
  for (std::size_t count = kLongestJump; count > 0; --count) {
    for (std::size_t i = 1; i + count < frames.size();) {
      const double here = JumpOf(frames, i, count, size);
      bool worst = here > 1;
      for (std::size_t k = 1; k <= count && worst; ++k) {
        worst = (i < k + 1 || JumpOf(frames, i - k, count, size) < here) &&
                (i + count + k >= frames.size() || JumpOf(frames, i + k, count, size) < here);
      }
      if (!worst) {
        ++i;
        continue;
      }
      const auto first = frames.begin() + static_cast<std::ptrdiff_t>(i);
      frames.erase(first, first + static_cast<std::ptrdiff_t>(count));
      dropped += static_cast<int>(count);
    }
  }
  return dropped;
}

double WayBetween(const Pose& a, const Pose& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double LowestCorner(const Pose& pose, const Vec3& edges) {
  const auto rotation = RotationOf(pose.data() + 3);
  double depth = 0;
  for (std::size_t i = 0; i < 3; ++i)
    depth += std::abs(rotation[2][i]) * edges[static_cast<Eigen::Index>(i)] / 2;
  return pose[2] - depth;
}

// Second difference of the place about frame i, with gravity taken off [m/s2].
double PushedBy(const Frames& frames, std::size_t i, double gravity) {
  const auto& [t0, a] = frames[i - 1];
  const auto& [t1, b] = frames[i];
  const auto& [t2, c] = frames[i + 1];
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double acceleration = 2 * ((c[k] - b[k]) / (t2 - t1) - (b[k] - a[k]) / (t1 - t0)) / (t2 - t0);
    sum += std::pow(acceleration + (k == 2 ? gravity : 0), 2);
  }
  return std::sqrt(sum);
}

// What noise alone does to a second difference [m/s2], from third differences, which motion hardly has.
double PushedByNoise(const Frames& frames) {
  std::vector<double> thirds;
  for (std::size_t i = 0; i + 3 < frames.size(); ++i) {
    const double gap = (frames[i + 3].first - frames[i].first) / 3;
    for (std::size_t k = 0; k < 3; ++k) {
      const double third = frames[i + 3].second[k] - 3 * frames[i + 2].second[k] +
                           3 * frames[i + 1].second[k] - frames[i].second[k];
      thirds.push_back(std::abs(third) / (gap * gap));
    }
  }
  const auto middle = thirds.begin() + static_cast<std::ptrdiff_t>(thirds.size() / 2);
  std::nth_element(thirds.begin(), middle, thirds.end());
  // Variances: 20 of a third difference, 6 of a second, in three directions.
  return *middle / 0.6745 * std::sqrt(3 * 6.0 / 20);
}

// Frames [N] about which the body falls freely; the first and the last count as their neighbours do.
std::vector<bool> FallsFreely(const Frames& frames, const FreeBodySettings& settings) {
  const double most = std::max(kFalls, kNoiseFactor * PushedByNoise(frames));
  std::vector<bool> free(frames.size(), false);
  for (std::size_t i = 1; i + 1 < frames.size(); ++i)
    free[i] = PushedBy(frames, i, settings.body.gravity) < most;
  free.front() = free[1];
  free.back() = free[free.size() - 2];
  return free;
}

// The first frame from which the body falls freely for three frames; 0 if it touches before.
std::size_t ReleasedAt(const Frames& frames, const std::vector<bool>& free,
                       const FreeBodySettings& settings) {
  for (std::size_t i = 0; i + 2 < frames.size(); ++i) {
    if (LowestCorner(frames[i + 2].second, settings.edges) < kOverTable * settings.body.size) break;
    if (free[i] && free[i + 1] && free[i + 2]) return i;
  }
  return 0;
}

// Frames until the body is at rest: all later ones show the same pose.
std::size_t UntilRest(const Frames& frames, double size) {
  const Pose& last = frames.back().second;
  std::size_t end = frames.size();
  while (end > 0) {
    const Pose& pose = frames[end - 1].second;
    if (WayBetween(pose, last) > kRest * size || AngleBetween(pose, last) > kRest) break;
    --end;
  }
  return std::min(frames.size(), end + kMinFrames / 2);
}

// A window begins in flight, where the state is smooth: at the first chance after the last one is long
// enough.
void AddWindows(const Toss& toss, const std::vector<bool>& free, int index, const FreeBodySettings& settings,
                std::vector<TossWindow>& windows) {
  const auto frames = static_cast<std::size_t>(toss.compared);
  std::vector<std::size_t> begins{0};
  if (settings.window > 0) {
    for (std::size_t i = 1; i + kMinFrames <= frames; ++i) {
      const bool long_enough = toss.times[i] - toss.times[begins.back()] >= settings.window * (1 - 1e-9) &&
                               i - begins.back() >= kMinFrames;
      if (long_enough && free[i] && free[i + 1]) begins.push_back(i);
    }
  }
  for (std::size_t b = 0; b < begins.size(); ++b) {
    const std::size_t first = begins[b];
    const std::size_t end = b + 1 < begins.size() ? begins[b + 1] : frames;
    TossWindow window;
    window.toss = index;
    window.first = static_cast<int>(first);
    window.times.assign(toss.times.begin() + static_cast<std::ptrdiff_t>(first),
                        toss.times.begin() + static_cast<std::ptrdiff_t>(end));
    window.guess = GuessStart(settings.body, window.times, toss.poses.data() + first);
    for (std::size_t i = first; i < end && free[i]; ++i) ++window.in_flight;
    windows.push_back(std::move(window));
  }
}

struct ReadOut {
  Toss toss;
  std::vector<bool> free;
};

Result<ReadOut> ReadToss(const std::string& name, const Trial& trial, const FreeBodySettings& settings,
                         std::vector<std::string>& notes, std::vector<std::string>& in_hand) {
  SINEW_ASSIGN(Frames frames, ReadFrames(trial));
  ReadOut out;
  const int dropped = DropOutliers(settings.body.size, frames);
  if (dropped > 0) {
    const bool one = dropped == 1;
    notes.push_back(fmt::format("trial '{}': {} frame{} that jump{} away and back {} left out", name, dropped,
                                one ? "" : "s", one ? "s" : "", one ? "is" : "are"));
  }
  out.free = FallsFreely(frames, settings);
  const std::size_t released = ReleasedAt(frames, out.free, settings);
  if (released > 0) {
    in_hand.push_back(fmt::format("{} ({})", name, released));
    frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(released));
    out.free.erase(out.free.begin(), out.free.begin() + static_cast<std::ptrdiff_t>(released));
  }
  const std::size_t moving = UntilRest(frames, settings.body.size);
  if (moving < kMinFrames)
    return Fail("has {} frames between its release and its rest, expected {}", moving, kMinFrames);
  frames.resize(moving);
  Toss& toss = out.toss;
  toss.trial = name;
  bool touched = false;
  for (const auto& [time, pose] : frames) {
    toss.times.push_back(time);
    toss.poses.push_back(pose);
    toss.height.push_back(LowestCorner(pose, settings.edges));
    touched = touched || toss.height.back() < kOverTable * settings.body.size;
    if (!touched) ++toss.in_flight;
  }
  if (toss.in_flight < 2) return Fail("has {} frames before the first touch, expected 2", toss.in_flight);
  if (!touched) return Fail("never comes near the table at z = 0");
  const double until = toss.times[static_cast<std::size_t>(toss.in_flight)] + settings.horizon;
  while (toss.compared < static_cast<int>(toss.times.size()) &&
         (settings.horizon == 0 || toss.times[static_cast<std::size_t>(toss.compared)] <= until))
    ++toss.compared;
  return out;
}

void AddBlocks(const Trial& trial, const Toss& toss, Layout& layout) {
  for (const TossPhase phase : {kFlight, kContact}) {
    const int begin = phase == kFlight ? 0 : toss.in_flight;
    const int end = phase == kFlight ? toss.in_flight : toss.compared;
    for (std::size_t c = 0; c < kPoseNames.size(); ++c) {
      Block block;
      block.trial = toss.trial;
      block.channel = (phase == kFlight ? "flight." : "") + std::string(kPoseNames[c]);
      block.quantity =
          std::string(c < 3 ? "position" : "orientation") + (phase == kFlight ? " in flight" : "");
      block.unit = c < 3 ? "m" : "1";
      block.role = trial.role == Role::kTrain ? BlockRole::kTrain : BlockRole::kValidate;
      for (int i = begin; i < end; ++i) {
        block.prediction_time.push_back(toss.times[static_cast<std::size_t>(i)]);
        block.sample.push_back(i - begin);
        block.measured.push_back(toss.poses[static_cast<std::size_t>(i)][c]);
      }
      block.sigma = trial.Find(kPoseNames[c]).channel->sigma;
      block.white = block.sigma.has_value();
      layout.push_back(std::move(block));
    }
  }
}

// Of a channel over all tosses: what the data state, else from third differences of flights, which motion
// hardly has.
double NoiseOf(const FreeBodyData& data, std::size_t channel) {
  double stated = 0;
  std::vector<double> thirds;
  for (const Toss& toss : data.tosses) {
    const Block& block = data.layout[static_cast<std::size_t>(toss.first_block) + channel];
    if (block.sigma) stated = std::max(stated, *block.sigma);
    const auto& x = block.measured;
    for (std::size_t i = 0; i + 3 < x.size(); ++i)
      thirds.push_back(std::abs(x[i + 3] - 3 * x[i + 2] + 3 * x[i + 1] - x[i]));
  }
  if (stated > 0) return stated;
  if (thirds.empty()) return 0;
  const auto middle = thirds.begin() + static_cast<std::ptrdiff_t>(thirds.size() / 2);
  std::nth_element(thirds.begin(), middle, thirds.end());
  return *middle / 0.6745 / std::sqrt(20.0);
}

// Positions and orientations have one weight each per phase: that of the noise, if the data state it. If not,
// the noise is what flights show, and after the first touch errors of a hundredth of the body's size are
// expected, which no simulation of a real impact undercuts (a turn by an angle a changes a quaternion by
// a/2).
void Weigh(FreeBodyData& data) {
  for (const bool turns : {false, true}) {
    const std::size_t begin = turns ? 3 : 0;
    const std::size_t end = turns ? kPoseChannels : 3;
    const double expected = kExpected * (turns ? 0.5 : data.body.size);
    double noise = kMinNoise * expected;
    bool stated = true;
    for (std::size_t c = begin; c < end; ++c) {
      noise = std::max(noise, NoiseOf(data, c));
      for (const Toss& toss : data.tosses)
        stated = stated && data.layout[static_cast<std::size_t>(toss.first_block) + c].sigma;
    }
    for (std::size_t c = begin; c < end; ++c) {
      data.weight[kFlight][c] = 1 / noise;
      data.weight[kContact][c] = 1 / (stated ? noise : std::max(noise, expected));
    }
  }
  for (const Toss& toss : data.tosses) {
    for (int b = 0; b < kTossPhases * kPoseChannels; ++b)
      data.layout[static_cast<std::size_t>(toss.first_block + b)].weight =
          data.weight[static_cast<std::size_t>(b / kPoseChannels)]
                     [static_cast<std::size_t>(b % kPoseChannels)];
  }
}

}  // namespace

std::string DescribeFreeBodyChannels() {
  return "measured, all on one grid; frames with a gap are left out:\n"
         "  position_x _y _z       m     of the body's middle; z up, the table is at z = 0\n"
         "  orientation_w _x _y _z 1     unit quaternion, body to world\n"
         "files:\n"
         "  free_body.yaml               settings with key `free_body`: box, mass (or give --config)\n";
}

double AngleBetween(const Pose& a, const Pose& b) {
  const std::array<double, 4> back{a[3], -a[4], -a[5], -a[6]};
  const auto turn = Product(back.data(), b.data() + 3);
  return 2 * std::atan2(std::hypot(turn[1], turn[2], turn[3]), std::abs(turn[0]));
}

FlightStart GuessStart(const FreeBody& body, const std::vector<double>& times, const Pose* poses) {
  FlightStart start;
  start.pose = poses[0];
  const double gap = times[1] - times[0];
  for (std::size_t i = 0; i < 3; ++i)
    start.velocity[static_cast<Eigen::Index>(i)] = (poses[1][i] - poses[0][i]) / gap;
  start.velocity[2] += 0.5 * body.gravity * gap;
  const std::array<double, 4> back{poses[0][3], -poses[0][4], -poses[0][5], -poses[0][6]};
  const auto turn = Product(back.data(), poses[1].data() + 3);
  const double sine = std::sqrt(turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]);
  const double angle = 2 * std::atan2(sine, turn[0]);
  for (std::size_t i = 0; i < 3; ++i)
    start.spin[static_cast<Eigen::Index>(i)] = sine > 0 ? turn[1 + i] / sine * angle / gap : 0;
  return start;
}

Result<FreeBodyData> PrepareFreeBodyData(const Dataset& data, const FreeBodySettings& settings) {
  FreeBodyData out;
  out.body = settings.body;
  out.speed = 0;
  std::vector<std::string> in_hand;
  for (const auto& [name, trial] : data.trials) {
    auto read = ReadToss(name, trial, settings, out.notes, in_hand);
    if (!read) return Fail("trial '{}': {}", name, read.error().message);
    Toss& toss = read->toss;
    toss.first_block = static_cast<int>(out.layout.size());
    for (std::size_t i = 1; i < toss.times.size(); ++i)
      out.speed = std::max(
          out.speed, WayBetween(toss.poses[i], toss.poses[i - 1]) / (toss.times[i] - toss.times[i - 1]));
    AddBlocks(trial, toss, out.layout);
    out.tosses.push_back(std::move(toss));
    AddWindows(out.tosses.back(), read->free, static_cast<int>(out.tosses.size()) - 1, settings, out.windows);
  }
  if (out.tosses.empty()) return Fail("holds no trial");
  if (!in_hand.empty()) {
    out.notes.push_back("begins in the hand (so many frames are left out): " + Join(in_hand, ", "));
  }
  out.speed = std::max(out.speed, 0.1);
  for (int k = 0; k < kFreeBodyKnots; ++k) {
    // Finer where slip is slow; approach is positive on the way in.
    const double share = static_cast<double>(k) / (kFreeBodyKnots - 1);
    out.body.knots[0].push_back(out.speed * share * share);
    out.body.knots[1].push_back(out.speed * (1.5 * share - 0.5));
  }
  Weigh(out);
  return out;
}

}  // namespace sinew
