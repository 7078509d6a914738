#include "problems/drive/data/blocks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "problems/drive/data/channels.h"
#include "problems/drive/data/trial.h"

namespace sinew {
namespace {

struct Spread {
  double deviation = 0;
  double largest = 0;
  std::size_t count = 0;
  bool all_sigma = true;
  std::optional<double> least_sigma;
};

bool IsTrained(const DriveData& data) {
  return std::any_of(data.layout.begin(), data.layout.end(),
                     [](const Block& block) { return block.role == BlockRole::kTrain; });
}

// Over all training blocks of a channel, or over all blocks where none is fitted: they share one weight.
Spread SpreadOf(const DriveData& data, std::size_t channel, bool trained) {
  Spread spread;
  const auto counts = [&](const Block& block) { return !trained || block.role != BlockRole::kValidate; };
  double sum = 0;
  for (std::size_t b = 0; b < data.layout.size(); ++b) {
    const Block& block = data.layout[b];
    if (data.blocks[b].channel != static_cast<int>(channel) || block.measured.empty()) continue;
    if (block.sigma) {
      spread.least_sigma = std::min(spread.least_sigma.value_or(*block.sigma), *block.sigma);
    } else {
      spread.all_sigma = false;
    }
    if (!counts(block)) continue;
    for (const double value : block.measured) {
      sum += value;
      spread.largest = std::max(spread.largest, std::abs(value));
      ++spread.count;
    }
  }
  if (spread.count == 0) return spread;
  const auto n = static_cast<double>(spread.count);
  const double mean = sum / n;
  double variance = 0;  // in two passes: positions far from zero must not lose their digits
  for (std::size_t b = 0; b < data.layout.size(); ++b) {
    if (data.blocks[b].channel != static_cast<int>(channel)) continue;
    if (!counts(data.layout[b])) continue;
    for (const double value : data.layout[b].measured) variance += (value - mean) * (value - mean) / n;
  }
  spread.deviation = std::sqrt(variance);
  return spread;
}

}  // namespace

Status AddBlocks(const Trial& trial, const std::vector<std::string>& fit, int run_index,
                 const DriveMotion& motion, double margin, DriveData& out) {
  const DriveRun& run = out.runs[static_cast<std::size_t>(run_index)];
  const std::string& name = run.trial;
  const bool rotary = out.traits.rotary;
  const std::vector<std::string> units{rotary ? "rad" : "m", rotary ? "rad/s" : "m/s", rotary ? "N*m" : "N",
                                       "A"};
  const std::vector<std::string> quantities{"position", "speed",
                                            rotary ? "torque of the drive" : "force of the drive", "current"};
  const Grid* primary = nullptr;
  if (MeasuredIn(trial, "position", &primary) == nullptr) MeasuredIn(trial, "speed", &primary);
  for (std::size_t c = 0; c < kDriveChannels.size(); ++c) {
    if (kDriveChannels[c] == "current" && !out.traits.electric) continue;
    const std::string channel = kDriveChannels[c] == "torque" && !rotary ? "force" : kDriveChannels[c];
    const bool fitted = std::find(fit.begin(), fit.end(), kDriveChannels[c]) != fit.end();
    const Grid* grid = primary;
    const Channel* measured = MeasuredIn(trial, channel, &grid);
    if (measured != nullptr && measured->unit != units[c]) {
      return Fail("trial '{}': {} has unit '{}', expected {}", name, channel, measured->unit, units[c]);
    }
    Block block;
    block.trial = name;
    block.channel = channel;
    block.quantity = quantities[c];
    block.unit = units[c];
    block.role = !fitted                      ? BlockRole::kPredicted
                 : trial.role == Role::kTrain ? BlockRole::kTrain
                                              : BlockRole::kValidate;
    DriveBlock made;
    made.run = run_index;
    made.channel = static_cast<int>(c);
    made.rows.assign(run.stops.size(), -1);
    std::size_t sample = 0;
    for (std::size_t stop = 0; stop < run.stops.size(); ++stop) {
      const double t = run.begin + run.stops[stop];
      while (sample < grid->time.size() && grid->time[sample] - run.begin < run.stops[stop]) ++sample;
      const bool sampled = sample < grid->time.size() && grid->time[sample] - run.begin == run.stops[stop];
      const bool outside = t < grid->time.front() || t > grid->time.back();
      if (!sampled && !(margin > 0 && outside)) continue;
      const int row = static_cast<int>(block.prediction_time.size());
      made.rows[stop] = row;
      block.prediction_time.push_back(sampled ? grid->time[sample] : t);
      if (measured == nullptr || !sampled || !std::isfinite(measured->values[sample])) continue;
      block.sample.push_back(row);
      block.measured.push_back(measured->values[sample]);
      made.position.push_back(At(motion.time, motion.position, run.stops[stop]));
      made.velocity.push_back(At(motion.time, motion.speed, run.stops[stop]));
      made.command.push_back(At(run.input_time, run.input, run.stops[stop]));
    }
    if (measured != nullptr) block.sigma = measured->sigma;
    if (fitted && block.measured.empty()) {
      return Fail("trial '{}': channel '{}' is to be fitted but {}", name, channel,
                  measured != nullptr ? "has no usable sample" : "is not measured");
    }
    if (block.prediction_time.empty()) continue;  // no prediction on this grid
    if (fitted && measured != nullptr && block.measured.size() < measured->values.size()) {
      out.notes.push_back(
          fmt::format("trial '{}': {} of {} samples of '{}' are not compared (gaps, or no input there)", name,
                      measured->values.size() - block.measured.size(), measured->values.size(), channel));
    }
    out.layout.push_back(std::move(block));
    out.blocks.push_back(std::move(made));
  }
  return {};
}

Status WeighBlocks(const std::vector<std::string>& fit, DriveData& out) {
  out.known_noise = true;
  const bool trained = IsTrained(out);
  std::vector<Spread> spreads;
  for (std::size_t c = 0; c < kDriveChannels.size(); ++c) {
    spreads.push_back(SpreadOf(out, c, trained));
    const bool fitted = std::find(fit.begin(), fit.end(), kDriveChannels[c]) != fit.end();
    if (!fitted) continue;
    if (!(spreads[c].deviation > 1e-12 * spreads[c].largest)) {
      if (trained) return Fail("channel '{}' does not vary: nothing to fit", kDriveChannels[c]);
      spreads[c].deviation = std::max(spreads[c].largest, 1e-12);
    }
    out.known_noise = out.known_noise && spreads[c].all_sigma;
  }
  out.scales.noise = spreads[0].least_sigma.value_or(0.01 * std::max(spreads[0].deviation, 1e-9));
  for (std::size_t b = 0; b < out.layout.size(); ++b) {
    Block& block = out.layout[b];
    if (block.role == BlockRole::kPredicted) continue;
    const Spread& spread = spreads[static_cast<std::size_t>(out.blocks[b].channel)];
    block.weight = out.known_noise ? 1 / *block.sigma
                                   : 1 / (spread.deviation * std::sqrt(static_cast<double>(spread.count)));
  }
  return {};
}

}  // namespace sinew
