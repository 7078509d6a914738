#include "models/emg/cycles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/numbers.h"
#include "models/emg/cycle_alignment.h"
#include "models/emg/movement_period.h"
#include "models/emg/turning_points.h"

namespace sinew {
namespace {

constexpr std::size_t kMinSamples = 16;
constexpr double kTail = 0.02;            // of the samples, beyond the range's ends
constexpr double kRangeOfNoise = 12;      // standard deviations: a swing is then at least 6 of them
constexpr double kSmallSwing = 0.02;      // of the range: what counts for the speed
constexpr double kOftenIrregular = 0.05;  // of the turning points
constexpr double kClockGap = 1.5;         // median steps

// The last sample before a gap and the first one behind.
struct Gap {
  double from_s = 0;
  double to_s = 0;
};

// The samples from the first to the last that are numbers, with lines across gaps.
struct CleanAngle {
  std::vector<double> time;
  std::vector<double> angle;
  std::vector<Gap> gaps;  // longer than the setting allows
  double low = 0;         // the range
  double high = 0;
};

Status CheckTime(const std::vector<double>& time, const std::vector<double>& angle) {
  if (time.size() != angle.size())
    return Fail("{} times for {} angles, expected as many", time.size(), angle.size());
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (!std::isfinite(time[k])) return Fail("time {} is {}, expected a finite number", k, time[k]);
    if (k > 0 && !(time[k] > time[k - 1]))
      return Fail("time does not increase after sample {} (t = {} s)", k - 1, Readable(time[k - 1], 4));
  }
  return {};
}

double Quantile(std::vector<double>& values, double share) {
  const double place = std::round(share * static_cast<double>(values.size() - 1));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Result<CleanAngle> Clean(const std::vector<double>& time, const std::vector<double>& angle,
                         double longest_gap_s) {
  SINEW_TRY(CheckTime(time, angle));
  CleanAngle clean;
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (!std::isfinite(angle[k])) continue;
    clean.time.push_back(time[k]);
    clean.angle.push_back(angle[k]);
  }
  if (clean.time.size() < kMinSamples) {
    return Fail("{} of {} angles are numbers, expected at least {}", clean.time.size(), time.size(),
                kMinSamples);
  }
  if (!std::isfinite(time.back() - time.front())) return Fail("times are too large");
  std::vector<double> sorted;
  sorted.reserve(time.size());
  for (std::size_t k = 1; k < time.size(); ++k) sorted.push_back(time[k] - time[k - 1]);
  const double step = Quantile(sorted, 0.5);
  for (std::size_t k = 1; k < clean.time.size(); ++k) {
    const double between = clean.time[k] - clean.time[k - 1];
    // What is missing between two samples is a step less than their distance.
    if (between > kClockGap * step && between - step > longest_gap_s)
      clean.gaps.push_back({clean.time[k - 1], clean.time[k]});
  }
  sorted = clean.angle;
  clean.low = Quantile(sorted, kTail);
  clean.high = Quantile(sorted, 1 - kTail);
  return clean;
}

// Distance that the angle goes between samples, without what noise adds.
class Path {
 public:
  explicit Path(const std::vector<TurningPoint>& points) : points_(points) {}

  // From one turning point to another; calls go forward.
  double Between(const TurningPoint& from, const TurningPoint& to) {
    while (next_ < points_.size() && points_[next_].sample <= from.sample) ++next_;
    double path = 0;
    double last = from.angle;
    for (; next_ < points_.size() && points_[next_].sample < to.sample; ++next_) {
      path += std::abs(points_[next_].angle - last);
      last = points_[next_].angle;
    }
    return path + std::abs(to.angle - last);
  }

 private:
  const std::vector<TurningPoint>& points_;
  std::size_t next_ = 0;
};

struct Candidate {
  TurningPoint begin;
  TurningPoint reversal;
  TurningPoint end;
};

bool MoreExtreme(const TurningPoint& a, const TurningPoint& b) {
  return a.highest ? a.angle > b.angle : a.angle < b.angle;
}

// From each beginning to the next, over the most extreme point between them.
std::vector<Candidate> Pair(const std::vector<TurningPoint>& points, bool from_highest, double shortest_s) {
  std::vector<std::size_t> beginnings;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].highest != from_highest) continue;
    if (!beginnings.empty() && points[i].time_s - points[beginnings.back()].time_s < shortest_s) {
      if (MoreExtreme(points[i], points[beginnings.back()])) beginnings.back() = i;
      continue;
    }
    beginnings.push_back(i);
  }
  std::vector<Candidate> candidates;
  for (std::size_t i = 1; i < beginnings.size(); ++i) {
    std::size_t reversal = beginnings[i - 1] + 1;
    for (std::size_t k = reversal; k < beginnings[i]; ++k)
      if (points[k].highest != from_highest && MoreExtreme(points[k], points[reversal])) reversal = k;
    candidates.push_back({points[beginnings[i - 1]], points[reversal], points[beginnings[i]]});
  }
  return candidates;
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const double upper = Quantile(values, 0.5);
  if (values.size() % 2 == 1) return upper;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

LeftOutCycle Incomplete(double begin_s, double end_s, const char* which) {
  return {begin_s, end_s, CycleFault::kIncomplete,
          fmt::format("The {} s from {} to {} s are no complete cycle: the recording {} there.",
                      Readable(end_s - begin_s), Readable(begin_s, 4), Readable(end_s, 4), which)};
}

LeftOutCycle WithGap(const Candidate& c, const Gap& gap) {
  return {c.begin.time_s, c.end.time_s, CycleFault::kGap,
          fmt::format("The cycle from {} to {} s is left out: no angle between {} and {} s.",
                      Readable(c.begin.time_s, 4), Readable(c.end.time_s, 4), Readable(gap.from_s, 4),
                      Readable(gap.to_s, 4))};
}

LeftOutCycle OddDuration(const Candidate& c, double median_s, double tolerance) {
  const double duration_s = c.end.time_s - c.begin.time_s;
  return {c.begin.time_s, c.end.time_s, CycleFault::kDuration,
          fmt::format("The cycle from {} to {} s is left out: it takes {} s, {:.0f} % {} than the median of "
                      "{} s, more than the {:.0f} % that are allowed.",
                      Readable(c.begin.time_s, 4), Readable(c.end.time_s, 4), Readable(duration_s),
                      100 * std::abs(duration_s / median_s - 1), duration_s > median_s ? "more" : "less",
                      Readable(median_s), 100 * tolerance)};
}

void Judge(const std::vector<Candidate>& candidates, const CleanAngle& clean, const CycleSettings& settings,
           Path path, CycleFindings& findings) {
  std::vector<const Gap*> spoilt(candidates.size(), nullptr);
  std::vector<double> durations;
  auto gap = clean.gaps.begin();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    // The gap that ends first behind the beginning; one that lies at a turning point spoils both cycles.
    while (gap != clean.gaps.end() && gap->to_s <= candidates[i].begin.from_s) ++gap;
    if (gap != clean.gaps.end() && gap->from_s < candidates[i].end.to_s)
      spoilt[i] = &*gap;
    else
      durations.push_back(candidates[i].end.time_s - candidates[i].begin.time_s);
  }
  const double median = findings.median_duration_s = Median(std::move(durations));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    const double duration_s = c.end.time_s - c.begin.time_s;
    if (spoilt[i] != nullptr) {
      findings.left_out.push_back(WithGap(c, *spoilt[i]));
    } else if (!(std::abs(duration_s - median) <= settings.duration_tolerance * median)) {
      findings.left_out.push_back(OddDuration(c, median, settings.duration_tolerance));
    } else {
      const double way = path.Between(c.begin, c.reversal) + path.Between(c.reversal, c.end);
      findings.cycles.push_back({c.begin.time_s, c.reversal.time_s, c.end.time_s, way / duration_s});
    }
  }
}

std::vector<std::string> Doubts(const CycleFindings& findings, const AlignedPoints& aligned,
                                const CycleSettings& settings) {
  std::vector<std::string> doubts;
  const double cycle_s = findings.median_duration_s;
  const double period_s = findings.period_s;
  if (period_s > 0 && !(cycle_s > 0)) {
    doubts.push_back(
        fmt::format("The movement repeats every {} s, but its turns are smaller than the swing that counts.",
                    Readable(period_s)));
  } else if (period_s > 0 && std::abs(cycle_s - period_s) > settings.duration_tolerance * period_s) {
    doubts.push_back(fmt::format(
        "The movement repeats every {} s, but the cycles that were found take {} s: {}.", Readable(period_s),
        Readable(cycle_s),
        cycle_s < period_s
            ? "a cycle may have several high points (a larger swing or a shortest duration separates them)"
            : "some turns may have been too small (a smaller swing finds them)"));
  }
  const double allowed = static_cast<double>(aligned.irregular_reversals) +
                         kOftenIrregular * static_cast<double>(aligned.points.size());
  if (static_cast<double>(aligned.irregular_beginnings) > allowed) {
    const bool highest = settings.begins_at == CycleBegin::kHighest;
    doubts.push_back(
        fmt::format("The {} angle comes at irregular times ({} intervals differ by over 10 % from the "
                    "median), the {} one "
                    "does not ({}): cycles that begin there would be more alike.",
                    highest ? "highest" : "lowest", aligned.irregular_beginnings,
                    highest ? "lowest" : "highest", aligned.irregular_reversals));
  }
  return doubts;
}

}  // namespace

Status CheckCycleSettings(const CycleSettings& settings) {
  if (!(settings.swing >= 0.05 && settings.swing <= 0.9))
    return Fail("swing {}: expected a share of the range from 0.05 to 0.9", settings.swing);
  if (!(settings.shortest_s >= 0))
    return Fail("shortest cycle {} s: expected 0 or more", settings.shortest_s);
  if (!(settings.duration_tolerance > 0))
    return Fail("duration tolerance {}: expected more than 0", settings.duration_tolerance);
  if (!(settings.longest_gap_s >= 0))
    return Fail("longest gap {} s: expected 0 or more", settings.longest_gap_s);
  return {};
}

Result<CycleFindings> FindCycles(const std::vector<double>& time, const std::vector<double>& angle,
                                 const CycleSettings& settings) {
  SINEW_TRY(CheckCycleSettings(settings));
  SINEW_ASSIGN(const CleanAngle clean, Clean(time, angle, settings.longest_gap_s));
  const double range = clean.high - clean.low;
  CycleFindings findings;
  findings.noise = NoiseOfAngle(clean.angle);
  if (!(range > 0)) return Fail("the angle never changes, expected a movement");
  if (!std::isfinite(range))
    return Fail("angles from {:.3g} to {:.3g} are no movement", clean.low, clean.high);
  if (range < kRangeOfNoise * findings.noise) {
    return Fail(
        "the angle changes by {} and its noise has a standard deviation of {}, expected at least {} times "
        "as much movement",
        Readable(range), Readable(findings.noise), kRangeOfNoise);
  }

  const bool from_highest = settings.begins_at == CycleBegin::kHighest;
  const auto turns = [&](double share) {
    return FindTurningPoints(clean.time, clean.angle,
                             std::max(share * range, 0.5 * kRangeOfNoise * findings.noise), findings.noise);
  };
  const std::vector<TurningPoint> small = turns(kSmallSwing);
  const AlignedPoints aligned = AlignBeginnings(turns(settings.swing), small, from_highest, range);
  findings.moved = aligned.moved;
  findings.phase = aligned.phase;
  const auto candidates = Pair(aligned.points, from_highest, settings.shortest_s);
  const double first_s = clean.time.front();
  const double last_s = clean.time.back();
  findings.left_out.push_back(
      candidates.empty()
          ? LeftOutCycle{first_s, last_s, CycleFault::kIncomplete,
                         fmt::format("The {} s from {} to {} s hold no complete cycle.",
                                     Readable(last_s - first_s), Readable(first_s, 4), Readable(last_s, 4))}
          : Incomplete(first_s, candidates.front().begin.time_s, "begins"));
  Judge(candidates, clean, settings, Path(small), findings);
  if (!candidates.empty())
    findings.left_out.push_back(Incomplete(candidates.back().end.time_s, last_s, "ends"));
  findings.period_s = FindMovementPeriod(time, angle).period_s;
  findings.doubts = Doubts(findings, aligned, settings);
  return findings;
}

std::size_t CountLeftOut(const CycleFindings& findings, CycleFault fault) {
  return static_cast<std::size_t>(
      std::count_if(findings.left_out.begin(), findings.left_out.end(),
                    [fault](const LeftOutCycle& cycle) { return cycle.fault == fault; }));
}

std::vector<std::string> DescribeCycles(const CycleFindings& findings) {
  std::vector<std::string> sentences;
  sentences.push_back(
      findings.cycles.empty()
          ? "No cycle was found."
          : fmt::format("{} cycle{} found, median {} s; left out: {} incomplete, {} with gaps, {} of another "
                        "duration.",
                        findings.cycles.size(), findings.cycles.size() == 1 ? "" : "s",
                        Readable(findings.median_duration_s), CountLeftOut(findings, CycleFault::kIncomplete),
                        CountLeftOut(findings, CycleFault::kGap),
                        CountLeftOut(findings, CycleFault::kDuration)));
  if (findings.moved > 0) {
    sentences.push_back(fmt::format(
        "The angle has several turning points of this kind in a cycle that are almost equal: {} beginnings "
        "are "
        "not the most extreme one, so that all lie at {:.0f} % of the way from one reversal to the next.",
        findings.moved, 100 * findings.phase));
  }
  for (const LeftOutCycle& cycle : findings.left_out) sentences.push_back(cycle.reason);
  sentences.insert(sentences.end(), findings.doubts.begin(), findings.doubts.end());
  return sentences;
}

}  // namespace sinew
