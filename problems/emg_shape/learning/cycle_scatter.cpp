#include "problems/emg_shape/learning/cycle_scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "base/median.h"
#include "models/emg/shape_basis.h"

namespace sinew {
namespace {

constexpr int kSweeps = 3;
constexpr double kUnusual = 3;     // times the median variance of recordings: no measure of the others
constexpr double kUsual = 10;      // bursts that what is usual counts for against a recording's own
constexpr double kMinimum = 4;     // samples of a burst
constexpr double kMaxTaken = 0.8;  // share of a sample's noise that a regression is believed to have taken
constexpr double kWellTold = 0.2;  // share of the mean burst's information below which a burst is not used
constexpr double kEnoughForATrend = 6;   // degrees of freedom of all gains
constexpr double kEnoughForStudent = 4;  // degrees of freedom from which its variance is used
constexpr double kMinShare = 0.1;        // of the variance of bursts, below which a part of it is none

// Sums over samples of one burst, by the inverse of their noise's variance.
struct BurstSums {
  double pp = 0;  // shape
  double ps = 0;  // shape and slope
  double ss = 0;
  double pr = 0;  // residual
  double sr = 0;
  double rr = 0;
  double count = 0;
  int recording = 0;
  int number = 0;  // BurstPattern::BurstAt
};

struct Sample {
  int burst = 0;
  double phase = 0;
  double emg = 0;  // of the shape, with the burst's gain and timing once they are known
  double above = 0;
  double slope = 0;
  double residual = 0;
};

// A burst with enough information on its gain and timing.
struct Told {
  int recording = 0;
  int number = 0;
  double gain = 0;
  double timing = 0;
  double gain_noise = 0;  // variances of the estimates, of unit noise
  double timing_noise = 0;
};

class Estimation {
 public:
  Estimation(const std::vector<CycleSamples>& recordings, int knots, double correlated)
      : recordings_(recordings), basis_(knots), correlated_(correlated) {}

  Result<CycleScatter> Run() {
    for (const CycleSamples& recording : recordings_) SINEW_TRY(Gather(recording));
    AssumeNoise();
    // The information on gains and timings depends on the noise, and the noise on what they explain.
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      AddUp();
      AskBursts();
      RemoveTrend();
      FindTotal(&Told::gain, &Told::gain_noise, kMinGainScatter, out_.gain);
      FindTotal(&Told::timing, &Told::timing_noise, kMinTimingScatter, out_.timing);
      if (variance_ > 0) FindNoise();
    }
    FindTogether();
    out_.emg.resize(recordings_.size());
    for (const Sample& sample : samples_)
      out_.emg[static_cast<std::size_t>(bursts_[static_cast<std::size_t>(sample.burst)].recording)].push_back(
          sample.emg);
    return std::move(out_);
  }

 private:
  Status Gather(const CycleSamples& recording) {
    SINEW_ASSIGN(const Vector shape, FitShape(recording.phase, recording.values, basis_));
    shapes_.push_back(shape);
    const double floor = shape.minCoeff();
    for (std::size_t i = 0; i < recording.phase.size(); ++i) {
      if (i == 0 || recording.burst[i] != recording.burst[i - 1]) {
        bursts_.emplace_back();
        bursts_.back().recording = static_cast<int>(&recording - recordings_.data());
        bursts_.back().number = recording.burst[i];
      }
      const double p = basis_.Value(recording.phase[i], shape.data());
      const double slope = basis_.Slope(recording.phase[i], shape.data());
      // A gain leaves the floor as it is.
      samples_.push_back({static_cast<int>(bursts_.size()) - 1, recording.phase[i], p, p - floor, slope,
                          recording.values[i] - p});
    }
    return {};
  }

  // To begin with, gains and timings are noise too.
  void AssumeNoise() {
    std::vector<double> squares;
    for (const Sample& sample : samples_) squares.push_back(sample.residual * sample.residual);
    SetNoise(squares);
  }

  void SetNoise(const std::vector<double>& squares) {
    std::vector<double> emg;
    double sum = 0;
    for (const Sample& sample : samples_) emg.push_back(sample.emg);
    for (const double square : squares) sum += square;
    out_.modulated = FitModulatedNoise(squares, emg);
    out_.noise = std::sqrt(sum / static_cast<double>(squares.size()));
  }

  [[nodiscard]] double VarianceOf(const Sample& sample) const {
    return std::max(std::pow(out_.modulated.At(sample.emg), 2), std::numeric_limits<double>::min());
  }

  void AddUp() {
    for (BurstSums& sums : bursts_) sums = {0, 0, 0, 0, 0, 0, 0, sums.recording, sums.number};
    for (const Sample& sample : samples_) {
      BurstSums& sums = bursts_[static_cast<std::size_t>(sample.burst)];
      const double weight = 1 / VarianceOf(sample);
      sums.pp += weight * sample.above * sample.above;
      sums.ps += weight * sample.above * sample.slope;
      sums.ss += weight * sample.slope * sample.slope;
      sums.pr += weight * sample.above * sample.residual;
      sums.sr += weight * sample.slope * sample.residual;
      sums.rr += weight * sample.residual * sample.residual;
      sums.count += 1;
    }
  }

  void AskBursts() {
    told_.clear();
    double mean_pp = 0;
    double mean_ss = 0;
    for (const BurstSums& sums : bursts_) {
      mean_pp += sums.pp / static_cast<double>(bursts_.size());
      mean_ss += sums.ss / static_cast<double>(bursts_.size());
    }
    double left = 0;
    double degrees = -static_cast<double>(basis_.knots() * recordings_.size());
    for (const BurstSums& sums : bursts_) {
      left += sums.rr;
      degrees += sums.count;
      const double determinant = sums.pp * sums.ss - sums.ps * sums.ps;
      const bool tells = sums.count >= kMinimum && sums.pp > kWellTold * mean_pp &&
                         sums.ss > kWellTold * mean_ss && determinant > 1e-6 * sums.pp * sums.ss;
      if (!tells) continue;
      const double gain = (sums.ss * sums.pr - sums.ps * sums.sr) / determinant;
      const double timing = (sums.pp * sums.sr - sums.ps * sums.pr) / determinant;
      left -= gain * sums.pr + timing * sums.sr;
      degrees -= 2;
      told_.push_back(
          {sums.recording, sums.number, gain, timing, sums.ss / determinant, sums.pp / determinant});
    }
    variance_ = std::max(left, 0.0) / std::max(degrees, 1.0);
  }

  // A muscle that tires is weaker from cycle to cycle, by as much in every recording. That is no scatter: as
  // part of it, it would widen the prior of the gains until they describe the fatigue as well.
  void RemoveTrend() {
    std::map<std::pair<int, int>, std::array<double, 2>> means;  // of recording and burst: count, mean cycle
    for (const Told& burst : told_) {
      auto& [count, mean] = means[PlaceOf(burst)];
      count += 1;
      mean += (CyclesSince0(burst) - mean) / count;
    }
    double squares = 0;
    double products = 0;
    const auto since = [&](const Told& burst) { return CyclesSince0(burst) - means.at(PlaceOf(burst))[1]; };
    for (const Told& burst : told_) {
      squares += since(burst) * since(burst);
      products += since(burst) * burst.gain;
    }
    const double freedom = static_cast<double>(told_.size()) - static_cast<double>(means.size());
    trend_share_ = 0;
    if (!(squares > 0) || freedom < kEnoughForATrend) return;
    for (Told& burst : told_) burst.gain -= products / squares * since(burst);
    trend_share_ = 1 / freedom;
  }

  [[nodiscard]] double CyclesSince0(const Told& burst) const {
    return static_cast<double>(burst.number) /
           recordings_[static_cast<std::size_t>(burst.recording)].pattern.count();
  }

  // Recording and burst of the cycle.
  [[nodiscard]] std::pair<int, int> PlaceOf(const Told& burst) const {
    const BurstPattern& pattern = recordings_[static_cast<std::size_t>(burst.recording)].pattern;
    return {burst.recording, pattern.IndexOf(burst.number)};
  }

  // A recording whose bursts scatter much more than those of the others is no measure of them, and is
  // recognised by its own bursts; a few cycles have little weight against the usual scatter.
  void FindTotal(double Told::*value, double Told::*noise, double least, Scatter& scatter) const {
    struct Sums {
      double squares = 0;
      double noise = 0;
      double told = 0;
      std::set<int> bursts;  // of the cycle: their means were taken away with the shape
    };
    std::vector<Sums> sums(recordings_.size());
    for (const Told& burst : told_) {
      const auto r = static_cast<std::size_t>(burst.recording);
      sums[r].squares += burst.*value * burst.*value;
      sums[r].noise += burst.*noise;
      sums[r].told += 1;
      sums[r].bursts.insert(recordings_[r].pattern.IndexOf(burst.number));
    }
    std::vector<std::size_t> telling;  // recordings
    std::vector<double> variances;
    std::vector<double> told;
    for (std::size_t r = 0; r < sums.size(); ++r) {
      const Sums& of = sums[r];
      double freedom = of.told - static_cast<double>(of.bursts.size());
      if (freedom < 1) continue;
      if (value == &Told::gain) freedom *= 1 - trend_share_;
      telling.push_back(r);
      variances.push_back(of.squares / freedom - correlated_ * variance_ * of.noise / of.told);
      told.push_back(freedom);
    }
    scatter.total = least;
    scatter.factor.assign(recordings_.size(), 1);
    if (variances.empty()) return;
    const double most = kUnusual * std::max(UpperMedian(variances), least * least);
    double sum = 0;
    double freedom = 0;
    for (std::size_t i = 0; i < variances.size(); ++i) {
      sum += told[i] * std::min(variances[i], most);
      freedom += told[i];
    }
    // Tests and intervals take the width of a prior as known. It is an estimate from few bursts, so that what
    // it describes has a Student's distribution, whose variance is larger.
    const double student = freedom > kEnoughForStudent ? freedom / (freedom - 2) : 1;
    scatter.total = std::sqrt(std::max(student * sum / freedom, least * least));
    for (std::size_t i = 0; i < telling.size(); ++i) {
      const double ratio = std::max(variances[i], 0.0) / (scatter.total * scatter.total);
      scatter.factor[telling[i]] = std::sqrt((kUsual + told[i] * ratio) / (kUsual + told[i]));
    }
  }

  // Bursts of each cycle, if so many after the main one belong to it.
  [[nodiscard]] std::map<std::pair<int, int>, std::vector<const Told*>> Cycles(int after) const {
    std::map<std::pair<int, int>, std::vector<const Told*>> cycles;
    for (const Told& burst : told_) {
      BurstPattern pattern = recordings_[static_cast<std::size_t>(burst.recording)].pattern;
      pattern.after = after;
      cycles[{burst.recording, pattern.CycleOf(burst.number)}].push_back(&burst);
    }
    return cycles;
  }

  void FindTogether() {
    int most = 1;
    double pairs_of_means = 0;
    for (const CycleSamples& recording : recordings_) {
      const int count = recording.pattern.count();
      most = std::max(most, count);
      pairs_of_means += 0.5 * count * (count - 1);
    }
    double best = 0;
    double gain = 0;
    double timing = 0;
    double pairs = 0;
    for (int after = 0; after < most && most > 1; ++after) {
      double gains = 0;
      double timings = 0;
      double count = 0;
      for (const auto& [key, bursts] : Cycles(after)) {
        for (std::size_t a = 0; a < bursts.size(); ++a) {
          for (std::size_t b = 0; b < a; ++b) {
            gains += Usual(*bursts[a]).gain * Usual(*bursts[b]).gain;
            timings += Usual(*bursts[a]).timing * Usual(*bursts[b]).timing;
            count += 1;
          }
        }
      }
      const double worth = gains / std::pow(out_.gain.total, 2) + timings / std::pow(out_.timing.total, 2);
      if (after > 0 && worth <= best) continue;
      best = worth;
      out_.after = after;
      gain = gains;
      timing = timings;
      pairs = count;
    }
    const double freedom = std::max(pairs - pairs_of_means, 1.0);
    // A single burst is all of its cycle; of several with too little information, each is independent.
    Share(most > 1 ? gain / freedom : std::pow(out_.gain.total, 2), out_.gain);
    Share(most > 1 ? timing / freedom : std::pow(out_.timing.total, 2), out_.timing);
    for (const auto& [key, bursts] : Cycles(out_.after)) {
      double mean = 0;
      for (const Told* burst : bursts) mean += Usual(*burst).timing / static_cast<double>(bursts.size());
      out_.timings.push_back({key.first, key.second, mean});
    }
  }

  // As if its recording scattered as is usual.
  [[nodiscard]] Told Usual(Told burst) const {
    const auto r = static_cast<std::size_t>(burst.recording);
    burst.gain /= out_.gain.factor[r];
    burst.timing /= out_.timing.factor[r];
    return burst;
  }

  static void Share(double together, Scatter& scatter) {
    const double total = scatter.total * scatter.total;
    if (together < kMinShare * total) together = 0;
    if (together > (1 - kMinShare) * total) together = total;
    scatter.together = std::sqrt(together);
  }

  // What gains and timings, drawn to 0 by their scatter, took from a sample is given back: most where a burst
  // is, whose few independent samples they nearly explain.
  void FindNoise() {
    const double one = correlated_ * variance_;  // of an independent value
    std::vector<std::array<double, 3>> inverse;  // of each burst's information: gain, both, timing
    std::vector<std::array<double, 2>> found;
    for (const BurstSums& of : bursts_) {
      const auto r = static_cast<std::size_t>(of.recording);
      const double gain = of.pp / one + std::pow(out_.gain.total * out_.gain.factor[r], -2);
      const double timing = of.ss / one + std::pow(out_.timing.total * out_.timing.factor[r], -2);
      const double both = of.ps / one;
      const double determinant = gain * timing - both * both;
      inverse.push_back({timing / determinant, -both / determinant, gain / determinant});
      found.push_back({(timing * of.pr - both * of.sr) / one / determinant,
                       (gain * of.sr - both * of.pr) / one / determinant});
    }
    std::vector<double> squares;
    for (Sample& sample : samples_) {
      const auto of = static_cast<std::size_t>(sample.burst);
      const double left = sample.residual - found[of][0] * sample.above - found[of][1] * sample.slope;
      const double taken =
          (inverse[of][0] * sample.above * sample.above + 2 * inverse[of][1] * sample.above * sample.slope +
           inverse[of][2] * sample.slope * sample.slope) /
          (variance_ * VarianceOf(sample));
      squares.push_back(left * left / (1 - std::min(taken, kMaxTaken)));
      // Errors grow with the EMG as it is, not with its mean: on the flank of a burst that comes late there
      // is half of it.
      const Vector& shape = shapes_[static_cast<std::size_t>(bursts_[of].recording)];
      const double floor = shape.minCoeff();
      const double there = basis_.Value(sample.phase + found[of][1], shape.data()) - floor;
      sample.emg = std::max(floor, 0.0) + std::exp(found[of][0]) * std::max(there, 0.0);
    }
    SetNoise(squares);
  }

  const std::vector<CycleSamples>& recordings_;
  ShapeBasis basis_;
  double correlated_;
  std::vector<Vector> shapes_;  // [recordings]
  std::vector<BurstSums> bursts_;
  std::vector<Sample> samples_;
  std::vector<Told> told_;
  double trend_share_ = 0;  // of the gains' degrees of freedom that their trend took
  double variance_ = 0;     // of a sample, less gains and timings, over that of the present noise estimate
  CycleScatter out_;
};

}  // namespace

double Scatter::own() const {
  return std::sqrt(std::max(total * total - together * together, 0.0));
}

Result<CycleScatter> EstimateCycleScatter(const std::vector<CycleSamples>& recordings, int knots,
                                          double correlated) {
  if (recordings.empty()) return Fail("no recording");
  return Estimation(recordings, knots, correlated).Run();
}

double SharedTiming(const std::vector<std::vector<CycleTiming>>& muscles) {
  std::map<std::pair<int, int>, std::vector<double>> cycles;  // of each muscle with enough information
  for (const auto& timings : muscles) {
    for (const CycleTiming& of : timings) cycles[{of.recording, of.cycle}].push_back(of.timing);
  }
  double products = 0;
  double pairs = 0;
  for (const auto& [key, means] : cycles) {
    for (std::size_t a = 0; a < means.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        products += means[a] * means[b];
        pairs += 1;
      }
    }
  }
  return pairs > 0 ? std::sqrt(std::max(products / pairs, 0.0)) : 0;
}

}  // namespace sinew
