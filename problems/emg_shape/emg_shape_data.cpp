#include "problems/emg_shape/emg_shape_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/text.h"
#include "models/emg/cycle_warp.h"
#include "models/emg/shape_basis.h"
#include "problems/emg_shape/bursts.h"
#include "problems/emg_shape/cycle_scatter.h"
#include "problems/emg_shape/recorded_trial.h"

namespace sinew {
namespace {

constexpr double kLeastNoise = 1e-3;  // of normalised EMG; made-up data without noise have a weight too
constexpr int kPhases = 100;          // of a mean curve
// An envelope of 6 Hz is correlated over so many seconds.
constexpr double kCorrelated_s = 0.08;

// What is learnt of one recording's muscles, beside it.
struct Recording : RecordedTrial {
  std::map<std::string, std::vector<double>> cuts;    // FindCuts
  std::map<std::string, std::vector<double>> curves;  // mean over a cycle; [0] and the end are one
};

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
      auto read = ReadRecordedTrial(name, trial, settings_, out_.notes);
      if (!read) return Fail("trial '{}': {}", name, read.error().message);
      if (*read) recordings_.push_back({std::move(**read), {}, {}});
    }
    SINEW_TRY(ChooseMuscles());
    SINEW_TRY(GroupSpeeds());
    SINEW_TRY(ChooseReference());
    SINEW_TRY(LearnMuscles());
    for (Recording& recording : recordings_) Finish(recording);
    return std::move(out_);
  }

 private:
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
      recording.cuts[muscle.name] = FindCuts(curve);
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
