#include "problems/contact/steps/step_predictor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "problems/contact/load/plate_channels.h"
#include "problems/contact/steps/expected_friction.h"
#include "problems/contact/steps/load_estimate.h"
#include "problems/contact/steps/shared_deviation.h"

namespace sinew {
namespace {

double MeanLoadedForce(const Stance& stance, const Block& vertical) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < vertical.sample.size(); ++i) {
    const double t = stance.time[static_cast<std::size_t>(vertical.sample[i])];
    if (t < stance.loaded[0] || t > stance.loaded[1]) continue;
    sum += vertical.measured[i];
    count += 1;
  }
  return count > 0 ? sum / count : 0;
}

// Those of the vertical force and its place.
std::vector<LoadRow> WithoutFriction(std::vector<LoadRow> rows) {
  const auto feels_friction = [](const LoadRow& row) {
    return std::any_of(row.terms.begin(), row.terms.end(), [](const LoadRow::Term& term) {
      return term.factors[kForceX] != 0 || term.factors[kForceZ] != 0 || term.factors[kMomentY] != 0;
    });
  };
  rows.erase(std::remove_if(rows.begin(), rows.end(), feels_friction), rows.end());
  return rows;
}

// What two estimates tell of the channels of friction, weighted by their precisions; where the other one is
// exact (no load, of a foot that is off the floor), that.
void TakeBoth(const StepEstimate& other, StepEstimate& estimate) {
  for (const std::size_t channel : {kFx, kFz, kFreeMoment}) {
    for (Eigen::Index t = 0; t < estimate.value[channel].size(); ++t) {
      double& value = estimate.value[channel][t];
      double& deviation = estimate.deviation[channel][t];
      const double variance = deviation * deviation;
      const double of_other = other.deviation[channel][t] * other.deviation[channel][t];
      const double share = of_other > 0 ? variance / (variance + of_other) : 1;
      value += share * (other.value[channel][t] - value);
      deviation = std::sqrt(share * of_other);
    }
  }
}

// The horizontal force and the free moment about the centre of pressure, in place of those of friction.
void TakeHorizontalLoad(const LoadEstimate& known, StepEstimate& estimate) {
  for (std::size_t i = 0; i < known.load.size(); ++i) {
    const auto t = static_cast<Eigen::Index>(i);
    const ContactLoad& load = known.load[i];
    ContactLoad free_moment = ContactLoad::Zero();
    free_moment[kMomentY] = 1;
    free_moment[kForceX] = -estimate.value[kCopZ][t];
    free_moment[kForceZ] = estimate.value[kCopX][t];
    const auto take = [&](std::size_t channel, const ContactLoad& factors) {
      estimate.value[channel][t] = factors.dot(load);
      estimate.deviation[channel][t] = std::sqrt(factors.dot(known.covariance[i] * factors));
    };
    take(kFx, ContactLoad::Unit(kForceX));
    take(kFz, ContactLoad::Unit(kForceZ));
    take(kFreeMoment, free_moment);
  }
}

}  // namespace

StepPredictor::StepPredictor(const ContactProblem& problem, std::vector<const Stance*> fitted,
                             const std::vector<std::vector<ContactLoad>>& loads, const Vector& parameters)
    : problem_(problem),
      fitted_(std::move(fitted)),
      parameters_(parameters),
      errors_(fitted_, loads),
      mean_(fitted_, loads, problem.settings().floor.height),
      spread_(SpreadOfSteps(problem, fitted_, parameters)) {
  const auto steps = static_cast<double>(fitted_.size());
  for (const Stance* stance : fitted_) {
    const auto vertical = static_cast<std::size_t>(stance->blocks[kFy]);
    mean_force_ += MeanLoadedForce(*stance, problem.layout()[vertical]) / steps;
    greatest_force_ += stance->greatest_force / steps;
    mean_duration_ += (stance->loaded[1] - stance->loaded[0]) / steps;
  }
}

std::vector<LoadRow> StepPredictor::RowsOfAStep(const Stance& stance) const {
  constexpr double kMeanDiffers = 0.05;  // between the feet, and between steps
  constexpr double kLight = 0.02;        // of the greatest force, where a stance begins and ends
  if (!(mean_force_ > 0)) return {};
  LoadRow mean;
  std::vector<std::size_t> loaded;
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    if (stance.time[t] >= stance.loaded[0] && stance.time[t] <= stance.loaded[1]) loaded.push_back(t);
  }
  if (loaded.empty()) return {};
  ContactLoad vertical = ContactLoad::Zero();
  vertical[kForceY] = 1;
  for (const std::size_t t : loaded)
    mean.terms.push_back({static_cast<int>(t), vertical / static_cast<double>(loaded.size())});
  mean.measured = mean_force_;
  mean.deviation = kMeanDiffers * mean_force_;
  std::vector<LoadRow> rows{mean};
  for (const std::size_t t : {loaded.front(), loaded.back()})
    rows.push_back({{{static_cast<int>(t), vertical}}, kLight * greatest_force_, kLight * greatest_force_});
  return rows;
}

Vector StepPredictor::MeanOfPrior(const Stance& stance) const {
  Vector mean = parameters_;
  SetMeanDeviation(fitted_, stance, mean);
  return mean;
}

std::optional<StepEstimate> StepPredictor::ByMotion(const Stance& stance) const {
  auto estimate = EstimateStep(problem_, stance, MeanOfPrior(stance), spread_, RowsOfAStep(stance));
  if (!estimate || !TakeExpectedFriction(problem_, stance, *estimate)) return {};
  return std::move(*estimate);
}

double StepPredictor::UnusuallyLong(const Stance& stance) const {
  constexpr double kUsual = 0.04;  // of the duration of a stance, twice what steps of one gait differ by
  const double duration = stance.loaded[1] - stance.loaded[0];
  return std::max(1.0, std::abs(duration / mean_duration_ - 1) / kUsual);
}

Wrench StepPredictor::UnusuallyFar(const Stance& stance, const StepEstimate& by_motion) const {
  const Mat3 into_foot = IntoFoot(stance).topLeftCorner<3, 3>();
  Vec3 squares = Vec3::Zero();
  Vec3 variances = Vec3::Zero();
  double count = 0;
  for (std::size_t i = 0; i < stance.time.size(); ++i) {
    if (!IsLoaded(stance, i)) continue;
    const auto t = static_cast<Eigen::Index>(i);
    const auto of = [&](const ChannelValues& channels) {
      return Vec3(channels[kFx][t], channels[kFy][t], channels[kFz][t]);
    };
    const Vec3 apart = into_foot * of(by_motion.value) - mean_.At(PhaseOf(stance, i)).head<3>();
    squares += apart.cwiseAbs2();
    variances += into_foot.cwiseAbs2() * of(by_motion.deviation).cwiseAbs2();
    count += 1;
  }
  Wrench larger = Wrench::Ones();
  if (count == 0) return larger;
  const Vec3 scatter = mean_.scatter().head<3>();
  larger.head<3>() =
      ((squares - variances) / count).cwiseQuotient(scatter.cwiseAbs2()).array().max(1.0).sqrt();
  return larger;
}

std::optional<StepEstimate> StepPredictor::ByMeanLoad(const Stance& stance) const {
  const auto by_motion = ByMotion(stance);
  if (!by_motion) return {};
  const Wrench larger = UnusuallyFar(stance, *by_motion).cwiseMax(UnusuallyLong(stance));
  std::vector<LoadRow> rows = mean_.RowsFor(stance, larger);
  const std::vector<LoadRow> of_a_step = RowsOfAStep(stance);
  rows.insert(rows.end(), of_a_step.begin(), of_a_step.end());
  auto estimate = EstimateStep(problem_, stance, MeanOfPrior(stance), spread_, WithoutFriction(rows));
  if (!estimate || !TakeExpectedFriction(problem_, stance, *estimate)) return {};
  StepEstimate without_friction = *estimate;
  TakeHorizontalLoad(EstimateLoad(rows, stance.time.size()), without_friction);
  TakeBoth(without_friction, *estimate);
  return std::move(*estimate);
}

Wrench StepPredictor::Unusual(const Stance& stance) const {
  Wrench squares = Wrench::Zero();
  double count = 0;
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    if (!IsLoaded(stance, t) || stance.body->phase[t] != kSingle) continue;
    squares += (errors_.CorrectedLoad(stance, t) - mean_.At(PhaseOf(stance, t))).array().square().matrix();
    count += 1;
  }
  if (count == 0) return Wrench::Ones();
  const Wrench expected = mean_.scatter().array().square() + errors_.scatter().array().square();
  return (squares / count).cwiseQuotient(expected).array().sqrt().max(1.0);
}

std::optional<StepEstimate> StepPredictor::ByBody(const Stance& stance) const {
  const std::vector<LoadRow> of_body = errors_.RowsFor(stance);
  if (of_body.empty()) return {};
  std::vector<LoadRow> rows = mean_.RowsFor(stance, Unusual(stance));
  for (const std::vector<LoadRow>& more : {RowsOfAStep(stance), of_body})
    rows.insert(rows.end(), more.begin(), more.end());
  auto estimate = EstimateStep(problem_, stance, MeanOfPrior(stance), spread_, WithoutFriction(rows));
  if (!estimate) return {};
  TakeHorizontalLoad(EstimateLoad(rows, stance.time.size()), *estimate);
  return std::move(*estimate);
}

Vector HalfWidthOf(const StepEstimate& estimate, std::size_t channel, const Block& block) {
  constexpr double kInside95 = 1.96;  // standard deviations on both sides
  const double accuracy = block.sigma.value_or(0);
  return kInside95 * (estimate.deviation[channel].array().square() + accuracy * accuracy).sqrt().matrix();
}

}  // namespace sinew
