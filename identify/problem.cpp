#include "identify/problem.h"

#include <algorithm>

namespace sinew {

const char* ToString(Level level) {
  switch (level) {
    case Level::kHuman:
      return "human";
    case Level::kRobot:
      return "robot";
    case Level::kBoundary:
      return "boundary";
    case Level::kSensor:
      return "sensor";
  }
  return "?";
}

double UnknownTerm::Value(double signal_value) const {
  if (signal_value <= knots.front()) return weights[0];
  if (signal_value >= knots.back()) return weights[weights.size() - 1];
  const auto after = std::upper_bound(knots.begin(), knots.end(), signal_value);
  const auto j = after - knots.begin();
  const double share = (signal_value - knots[j - 1]) / (knots[j] - knots[j - 1]);
  return weights[j - 1] + share * (weights[j] - weights[j - 1]);
}

const std::vector<Effect>& Problem::effects() const {
  static const std::vector<Effect> kNone;
  return kNone;
}

const std::vector<Port>& Problem::ports() const {
  static const std::vector<Port> kNone;
  return kNone;
}

const std::vector<Constraint>& Problem::constraints() const {
  static const std::vector<Constraint> kNone;
  return kNone;
}

Status Problem::Describe(const Vector& /*parameters*/, Hdf5Node& /*details*/) const {
  return {};
}

Vector RestPoint(const Problem& problem) {
  const auto& parameters = problem.parameters();
  Vector rest(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i)
    rest[static_cast<Eigen::Index>(i)] = parameters[i].rest_value();
  return rest;
}

}  // namespace sinew
