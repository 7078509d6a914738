// What a contact's prediction is judged by: steps without their plates, from the motion alone, with the mean
// load of the fitted ones and from the dynamics of the whole body, and the mean curve of other steps.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "identify/fit_quality.h"
#include "problems/contact/load/plate_channels.h"
#include "problems/contact/problem.h"
#include "problems/contact/steps/body_rows.h"
#include "problems/contact/steps/step_predictor.h"

namespace sinew {
namespace {

constexpr int kPhases = 101;
constexpr const char* kByMotion = "the motion alone";
constexpr const char* kByMeanLoad = "the motion and the mean load of the fitted stances";
constexpr const char* kByBody = "the motion of the whole body";

// Of a stance, at equal parts of the time between its first and last fitted or compared sample.
using Curve = std::vector<double>;

bool IsSideways(std::size_t channel) {
  return channel == kFz || channel == kCopZ || channel == kFreeMoment;
}

// The place of the foot in the middle of its stance, from which a centre of pressure is counted.
double Origin(const Stance& stance, std::size_t channel) {
  const Vec3& centre = stance.foot.centre[stance.time.size() / 2];
  return channel == kCopX ? centre.x() : channel == kCopZ ? centre.z() : 0;
}

// A block's measurement at equal phases; nothing where it was not measured. Beyond the ends of what was
// measured (a light foot has no centre of pressure) its end values go on.
std::optional<Curve> MeasuredCurve(const Block& block, const std::array<double, 2>& span) {
  if (block.measured.size() < 2) return {};
  Curve curve;
  std::size_t i = 0;
  for (int p = 0; p < kPhases; ++p) {
    const double t = span[0] + (span[1] - span[0]) * p / (kPhases - 1);
    const auto time = [&](std::size_t s) {
      return block.prediction_time[static_cast<std::size_t>(block.sample[s])];
    };
    while (i + 2 < block.sample.size() && time(i + 1) < t) ++i;
    const double share = std::clamp((t - time(i)) / (time(i + 1) - time(i)), 0.0, 1.0);
    curve.push_back(block.measured[i] + share * (block.measured[i + 1] - block.measured[i]));
  }
  return curve;
}

// Values of the blocks of held-out stances; nothing for all others.
struct HeldOut {
  AlternativePrediction prediction;
  HeldOut(const char* from, std::size_t blocks) {
    prediction.name = std::string("from ") + from;
    prediction.values.resize(blocks);
    prediction.half_width.resize(blocks);
  }
  void Add(const Stance& stance, const Layout& layout, const StepEstimate& estimate) {
    for (std::size_t c = 0; c < ContactProblem::kChannels; ++c) {
      const auto b = static_cast<std::size_t>(stance.blocks[c]);
      prediction.values[b] = estimate.value[c];
      prediction.half_width[b] = HalfWidthOf(estimate, c, layout[b]);
    }
  }
};

// The same prediction, compared in single support alone.
AlternativePrediction InSingleSupport(AlternativePrediction prediction, const std::vector<Stance>& stances,
                                      const Layout& layout) {
  prediction.name += ", in single support";
  prediction.compared.assign(layout.size(), std::vector<bool>());
  for (const Stance& stance : stances) {
    for (const int block : stance.blocks) {
      auto& compared = prediction.compared[static_cast<std::size_t>(block)];
      compared.assign(stance.time.size(), false);
      if (!stance.body) continue;
      for (std::size_t t = 0; t < stance.time.size(); ++t) compared[t] = stance.body->phase[t] == kSingle;
    }
  }
  return prediction;
}

}  // namespace

std::vector<const Stance*> ContactProblem::StancesOf(BlockRole role) const {
  std::vector<const Stance*> stances;
  for (const Stance& stance : data_.stances) {
    const auto has_role = [&](int block) {
      return data_.layout[static_cast<std::size_t>(block)].role == role;
    };
    if (std::any_of(stance.blocks.begin(), stance.blocks.end(), has_role)) stances.push_back(&stance);
  }
  return stances;
}

std::optional<std::vector<std::vector<ContactLoad>>> ContactProblem::FittedLoads(
    const Vector& parameters) const {
  const auto predicted = PredictAll(*this, parameters);
  if (!predicted) return {};
  const std::vector<const Stance*> fitted = StancesOf(BlockRole::kTrain);
  std::vector<std::vector<ContactLoad>> loads;
  for (const Stance* stance : fitted) {
    std::array<Vector, kChannels> channels;
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto b = static_cast<std::size_t>(stance->blocks[c]);
      channels[c] = predicted->values[b];
      // Nothing holds a channel that is not fitted to its measurement; free moments are left out where plates
      // have offsets.
      const Block& block = data_.layout[b];
      if (block.role == BlockRole::kTrain || c == kFreeMoment) continue;
      for (std::size_t i = 0; i < block.sample.size(); ++i) channels[c][block.sample[i]] = block.measured[i];
    }
    auto& of_stance = loads.emplace_back();
    for (Eigen::Index t = 0; t < channels[0].size(); ++t) {
      std::array<double, kChannels> at{};
      for (std::size_t c = 0; c < kChannels; ++c) at[c] = channels[c][t];
      of_stance.push_back(LoadOf(at));
    }
  }
  return loads;
}

std::optional<UnmeasuredEstimate> ContactProblem::EstimateUnmeasured(const Vector& parameters) const {
  const std::vector<const Stance*> fitted = StancesOf(BlockRole::kTrain);
  const bool any = std::any_of(data_.stances.begin(), data_.stances.end(),
                               [](const Stance& stance) { return !stance.measured; });
  if (!settings_.motion_errors || !any || fitted.empty()) return {};
  const auto loads = FittedLoads(parameters);
  if (!loads) return {};
  const StepPredictor steps(*this, fitted, *loads, parameters);
  UnmeasuredEstimate all{parameters, std::vector<Vector>(data_.layout.size()),
                         std::vector<Vector>(data_.layout.size()),
                         std::vector<std::string>(data_.layout.size())};
  for (const Stance& stance : data_.stances) {
    if (stance.measured) continue;
    auto estimate = steps.ByBody(stance);
    const char* from_what = kByBody;
    if (!estimate) {
      estimate = steps.ByMeanLoad(stance);
      from_what = kByMeanLoad;
    }
    if (!estimate) continue;
    const auto [from, to] = stance.motion_errors.OwnRange();
    all.parameters.segment(from, to - from) = estimate->parameters.segment(from, to - from);
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto b = static_cast<std::size_t>(stance.blocks[c]);
      all.values[b] = estimate->value[c];
      all.half_width[b] = HalfWidthOf(*estimate, c, data_.layout[b]);
      all.from[b] = from_what;
    }
  }
  return all;
}

std::vector<AlternativePrediction> ContactProblem::Alternatives(const Vector& parameters) const {
  std::vector<AlternativePrediction> alternatives;
  if (!settings_.motion_errors) return alternatives;

  const std::vector<const Stance*> fitted = StancesOf(BlockRole::kTrain);
  const std::vector<const Stance*> held_out = StancesOf(BlockRole::kValidate);
  HeldOut by_motion(kByMotion, data_.layout.size());
  HeldOut by_mean_load(kByMeanLoad, data_.layout.size());
  HeldOut by_body(kByBody, data_.layout.size());
  bool any_mean_load = false;
  bool any_body = false;
  const auto loads = FittedLoads(parameters);
  if (!fitted.empty() && !held_out.empty() && loads) {
    const StepPredictor steps(*this, fitted, *loads, parameters);
    for (const Stance* stance : held_out) {
      const auto alone = steps.ByMotion(*stance);
      if (!alone) continue;
      by_motion.Add(*stance, data_.layout, *alone);
      if (const auto of_body = steps.ByBody(*stance)) {
        by_body.Add(*stance, data_.layout, *of_body);
        any_body = true;
      } else if (const auto of_mean = steps.ByMeanLoad(*stance)) {
        by_mean_load.Add(*stance, data_.layout, *of_mean);
        any_mean_load = true;
      }
    }
    alternatives.push_back(std::move(by_motion.prediction));
    if (any_mean_load) alternatives.push_back(std::move(by_mean_load.prediction));
    if (any_body) alternatives.push_back(by_body.prediction);
  }

  AlternativePrediction mean;
  mean.name = "by the mean curve of the fitted stances";
  mean.values.resize(data_.layout.size());
  for (std::size_t c = 0; c < kChannels; ++c) {
    Curve sum(kPhases, 0.0);
    int curves = 0;
    for (const Stance& stance : data_.stances) {
      const Block& block = data_.layout[static_cast<std::size_t>(stance.blocks[c])];
      if (block.role != BlockRole::kTrain) continue;
      const auto curve = MeasuredCurve(block, stance.loaded);
      if (!curve) continue;
      const double sign = IsSideways(c) ? stance.side : 1;
      for (std::size_t p = 0; p < sum.size(); ++p) sum[p] += sign * ((*curve)[p] - Origin(stance, c));
      ++curves;
    }
    if (curves == 0) continue;
    // A fitted stance is part of its own mean.
    for (const Stance* held : held_out.empty() ? fitted : held_out) {
      const Stance& stance = *held;
      const double sign = IsSideways(c) ? stance.side : 1;
      Vector values(static_cast<Eigen::Index>(stance.time.size()));
      for (std::size_t t = 0; t < stance.time.size(); ++t) {
        const double phase =
            std::clamp((stance.time[t] - stance.loaded[0]) / (stance.loaded[1] - stance.loaded[0]), 0.0,
                       1.0) *
            (kPhases - 1);
        const auto p = std::min(static_cast<std::size_t>(phase), sum.size() - 2);
        const double at = phase - static_cast<double>(p);
        values[static_cast<Eigen::Index>(t)] =
            sign * ((1 - at) * sum[p] + at * sum[p + 1]) / curves + Origin(stance, c);
      }
      mean.values[static_cast<std::size_t>(stance.blocks[c])] = std::move(values);
    }
  }
  alternatives.push_back(mean);
  if (any_body) {
    for (AlternativePrediction* of : {&by_body.prediction, &mean})
      alternatives.push_back(InSingleSupport(std::move(*of), data_.stances, data_.layout));
  }
  return alternatives;
}

}  // namespace sinew
