#include "problems/emg_shape/learning/muscle_learning.h"

#include <algorithm>
#include <cmath>

#include "models/emg/shape_basis.h"
#include "problems/emg_shape/learning/clean_emg.h"

namespace sinew {
namespace {

constexpr int kPhases = 100;     // of a mean curve
constexpr int kNoiseKnots = 24;  // at least, of curves that noise is measured about: valleys count

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

CycleSamples SamplesOf(const RecordedTrial& recording, const std::string& muscle,
                       const BurstPattern& bursts) {
  CycleSamples samples;
  samples.pattern = bursts;
  const EmgShapeTrial& trial = recording.trial;
  const std::vector<double>& values = recording.measured.at(muscle);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    samples.phase.push_back(trial.phase[i]);
    samples.values.push_back(values[i]);
    samples.burst.push_back(bursts.BurstAt(trial.cycle[i], trial.phase[i]));
  }
  return samples;
}

void Append(const CycleSamples& from, CycleSamples& to) {
  to.phase.insert(to.phase.end(), from.phase.begin(), from.phase.end());
  to.values.insert(to.values.end(), from.values.begin(), from.values.end());
}

class Learning {
 public:
  Learning(const EmgShapeSettings& settings, int knots, const EmgReference& reference,
           std::vector<LearntRecording>& recordings)
      : settings_(settings), knots_(knots), reference_(reference), recordings_(recordings) {}

  Status Learn(EmgMuscle& muscle) {
    muscle.shape = Vector::Zero(knots_);
    with_.clear();
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      if (recordings_[r].trial.role == BlockRole::kTrain && recordings_[r].measured.count(muscle.name) > 0)
        with_.push_back(r);
    }
    if (with_.empty()) {
      muscle.noise = 1;
      const auto known = settings_.jitter.find(muscle.name);
      if (known != settings_.jitter.end()) muscle.timing.total = known->second;
      return {};
    }
    SINEW_TRY(FindShape(muscle));
    return FindScatter(muscle);
  }

  [[nodiscard]] double shared_timing() const { return SharedTiming(timings_); }

 private:
  // Mean curves of all recordings, and where the shape begins to be fitted: those at the reference speed, or
  // all of them.
  Status FindShape(EmgMuscle& muscle) {
    const ShapeBasis plain(knots_);
    Vector mean = Vector::Zero(kPhases);
    muscle.mean_shape = Vector::Zero(knots_);
    CycleSamples at_reference;
    CycleSamples all;
    for (const std::size_t r : with_) {
      LearntRecording& recording = recordings_[r];
      const CycleSamples samples = SamplesOf(recording, muscle.name, {});
      const auto shape = FitShape(samples.phase, samples.values, plain);
      if (!shape) return Fail("trial '{}': {}", recording.trial.name, shape.error().message);
      const Vector curve = CurveOf(plain, *shape);
      mean += curve / static_cast<double>(with_.size());
      muscle.mean_shape += *shape / static_cast<double>(with_.size());
      recording.learnt[muscle.name].curve = Closed(curve);
      recording.learnt[muscle.name].bursts = FindBursts(curve);
      Append(samples, all);
      if (recording.trial.speed == reference_.speed) Append(samples, at_reference);
    }
    muscle.mean = Closed(mean);
    const CycleSamples& from = at_reference.phase.empty() ? all : at_reference;
    const ShapeBasis seen = BasisOf(settings_, knots_, reference_.period);
    SINEW_ASSIGN(muscle.shape, FitShape(from.phase, from.values, seen));
    muscle.bursts = FindBursts(CurveOf(seen, muscle.shape));
    return {};
  }

  Status FindScatter(EmgMuscle& muscle) {
    std::vector<CycleSamples> samples;
    std::vector<ShapeBasis> bases;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    double rate = 0;
    for (const std::size_t r : with_) {
      const LearntRecording& recording = recordings_[r];
      samples.push_back(SamplesOf(recording, muscle.name, recording.learnt.at(muscle.name).bursts));
      bases.push_back(BasisOf(settings_, knots_, recording.trial.period));
      fewest = std::min(fewest, samples.back().phase.size());
      rate = 1 / (recording.trial.time[1] - recording.trial.time[0]);
    }
    const int knots = std::max(knots_, std::min(kNoiseKnots, static_cast<int>(fewest / 3)));
    const double correlated = std::max(1.0, kEnvelopeCorrelated_s * rate);
    SINEW_ASSIGN(const CycleScatter scatter, EstimateCycleScatter(samples, knots, correlated));
    SINEW_ASSIGN(const auto clean, CleanEmg(samples, bases, scatter, correlated));
    muscle.noise = std::max(scatter.noise, kMinEnvelopeNoise);
    muscle.bursts.after = scatter.after;
    muscle.modulated = scatter.modulated;
    muscle.gain = scatter.gain;
    muscle.timing = scatter.timing;
    for (std::size_t i = 0; i < with_.size(); ++i) {
      LearntRecording::Muscle& learnt = recordings_[with_[i]].learnt.at(muscle.name);
      learnt.emg = scatter.emg[i];
      learnt.clean = clean[i];
      learnt.factors = {scatter.gain.factor[i], scatter.timing.factor[i]};
    }
    timings_.push_back(scatter.timings);
    for (CycleTiming& timing : timings_.back())
      timing.recording = static_cast<int>(with_[static_cast<std::size_t>(timing.recording)]);
    return {};
  }

  const EmgShapeSettings& settings_;
  int knots_;
  const EmgReference& reference_;
  std::vector<LearntRecording>& recordings_;
  std::vector<std::size_t> with_;                  // recordings with enough information on the muscle
  std::vector<std::vector<CycleTiming>> timings_;  // [muscles] that were learnt
};

}  // namespace

Result<double> LearnMuscles(const EmgShapeSettings& settings, int knots, const EmgReference& reference,
                            std::vector<LearntRecording>& recordings, std::vector<EmgMuscle>& muscles) {
  Learning learning(settings, knots, reference, recordings);
  for (EmgMuscle& muscle : muscles) {
    const Status learnt = learning.Learn(muscle);
    if (!learnt) return Fail("{}: {}", muscle.name, learnt.error().message);
  }
  return learning.shared_timing();
}

}  // namespace sinew
