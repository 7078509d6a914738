#include "problems/drive/data/data.h"

#include <algorithm>
#include <cmath>

#include "problems/drive/data/blocks.h"
#include "problems/drive/data/channels.h"
#include "problems/drive/data/traits.h"
#include "problems/drive/data/trial.h"

namespace sinew {
namespace {

constexpr double kStepOfInterval = 0.05;  // longest step, where that is more than 10 ms

void MeasureScales(const std::vector<DriveMotion>& motions, DriveData& data) {
  DriveScales& s = data.scales;
  double low = INFINITY;
  double high = -INFINITY;
  double speed = 0;
  double low_command = INFINITY;
  double high_command = -INFINITY;
  s.duration = 0;
  s.samples = 0;
  s.shortest = INFINITY;
  double drive = 0;
  for (const DriveMotion& motion : motions) {
    for (const double q : motion.position) {
      low = std::min(low, q);
      high = std::max(high, q);
    }
    s.samples += static_cast<double>(motion.position.size());
    for (const double v : motion.speed) speed = std::max(speed, std::abs(v));
    for (const double u : motion.run->input) {
      low_command = std::min(low_command, u);
      high_command = std::max(high_command, u);
    }
    for (const double u : ReplayCommand(data.command, motion)) drive = std::max(drive, std::abs(u));
    s.duration = std::max(s.duration, motion.run->stops.back());
    s.shortest = std::min(s.shortest, motion.run->stops.back());
  }
  s.position = high > low ? high - low : 1;
  s.lowest = low;
  s.highest = high > low ? high : low + 1;
  s.speed = speed > 0 ? speed : 1;
  s.command = std::max({std::abs(low_command), std::abs(high_command), 1e-12});
  s.lowest_command = low_command;
  s.highest_command = high_command > low_command ? high_command : low_command + 1;
  data.joint.largest_command = s.command;
  if (data.command.controller == DriveControllerKind::kServo) data.joint.largest_command = 1;
  if (data.command.sampled()) {
    double limit = 0;
    for (const DriveMotion& motion : motions) limit = std::max(limit, motion.run->gains.output_limit);
    data.traits.compressible = limit > 0;
    data.joint.largest_command = limit > 0 ? limit : 1;
  }
  s.motor_command = data.traits.compressible ? data.joint.largest_command : std::max(drive, 1e-12);
  s.torque = drive;
  if (data.traits.electric)
    s.torque *= data.joint.gear_ratio * data.starts[kTorqueConstant] / data.starts[kResistance];
  // A joint that swings freely has no drive torque: gravity and inertia are the measure then.
  s.torque = std::max({s.torque, 1e-3 * data.starts[kInertia] * s.speed / 0.1, 1e-12});
  data.joint.largest_torque = s.torque;
  data.joint.largest_speed = s.speed;
  data.joint.largest_position = std::max(std::abs(low), std::abs(high));
  data.command.most_position = 1e5 * (std::max(std::abs(low), std::abs(high)) + s.position);
  data.command.most_speed = 1e5 * s.speed;
}

// When in the session each trial was recorded, counted from the first; times of a trial count from its own.
Status FindSession(const Dataset& data, DriveData& out) {
  double first = INFINITY;
  double last = -INFINITY;
  std::string without;
  std::string with;
  for (DriveRun& run : out.runs) {
    const auto& conditions = data.trials.at(run.trial).conditions;
    const auto found = conditions.find(kSessionTime);
    (found == conditions.end() ? without : with) = run.trial;
    if (found == conditions.end()) continue;
    if (!std::isfinite(found->second))
      return Fail("trial '{}': condition {} is not a finite number", run.trial, kSessionTime);
    run.session = found->second + run.begin;
    first = std::min(first, run.session);
    last = std::max(last, run.session);
  }
  out.traits.session = without.empty() && last > first;
  if (!without.empty() && !with.empty()) {
    return Fail("trial '{}' has the condition {}, trial '{}' has not: expected it in all trials or in none",
                with, kSessionTime, without);
  }
  for (DriveRun& run : out.runs) {
    run.session = out.traits.session ? run.session - first : 0;
    out.scales.session = std::max(out.scales.session, run.session + run.stops.back());
  }
  return {};
}

void NoteSmoothedInputs(DriveData& data) {
  double lowest = INFINITY;
  double highest = 0;
  double noise = 0;
  std::size_t smoothed = 0;
  for (const DriveRun& run : data.runs) {
    if (run.input_cutoff == 0) continue;
    ++smoothed;
    const double rate =
        static_cast<double>(run.input_time.size() - 1) / (run.input_time.back() - run.input_time.front());
    lowest = std::min(lowest, run.input_cutoff * rate);
    highest = std::max(highest, run.input_cutoff * rate);
    noise = std::max(noise, run.input_noise);
  }
  if (smoothed == 0) return;
  data.notes.push_back(
      fmt::format("'{}' has noise of up to {:.2g} {}; in {} of {} trials it was smoothed above "
                  "{:.3g}{} Hz, where "
                  "the record holds nothing else",
                  data.traits.input_channel, noise, data.traits.input_unit, smoothed, data.runs.size(),
                  lowest, highest > lowest ? fmt::format(" to {:.3g}", highest) : ""));
}

}  // namespace

Result<DriveData> PrepareDriveData(const Dataset& data, const DriveSettings& settings, double margin) {
  DriveData out;
  SINEW_TRY(FindTraits(data, settings, out));
  std::vector<std::string> fit = settings.fit;
  const std::string torque = out.traits.rotary ? "torque" : "force";
  if (std::find(fit.begin(), fit.end(), "torque") != fit.end() && out.traits.input_channel == torque) {
    return Fail("fit: '{}' is the input of these trials, it cannot be fitted", torque);
  }
  if (std::find(fit.begin(), fit.end(), "current") != fit.end() && !out.traits.electric) {
    return Fail("fit: the drive is not electric (input '{}'): it has no current", out.traits.input_channel);
  }
  if (fit.empty()) {
    const Grid* grid = nullptr;
    const bool has_position = std::any_of(data.trials.begin(), data.trials.end(), [&](const auto& trial) {
      return MeasuredIn(trial.second, "position", &grid) != nullptr;
    });
    fit = {has_position ? "position" : "speed"};
  }

  std::vector<const Trial*> trials;
  for (const auto& [name, trial] : data.trials) {
    SINEW_ASSIGN(DriveRun run, ReadDriveRun(data, settings, out.traits, name, trial));
    out.runs.push_back(std::move(run));
    trials.push_back(&trial);
  }
  NoteSmoothedInputs(out);
  SINEW_TRY(FindSession(data, out));
  std::vector<DriveMotion> motions;
  for (std::size_t r = 0; r < out.runs.size(); ++r) {
    SINEW_ASSIGN(DriveMotion motion, MotionOf(*trials[r], out.runs[r]));
    motions.push_back(std::move(motion));
  }
  std::vector<DriveMotion> training;
  for (std::size_t r = 0; r < motions.size(); ++r) {
    if (trials[r]->role == Role::kTrain) training.push_back(motions[r]);
  }
  // Data that are only predicted have ranges of parameters all the same.
  out.starts =
      EstimateDriveStarts(out.joint, out.command, training.empty() ? motions : training, out.traits.fixed);
  MeasureScales(motions, out);
  for (std::size_t r = 0; r < out.runs.size(); ++r) {
    SINEW_TRY(AddBlocks(*trials[r], fit, static_cast<int>(r), motions[r], margin, out));
  }

  // Of slow recordings; as long as that of fast ones, it would be most of the work.
  if (!settings.step) out.command.step = std::max(out.command.step, kStepOfInterval * UsualInterval(motions));
  out.conventions = JudgeConventions(out.joint, out.command, motions);
  for (std::string& note : ConventionNotes(out.conventions, out.traits.input_channel))
    out.notes.push_back(std::move(note));
  for (DriveMotion& motion : motions) motion.run = nullptr;
  out.motions = std::move(motions);
  SINEW_TRY(WeighBlocks(fit, out));
  return out;
}

}  // namespace sinew
