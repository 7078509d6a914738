#include "models/emg/averaged_emg.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/constants.h"
#include "base/numbers.h"

namespace sinew {
namespace {

using Cycles = std::vector<std::vector<double>>;

std::string Degrees(double speed) {
  return Readable(speed * 180 / kPi);
}

Status CheckSpeeds(const std::vector<std::string>& muscles, const std::vector<SpeedCycles>& speeds) {
  if (muscles.empty()) return Fail("no muscles, expected at least one");
  if (speeds.empty()) return Fail("no speeds, expected at least one");
  std::size_t samples = 0;
  for (const SpeedCycles& at : speeds) {
    if (!std::isfinite(at.speed)) return Fail("speed {}: expected a finite number", at.speed);
    if (at.muscles.size() != muscles.size()) {
      return Fail("{} muscles at {} deg/s, expected {}", at.muscles.size(), Degrees(at.speed),
                  muscles.size());
    }
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      for (const auto& cycle : at.muscles[m]) {
        if (samples == 0) samples = cycle.size();
        if (cycle.size() != samples || samples < 2) {
          return Fail("{} at {} deg/s: a cycle of {} samples, expected {}", muscles[m], Degrees(at.speed),
                      cycle.size(), std::max<std::size_t>(samples, 2));
        }
        const auto bad =
            std::find_if_not(cycle.begin(), cycle.end(), [](double v) { return std::isfinite(v); });
        if (bad != cycle.end()) {
          return Fail("{} at {} deg/s: sample {} of a cycle is {}, expected a finite number", muscles[m],
                      Degrees(at.speed), bad - cycle.begin(), *bad);
        }
      }
    }
  }
  return {};
}

void AverageOverSpeeds(MuscleAverage& average) {
  const auto count = static_cast<double>(average.at_speeds.size());
  average.shape.assign(average.at_speeds.front().mean.size(), 0);
  for (const MeanCurve& curve : average.at_speeds)
    for (std::size_t k = 0; k < curve.mean.size(); ++k) average.shape[k] += curve.mean[k] / count;
  average.peak = *std::max_element(average.shape.begin(), average.shape.end());
  for (const MeanCurve& curve : average.at_speeds)
    average.factors.push_back(*std::max_element(curve.mean.begin(), curve.mean.end()) / average.peak);
}

// Scatter about the model; speeds at which the model predicts zero are left out.
void SpreadOverCycles(const std::vector<const Cycles*>& at_speeds, const ShapeFactor& factor,
                      MuscleAverage& average) {
  std::vector<double> sum(average.shape.size(), 0);
  std::size_t count = 0;
  for (std::size_t s = 0; s < at_speeds.size(); ++s) {
    const double f = factor.At(average.speeds[s]);
    if (!(f > 0)) continue;
    for (const auto& cycle : *at_speeds[s]) {
      ++count;
      for (std::size_t k = 0; k < cycle.size(); ++k) {
        const double off = cycle[k] / f - average.shape[k];
        sum[k] += off * off;
      }
    }
  }
  if (count < 2) return;
  for (double& value : sum) value = std::sqrt(value / static_cast<double>(count - 1));
  average.spread = std::move(sum);
}

}  // namespace

Result<AveragedEmg> AveragedEmg::Build(const std::vector<std::string>& muscles,
                                       const std::vector<SpeedCycles>& speeds,
                                       const AveragedEmgSettings& settings) {
  if (settings.fewest_cycles < 1) return Fail("fewest cycles 0: expected 1 or more");
  SINEW_TRY(CheckSpeeds(muscles, speeds));
  std::vector<std::size_t> order(speeds.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return speeds[a].speed < speeds[b].speed; });
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (speeds[order[i]].speed == speeds[order[i - 1]].speed)
      return Fail("{} deg/s comes twice, expected its cycles together", Degrees(speeds[order[i]].speed));
  }

  AveragedEmg model;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    MuscleAverage average;
    average.name = muscles[m];
    std::vector<ShapeFactor> factor;
    std::vector<const Cycles*> used;
    for (const std::size_t i : order) {
      const Cycles& cycles = speeds[i].muscles[m];
      if (cycles.size() < settings.fewest_cycles) {
        model.notes_.push_back(fmt::format("{}: {} deg/s is left out, it has {} cycle{} and {} are wanted.",
                                           muscles[m], Degrees(speeds[i].speed), cycles.size(),
                                           cycles.size() == 1 ? "" : "s", settings.fewest_cycles));
        continue;
      }
      MeanCurve mean = MeanOfCycles(cycles);
      if (!(*std::max_element(mean.mean.begin(), mean.mean.end()) > 0)) {
        model.notes_.push_back(fmt::format("{}: {} deg/s is left out, there is no signal in its {} cycles.",
                                           muscles[m], Degrees(speeds[i].speed), cycles.size()));
        continue;
      }
      average.speeds.push_back(speeds[i].speed);
      average.at_speeds.push_back(std::move(mean));
      average.cycles += cycles.size();
      used.push_back(&cycles);
    }
    if (used.empty()) {
      model.notes_.push_back(fmt::format("{}: no speed has enough cycles, it is left out.", muscles[m]));
      average = {};
      average.name = muscles[m];
    } else {
      AverageOverSpeeds(average);
      SINEW_ASSIGN(ShapeFactor fit, ShapeFactor::Fit(average.speeds, average.factors, settings.law));
      SpreadOverCycles(used, fit, average);
      factor.push_back(std::move(fit));
    }
    model.muscles_.push_back(std::move(average));
    model.factors_.push_back(std::move(factor));
  }
  const auto with_shape = [](const std::vector<ShapeFactor>& factor) { return !factor.empty(); };
  if (std::none_of(model.factors_.begin(), model.factors_.end(), with_shape))
    return Fail("no muscle has a shape: {}", model.notes_.back());
  return model;
}

double AveragedEmg::At(std::size_t muscle, double speed, double phase) const {
  return has(muscle) ? factor(muscle).At(speed) * AtPhase(muscles_[muscle].shape, phase) : kNaN;
}

double AveragedEmg::SpreadAt(std::size_t muscle, double speed, double phase) const {
  if (!has(muscle) || muscles_[muscle].spread.empty()) return kNaN;
  return factor(muscle).At(speed) * AtPhase(muscles_[muscle].spread, phase);
}

std::vector<double> AveragedEmg::PredictCycle(std::size_t muscle, double speed, double duration_s,
                                              double rate_Hz) const {
  const std::vector<double> none{kNaN, kNaN};
  std::vector<double> values = UnwarpCycle(has(muscle) ? muscles_[muscle].shape : none, duration_s, rate_Hz);
  if (!has(muscle)) return values;
  const double scale = factor(muscle).At(speed);
  for (double& value : values) value *= scale;
  return values;
}

std::vector<double> AveragedEmg::PredictRecording(std::size_t muscle, const std::vector<double>& time,
                                                  const std::vector<MovementCycle>& cycles) const {
  std::vector<double> values(time.size(), kNaN);
  if (!has(muscle)) return values;
  std::size_t c = 0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    while (c < cycles.size() && cycles[c].end_s < time[k]) ++c;
    if (c == cycles.size()) break;
    if (time[k] < cycles[c].begin_s) continue;
    const double phase = (time[k] - cycles[c].begin_s) / cycles[c].duration_s();
    values[k] = At(muscle, cycles[c].speed, phase);
  }
  return values;
}

std::string AveragedEmg::RangeWarning(std::size_t muscle, double speed) const {
  if (!has(muscle) || factor(muscle).Covers(speed)) return "";
  const ShapeFactor& law = factor(muscle);
  const std::string measured = law.slowest() == law.fastest()
                                   ? fmt::format("the only measured speed, {} deg/s", Degrees(law.slowest()))
                                   : fmt::format("the measured speeds, {} to {} deg/s",
                                                 Degrees(law.slowest()), Degrees(law.fastest()));
  return fmt::format("{}: {} deg/s lies outside of {}: shape and factor {} are not supported by data.",
                     muscles_[muscle].name, Degrees(speed), measured, Readable(law.At(speed)));
}

}  // namespace sinew
