#include "identify/problem.h"

#include "identify/alternative_prediction.h"
#include "identify/unmeasured_estimate.h"

namespace sinew {

const char* ToString(Occurrence occurrence) {
  switch (occurrence) {
    case Occurrence::kCommon:
      return "common";
    case Occurrence::kOccasional:
      return "occasional";
    case Occurrence::kRare:
      return "rare";
  }
  return "?";
}

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

const std::vector<Effect>& Problem::effects() const {
  static const std::vector<Effect> kNone;
  return kNone;
}

const std::vector<DiscrepancyPort>& Problem::ports() const {
  static const std::vector<DiscrepancyPort> kNone;
  return kNone;
}

const std::vector<Constraint>& Problem::constraints() const {
  static const std::vector<Constraint> kNone;
  return kNone;
}

const std::vector<FitStep>& Problem::steps() const {
  static const std::vector<FitStep> kNone;
  return kNone;
}

std::vector<Warning> Problem::WarningsAt(const Vector& /*parameters*/) const {
  return {};
}

std::optional<Vector> Problem::ImprovedStart(const std::vector<int>& /*free*/,
                                             const std::vector<bool>& /*compared*/,
                                             const Vector& /*parameters*/) const {
  return {};
}

Result<bool> Problem::PredictWithInputNoise(const Query& /*query*/, std::uint64_t /*draw*/,
                                            Workspace& /*workspace*/, Prediction& /*prediction*/) const {
  return false;
}

std::vector<DerivedQuantity> Problem::DerivedQuantities() const {
  return {};
}

std::vector<AlternativePrediction> Problem::Alternatives(const Vector& /*parameters*/) const {
  return {};
}

Vector Problem::AtPriors(const Vector& parameters, const Vector& priors, CarryOver /*how*/) const {
  Vector at = parameters;
  for (std::size_t i = 0; i < this->parameters().size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    if (this->parameters()[i].kind == ParameterKind::kPrior) at[index] = priors[index];
  }
  return at;
}

std::optional<UnmeasuredEstimate> Problem::EstimateUnmeasured(const Vector& /*parameters*/) const {
  return {};
}

std::vector<FigureOfMerit> Problem::FiguresOfMerit(const Vector& /*parameters*/,
                                                   const std::vector<Vector>& /*predicted*/) const {
  return {};
}

Status Problem::WriteDetails(const Vector& /*parameters*/, Hdf5Node& /*details*/) const {
  return {};
}

std::vector<Problem::Signal> Problem::ResidualCovariates(int /*block*/) const {
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
