#include "problems/emg_shape/data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/text.h"
#include "models/emg/cycle_warp.h"
#include "models/emg/shape_basis.h"
#include "problems/emg_shape/learning/muscle_learning.h"
#include "problems/emg_shape/learning/shape_resolution.h"

namespace sinew {
namespace {

// Errors of an envelope (6 Hz) are forgotten in this time, those of a burst's shape among them. What lasts
// longer is a floor.
constexpr double kForgotten_s = 0.2;

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
      if (*read) recordings_.push_back({std::move(**read), {}});
    }
    SINEW_TRY(ChooseMuscles());
    SINEW_TRY(GroupSpeeds());
    SINEW_TRY(ChooseReference());
    FindKnots();
    SINEW_ASSIGN(out_.shared_timing,
                 LearnMuscles(settings_, out_.knots, out_.reference, recordings_, out_.muscles));
    FindOthersShapes();
    for (const LearntRecording& recording : recordings_) Finish(recording);
    return std::move(out_);
  }

 private:
  Status ChooseMuscles() {
    std::set<std::string> learnt;
    std::set<std::string> seen(settings_.muscles.begin(), settings_.muscles.end());
    bool any_training = false;
    for (const LearntRecording& recording : recordings_) {
      any_training = any_training || recording.trial.role == BlockRole::kTrain;
      for (const auto& [muscle, values] : recording.measured) {
        seen.insert(muscle);
        if (recording.trial.role == BlockRole::kTrain) learnt.insert(muscle);
      }
    }
    if (!any_training) {
      if (!settings_.reference)
        return Fail(
            "there is no training trial; to predict with a fitted model state `reference` "
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
    for (LearntRecording& recording : recordings_) order.push_back(&recording.trial);
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
    for (const LearntRecording& recording : recordings_) {
      const EmgShapeTrial& trial = recording.trial;
      if (trial.group != middle || trial.role != BlockRole::kTrain) continue;
      out_.reference = {trial.speed, trial.period};
      return {};
    }
    return Fail("no training trial");
  }

  void FindKnots() {
    std::vector<const RecordedTrial*> recordings;
    for (const LearntRecording& recording : recordings_) recordings.push_back(&recording);
    out_.knots = settings_.knots ? *settings_.knots : ChooseKnots(recordings, out_.muscles);
  }

  // Windows, the other muscles' EMG, and a block per muscle.
  void Finish(const LearntRecording& recording) {
    EmgShapeTrial trial = recording.trial;
    trial.first_block = static_cast<int>(out_.layout.size());
    for (const EmgMuscle& muscle : out_.muscles) {
      Block block = BlockOf(recording, muscle);
      const bool apart = muscle.gain.own() > 0 || muscle.timing.own() > 0;
      trial.scatter.push_back(FactorsOf(recording, muscle));
      trial.windows.emplace_back();
      if (block.role == BlockRole::kTrain)
        trial.windows.back() = FindEmgWindows(muscle.bursts, apart, trial.cycle, trial.phase, block.sample);
      out_.layout.push_back(std::move(block));
    }
    AddOthers(recording, trial);
    out_.trials.push_back(std::move(trial));
  }

  [[nodiscard]] Block BlockOf(const LearntRecording& recording, const EmgMuscle& muscle) const {
    const EmgShapeTrial& trial = recording.trial;
    Block block;
    block.trial = trial.name;
    block.channel = muscle.name;
    block.unit = "1";
    block.prediction_time = trial.time;
    block.weight = 1 / muscle.noise;
    block.noise_memory = kForgotten_s;
    const auto measured = recording.measured.find(muscle.name);
    for (std::size_t i = 0; measured != recording.measured.end() && i < measured->second.size(); ++i) {
      if (!std::isfinite(measured->second[i])) continue;
      block.sample.push_back(static_cast<int>(i));
      block.measured.push_back(measured->second[i]);
    }
    block.role = block.measured.empty() ? BlockRole::kPredicted : trial.role;
    for (const double emg : EmgAt(recording, muscle, block.sample)) {
      block.relative_weight.push_back(muscle.noise / std::max(kMinEnvelopeNoise, muscle.modulated.At(emg)));
    }
    if (settings_.cycle_scatter && block.role == BlockRole::kValidate) {
      for (const int i : block.sample) block.group.push_back(trial.cycle[static_cast<std::size_t>(i)]);
    }
    return block;
  }

  // Without noise: of the recording's own bursts, else of the mean. Empty: nothing was learnt of the muscle.
  [[nodiscard]] std::vector<double> EmgAt(const LearntRecording& recording, const EmgMuscle& muscle,
                                          const std::vector<int>& samples) const {
    const auto own = recording.learnt.find(muscle.name);
    if (own != recording.learnt.end()) return own->second.emg;
    std::vector<double> emg;
    const std::vector<double>& curve = MeanOf(recording, muscle);
    if (curve.empty()) return emg;
    for (const int i : samples)
      emg.push_back(OverCycles(curve, recording.trial.phase[static_cast<std::size_t>(i)]));
    return emg;
  }

  // At a phase of any cycle.
  [[nodiscard]] static double OverCycles(const std::vector<double>& curve, double phase) {
    return AtPhase(curve, phase - std::floor(phase));
  }

  // The muscle's mean EMG in a fitted recording at the same speed, or at all speeds.
  [[nodiscard]] const std::vector<double>& MeanOf(const LearntRecording& recording,
                                                  const EmgMuscle& muscle) const {
    for (const LearntRecording& other : recordings_) {
      const auto found = other.learnt.find(muscle.name);
      if (other.trial.group == recording.trial.group && found != other.learnt.end())
        return found->second.curve;
    }
    return muscle.mean;
  }

  // Of the recording itself, else the mean of the fitted ones at the same speed.
  [[nodiscard]] EmgScatterFactors FactorsOf(const LearntRecording& recording, const EmgMuscle& muscle) const {
    const auto own = recording.learnt.find(muscle.name);
    if (own != recording.learnt.end()) return own->second.factors;
    EmgScatterFactors sum{0, 0};
    double count = 0;
    for (const LearntRecording& other : recordings_) {
      const auto found = other.learnt.find(muscle.name);
      if (other.trial.group != recording.trial.group || found == other.learnt.end()) continue;
      sum.gain += found->second.factors.gain;
      sum.timing += found->second.factors.timing;
      count += 1;
    }
    return count > 0 ? EmgScatterFactors{sum.gain / count, sum.timing / count} : EmgScatterFactors{};
  }

  // What another electrode records of a muscle. Its own noise is not cross-talk, and would mask it:
  // apart from what gains and timings take up, muscles of like shape differ by little more than this noise.
  [[nodiscard]] static std::vector<double> CrossTalkOf(const LearntRecording& recording,
                                                       const std::string& muscle) {
    std::vector<double> values = recording.recorded.at(muscle);
    const auto own = recording.learnt.find(muscle);
    if (own == recording.learnt.end()) return values;
    const std::vector<double>& measured = recording.measured.at(muscle);
    std::size_t at = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isfinite(measured[i])) values[i] = own->second.clean[at++];
    }
    return values;
  }

  void FindOthersShapes() {
    if (out_.muscles.size() < 2) return;
    for (const EmgMuscle& muscle : out_.muscles) {
      if (muscle.mean_shape.size() == 0) return;
    }
    for (std::size_t m = 0; m < out_.muscles.size(); ++m) {
      Vector shape = Vector::Zero(out_.knots);
      for (std::size_t o = 0; o < out_.muscles.size(); ++o) {
        if (o != m) shape += out_.muscles[o].mean_shape / static_cast<double>(out_.muscles.size() - 1);
      }
      out_.others_shape.push_back(std::move(shape));
    }
  }

  void AddOthers(const LearntRecording& recording, EmgShapeTrial& trial) const {
    trial.others.resize(out_.muscles.size());
    if (out_.others_shape.empty()) return;
    std::vector<std::vector<double>> recorded;
    for (const EmgMuscle& muscle : out_.muscles) {
      if (recording.recorded.count(muscle.name) == 0) return;
      recorded.push_back(CrossTalkOf(recording, muscle.name));
    }
    const double share = 1 / static_cast<double>(out_.muscles.size() - 1);
    for (std::size_t m = 0; m < out_.muscles.size(); ++m) {
      std::vector<double>& others = trial.others[m];
      others.assign(trial.time.size(), 0);
      for (std::size_t o = 0; o < out_.muscles.size(); ++o) {
        for (std::size_t i = 0; o != m && i < others.size(); ++i) others[i] += share * recorded[o][i];
      }
    }
  }

  const EmgShapeSettings& settings_;
  std::vector<LearntRecording> recordings_;
  EmgShapeData out_;
};

}  // namespace

ShapeBasis BasisOf(const EmgShapeSettings& settings, int knots, double period, double jitter) {
  return ShapeBasis(knots, settings.low_pass * period, jitter);
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
