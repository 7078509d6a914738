#include "problems/contact/steps/mean_load.h"

#include <algorithm>
#include <cmath>

#include "problems/contact/steps/shared_deviation.h"

namespace sinew {
namespace {

constexpr double kMemory = 0.1;  // [s]

WrenchOfLoad AboutFoot(const Stance& stance, std::size_t instant, double floor_height) {
  Vec3 place = stance.foot.centre[instant];
  place.y() = floor_height;
  return IntoFoot(stance) * WrenchAbout(place);
}

// What is expected before any step is seen, for a greatest vertical force [N] and a sole's length [m].
Wrench ExpectedScatter(double force, double length) {
  Wrench share;
  share << 0.02, 0.04, 0.015, 0.06 * length, 0.01 * length, 0.1 * length;
  return force * share;
}

}  // namespace

MeanLoad::MeanLoad(const std::vector<const Stance*>& fitted,
                   const std::vector<std::vector<ContactLoad>>& loads, double floor_height)
    : floor_height_(floor_height) {
  constexpr double kExpectedFrom = 3;  // steps
  const auto steps = static_cast<double>(fitted.size());
  double force = 0;
  double length = 0;
  for (std::size_t s = 0; s < fitted.size(); ++s) {
    const Stance& stance = *fitted[s];
    WrenchCurve& curve = curves_.emplace_back();
    for (std::size_t t = 0; t < stance.time.size(); ++t) {
      if (!IsLoaded(stance, t)) continue;
      curve.share.push_back(PhaseOf(stance, t));
      curve.wrench.emplace_back(AboutFoot(stance, t, floor_height) * loads[s][t]);
    }
    force += stance.greatest_force / steps;
    length += stance.length / steps;
  }
  Wrench squares = kExpectedFrom * ExpectedScatter(force, length).array().square();
  for (const WrenchCurve& curve : curves_) {
    Wrench sum = Wrench::Zero();
    for (std::size_t i = 0; i < curve.share.size(); ++i)
      sum += (curve.wrench[i] - At(curve.share[i])).array().square().matrix();
    if (!curve.share.empty()) squares += sum / static_cast<double>(curve.share.size());
  }
  // One step's own degrees of freedom are those of its difference to the mean of all.
  const double known = kExpectedFrom + steps - 1;
  scatter_ = (squares / known * (1 + 1 / steps)).array().sqrt();
}

Wrench MeanLoad::At(double phase) const {
  Wrench sum = Wrench::Zero();
  double count = 0;
  for (const WrenchCurve& curve : curves_) {
    if (curve.share.empty()) continue;
    sum += curve.At(phase);
    count += 1;
  }
  return count > 0 ? Wrench(sum / count) : sum;
}

std::vector<LoadRow> MeanLoad::RowsFor(const Stance& stance, const Wrench& larger) const {
  std::vector<LoadRow> rows;
  bool first = true;
  WrenchOfLoad before = WrenchOfLoad::Zero();
  Wrench mean_before = Wrench::Zero();
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    if (!IsLoaded(stance, t)) continue;
    const WrenchOfLoad now = AboutFoot(stance, t, floor_height_);
    const Wrench mean = At(PhaseOf(stance, t));
    // What the difference at the instant before does not tell of this one.
    const double kept = first ? 0 : std::exp(-(stance.time[t] - stance.time[t - 1]) / kMemory);
    for (Eigen::Index c = 0; c < 6; ++c) {
      const double scatter = larger[c] * scatter_[c];
      if (!(scatter > 0)) continue;
      LoadRow row{{{static_cast<int>(t), now.row(c).transpose()}},
                  mean[c] - kept * mean_before[c],
                  scatter * std::sqrt(1 - kept * kept)};
      if (!first) row.terms.push_back({static_cast<int>(t) - 1, -kept * before.row(c).transpose()});
      rows.push_back(std::move(row));
    }
    before = now;
    mean_before = mean;
    first = false;
  }
  return rows;
}

}  // namespace sinew
