#include "datasets/check/odd_cycles.h"

#include <algorithm>
#include <cmath>

#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kOddPhases = 60;     // samples per cycle
constexpr std::size_t kOddShift = 5;       // largest shift that aligns a piece with the median, in phases
constexpr double kOddSize = 0.15;          // largest difference in size that is taken off [logarithm]
constexpr double kOddSizeDeviations = 3;   // the same in robust deviations of the logarithms of the sizes
constexpr double kOddMostSize = 1.2;       // and at most: a factor of 3.3
constexpr double kOddSizeShare = 0.75;     // of the phases, those that differ least, tell the size
constexpr double kOddDeviations = 5;       // robust standard deviations of the logarithm
constexpr double kOddFew = 5;              // of so many cycles twice as many
constexpr double kOddLeastScatter = 0.1;   // of the logarithm
constexpr double kOddFactor = 2;           // of the median deviation
constexpr double kOddFactorOfScaled = 3;   // the same in terms of the usual deviation at each phase
constexpr double kOddFactorOfLocal = 3.5;  // the same of the tenth of the cycle that deviates most
constexpr double kOddPlainOfLocal = 1.5;   // and of its deviation as it is
constexpr double kOddShareOfRange = 0.05;  // of the median cycle's range: smaller deviations spoil nothing
constexpr double kOddPeakOfRange = 0.2;    // the same of the largest deviation at a phase
constexpr double kOddLeastScatterOfPhase = 0.5;  // of the median scatter over the phases
constexpr double kOddSpan = 0.98;                // of a cycle's squared deviation that its span holds
constexpr int kOddPasses = 3;
constexpr std::size_t kOddFewestTrials = 8;
constexpr double kOddDuration = 0.35;  // largest difference from the median duration

using Phases = std::vector<double>;  // [kOddPhases]
using Wide = std::vector<double>;    // [kOddPhases + 2 kOddShift], with neighbours

struct OddPiece {
  std::size_t index;
  double deviation;
  double first;  // [0, 1] of its duration: where it deviates
  double last;
};

struct OddPieces {
  std::vector<OddPiece> pieces;
  double usual = 0;
};

// Where most of the squared deviation is.
void SetSpan(const Phases& squares, OddPiece& piece) {
  double all = 0;
  for (const double s : squares) all += s;
  const double leave = 0.5 * (1 - kOddSpan) * all;
  double before = 0;
  std::size_t first = 0;
  while (first < kOddPhases - 1 && before + squares[first] < leave) before += squares[first++];
  double after = 0;
  std::size_t last = kOddPhases - 1;
  while (last > first && after + squares[last] < leave) after += squares[last--];
  piece.first = std::max(0.0, (static_cast<double>(first) - 1) / kOddPhases);
  piece.last = std::min(1.0, (static_cast<double>(last) + 2) / kOddPhases);
}

// Median over the pieces at each phase, and their robust deviation from it; NaN where most have gaps.
struct OddMiddle {
  Phases middle;
  Phases scatter;
  double range = 0;
};

OddMiddle MiddleOf(const std::vector<Phases>& pieces) {
  OddMiddle m;
  for (std::size_t i = 0; i < kOddPhases; ++i) {
    std::vector<double> at;
    for (const Phases& piece : pieces) at.push_back(piece[i]);
    const auto finite = Finite(at);
    const bool known = 2 * finite.size() > at.size();
    m.middle.push_back(known ? Median(finite) : NAN);
    m.scatter.push_back(known ? RobustDeviation(finite) : NAN);
  }
  const auto known = Finite(m.middle);
  if (known.empty()) return m;
  const auto [low, high] = std::minmax_element(known.begin(), known.end());
  m.range = *high - *low;
  // Phases at which nothing usually happens: deviations there count against those of the other phases as
  // well.
  const double typical = Median(Finite(m.scatter));
  for (double& s : m.scatter) s = std::max(s, kOddLeastScatterOfPhase * typical);
  return m;
}

// Squared deviations of a piece at each phase, of its values divided by `unit` of the phase; 0 where unknown.
Phases Squares(const Phases& piece, const Phases& middle, const Phases* unit) {
  Phases squares(kOddPhases, 0);
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const double difference = (piece[i] - middle[i]) / (unit != nullptr ? (*unit)[i] : 1);
    if (std::isfinite(difference)) squares[i] = difference * difference;
  }
  return squares;
}

// Root of the largest mean of neighbouring squares, a tenth of the piece.
double LargestLocal(const Phases& squares) {
  constexpr std::size_t kWidth = kOddPhases / 10;
  double largest = 0;
  for (std::size_t i = 0; i + kWidth <= squares.size(); ++i) {
    double sum = 0;
    for (std::size_t j = i; j < i + kWidth; ++j) sum += squares[j];
    largest = std::max(largest, sum / kWidth);
  }
  return std::sqrt(largest);
}

// Few pieces tell their scatter roughly: of nine the limit is twice that of many.
double Widened(std::size_t pieces) {
  const double share = kOddFew / static_cast<double>(pieces);
  return 1 + share + 2.7 * share * share * share;
}

// The limit of the deviations, or infinity if they do not tell.
double LimitOf(const std::vector<double>& deviations) {
  std::vector<double> logs;
  for (const double d : deviations) {
    if (d > 0) logs.push_back(std::log(d));
  }
  if (2 * logs.size() <= deviations.size()) return INFINITY;
  const double typical = Median(logs);
  const double scatter = std::max(RobustDeviation(logs), kOddLeastScatter);
  const double limit = kOddDeviations * Widened(logs.size());
  return std::exp(typical + std::max(limit * scatter, std::log(kOddFactor)));
}

// The phases from `shift` on, straight between those of the wide piece. @param shift [0, 2 kOddShift]
Phases Shifted(const Wide& wide, double shift) {
  const auto whole = std::min(static_cast<std::size_t>(shift), 2 * kOddShift - 1);
  const double part = shift - static_cast<double>(whole);
  Phases phases(kOddPhases);
  for (std::size_t i = 0; i < kOddPhases; ++i) {
    const double here = wide[i + whole];
    phases[i] = part == 0 ? here : here + part * (wide[i + whole + 1] - here);
  }
  return phases;
}

double MeanSquare(const Phases& piece, const Phases& middle) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < kOddPhases; ++i) {
    const double difference = piece[i] - middle[i];
    if (!std::isfinite(difference)) continue;
    sum += difference * difference;
    count += 1;
  }
  return 2 * count < kOddPhases / 2.0 ? INFINITY : sum / count;
}

// Size of a piece against the median, about its level. The phases that differ most, where a fault may be, do
// not decide. NaN if it is not known.
double SizeOf(const Phases& middle, double level, const Phases& piece) {
  double gain = 1;
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> differences(kOddPhases, NAN);
    for (std::size_t i = 0; i < kOddPhases; ++i)
      differences[i] = std::abs(piece[i] - level - gain * (middle[i] - level));
    const auto finite = Finite(differences);
    if (finite.size() < kOddPhases / 3) return NAN;
    const double most = Quantile(finite, kOddSizeShare);
    double ab = 0;
    double aa = 0;
    for (std::size_t i = 0; i < kOddPhases; ++i) {
      if (!(differences[i] <= most)) continue;
      ab += (piece[i] - level) * (middle[i] - level);
      aa += (middle[i] - level) * (middle[i] - level);
    }
    if (!(aa > 0)) return NAN;
    gain = std::clamp(ab / aa, std::exp(-kOddMostSize), std::exp(kOddMostSize));
  }
  return gain;
}

// Takes off what pieces differ from the median in size only: no two steps are of one size. Within +-15 %, or
// as much as the sizes usually differ: the activity of a muscle doubles from one step to the next, a moment
// does not.
void TakeOffSizes(const Phases& middle, std::vector<Phases>& pieces) {
  const double level = Median(Finite(middle));
  std::vector<double> gains;
  std::vector<double> logs;
  for (const Phases& piece : pieces) {
    gains.push_back(SizeOf(middle, level, piece));
    if (std::isfinite(gains.back())) logs.push_back(std::log(gains.back()));
  }
  if (logs.empty()) return;
  const double limit =
      std::clamp(kOddSizeDeviations * Widened(logs.size()) * RobustDeviation(logs), kOddSize, kOddMostSize);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (!std::isfinite(gains[k])) continue;
    const double gain = std::clamp(gains[k], std::exp(-limit), std::exp(limit));
    for (std::size_t i = 0; i < kOddPhases; ++i) pieces[k][i] -= (gain - 1) * (middle[i] - level);
  }
}

// Each piece moved to where it resembles the median most: steps vary in time, and their starts are not exact.
std::vector<Phases> Aligned(const std::vector<Wide>& wide) {
  std::vector<Phases> pieces;
  pieces.reserve(wide.size());
  for (const Wide& w : wide) pieces.push_back(Shifted(w, kOddShift));
  for (int pass = 0; pass < 2; ++pass) {
    const Phases middle = MiddleOf(pieces).middle;
    for (std::size_t k = 0; k < wide.size(); ++k) {
      std::vector<double> squares;
      for (std::size_t shift = 0; shift <= 2 * kOddShift; ++shift)
        squares.push_back(MeanSquare(Shifted(wide[k], static_cast<double>(shift)), middle));
      const auto least =
          static_cast<std::size_t>(std::min_element(squares.begin(), squares.end()) - squares.begin());
      if (!std::isfinite(squares[least])) continue;
      double shift = static_cast<double>(least);
      if (least > 0 && least < 2 * kOddShift) {
        // The lowest point of the parabola through three.
        const double bend = squares[least - 1] - 2 * squares[least] + squares[least + 1];
        if (bend > 0 && std::isfinite(bend)) shift += 0.5 * (squares[least - 1] - squares[least + 1]) / bend;
      }
      pieces[k] = Shifted(wide[k], shift);
    }
  }
  const Phases middle = MiddleOf(pieces).middle;
  if (Finite(middle).empty()) return pieces;
  TakeOffSizes(middle, pieces);
  return pieces;
}

// How much each piece deviates from the median.
struct OddMeasures {
  std::vector<double> plain;    // RMS as it is, which makes the squared error
  std::vector<double> scaled;   // in terms of what is usual at each phase
  std::vector<double> local;    // the same of the tenth of the piece that deviates most
  std::vector<double> largest;  // at any phase
};

OddMeasures Measure(const std::vector<Phases>& pieces, const OddMiddle& m) {
  OddMeasures measures;
  for (const Phases& piece : pieces) {
    double count = 0;
    for (std::size_t i = 0; i < kOddPhases; ++i) count += std::isfinite(piece[i] - m.middle[i]) ? 1 : 0;
    const bool known = count > kOddPhases / 10.0;
    const auto rms = [&](const Phases& squares) {
      double sum = 0;
      for (const double s : squares) sum += s;
      return known ? std::sqrt(sum / count) : NAN;
    };
    const Phases squares = Squares(piece, m.middle, nullptr);
    const Phases scaled = Squares(piece, m.middle, &m.scatter);
    measures.plain.push_back(rms(squares));
    measures.scaled.push_back(rms(scaled));
    measures.local.push_back(known ? LargestLocal(scaled) : NAN);
    measures.largest.push_back(std::sqrt(*std::max_element(squares.begin(), squares.end())));
  }
  return measures;
}

// The values of the pieces that are not odd.
template <class T>
std::vector<T> WithoutOdd(const std::vector<T>& all, const std::vector<bool>& odd) {
  std::vector<T> others;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!odd[k]) others.push_back(all[k]);
  }
  return others;
}

double UsualOf(const std::vector<double>& values) {
  const auto known = Finite(values);
  return known.empty() ? 0 : Median(known);
}

// Pieces that are odd by what is usual among those that are not.
OddPieces FindOddOnce(const std::vector<Phases>& pieces, const std::vector<bool>& known_odd) {
  const OddMiddle m = MiddleOf(WithoutOdd(pieces, known_odd));
  if (Finite(m.middle).size() < kOddPhases / 10 || !(m.range > 0)) return {};
  const OddMeasures all = Measure(pieces, m);
  const auto plain = WithoutOdd(all.plain, known_odd);
  const auto scaled = WithoutOdd(all.scaled, known_odd);
  const auto local = WithoutOdd(all.local, known_odd);
  OddPieces odd;
  odd.usual = UsualOf(plain);
  const double plain_limit = std::max(LimitOf(plain), kOddShareOfRange * m.range);
  const double scaled_limit = std::max(LimitOf(scaled), kOddFactorOfScaled * UsualOf(scaled));
  const double local_limit = std::max(LimitOf(local), kOddFactorOfLocal * UsualOf(local));
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const bool is_large = all.largest[k] > kOddPeakOfRange * m.range;
    const bool is_scaled = all.scaled[k] > scaled_limit && is_large && all.plain[k] > kOddFactor * odd.usual;
    const bool is_local =
        all.local[k] > local_limit && is_large && all.plain[k] > kOddPlainOfLocal * odd.usual;
    if (!(all.plain[k] > plain_limit) && !is_scaled && !is_local) continue;
    OddPiece piece{k, all.plain[k], 0, 1};
    SetSpan(Squares(pieces[k], m.middle, is_scaled || is_local ? &m.scatter : nullptr), piece);
    odd.pieces.push_back(piece);
  }
  return odd;
}

// Those that were found are left out of what is usual, and the rest is judged again.
OddPieces FindOdd(const std::vector<Wide>& wide) {
  const std::vector<Phases> pieces = Aligned(wide);
  std::vector<bool> known_odd(pieces.size(), false);
  OddPieces odd;
  for (int pass = 0; pass < kOddPasses; ++pass) {
    OddPieces now = FindOddOnce(pieces, known_odd);
    const std::size_t before = odd.pieces.size();
    // More than a third are no exceptions.
    if (3 * now.pieces.size() > pieces.size()) break;
    odd = std::move(now);
    known_odd.assign(pieces.size(), false);
    for (const OddPiece& piece : odd.pieces) known_odd[piece.index] = true;
    if (odd.pieces.size() == before) break;
  }
  return odd;
}

Wide PhasesOf(const Signal& signal, double from, double to) {
  Wide phases;
  for (int i = -static_cast<int>(kOddShift); i < static_cast<int>(kOddPhases + kOddShift); ++i)
    phases.push_back(ValueAt(*signal.time, signal.values,
                             from + (to - from) * (static_cast<double>(i) + 0.5) / kOddPhases));
  return phases;
}

// The first and last cycles of a recording, when the movement starts and ends, are rightly unlike the others.
void LeaveOutEnds(std::size_t count, std::vector<OddPiece>& odd) {
  std::size_t begin = 0;
  while (begin < odd.size() && odd[begin].index == begin) ++begin;
  std::size_t end = odd.size();
  while (end > begin && odd[end - 1].index + (odd.size() - end) + 1 == count) --end;
  odd = {odd.begin() + static_cast<std::ptrdiff_t>(begin), odd.begin() + static_cast<std::ptrdiff_t>(end)};
}

}  // namespace

std::vector<Finding> FindOddCycles(const Signal& signal, const Cycles& cycles) {
  std::vector<Wide> pieces;
  for (int k = 0; k < cycles.count(); ++k)
    pieces.push_back(PhasesOf(signal, cycles.starts[static_cast<std::size_t>(k)],
                              cycles.starts[static_cast<std::size_t>(k) + 1]));
  OddPieces odd = FindOdd(pieces);
  LeaveOutEnds(pieces.size(), odd.pieces);
  if (odd.pieces.empty()) return {};
  Finding finding = signal.Found(FindingKind::kOddCycle);
  finding.usual = odd.usual;
  finding.among = cycles.count();
  for (const OddPiece& piece : odd.pieces) {
    const double from = cycles.starts[piece.index];
    const double length = cycles.starts[piece.index + 1] - from;
    finding.spans.push_back({from + piece.first * length, from + piece.last * length});
    finding.size = std::max(finding.size, piece.deviation);
  }
  return {finding};
}

std::vector<Finding> FindOddTrials(const ChannelGroup& group) {
  if (group.signals.size() < kOddFewestTrials) return {};
  std::vector<double> durations;
  for (const Signal& signal : group.signals) durations.push_back(signal.Whole().to - signal.Whole().from);
  const double usual_duration = Median(durations);
  std::vector<Wide> pieces;
  std::vector<const Signal*> alike;
  for (std::size_t s = 0; s < group.signals.size(); ++s) {
    if (std::abs(durations[s] - usual_duration) > kOddDuration * usual_duration) continue;
    const Signal& signal = group.signals[s];
    pieces.push_back(PhasesOf(signal, signal.Whole().from, signal.Whole().to));
    alike.push_back(&signal);
  }
  if (alike.size() < kOddFewestTrials) return {};
  const OddPieces odd = FindOdd(pieces);
  std::vector<Finding> found;
  for (const OddPiece& piece : odd.pieces) {
    Finding finding = alike[piece.index]->Found(FindingKind::kOddTrial);
    finding.usual = odd.usual;
    finding.size = piece.deviation;
    finding.among = static_cast<int>(alike.size());
    finding.whole = true;
    finding.spans = {alike[piece.index]->Whole()};
    found.push_back(std::move(finding));
  }
  return found;
}

}  // namespace sinew
