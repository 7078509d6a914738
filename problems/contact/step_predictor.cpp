#include "problems/contact/step_predictor.h"

#include <cmath>
#include <utility>

#include "problems/contact/plate_channels.h"
#include "problems/contact/shared_deviation.h"

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

}  // namespace

StepPredictor::StepPredictor(const ContactProblem& problem, std::vector<const Stance*> fitted,
                             const Vector& parameters, std::optional<BodyLoadErrors> errors)
    : problem_(problem),
      fitted_(std::move(fitted)),
      parameters_(parameters),
      errors_(std::move(errors)),
      spread_(SpreadOfSteps(problem, fitted_, parameters)) {
  const auto steps = static_cast<double>(fitted_.size());
  for (const Stance* stance : fitted_) {
    const auto vertical = static_cast<std::size_t>(stance->blocks[kFy]);
    mean_force_ += MeanLoadedForce(*stance, problem.layout()[vertical]) / steps;
    greatest_force_ += stance->greatest_force / steps;
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

std::optional<StepEstimate> StepPredictor::Estimate(const Stance& stance,
                                                    const std::vector<LoadRow>& rows) const {
  Vector expected = parameters_;
  SetMeanDeviation(fitted_, stance, expected);
  auto estimate = EstimateStep(problem_, stance, expected, spread_, rows);
  if (!estimate) return {};
  return std::move(*estimate);
}

std::optional<StepEstimate> StepPredictor::ByMotion(const Stance& stance) const {
  return Estimate(stance, RowsOfAStep(stance));
}

std::optional<StepEstimate> StepPredictor::ByBody(const Stance& stance) const {
  if (!errors_) return {};
  const std::vector<LoadRow> of_body = errors_->RowsFor(stance);
  if (of_body.empty()) return {};
  std::vector<LoadRow> rows = RowsOfAStep(stance);
  rows.insert(rows.end(), of_body.begin(), of_body.end());
  return Estimate(stance, rows);
}

Vector HalfWidthOf(const StepEstimate& estimate, std::size_t channel, const Block& block) {
  constexpr double kInside95 = 1.96;  // standard deviations on both sides
  const double accuracy = block.sigma.value_or(0);
  return kInside95 * (estimate.deviation[channel].array().square() + accuracy * accuracy).sqrt().matrix();
}

}  // namespace sinew
