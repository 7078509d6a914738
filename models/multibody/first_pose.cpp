#include "models/multibody/first_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "models/multibody/equal_poses.h"

namespace sinew {
namespace {

constexpr double kCoarse = 1e-3;  // a start's search ends here unless its minimum may be the lowest
constexpr int kCoarseIterations = 60;

// The model's default pose, and the same turned by quarter turns about each angle between ground and the
// first bodies.
std::vector<Vector> Headings(const MultibodyModel& model) {
  std::vector<Vector> starts{model.default_values()};
  for (int i = 0; i < static_cast<int>(model.coordinate_names().size()); ++i) {
    const OsimCoordinate& coordinate = model.coordinate(i);
    if (!IsFreeAngle(model, i) || !model.IsGroundCoordinate(i)) continue;
    for (const double turn : {kPi / 2, kPi, -kPi / 2}) {
      Vector start = model.default_values();
      start[i] += turn;
      if (coordinate.clamped && (start[i] < coordinate.lower || start[i] > coordinate.upper)) continue;
      starts.push_back(std::move(start));
    }
  }
  return starts;
}

// Uniform within half a turn of what is expected, and within the range of a clamped angle.
double DrawAngle(const MultibodyModel& model, int coordinate, Random& random) {
  const OsimCoordinate& properties = model.coordinate(coordinate);
  const double middle = ExpectedAngle(model, coordinate);
  if (!properties.clamped) return random.Uniform(middle - kPi, middle + kPi);
  return random.Uniform(std::max(properties.lower, middle - kPi), std::min(properties.upper, middle + kPi));
}

// The starts' minima of one frame, each polished only if it may be the lowest.
class Minima {
 public:
  Minima(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options)
      : fit_(fit), model_(model), options_(options) {}

  void Try(const Vector& start) {
    ++starts_;
    MarkerFit::Solution found = SolveAcrossEnds(fit_, model_, start, SearchTo(kCoarse, kCoarseIterations));
    // What the coarse accuracy leaves open is far below this share of the cost, or of a perfect fit.
    constexpr double kMayFall = 2;
    constexpr double kPerfect = 1e-5;  // [m2]
    if (found.joined < 0 && found.cost < kMayFall * lowest_ + kPerfect)
      found = fit_.Solve(found.values, SearchTo(options_.accuracy, options_.max_iterations));
    if (found.joined >= 0) {
      ++hits_[static_cast<std::size_t>(found.joined)];
      return;
    }
    if (!IsLower(lowest_, found.cost, options_)) found = Canonical(fit_, model_, options_, std::move(found));
    Add(std::move(found));
  }

  void Add(MarkerFit::Solution found) {
    lowest_ = std::min(lowest_, found.cost);
    known_.push_back(found.values);
    hits_.push_back(1);
    found_.push_back(std::move(found));
  }

  [[nodiscard]] int starts() const { return starts_; }
  [[nodiscard]] int agreeing() const {
    int sum = 0;
    for (std::size_t i = 0; i < found_.size(); ++i) sum += IsLowest(i) ? hits_[i] : 0;
    return sum;
  }

  // Of equal minima the one whose angles are nearest to what is expected.
  [[nodiscard]] const MarkerFit::Solution& Lowest() const {
    std::size_t best = found_.size();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const double distance = Oddity(model_, found_[i].values);
      if (!IsLowest(i) || (best < found_.size() && distance >= nearest)) continue;
      nearest = distance;
      best = i;
    }
    return found_[best];
  }

 private:
  [[nodiscard]] MarkerFit::Search SearchTo(double accuracy, int iterations) const {
    MarkerFit::Search search;
    search.accuracy = accuracy;
    search.max_iterations = std::min(iterations, options_.max_iterations);
    search.known = &known_;
    return search;
  }
  [[nodiscard]] bool IsLowest(std::size_t i) const { return !IsLower(lowest_, found_[i].cost, options_); }

  MarkerFit& fit_;
  const MultibodyModel& model_;
  const IkOptions& options_;
  std::vector<MarkerFit::Solution> found_;
  std::vector<Vector> known_;
  std::vector<int> hits_;
  double lowest_ = std::numeric_limits<double>::infinity();
  int starts_ = 0;
};

// Free angles that this frame's markers or a goal determine; the others stay where they are.
std::vector<int> AnglesToDraw(MarkerFit& fit, const MultibodyModel& model, const Vector& pose,
                              Random& random) {
  constexpr int kPoses = 3;  // at special poses an angle may move no marker, at random ones it does
  std::vector<Vector> poses(kPoses, pose);
  for (Vector& drawn : poses) {
    for (const int i : fit.free_coordinates())
      if (IsFreeAngle(model, i)) drawn[i] = DrawAngle(model, i, random);
  }
  const std::vector<bool> determined = fit.Determined(poses);
  std::vector<int> angles;
  for (std::size_t i = 0; i < determined.size(); ++i) {
    const int coordinate = fit.free_coordinates()[i];
    if (determined[i] && IsFreeAngle(model, coordinate)) angles.push_back(coordinate);
  }
  return angles;
}

}  // namespace

FirstPose FindFirstPose(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                        Random& random) {
  constexpr int kLeastRandom = 8;
  constexpr int kMostRandom = 40;
  constexpr int kEnoughAgree = 3;
  Minima minima(fit, model, options);
  for (const Vector& start : Headings(model)) minima.Try(start);
  const std::vector<int> angles = AnglesToDraw(fit, model, model.default_values(), random);
  for (int i = 0; i < kMostRandom && (i < kLeastRandom || minima.agreeing() < kEnoughAgree); ++i) {
    Vector start = model.default_values();
    for (const int angle : angles) start[angle] = DrawAngle(model, angle, random);
    minima.Try(start);
  }
  const MarkerFit::Solution lower = FindLowerPose(fit, model, options, minima.Lowest(), {}, random);
  const bool escaped = IsLower(lower.cost, minima.Lowest().cost, options);
  return {lower, minima.starts(), escaped ? 0 : minima.agreeing()};
}

MarkerFit::Solution FindLowerPose(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                                  const MarkerFit::Solution& pose, const std::vector<Vector>& others,
                                  Random& random) {
  constexpr int kMostRounds = 10;
  constexpr std::size_t kLeastTries = 24;  // of a round, where there are few angles
  const std::vector<int> angles = AnglesToDraw(fit, model, pose.values, random);
  Minima minima(fit, model, options);
  minima.Add(pose);
  for (const Vector& other : others) {
    Vector start = minima.Lowest().values;
    for (const int angle : angles)
      if (!model.IsGroundCoordinate(angle)) start[angle] = other[angle];
    minima.Try(start);
  }
  for (int round = 0; round < kMostRounds; ++round) {
    const double before = minima.Lowest().cost;
    const std::size_t sweeps = angles.empty() ? 0 : 1 + kLeastTries / (2 * angles.size() + 1);
    for (std::size_t i = 0; i < sweeps * angles.size(); ++i) {
      const std::size_t first = i % angles.size();
      for (const std::size_t count : {1, 3}) {
        Vector start = minima.Lowest().values;
        for (std::size_t j = first; j < std::min(first + count, angles.size()); ++j)
          start[angles[j]] = DrawAngle(model, angles[j], random);
        minima.Try(start);
      }
    }
    if (!IsLower(minima.Lowest().cost, before, options)) break;
  }
  return IsLower(minima.Lowest().cost, pose.cost, options) ? minima.Lowest() : pose;
}

}  // namespace sinew
