#include "problems/emg_shape/learning/recorded_trial.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "models/emg/cycle_checks.h"
#include "models/emg/envelope.h"
#include "models/emg/raw_emg.h"
#include "models/emg/sampling.h"

namespace sinew {
namespace {

constexpr std::size_t kMinCycles = 2;  // the scatter of cycles needs two

double At(const std::vector<double>& time, const std::vector<double>& values, double t) {
  if (t <= time.front()) return values.front();
  if (t >= time.back()) return values.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  const double share = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

class Reader {
 public:
  Reader(const EmgShapeSettings& settings, std::vector<std::string>& notes)
      : settings_(settings), notes_(notes) {}

  Result<std::optional<RecordedTrial>> Read(const std::string& name, const Trial& trial) {
    RecordedTrial made;
    EmgShapeTrial& of = made.trial;
    of.name = name;
    const auto& held = settings_.hold_out;
    const bool fitted = trial.role == Role::kTrain && std::find(held.begin(), held.end(), name) == held.end();
    of.role = fitted ? BlockRole::kTrain : BlockRole::kValidate;
    const Trial::Found angle = trial.Find(settings_.angle);
    if (!angle) {
      return Fail("has no channel '{}', the angle of the settings{}", settings_.angle,
                  Suggestion(settings_.angle, trial.ChannelNames()));
    }
    if (angle.channel->unit != "rad")
      return Fail("channel '{}' has the unit {}, expected rad", settings_.angle, angle.channel->unit);
    const auto found = FindCycles(angle.grid->time, angle.channel->values, settings_.cycles);
    if (!found) return Fail("channel '{}': {}", settings_.angle, found.error().message);
    const auto grid = trial.grids.find("excitations");
    const Grid* excitations = grid == trial.grids.end() ? nullptr : &grid->second;
    if (excitations != nullptr && excitations->time.size() < 2) excitations = nullptr;
    if (excitations == nullptr && of.role == BlockRole::kTrain)
      return Fail("has no grid 'excitations': expected the envelopes of the EMG (`sinew data envelope`)");

    const Grid& clock = excitations != nullptr ? *excitations : *angle.grid;
    for (const MovementCycle& cycle : found->cycles) {
      if (cycle.begin_s >= clock.time.front() && cycle.end_s <= clock.time.back()) of.cycles.push_back(cycle);
    }
    NoteCycles(*found, of);
    if (of.cycles.empty() || (of.role == BlockRole::kTrain && of.cycles.size() < kMinCycles)) {
      notes_.push_back(fmt::format("trial '{}' is left out: {} cycle{}, expected at least {}", name,
                                   of.cycles.size(), of.cycles.size() == 1 ? "" : "s",
                                   of.role == BlockRole::kTrain ? kMinCycles : 1));
      return std::nullopt;
    }
    MeasureSpeed(trial, of);
    SetTimes(clock, *angle.grid, angle.channel->values, of);
    if (excitations != nullptr) SINEW_TRY(AddMuscles(trial, *excitations, made));
    return made;
  }

 private:
  void NoteCycles(const CycleFindings& found, const EmgShapeTrial& of) {
    const auto sentences = DescribeCycles(found);
    const std::size_t others =
        CountLeftOut(found, CycleFault::kGap) + CountLeftOut(found, CycleFault::kDuration);
    if (others > 0 || found.cycles.empty() || found.moved > 0)
      notes_.push_back(fmt::format("trial '{}': {}", of.name, sentences.front()));
    for (const LeftOutCycle& cycle : found.left_out) {
      if (cycle.fault != CycleFault::kIncomplete)
        notes_.push_back(fmt::format("trial '{}': {}", of.name, cycle.reason));
    }
    for (const std::string& doubt : found.doubts)
      notes_.push_back(fmt::format("trial '{}': {}", of.name, doubt));
    if (of.cycles.size() < found.cycles.size()) {
      notes_.push_back(fmt::format("trial '{}': {} cycles are left out, no EMG was recorded there", of.name,
                                   found.cycles.size() - of.cycles.size()));
    }
  }

  static void MeasureSpeed(const Trial& trial, EmgShapeTrial& of) {
    std::vector<double> durations;
    double speed = 0;
    for (const MovementCycle& cycle : of.cycles) {
      durations.push_back(cycle.duration_s());
      speed += cycle.speed / static_cast<double>(of.cycles.size());
    }
    const auto middle = durations.begin() + static_cast<std::ptrdiff_t>(durations.size() / 2);
    std::nth_element(durations.begin(), middle, durations.end());
    of.period = *middle;
    const auto stated = trial.conditions.find("speed_rad_per_s");
    of.speed = stated != trial.conditions.end() && stated->second > 0 ? stated->second : speed;
  }

  void SetTimes(const Grid& clock, const Grid& angle_grid, const std::vector<double>& angle,
                EmgShapeTrial& of) const {
    // Held-out trials are predicted at all times, for use of their EMG; fitted ones where they are
    // compared.
    const std::size_t step = of.role == BlockRole::kTrain ? Stride(clock) : 1;
    std::vector<double> known_time;
    std::vector<double> known;
    for (std::size_t i = 0; i < angle.size(); ++i) {
      if (!std::isfinite(angle[i])) continue;
      known_time.push_back(angle_grid.time[i]);
      known.push_back(angle[i]);
    }
    int cycle = 0;
    const int last = static_cast<int>(of.cycles.size()) - 1;
    for (std::size_t i = 0; i < clock.time.size(); i += step) {
      const double t = clock.time[i];
      while (cycle < last && t >= of.cycles[static_cast<std::size_t>(cycle) + 1].begin_s) ++cycle;
      const MovementCycle& in = of.cycles[static_cast<std::size_t>(cycle)];
      double duration = in.duration_s();
      // Between two cycles that were found lie others that were not.
      if (t >= in.end_s && cycle < last) {
        const double gap = of.cycles[static_cast<std::size_t>(cycle) + 1].begin_s - in.end_s;
        duration = gap / std::max(1.0, std::round(gap / of.period));
      }
      const double phase = t < in.end_s ? (t - in.begin_s) / duration : 1 + (t - in.end_s) / duration;
      of.time.push_back(t);
      of.cycle.push_back(cycle);
      of.phase.push_back(phase);
      of.angle.push_back(At(known_time, known, t));
    }
  }

  [[nodiscard]] std::size_t Stride(const Grid& clock) const {
    const double rate = static_cast<double>(clock.time.size() - 1) / (clock.time.back() - clock.time.front());
    return static_cast<std::size_t>(std::max(1.0, std::round(rate / settings_.rate)));
  }

  Status AddMuscles(const Trial& trial, const Grid& excitations, RecordedTrial& made) {
    const EmgShapeTrial& of = made.trial;
    for (const auto& [muscle, channel] : excitations.channels) {
      if (!settings_.muscles.empty() &&
          std::find(settings_.muscles.begin(), settings_.muscles.end(), muscle) == settings_.muscles.end())
        continue;
      if (channel.unit != "1")
        return Fail("channel '{}' of grid 'excitations' has the unit {}, expected 1", muscle, channel.unit);
      SINEW_ASSIGN(MuscleCheck check, CheckMuscle(excitations.time, channel.values, of.cycles, {}));
      AddRaw(trial, muscle, of.cycles, check);
      for (const std::string& sentence : DescribeMuscleCheck(muscle, of.cycles, check))
        notes_.push_back(fmt::format("trial '{}': {}", of.name, sentence));
      if (check.silent) continue;
      if (of.role == BlockRole::kTrain && CountUsable(check) < kMinCycles) {
        notes_.push_back(fmt::format("trial '{}': {} is left out: {} cycles, expected at least {}", of.name,
                                     muscle, CountUsable(check), kMinCycles));
        continue;
      }
      Compare(muscle, excitations, channel.values, check, made);
    }
    return {};
  }

  static void AddRaw(const Trial& trial, const std::string& muscle, const std::vector<MovementCycle>& cycles,
                     MuscleCheck& check) {
    const auto grid = trial.grids.find("emg");
    if (grid == trial.grids.end()) return;
    const auto raw = grid->second.channels.find(muscle);
    if (raw == grid->second.channels.end()) return;
    const auto rate = UniformRate(grid->second.time);
    if (!rate) return;
    AddRawFaults(FindRawEmgFaults(raw->second.values, *rate), grid->second.time.front(), *rate,
                 UnsettledSeconds({}), cycles, {}, check);
  }

  void Compare(const std::string& muscle, const Grid& excitations, const std::vector<double>& values,
               const MuscleCheck& check, RecordedTrial& made) const {
    const EmgShapeTrial& of = made.trial;
    const std::size_t step = Stride(excitations);
    const std::size_t per_prediction = of.role == BlockRole::kTrain ? step : 1;
    std::vector<double>& recorded = made.recorded[muscle];
    std::vector<double>& compared = made.measured[muscle];
    for (std::size_t i = 0; i < of.time.size(); ++i) {
      const std::size_t source = i * per_prediction;
      const bool counts = source % step == 0 && check.usable[static_cast<std::size_t>(of.cycle[i])] &&
                          of.phase[i] >= 0 && of.phase[i] < 1;
      const double held = recorded.empty() ? 0 : recorded.back();
      recorded.push_back(std::isfinite(values[source]) ? values[source] : held);
      compared.push_back(counts ? values[source] : std::nan(""));
    }
  }

  const EmgShapeSettings& settings_;
  std::vector<std::string>& notes_;
};

}  // namespace

Result<std::optional<RecordedTrial>> ReadRecordedTrial(const std::string& name, const Trial& trial,
                                                       const EmgShapeSettings& settings,
                                                       std::vector<std::string>& notes) {
  return Reader(settings, notes).Read(name, trial);
}

}  // namespace sinew
