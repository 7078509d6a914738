#include "problems/contact/steps/body_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew {
namespace {

Wrench OfBody(const BodyLoad& body, std::size_t instant) {
  Wrench wrench;
  wrench << body.force[instant], body.moment[instant];
  return wrench;
}

// Standard deviation of one component, and how many samples in a row say the same: one and twice the sum of
// the autocorrelations up to the first that is not positive (Geyer 1992, Statist. Sci. 7:473).
std::pair<double, double> SpreadOf(const std::vector<std::vector<Wrench>>& errors, Eigen::Index component) {
  const auto products = [&](std::size_t lag) {
    double sum = 0;
    for (const std::vector<Wrench>& of_step : errors) {
      for (std::size_t i = lag; i < of_step.size(); ++i)
        sum += of_step[i][component] * of_step[i - lag][component];
    }
    return sum;
  };
  const double squares = products(0);
  if (!(squares > 0)) return {0, 1};
  double count = 0;
  for (const std::vector<Wrench>& of_step : errors) count += static_cast<double>(of_step.size());
  double repeated = 1;
  for (std::size_t lag = 1;; ++lag) {
    const double shifted = products(lag);
    if (!(shifted > 0)) break;  // at the latest where no two samples are so far apart
    repeated += 2 * shifted / squares;
  }
  return {std::sqrt(squares / count), repeated};
}

}  // namespace

BodyLoadErrors::BodyLoadErrors(const std::vector<const Stance*>& fitted,
                               const std::vector<std::vector<ContactLoad>>& loads) {
  constexpr double kOtherBody = 0.25;
  constexpr double kNoLess = 1e-3;  // of the mean vertical force: the error of a row is not known better
  double body_force = 0;
  double foot_force = 0;
  double squares = 0;
  double count = 0;
  for (std::size_t s = 0; s < fitted.size(); ++s) {
    const Stance& stance = *fitted[s];
    if (!stance.body) continue;
    const BodyLoad& body = *stance.body;
    const WrenchOfLoad into_foot = IntoFoot(stance);
    auto& curves = curves_.emplace_back();
    for (std::size_t t = 0; t < stance.time.size(); ++t) {
      if (!IsLoaded(stance, t)) continue;
      const SupportPhase phase = body.phase[t];
      const Wrench error = OfBody(body, t) - WrenchAbout(body.about[t]) * loads[s][t];
      curves[static_cast<std::size_t>(phase)].share.push_back(body.ShareAt(stance.time[t], phase));
      curves[static_cast<std::size_t>(phase)].wrench.emplace_back(into_foot * error);
      if (phase != kSingle) continue;
      body_force += body.force[t].y();
      foot_force += loads[s][t][kForceY];
      squares += error[1] * error[1];
      count += 1;
    }
  }
  usable_ = count > 0 && std::abs(body_force - foot_force) < kOtherBody * foot_force;
  vertical_ = count > 0 ? std::sqrt(squares / count) : 0;

  // Errors of a new step about the mean of these ones. One step's differ from their own mean at least so
  // much.
  const auto steps = static_cast<double>(curves_.size());
  const double least = kNoLess * foot_force / std::max(count, 1.0);
  for (std::size_t phase = 0; phase < kSupportPhases; ++phase) {
    std::vector<std::vector<Wrench>> left;  // [steps][instants]
    for (const auto& curves : curves_) {
      const WrenchCurve& curve = curves[phase];
      Wrench mean = Wrench::Zero();
      for (const Wrench& error : curve.wrench) mean += error / static_cast<double>(curve.wrench.size());
      auto& of_step = left.emplace_back();
      for (std::size_t i = 0; i < curve.wrench.size(); ++i) {
        if (curves_.size() > 1)
          of_step.emplace_back(
              std::sqrt(steps / (steps - 1)) *
              (curve.wrench[i] - MeanError(static_cast<SupportPhase>(phase), curve.share[i])));
        else
          of_step.emplace_back(curve.wrench[i] - mean);
      }
    }
    for (Eigen::Index c = 0; c < 6; ++c) {
      const auto [deviation, repeated] = SpreadOf(left, c);
      deviation_[phase][c] = std::max(least, deviation * std::sqrt((1 + 1 / steps) * repeated));
      if (phase == kSingle) scatter_[c] = std::max(least, deviation * std::sqrt(1 + 1 / steps));
    }
  }
}

Wrench BodyLoadErrors::MeanError(SupportPhase phase, double share) const {
  Wrench sum = Wrench::Zero();
  double count = 0;
  for (const auto& curves : curves_) {
    const WrenchCurve& curve = curves[static_cast<std::size_t>(phase)];
    if (curve.share.empty()) continue;
    sum += curve.At(share);
    count += 1;
  }
  return count > 0 ? Wrench(sum / count) : sum;
}

Wrench BodyLoadErrors::CorrectedLoad(const Stance& stance, std::size_t instant) const {
  const BodyLoad& body = *stance.body;
  const SupportPhase phase = body.phase[instant];
  return IntoFoot(stance) * OfBody(body, instant) -
         MeanError(phase, body.ShareAt(stance.time[instant], phase));
}

std::vector<LoadRow> BodyLoadErrors::RowsFor(const Stance& stance) const {
  std::vector<LoadRow> rows;
  if (!stance.body || !usable_) return rows;
  const BodyLoad& body = *stance.body;
  const WrenchOfLoad into_foot = IntoFoot(stance);
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    if (!IsLoaded(stance, t)) continue;
    const SupportPhase phase = body.phase[t];
    const Wrench measured = CorrectedLoad(stance, t);
    const WrenchOfLoad of_load = into_foot * WrenchAbout(body.about[t]);
    for (Eigen::Index c = phase == kSingle ? 0 : 3; c < 6; ++c) {
      const double deviation = deviation_[static_cast<std::size_t>(phase)][c];
      if (!(deviation > 0)) continue;
      rows.push_back({{{static_cast<int>(t), of_load.row(c).transpose()}}, measured[c], deviation});
    }
  }
  return rows;
}

}  // namespace sinew
