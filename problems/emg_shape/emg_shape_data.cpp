#include "problems/emg_shape/emg_shape_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/text.h"
#include "models/emg/cycle_checks.h"
#include "models/emg/cycle_warp.h"
#include "models/emg/envelope.h"
#include "models/emg/raw_emg.h"
#include "models/emg/sampling.h"
#include "models/emg/shape_basis.h"
#include "problems/emg_shape/cycle_scatter.h"

namespace sinew {
namespace {

constexpr std::size_t kFewestCycles = 2;  // one cannot say how much cycles differ
constexpr double kLeastNoise = 1e-3;      // of normalised EMG; made-up data without noise have a weight too
constexpr int kPhases = 100;              // at which cuts between bursts are looked for
constexpr double kBetweenBursts = 0.03;   // of the shape's range, by which a cut lies below both bursts
// An envelope of 6 Hz is correlated over so many seconds.
constexpr double kCorrelated_s = 0.08;

// One recording while it is prepared.
struct Recording {
  EmgShapeTrial trial;
  std::map<std::string, std::vector<double>> recorded;  // muscle -> values at trial.time
  std::map<std::string, std::vector<double>> measured;  // the same, NaN where nothing is compared
  // Phases between a muscle's bursts, increasing [0..1), at least one. Bursts shift with speed, and so do
  // these: a cut through a flank would give it the next burst's gain.
  std::map<std::string, std::vector<double>> cuts;
  std::map<std::string, std::vector<double>>
      curves;  // mean over a cycle, where fitted; [0] and the end are one
};

double At(const std::vector<double>& time, const std::vector<double>& values, double t) {
  if (t <= time.front()) return values.front();
  if (t >= time.back()) return values.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  const double share = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

// Minima of a curve on a circle, each at least `depth` below the curve's maxima on both sides; increasing.
// The lowest is always one.
std::vector<int> Valleys(const Vector& curve, double depth) {
  const auto n = static_cast<int>(curve.size());
  Eigen::Index lowest = 0;
  curve.minCoeff(&lowest);
  std::vector<int> valleys{static_cast<int>(lowest)};
  double peak = curve[lowest];
  int candidate = -1;  // lowest point since the peak
  for (int i = 1; i < n; ++i) {
    const int at = (static_cast<int>(lowest) + i) % n;
    const double value = curve[at];
    if (candidate < 0) {
      peak = std::max(peak, value);
      if (peak - curve[valleys.back()] > depth && peak - value > depth) candidate = at;
      continue;
    }
    if (value < curve[candidate]) candidate = at;
    if (value - curve[candidate] > depth) {
      valleys.push_back(candidate);
      candidate = -1;
      peak = value;
    }
  }
  std::sort(valleys.begin(), valleys.end());
  return valleys;
}

std::vector<double> Closed(const Vector& curve) {
  std::vector<double> closed(curve.data(), curve.data() + curve.size());
  closed.push_back(curve[0]);
  return closed;
}

// Standard deviation of the noise at a phase of a muscle whose EMG runs along this curve.
double NoiseAt(const EmgMuscle& muscle, const std::vector<double>& curve, double phase) {
  if (curve.empty()) return muscle.noise;
  const double emg = AtPhase(curve, phase - std::floor(phase));
  return std::max(kLeastNoise, std::hypot(muscle.quiet_noise, muscle.noise_growth * emg));
}

// Which burst a sample is of: as many numbers per cycle as there are cuts.
int BurstOf(const std::vector<double>& cuts, int cycle, double phase) {
  const auto past = std::upper_bound(cuts.begin(), cuts.end(), phase) - cuts.begin();
  return cycle * static_cast<int>(cuts.size()) + static_cast<int>(past);
}

class Preparation {
 public:
  explicit Preparation(const EmgShapeSettings& settings) : settings_(settings) {}

  Result<EmgShapeData> Run(const Dataset& data) {
    std::vector<std::string> names;
    for (const auto& [name, trial] : data.trials) names.push_back(name);
    for (const std::string& name : settings_.hold_out) {
      if (data.trials.count(name) == 0)
        return Fail("hold_out: there is no trial '{}'{}", name, Suggestion(name, names));
    }
    for (const auto& [name, trial] : data.trials) {
      const Status added = Add(name, trial);
      if (!added) return Fail("trial '{}': {}", name, added.error().message);
    }
    SINEW_TRY(ChooseMuscles());
    SINEW_TRY(GroupSpeeds());
    SINEW_TRY(ChooseReference());
    SINEW_TRY(LearnMuscles());
    for (Recording& recording : recordings_) Finish(recording);
    return std::move(out_);
  }

 private:
  Status Add(const std::string& name, const Trial& trial) {
    Recording made;
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
    if (of.cycles.empty() || (of.role == BlockRole::kTrain && of.cycles.size() < kFewestCycles)) {
      out_.notes.push_back(fmt::format("trial '{}' is left out: {} cycle{}, expected at least {}", name,
                                       of.cycles.size(), of.cycles.size() == 1 ? "" : "s",
                                       of.role == BlockRole::kTrain ? kFewestCycles : 1));
      return {};
    }
    MeasureSpeed(trial, of);
    SetTimes(clock, *angle.grid, angle.channel->values, of);
    if (excitations != nullptr) SINEW_TRY(AddMuscles(trial, *excitations, made));
    recordings_.push_back(std::move(made));
    return {};
  }

  void NoteCycles(const CycleFindings& found, const EmgShapeTrial& of) {
    const auto sentences = DescribeCycles(found);
    const std::size_t others =
        CountLeftOut(found, CycleFault::kGap) + CountLeftOut(found, CycleFault::kDuration);
    if (others > 0 || found.cycles.empty() || found.moved > 0)
      out_.notes.push_back(fmt::format("trial '{}': {}", of.name, sentences.front()));
    for (const LeftOutCycle& cycle : found.left_out) {
      if (cycle.fault != CycleFault::kIncomplete)
        out_.notes.push_back(fmt::format("trial '{}': {}", of.name, cycle.reason));
    }
    for (const std::string& doubt : found.doubts)
      out_.notes.push_back(fmt::format("trial '{}': {}", of.name, doubt));
    if (of.cycles.size() < found.cycles.size()) {
      out_.notes.push_back(fmt::format("trial '{}': {} cycles are left out, no EMG was recorded there",
                                       of.name, found.cycles.size() - of.cycles.size()));
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
    // Held-out trials are predicted on the whole clock, for whoever wants the EMG; fitted ones where they are
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

  Status AddMuscles(const Trial& trial, const Grid& excitations, Recording& made) {
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
        out_.notes.push_back(fmt::format("trial '{}': {}", of.name, sentence));
      if (check.silent) continue;
      if (of.role == BlockRole::kTrain && CountUsable(check) < kFewestCycles) {
        out_.notes.push_back(fmt::format("trial '{}': {} is left out: {} cycles, expected at least {}",
                                         of.name, muscle, CountUsable(check), kFewestCycles));
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
               const MuscleCheck& check, Recording& made) const {
    const EmgShapeTrial& of = made.trial;
    const std::size_t step = Stride(excitations);
    const std::size_t per_prediction = of.role == BlockRole::kTrain ? step : 1;
    std::vector<double>& recorded = made.recorded[muscle];
    std::vector<double>& compared = made.measured[muscle];
    for (std::size_t i = 0; i < of.time.size(); ++i) {
      const std::size_t source = i * per_prediction;
      const bool counts = source % step == 0 && check.usable[static_cast<std::size_t>(of.cycle[i])] &&
                          of.phase[i] >= 0 && of.phase[i] < 1;
      recorded.push_back(std::isfinite(values[source]) ? values[source] : 0);
      compared.push_back(counts ? values[source] : std::nan(""));
    }
  }

  Status ChooseMuscles() {
    std::set<std::string> learnt;
    std::set<std::string> seen(settings_.muscles.begin(), settings_.muscles.end());
    bool any_training = false;
    for (const Recording& recording : recordings_) {
      any_training = any_training || recording.trial.role == BlockRole::kTrain;
      for (const auto& [muscle, values] : recording.measured) {
        seen.insert(muscle);
        if (recording.trial.role == BlockRole::kTrain) learnt.insert(muscle);
      }
    }
    if (!any_training) {
      if (!settings_.reference)
        return Fail(
            "no training trial to learn from; to predict with a fitted model state `reference` "
            "(speed, period) in the settings");
      if (settings_.muscles.empty())
        return Fail("no training trial: state the `muscles` of the fitted model in the settings");
      learnt = seen;
    }
    // In the order of the settings, or of the alphabet.
    const std::vector<std::string> order =
        settings_.muscles.empty() ? std::vector<std::string>(seen.begin(), seen.end()) : settings_.muscles;
    for (const std::string& muscle : order) {
      if (learnt.count(muscle) > 0) {
        out_.muscles.emplace_back();
        out_.muscles.back().name = muscle;
      } else {
        out_.notes.push_back(muscle + " is left out: no training trial has a usable signal of it");
      }
    }
    if (out_.muscles.empty()) return Fail("no training trial has a usable signal of any muscle");
    return {};
  }

  Status GroupSpeeds() {
    std::vector<EmgShapeTrial*> order;
    for (Recording& recording : recordings_) order.push_back(&recording.trial);
    std::stable_sort(order.begin(), order.end(),
                     [](const EmgShapeTrial* a, const EmgShapeTrial* b) { return a->speed < b->speed; });
    std::set<std::string> labels;
    for (EmgShapeTrial* trial : order) {
      if (!(trial->speed > 0)) return Fail("trial '{}': the movement has no speed", trial->name);
      if (out_.speeds.empty() || trial->speed > out_.speeds.back().speed * (1 + settings_.same_speed)) {
        std::string label = fmt::format("{:.3g}", trial->speed);
        if (!labels.insert(label).second) label = fmt::format("{:.9g}", trial->speed);
        out_.speeds.push_back({trial->speed, label, false});
      }
      trial->group = static_cast<int>(out_.speeds.size()) - 1;
      if (trial->role == BlockRole::kTrain) out_.speeds.back().trained = true;
    }
    return {};
  }

  Status ChooseReference() {
    if (settings_.reference) {
      out_.reference = *settings_.reference;
      return {};
    }
    std::vector<int> trained;
    for (std::size_t s = 0; s < out_.speeds.size(); ++s) {
      if (out_.speeds[s].trained) trained.push_back(static_cast<int>(s));
    }
    const int middle = trained[trained.size() / 2];
    for (const Recording& recording : recordings_) {
      const EmgShapeTrial& trial = recording.trial;
      if (trial.group != middle || trial.role != BlockRole::kTrain) continue;
      out_.reference = {trial.speed, trial.period};
      return {};
    }
    return Fail("no training trial");
  }

  [[nodiscard]] static CycleSamples SamplesOf(const Recording& recording, const std::vector<double>& values,
                                              const std::vector<double>& cuts) {
    CycleSamples samples;
    samples.bursts = std::max(1, static_cast<int>(cuts.size()));
    const EmgShapeTrial& trial = recording.trial;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      samples.phase.push_back(trial.phase[i]);
      samples.values.push_back(values[i]);
      samples.cycle.push_back(trial.cycle[i]);
      samples.burst.push_back(BurstOf(cuts, trial.cycle[i], trial.phase[i]));
    }
    return samples;
  }

  Status LearnMuscles() {
    for (EmgMuscle& muscle : out_.muscles) {
      const Status learnt = Learn(muscle);
      if (!learnt) return Fail("{}: {}", muscle.name, learnt.error().message);
    }
    out_.shared_timing = SharedTiming(timings_);
    return {};
  }

  // Where the shape begins to be fitted: the recordings at the reference speed, or all of them.
  Status Learn(EmgMuscle& muscle) {
    muscle.shape = Vector::Zero(settings_.knots);
    const ShapeBasis plain(settings_.knots);
    Vector mean = Vector::Zero(kPhases);
    CycleSamples at_reference;
    CycleSamples all;
    std::vector<const Recording*> with;
    const auto append = [](const CycleSamples& from, CycleSamples& to) {
      to.phase.insert(to.phase.end(), from.phase.begin(), from.phase.end());
      to.values.insert(to.values.end(), from.values.begin(), from.values.end());
    };
    for (Recording& recording : recordings_) {
      const auto found = recording.measured.find(muscle.name);
      if (recording.trial.role != BlockRole::kTrain || found == recording.measured.end()) continue;
      with.push_back(&recording);
      const CycleSamples samples = SamplesOf(recording, found->second, {});
      const auto shape = FitShape(samples.phase, samples.values, plain);
      if (!shape) return Fail("trial '{}': {}", recording.trial.name, shape.error().message);
      Vector curve(kPhases);
      for (int i = 0; i < kPhases; ++i)
        curve[i] = plain.Value(static_cast<double>(i) / kPhases, shape->data());
      mean += curve;
      recording.curves[muscle.name] = Closed(curve);
      std::vector<double>& cuts = recording.cuts[muscle.name];
      for (const int valley : Valleys(curve, kBetweenBursts * (curve.maxCoeff() - curve.minCoeff())))
        cuts.push_back(static_cast<double>(valley) / kPhases);
      append(samples, all);
      if (recording.trial.speed == out_.reference.speed) append(samples, at_reference);
    }
    if (with.empty()) {
      muscle.noise = 1;
      const auto known = settings_.jitter.find(muscle.name);
      if (known != settings_.jitter.end()) muscle.timing_scatter = known->second;
      return {};
    }
    const CycleSamples& from = at_reference.phase.empty() ? all : at_reference;
    SINEW_ASSIGN(muscle.shape, FitShape(from.phase, from.values, BasisOf(settings_, out_.reference.period)));
    mean /= static_cast<double>(with.size());
    muscle.mean = Closed(mean);
    std::vector<CycleSamples> recordings;
    double rate = 0;
    for (const Recording* recording : with) {
      recordings.push_back(
          SamplesOf(*recording, recording->measured.at(muscle.name), recording->cuts.at(muscle.name)));
      rate = 1 / (recording->trial.time[1] - recording->trial.time[0]);
    }
    SINEW_ASSIGN(const CycleScatter scatter,
                 EstimateCycleScatter(recordings, settings_.knots, std::max(1.0, kCorrelated_s * rate)));
    muscle.noise = std::max(scatter.noise, kLeastNoise);
    muscle.quiet_noise = scatter.quiet;
    muscle.noise_growth = scatter.growth;
    muscle.gain_scatter = scatter.gain;
    muscle.timing_scatter = scatter.timing;
    timings_.push_back(scatter.timings);
    for (BurstTiming& timing : timings_.back())
      timing.recording =
          static_cast<int>(with[static_cast<std::size_t>(timing.recording)] - recordings_.data());
    return {};
  }

  // Windows, the other muscles' EMG, and a block per muscle.
  void Finish(Recording& recording) {
    EmgShapeTrial trial = std::move(recording.trial);
    trial.first_block = static_cast<int>(out_.layout.size());
    for (const EmgMuscle& muscle : out_.muscles) {
      Block block;
      block.trial = trial.name;
      block.channel = muscle.name;
      block.unit = "1";
      block.prediction_time = trial.time;
      block.weight = 1 / muscle.noise;
      const auto found = recording.measured.find(muscle.name);
      const std::vector<double>& curve = CurveOf(recording, trial.group, muscle);
      if (found != recording.measured.end()) {
        for (std::size_t i = 0; i < found->second.size(); ++i) {
          if (!std::isfinite(found->second[i])) continue;
          block.sample.push_back(static_cast<int>(i));
          block.measured.push_back(found->second[i]);
          block.relative_weight.push_back(muscle.noise / NoiseAt(muscle, curve, trial.phase[i]));
        }
      }
      block.role = block.measured.empty() ? BlockRole::kPredicted : trial.role;
      AddWindows(recording.cuts[muscle.name], block, trial);
      out_.layout.push_back(std::move(block));
    }
    AddOthers(recording, trial);
    out_.trials.push_back(std::move(trial));
  }

  // The muscle's mean EMG in this recording, in a fitted one at the same speed, or at all speeds.
  [[nodiscard]] const std::vector<double>& CurveOf(const Recording& recording, int group,
                                                   const EmgMuscle& muscle) const {
    const auto own = recording.curves.find(muscle.name);
    if (own != recording.curves.end()) return own->second;
    for (const Recording& other : recordings_) {
      const auto found = other.curves.find(muscle.name);
      if (other.trial.group == group && found != other.curves.end()) return found->second;
    }
    return muscle.mean;
  }

  static void AddWindows(const std::vector<double>& cuts, const Block& block, EmgShapeTrial& trial) {
    std::vector<EmgWindow> windows;
    int last = -1;
    for (const int i : block.sample) {
      const auto at = static_cast<std::size_t>(i);
      const int window = BurstOf(cuts, trial.cycle[at], trial.phase[at]);
      if (window != last) windows.push_back({i, i + 1, 0});
      windows.back().end = i + 1;
      last = window;
    }
    for (EmgWindow& window : windows)
      window.cycle = trial.cycle[static_cast<std::size_t>((window.first + window.end) / 2)];
    if (block.role != BlockRole::kTrain) windows.clear();
    trial.windows.push_back(std::move(windows));
  }

  void AddOthers(const Recording& recording, EmgShapeTrial& trial) const {
    trial.others.resize(out_.muscles.size());
    if (out_.muscles.size() < 2) return;
    for (const EmgMuscle& muscle : out_.muscles) {
      if (recording.recorded.count(muscle.name) == 0) return;
    }
    const double share = 1 / static_cast<double>(out_.muscles.size() - 1);
    for (std::size_t m = 0; m < out_.muscles.size(); ++m) {
      std::vector<double>& others = trial.others[m];
      others.assign(trial.time.size(), 0);
      for (std::size_t o = 0; o < out_.muscles.size(); ++o) {
        if (o == m) continue;
        const std::vector<double>& values = recording.recorded.at(out_.muscles[o].name);
        for (std::size_t i = 0; i < others.size(); ++i) others[i] += share * values[i];
      }
    }
  }

  const EmgShapeSettings& settings_;
  std::vector<Recording> recordings_;
  EmgShapeData out_;
  std::vector<std::vector<BurstTiming>> timings_;  // [muscles] that were learnt
};

}  // namespace

ShapeBasis BasisOf(const EmgShapeSettings& settings, double period, double jitter) {
  return ShapeBasis(settings.knots, settings.low_pass * period, jitter);
}

int EmgShapeData::trained_speeds() const {
  return static_cast<int>(
      std::count_if(speeds.begin(), speeds.end(), [](const EmgSpeed& s) { return s.trained; }));
}

std::string DescribeEmgShapeChannels() {
  return "grid excitations, one channel per muscle   1    envelopes, normalised (`sinew data envelope`)\n"
         "  (a trial without it is predicted only)\n"
         "ANGLE, on any grid                         rad  the movement; its name is in the settings\n"
         "grid emg, channels as above (optional)     V    raw signals: clipped or frozen ones are left out\n"
         "condition speed_rad_per_s (optional)            else the mean absolute speed of the angle\n"
         "files:\n"
         "  emg_shape.yaml             settings with key `emg_shape` (or give --config)\n";
}

Result<EmgShapeData> PrepareEmgShapeData(const Dataset& data, const EmgShapeSettings& settings) {
  return Preparation(settings).Run(data);
}

}  // namespace sinew
