#include "problems/contact/soles/plate_record.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "datasets/stances/stances.h"
#include "problems/contact/load/plate_samples.h"
#include "problems/contact/motion/trial_motion.h"

namespace sinew {
namespace {

// A channel as it is read at each frame (AddLocalFits); NaN where there is none.
std::vector<double> FrameValues(const Trial& trial, const std::string& plate, const std::string& kind,
                                const std::vector<double>& time) {
  std::vector<double> values(time.size(), std::numeric_limits<double>::quiet_NaN());
  const auto found = trial.Find(plate + "_" + kind);
  if (!found) return values;
  Block block;
  block.prediction_time = time;
  AddLocalFits(*found.grid, *found.channel, plate, kind.rfind("cop", 0) == 0, kLoadedShare,
               found.channel->sigma.value_or(std::numeric_limits<double>::infinity()), block);
  for (std::size_t i = 0; i < block.sample.size(); ++i)
    values[static_cast<std::size_t>(block.sample[i])] = block.measured[i];
  return values;
}

// A contact within which the record begins or ends shows a part of a stance: its frames count as unloaded.
void LeaveOutPartialContacts(PlateRecord& record) {
  constexpr double kCut = 0.3;     // of the largest load, at the end of the record
  constexpr double kEnded = 0.05;  // of the largest load
  const double peak = record.peak;
  const auto leave_out = [&](const auto& frame_of) {
    for (std::size_t i = 0; i < record.time.size(); ++i) {
      const std::size_t t = frame_of(i);
      const double load = record.force[t].y();
      if (!(load > (i == 0 ? kCut : kEnded) * peak)) return;
      record.partial = true;
      record.force[t].y() = 0;
      record.cop[t] = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    }
  };
  leave_out([](std::size_t i) { return i; });
  leave_out([&](std::size_t i) { return record.time.size() - 1 - i; });
  if (!record.partial) return;
  record.peak = 0;
  record.has_cop = false;
  for (std::size_t t = 0; t < record.time.size(); ++t) {
    if (record.force[t].y() > record.peak) record.peak = record.force[t].y();
    record.has_cop |= record.cop[t].allFinite();
  }
}

Result<PlateRecord> ReadRecord(const std::string& name, const Trial& trial, const std::string& plate,
                               const TrialMotion& motion, const MultibodyModel& model, double floor_height) {
  PlateRecord record;
  record.trial = name;
  record.plate = plate;
  record.role = trial.role;
  const Grid& forces = *trial.Find(plate + "_force_y").grid;
  for (const double t : motion.time) {
    if (t >= forces.time.front() && t <= forces.time.back()) record.time.push_back(t);
  }
  constexpr std::size_t kFewest = 8;
  if (record.time.size() < kFewest)
    return Fail("{} frames of the motion while {} was recorded, expected at least {}", record.time.size(),
                plate, kFewest);
  std::vector<int> all(model.body_names().size());
  std::iota(all.begin(), all.end(), 0);
  SINEW_ASSIGN(record.motion, model.BodyMotions(record.time, motion.trajectory, all));
  const auto x = FrameValues(trial, plate, "force_x", record.time);
  const auto y = FrameValues(trial, plate, "force_y", record.time);
  const auto z = FrameValues(trial, plate, "force_z", record.time);
  const auto cop_x = FrameValues(trial, plate, "cop_x", record.time);
  const auto cop_z = FrameValues(trial, plate, "cop_z", record.time);
  for (std::size_t t = 0; t < record.time.size(); ++t) {
    record.force.emplace_back(x[t], y[t], z[t]);
    record.cop.emplace_back(cop_x[t], floor_height, cop_z[t]);
    if (!std::isfinite(y[t])) continue;
    record.peak = std::max(record.peak, y[t]);
    record.lowest = std::min(record.lowest, y[t]);
    record.has_cop |= record.cop.back().allFinite();
  }
  LeaveOutPartialContacts(record);
  return record;
}

}  // namespace

Result<std::vector<PlateRecord>> ReadPlateRecords(const Dataset& data, const MultibodyModel& model,
                                                  double floor_height, std::vector<std::string>& skipped) {
  std::vector<PlateRecord> records;
  for (const auto& [name, trial] : data.trials) {
    const std::vector<std::string> plates = PlateNames(trial);
    if (plates.empty()) continue;
    const auto motion = FitTrialMotion(trial, model);
    if (!motion) {
      skipped.push_back(fmt::format("trial '{}': {}", name, motion.error().message));
      continue;
    }
    for (const std::string& plate : plates) {
      auto record = ReadRecord(name, trial, plate, *motion, model, floor_height);
      if (record) {
        records.push_back(std::move(*record));
      } else {
        skipped.push_back(fmt::format("trial '{}': {}", name, record.error().message));
      }
    }
  }
  if (!records.empty()) return records;
  if (!skipped.empty()) return Fail("{}", skipped.front());
  return Fail("no trial has a plate (a channel NAME_force_y)");
}

}  // namespace sinew
