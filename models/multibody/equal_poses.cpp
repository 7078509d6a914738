#include "models/multibody/equal_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/constants.h"
#include "models/multibody/simbody_model.h"

namespace sinew {
namespace {

constexpr double kTurn = 2 * kPi;

bool Allows(const MultibodyModel& model, int coordinate, double value) {
  const OsimCoordinate& properties = model.coordinate(coordinate);
  return !properties.clamped || (value >= properties.lower && value <= properties.upper);
}

// To within half a turn of `middle`, where the range allows it.
double Wrapped(const MultibodyModel& model, int coordinate, double value, double middle) {
  const double wrapped = middle + std::remainder(value - middle, kTurn);
  // A value within half a turn stays as it is to the last bit.
  return std::abs(value - middle) > kPi && Allows(model, coordinate, wrapped) ? wrapped : value;
}

MarkerFit::Search FullSearch(const IkOptions& options) {
  MarkerFit::Search search;
  search.accuracy = options.accuracy;
  search.max_iterations = options.max_iterations;
  return search;
}

// Joints with three free angles.
std::vector<std::array<int, 3>> ThreeRotations(const MultibodyModel& model) {
  std::map<int, std::vector<int>> angles;  // of a body, in the order of the rotations
  const auto& coordinates = model.simbody().coordinates;
  for (int i = 0; i < static_cast<int>(coordinates.size()); ++i) {
    if (IsFreeAngle(model, i)) angles[coordinates[static_cast<std::size_t>(i)].body].push_back(i);
  }
  std::vector<std::array<int, 3>> joints;
  for (auto& [body, of_body] : angles) {
    if (of_body.size() != 3) continue;
    std::sort(of_body.begin(), of_body.end(), [&](int a, int b) {
      return coordinates[static_cast<std::size_t>(a)].q < coordinates[static_cast<std::size_t>(b)].q;
    });
    joints.push_back({of_body[0], of_body[1], of_body[2]});
  }
  return joints;
}

// The other angles of an orientation, for three axes in turn at right angles (the second angle's supplement)
// and for a third axis that is the first one (its negative). Axes in between start near it.
std::vector<Vector> Flipped(const MultibodyModel& model, const std::array<int, 3>& joint,
                            const Vector& values, const Vector& middles) {
  std::vector<Vector> flipped;
  for (const double second : {kPi - values[joint[1]], -values[joint[1]]}) {
    Vector pose = values;
    pose[joint[0]] += kPi;
    pose[joint[1]] = second;
    pose[joint[2]] += kPi;
    bool allowed = true;
    for (const int i : joint) {
      pose[i] = middles[i] + std::remainder(pose[i] - middles[i], kTurn);
      allowed = allowed && Allows(model, i, pose[i]);
    }
    if (allowed) flipped.push_back(std::move(pose));
  }
  return flipped;
}

double DistanceSquared(const MultibodyModel& model, const Vector& values, const Vector& middles) {
  double sum = 0;
  for (int i = 0; i < static_cast<int>(values.size()); ++i) {
    if (IsFreeAngle(model, i)) sum += std::pow(values[i] - middles[i], 2);
  }
  return sum;
}

// Flips of joints that bring the angles nearer to `middles` and place the markers alike.
MarkerFit::Solution NearestFlip(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                                MarkerFit::Solution solution, const Vector& middles) {
  constexpr double kNearer = 1e-3;  // [rad2]; at equal distances the pose stays
  for (const std::array<int, 3>& joint : ThreeRotations(model)) {
    for (const Vector& start : Flipped(model, joint, solution.values, middles)) {
      const double distance = DistanceSquared(model, solution.values, middles) - kNearer;
      if (DistanceSquared(model, start, middles) >= distance) continue;
      MarkerFit::Solution found = fit.Solve(start, FullSearch(options));
      if (IsLower(solution.cost, found.cost, options)) continue;
      if (DistanceSquared(model, found.values, middles) < distance) solution = std::move(found);
    }
  }
  return solution;
}

Vector WrappedPose(const MultibodyModel& model, const Vector& values, const Vector& middles) {
  Vector wrapped = values;
  for (int i = 0; i < static_cast<int>(values.size()); ++i) {
    if (IsFreeAngle(model, i)) wrapped[i] = Wrapped(model, i, values[i], middles[i]);
  }
  return wrapped;
}

Vector ExpectedAngles(const MultibodyModel& model) {
  Vector expected = model.default_values();
  for (int i = 0; i < static_cast<int>(expected.size()); ++i) {
    if (IsFreeAngle(model, i)) expected[i] = ExpectedAngle(model, i);
  }
  return expected;
}

}  // namespace

bool IsLower(double cost, double than, const IkOptions& options) {
  constexpr double kRelative = 1e-6;
  return cost < (1 - kRelative) * than - options.accuracy * options.accuracy;
}

bool IsFreeAngle(const MultibodyModel& model, int coordinate) {
  const OsimCoordinate& properties = model.coordinate(coordinate);
  return properties.motion == MotionType::kRotational && !properties.locked && !model.IsDependent(coordinate);
}

double ExpectedAngle(const MultibodyModel& model, int coordinate) {
  constexpr double kWidest = 4 * kTurn;
  const OsimCoordinate& properties = model.coordinate(coordinate);
  const double width = properties.upper - properties.lower;
  const bool has_middle = width > 0 && width <= kWidest;
  return has_middle ? properties.lower + width / 2 : model.default_values()[coordinate];
}

double Oddity(const MultibodyModel& model, const Vector& values) {
  return DistanceSquared(model, values, ExpectedAngles(model));
}

MarkerFit::Solution Canonical(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                              MarkerFit::Solution solution) {
  constexpr int kMostRounds = 3;  // where the search goes back beyond the half turn
  const Vector expected = ExpectedAngles(model);
  for (int round = 0; round < kMostRounds; ++round) {
    const Vector wrapped = WrappedPose(model, solution.values, expected);
    if (wrapped == solution.values) break;
    solution = fit.Solve(wrapped, FullSearch(options));
  }
  return NearestFlip(fit, model, options, std::move(solution), expected);
}

MarkerFit::Solution Continued(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                              MarkerFit::Solution solution, const Vector& neighbour) {
  const Vector wrapped = WrappedPose(model, solution.values, neighbour);
  if (wrapped != solution.values) {
    MarkerFit::Solution found = fit.Solve(wrapped, FullSearch(options));
    if (!IsLower(solution.cost, found.cost, options)) solution = std::move(found);
  }
  return NearestFlip(fit, model, options, std::move(solution), neighbour);
}

MarkerFit::Solution SolveAcrossEnds(MarkerFit& fit, const MultibodyModel& model, const Vector& start,
                                    const MarkerFit::Search& search) {
  MarkerFit::Solution found = fit.Solve(start, search);
  if (found.joined >= 0) return found;
  for (const int i : fit.free_coordinates()) {
    const OsimCoordinate& properties = model.coordinate(i);
    constexpr double kAlmost = 0.1;  // ranges are written with few digits
    if (!IsFreeAngle(model, i) || !properties.clamped ||
        properties.upper - properties.lower < kTurn - kAlmost)
      continue;
    const bool at_lower = found.values[i] <= properties.lower;
    if (!at_lower && found.values[i] < properties.upper) continue;
    Vector other = found.values;
    other[i] += at_lower ? kTurn : -kTurn;
    MarkerFit::Solution across = fit.Solve(other, search);
    if (across.joined >= 0 || across.cost < found.cost) found = std::move(across);
    if (found.joined >= 0) break;
  }
  return found;
}

}  // namespace sinew
