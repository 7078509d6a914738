#include "problems/emg_shape/learning/shape_resolution.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "models/emg/shape_basis.h"

namespace sinew {
namespace {

constexpr std::array<int, 3> kKnots{kUsualKnots, 20, 28};
constexpr int kFolds = 5;
constexpr double kNearly = 1.02;

struct Samples {
  std::vector<double> phase;
  std::vector<double> values;
};

// Sum of squared errors of the cycles that a curve was not fitted to; NaN: there are too few samples for it.
double LeftOutSquares(const RecordedTrial& recording, const std::vector<double>& values,
                      const ShapeBasis& basis) {
  const EmgShapeTrial& trial = recording.trial;
  double squares = 0;
  for (int fold = 0; fold < kFolds; ++fold) {
    Samples fitted;
    Samples left_out;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      Samples& to = trial.cycle[i] % kFolds == fold ? left_out : fitted;
      to.phase.push_back(trial.phase[i]);
      to.values.push_back(values[i]);
    }
    if (left_out.phase.empty()) continue;
    const auto shape = FitShape(fitted.phase, fitted.values, basis);
    if (!shape) return std::nan("");
    for (std::size_t i = 0; i < left_out.phase.size(); ++i)
      squares += std::pow(left_out.values[i] - basis.Value(left_out.phase[i], shape->data()), 2);
  }
  return squares;
}

int KnotsOf(const std::vector<const RecordedTrial*>& recordings, const std::string& muscle) {
  std::vector<double> errors;
  for (const int knots : kKnots) {
    const ShapeBasis basis(knots);
    double squares = 0;
    for (const RecordedTrial* recording : recordings) {
      const auto measured = recording->measured.find(muscle);
      if (recording->trial.role == BlockRole::kTrain && measured != recording->measured.end())
        squares += LeftOutSquares(*recording, measured->second, basis);
    }
    if (std::isnan(squares)) break;
    errors.push_back(std::sqrt(squares));
  }
  if (errors.empty()) return kUsualKnots;
  const double best = *std::min_element(errors.begin(), errors.end());
  const auto enough =
      std::find_if(errors.begin(), errors.end(), [&](double e) { return e <= kNearly * best; });
  return kKnots[static_cast<std::size_t>(enough - errors.begin())];
}

}  // namespace

int ChooseKnots(const std::vector<const RecordedTrial*>& recordings, const std::vector<EmgMuscle>& muscles) {
  int knots = kUsualKnots;
  for (const EmgMuscle& muscle : muscles) knots = std::max(knots, KnotsOf(recordings, muscle.name));
  return knots;
}

}  // namespace sinew
