#include "problems/emg_shape/learning/clean_emg.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/decompositions.h"

namespace sinew {
namespace {

constexpr int kTurns = 4;
constexpr int kSteps = 4;            // of Gauss-Newton, per turn
constexpr double kMaxGain = 0.5;     // of one step, of the logarithm
constexpr double kMaxTiming = 0.03;  // of one step [cycle]
constexpr double kSmoothing = 1e-9;  // decides only where no sample does

struct WindowSample {
  int recording = 0;
  double phase = 0;
  double value = 0;
  double emg = 0;
};

// Gain (of the logarithm) and timing [cycle] that some samples have in common.
struct Shift {
  std::size_t first = 0;  // samples
  std::size_t end = 0;
  double gain = 0;
  double timing = 0;
  double gain_information = 0;  // of the prior
  double timing_information = 0;
};

class Cleaning {
 public:
  Cleaning(const std::vector<CycleSamples>& from, const std::vector<ShapeBasis>& basis,
           const CycleScatter& scatter, double correlated)
      : basis_(basis), scatter_(scatter), correlated_(correlated) {
    for (std::size_t r = 0; r < from.size(); ++r) Gather(from[r], r);
    values_.resize(basis.front().knots());
    slopes_.resize(basis.front().knots());
  }

  Status Run() {
    SINEW_TRY(Begin());
    for (int turn = 0; turn < kTurns; ++turn) {
      for (Shift& recording : recordings_) Move(recording);
      for (Shift& burst : bursts_) Move(burst);
      FindCurve();
      Center();
    }
    return {};
  }

  [[nodiscard]] std::vector<std::vector<double>> Emg() const {
    std::vector<std::vector<double>> emg(recordings_.size());
    for (const WindowSample& sample : samples_)
      emg[static_cast<std::size_t>(sample.recording)].push_back(sample.emg);
    return emg;
  }

 private:
  void Gather(const CycleSamples& from, std::size_t r) {
    Shift recording;
    recording.first = samples_.size();
    for (std::size_t i = 0; i < from.phase.size(); ++i) {
      if (i == 0 || from.burst[i] != from.burst[i - 1]) {
        Shift burst;
        burst.first = samples_.size();
        burst.gain_information = std::pow(scatter_.gain.total * scatter_.gain.factor[r], -2);
        burst.timing_information = std::pow(scatter_.timing.total * scatter_.timing.factor[r], -2);
        bursts_.push_back(burst);
      }
      burst_of_.push_back(bursts_.size() - 1);
      samples_.push_back({static_cast<int>(r), from.phase[i], from.values[i], scatter_.emg[r][i]});
      bursts_.back().end = samples_.size();
    }
    recording.end = samples_.size();
    recordings_.push_back(recording);
  }

  // The curve of all recordings as they are, and its lowest value, which no gain changes.
  Status Begin() {
    std::vector<double> phase;
    std::vector<double> values;
    for (const WindowSample& sample : samples_) {
      phase.push_back(sample.phase);
      values.push_back(sample.value);
    }
    SINEW_ASSIGN(curve_, FitShape(phase, values, ShapeBasis(basis_.front().knots())));
    floor_ = std::numeric_limits<double>::infinity();
    const ShapeBasis plain(basis_.front().knots());
    for (int i = 0; i < 100; ++i) floor_ = std::min(floor_, plain.Value(0.01 * i, curve_.data()));
    floor_ = std::max(floor_, 0.0);
    curve_.array() -= floor_;
    return {};
  }

  struct Place {
    double gain = 1;
    double phase = 0;
  };
  [[nodiscard]] Place PlaceOf(std::size_t i) const {
    const Shift& recording = recordings_[static_cast<std::size_t>(samples_[i].recording)];
    const Shift& burst = bursts_[burst_of_[i]];
    return {std::exp(recording.gain + burst.gain), samples_[i].phase + recording.timing + burst.timing};
  }

  [[nodiscard]] const ShapeBasis& BasisAt(std::size_t i) const {
    return basis_[static_cast<std::size_t>(samples_[i].recording)];
  }

  [[nodiscard]] double WeightOf(const WindowSample& sample) const {
    const double noise = std::max(scatter_.modulated.At(sample.emg), kMinEnvelopeNoise);
    return 1 / (correlated_ * noise * noise);
  }

  void Move(Shift& shift) {
    for (int step = 0; step < kSteps; ++step) {
      double gg = shift.gain_information;
      double gt = 0;
      double tt = shift.timing_information;
      double g = -gg * shift.gain;
      double t = -tt * shift.timing;
      for (std::size_t i = shift.first; i < shift.end; ++i) {
        const Place place = PlaceOf(i);
        BasisAt(i).At(place.phase, values_.data(), slopes_.data());
        const double above = place.gain * values_.dot(curve_);
        const double slope = place.gain * slopes_.dot(curve_);
        const double weight = WeightOf(samples_[i]);
        const double left = samples_[i].value - floor_ - above;
        gg += weight * above * above;
        gt += weight * above * slope;
        tt += weight * slope * slope;
        g += weight * above * left;
        t += weight * slope * left;
      }
      const double determinant = gg * tt - gt * gt;
      if (!(determinant > 1e-9 * gg * tt)) return;
      shift.gain += std::clamp((tt * g - gt * t) / determinant, -kMaxGain, kMaxGain);
      shift.timing += std::clamp((gg * t - gt * g) / determinant, -kMaxTiming, kMaxTiming);
    }
  }

  void FindCurve() {
    const auto knots = static_cast<Eigen::Index>(curve_.size());
    Matrix normal = Matrix::Zero(knots, knots);
    Vector right = Vector::Zero(knots);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Place place = PlaceOf(i);
      BasisAt(i).At(place.phase, values_.data(), nullptr);
      const double weight = WeightOf(samples_[i]) * place.gain;
      right += weight * (samples_[i].value - floor_) * values_;
      normal += weight * place.gain * values_ * values_.transpose();
    }
    normal.diagonal().array() += kSmoothing * normal.diagonal().mean();
    curve_ = Eigen::LDLT<Matrix>(normal).solve(right);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Place place = PlaceOf(i);
      BasisAt(i).At(place.phase, values_.data(), nullptr);
      samples_[i].emg = std::max(floor_ + place.gain * values_.dot(curve_), 0.0);
    }
  }

  // What all recordings have in common is the curve's.
  void Center() {
    double gain = 0;
    double timing = 0;
    for (const Shift& recording : recordings_) {
      gain += recording.gain / static_cast<double>(recordings_.size());
      timing += recording.timing / static_cast<double>(recordings_.size());
    }
    for (Shift& recording : recordings_) {
      recording.gain -= gain;
      recording.timing -= timing;
    }
    curve_ *= std::exp(gain);
  }

  const std::vector<ShapeBasis>& basis_;
  const CycleScatter& scatter_;
  double correlated_;
  std::vector<WindowSample> samples_;
  std::vector<std::size_t> burst_of_;  // [samples]
  std::vector<Shift> recordings_;
  std::vector<Shift> bursts_;
  Vector curve_;  // [knots] above the floor
  double floor_ = 0;
  Vector values_;
  Vector slopes_;
};

}  // namespace

Result<std::vector<std::vector<double>>> CleanEmg(const std::vector<CycleSamples>& recordings,
                                                  const std::vector<ShapeBasis>& basis,
                                                  const CycleScatter& scatter, double correlated) {
  Cleaning cleaning(recordings, basis, scatter, correlated);
  SINEW_TRY(cleaning.Run());
  return cleaning.Emg();
}

}  // namespace sinew
