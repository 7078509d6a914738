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

constexpr double kLeastNoise = 1e-4;  // of normalised EMG; made-up data without noise have a weight too
constexpr int kPhases = 100;          // of a mean curve
constexpr int kNoiseKnots = 24;       // at least, of curves that noise is measured about: valleys count
// An envelope of 6 Hz is correlated over so many seconds.
constexpr double kCorrelated_s = 0.08;
// And its errors are forgotten in this time, those of a burst's shape among them. What lasts longer is a
// floor.
constexpr double kForgotten_s = 0.2;

// What is learnt of one recording's muscles, beside it.
struct Recording : RecordedTrial {
  std::map<std::string, BurstPattern> bursts;
  std::map<std::string, std::vector<double>> curves;  // mean over a cycle; [0] and the end are one
  std::map<std::string, EmgScatterFactors> factors;
  std::map<std::string, std::vector<double>> emg;  // CycleScatter::emg
};

Vector CurveOf(const ShapeBasis& basis, const Vector& shape) {
  Vector curve(kPhases);
  for (int i = 0; i < kPhases; ++i) curve[i] = basis.Value(static_cast<double>(i) / kPhases, shape.data());
  return curve;
}

std::vector<double> Closed(const Vector& curve) {
  std::vector<double> closed(curve.data(), curve.data() + curve.size());
  closed.push_back(curve[0]);
  return closed;
}

// Standard deviation of the noise where a muscle has so much EMG.
double NoiseAt(const EmgMuscle& muscle, double emg) {
  return std::max(kLeastNoise, muscle.modulated.At(emg));
}

int Remainder(int i, int n) {
  return ((i % n) + n) % n;
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
      if (*read) recordings_.push_back({std::move(**read), {}, {}, {}, {}});
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
                                              const BurstPattern& bursts) {
    CycleSamples samples;
    samples.pattern = bursts;
    const EmgShapeTrial& trial = recording.trial;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      samples.phase.push_back(trial.phase[i]);
      samples.values.push_back(values[i]);
      samples.burst.push_back(bursts.BurstAt(trial.cycle[i], trial.phase[i]));
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
    std::vector<Recording*> with;
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
      const Vector curve = CurveOf(plain, *shape);
      mean += curve;
      recording.curves[muscle.name] = Closed(curve);
      recording.bursts[muscle.name] = FindBursts(curve);
      append(samples, all);
      if (recording.trial.speed == out_.reference.speed) append(samples, at_reference);
    }
    if (with.empty()) {
      muscle.noise = 1;
      const auto known = settings_.jitter.find(muscle.name);
      if (known != settings_.jitter.end()) muscle.timing.total = known->second;
      return {};
    }
    const CycleSamples& from = at_reference.phase.empty() ? all : at_reference;
    SINEW_ASSIGN(muscle.shape, FitShape(from.phase, from.values, BasisOf(settings_, out_.reference.period)));
    muscle.bursts = FindBursts(CurveOf(BasisOf(settings_, out_.reference.period), muscle.shape));
    mean /= static_cast<double>(with.size());
    muscle.mean = Closed(mean);
    std::vector<CycleSamples> recordings;
    double rate = 0;
    for (const Recording* recording : with) {
      recordings.push_back(
          SamplesOf(*recording, recording->measured.at(muscle.name), recording->bursts.at(muscle.name)));
      rate = 1 / (recording->trial.time[1] - recording->trial.time[0]);
    }
    std::size_t fewest = all.phase.size();
    for (const CycleSamples& samples : recordings) fewest = std::min(fewest, samples.phase.size());
    const int knots = std::max(settings_.knots, std::min(kNoiseKnots, static_cast<int>(fewest / 3)));
    SINEW_ASSIGN(const CycleScatter scatter,
                 EstimateCycleScatter(recordings, knots, std::max(1.0, kCorrelated_s * rate)));
    muscle.noise = std::max(scatter.noise, kLeastNoise);
    muscle.bursts.after = scatter.after;
    muscle.modulated = scatter.modulated;
    muscle.gain = scatter.gain;
    muscle.timing = scatter.timing;
    for (std::size_t i = 0; i < with.size(); ++i) {
      with[i]->emg[muscle.name] = scatter.emg[i];
      with[i]->factors[muscle.name] = {scatter.gain.factor[i], scatter.timing.factor[i]};
    }
    timings_.push_back(scatter.timings);
    for (CycleTiming& timing : timings_.back())
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
      block.noise_memory = kForgotten_s;
      const auto found = recording.measured.find(muscle.name);
      const std::vector<double>& curve = MeanOf(recording, trial.group, muscle);
      const auto own = recording.emg.find(muscle.name);
      std::size_t at = 0;
      if (found != recording.measured.end()) {
        for (std::size_t i = 0; i < found->second.size(); ++i) {
          if (!std::isfinite(found->second[i])) continue;
          block.sample.push_back(static_cast<int>(i));
          block.measured.push_back(found->second[i]);
          const double noise =
              own != recording.emg.end() ? NoiseAt(muscle, own->second[at++])
              : curve.empty()            ? muscle.noise
                              : NoiseAt(muscle, AtPhase(curve, trial.phase[i] - std::floor(trial.phase[i])));
          block.relative_weight.push_back(muscle.noise / noise);
        }
      }
      block.role = block.measured.empty() ? BlockRole::kPredicted : trial.role;
      if (settings_.cycle_scatter && block.role == BlockRole::kValidate) {
        for (const int i : block.sample) block.group.push_back(trial.cycle[static_cast<std::size_t>(i)]);
      }
      trial.scatter.push_back(FactorsOf(recording, trial.group, muscle));
      AddWindows(muscle, block, trial);
      out_.layout.push_back(std::move(block));
    }
    AddOthers(recording, trial);
    out_.trials.push_back(std::move(trial));
  }

  // The muscle's mean EMG in this recording, in a fitted one at the same speed, or at all speeds.
  [[nodiscard]] const std::vector<double>& MeanOf(const Recording& recording, int group,
                                                  const EmgMuscle& muscle) const {
    const auto own = recording.curves.find(muscle.name);
    if (own != recording.curves.end()) return own->second;
    for (const Recording& other : recordings_) {
      const auto found = other.curves.find(muscle.name);
      if (other.trial.group == group && found != other.curves.end()) return found->second;
    }
    return muscle.mean;
  }

  // Of the recording itself, else the mean of the fitted ones at the same speed.
  [[nodiscard]] EmgScatterFactors FactorsOf(const Recording& recording, int group,
                                            const EmgMuscle& muscle) const {
    const auto own = recording.factors.find(muscle.name);
    if (own != recording.factors.end()) return own->second;
    EmgScatterFactors sum{0, 0};
    double count = 0;
    for (const Recording& other : recordings_) {
      const auto found = other.factors.find(muscle.name);
      if (other.trial.group != group || found == other.factors.end()) continue;
      sum.gain += found->second.gain;
      sum.timing += found->second.timing;
      count += 1;
    }
    return count > 0 ? EmgScatterFactors{sum.gain / count, sum.timing / count} : EmgScatterFactors{};
  }

  static void AddWindows(const EmgMuscle& muscle, const Block& block, EmgShapeTrial& trial) {
    const BurstPattern& bursts = muscle.bursts;
    trial.windows.emplace_back();
    if (block.role != BlockRole::kTrain) return;
    const bool apart = muscle.gain.own() > 0 || muscle.timing.own() > 0;
    std::vector<EmgWindow>& windows = trial.windows.back();
    std::vector<int> window_of(trial.time.size());
    int last = 0;
    for (std::size_t i = 0; i < trial.time.size(); ++i) {
      const int burst = bursts.BurstAt(trial.cycle[i], trial.phase[i]);
      const int cycle = bursts.CycleOf(burst);
      if (windows.empty() || (apart ? burst != last : cycle != windows.back().cycle)) {
        EmgWindow window;
        window.first = static_cast<int>(i);
        window.cycle = cycle;
        if (!windows.empty() && !bursts.cuts.empty()) {
          window.before = bursts.cuts[static_cast<std::size_t>(Remainder(burst - 1, bursts.count()))];
          window.begin =
              std::round(trial.cycle[i] + trial.phase[i] - window.before.phase) + window.before.phase;
          windows.back().finish = window.begin;
          windows.back().after = window.before;
        }
        windows.push_back(window);
      }
      windows.back().end = static_cast<int>(i) + 1;
      window_of[i] = static_cast<int>(windows.size()) - 1;
      last = burst;
    }
    for (const int i : block.sample)
      windows[static_cast<std::size_t>(window_of[static_cast<std::size_t>(i)])].fitted = true;
    // Timings move a burst into where its neighbours are.
    std::vector<int> ends;
    for (const EmgWindow& window : windows) ends.push_back(window.end);
    for (std::size_t w = windows.size(); w-- > 1;) windows[w].first = windows[w - 1].first;
    for (std::size_t w = 0; w + 1 < windows.size(); ++w) windows[w].end = ends[w + 1];
  }

  // What another electrode hears of a muscle. Noise of its own is none of that, and would hide what is: apart
  // from what gains and timings take up, muscles of like shape differ by little more than this noise.
  [[nodiscard]] static std::vector<double> WithoutNoise(const Recording& recording,
                                                        const std::string& muscle) {
    std::vector<double> values = recording.recorded.at(muscle);
    const auto known = recording.emg.find(muscle);
    if (known == recording.emg.end()) return values;
    const std::vector<double>& measured = recording.measured.at(muscle);
    std::size_t at = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isfinite(measured[i])) values[i] = known->second[at++];
    }
    return values;
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
        const EmgMuscle& other = out_.muscles[o];
        const std::vector<double> values = WithoutNoise(recording, other.name);
        for (std::size_t i = 0; i < others.size(); ++i) {
          const double mean =
              other.mean.empty() ? 0 : AtPhase(other.mean, trial.phase[i] - std::floor(trial.phase[i]));
          others[i] += share * (values[i] - mean);
        }
      }
    }
  }

  const EmgShapeSettings& settings_;
  std::vector<Recording> recordings_;
  EmgShapeData out_;
  std::vector<std::vector<CycleTiming>> timings_;  // [muscles] that were learnt
};

}  // namespace

BurstCut::Share EmgWindow::ShareAt(double place) const {
  const BurstCut::Share here = std::isfinite(begin) ? before.Later(place - begin) : BurstCut::Share{1, 0};
  const BurstCut::Share gone = std::isfinite(finish) ? after.Later(place - finish) : BurstCut::Share{};
  return {here.value * (1 - gone.value), here.slope * (1 - gone.value) - here.value * gone.slope};
}

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
