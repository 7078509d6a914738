// What a contact's prediction is judged by: the recorded motion alone, and the mean curve of other steps.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "problems/contact/plate_channels.h"
#include "problems/contact/problem.h"

namespace sinew {
namespace {

constexpr int kPhases = 101;

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

}  // namespace

std::vector<AlternativePrediction> ContactProblem::Alternatives(const Vector& parameters) const {
  std::vector<AlternativePrediction> alternatives;
  if (!settings_.motion_errors) return alternatives;

  AlternativePrediction recorded{"from the motion alone", parameters, {}};
  for (const Stance& stance : data_.stances) {
    const auto [from, to] = stance.motion_errors.OwnRange();
    recorded.parameters.segment(from, to - from).setZero();
  }
  alternatives.push_back(std::move(recorded));

  AlternativePrediction mean{"by the mean curve of the fitted stances", {}, {}};
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
    for (const Stance& stance : data_.stances) {
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
  alternatives.push_back(std::move(mean));
  return alternatives;
}

}  // namespace sinew
