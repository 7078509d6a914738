#include "cli/data/check_text.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/text/phrases.h"

namespace sinew::text {
namespace {

constexpr std::size_t kShownSpans = 4;

std::string Seconds(double s) {
  return Readable(s, 4) + " s";
}

std::string SpanText(const TimeSpan& span) {
  if (span.from == span.to) return Seconds(span.from);
  return fmt::format("{} to {} s", Readable(span.from, 4), Readable(span.to, 4));
}

std::string SpansText(const Finding& f) {
  std::vector<std::string> spans;
  for (const TimeSpan& span : f.spans) {
    if (spans.size() == kShownSpans) break;
    spans.push_back(SpanText(span));
  }
  const std::string more =
      f.spans.size() > kShownSpans ? fmt::format(" and {} more", f.spans.size() - kShownSpans) : "";
  return Join(spans, ", ") + more;
}

std::string Where(const Finding& f) {
  if (f.channel.empty()) return fmt::format("all of grid '{}' in trial '{}'", f.grid, f.trial);
  return fmt::format("{} in trial '{}'", f.channel, f.trial);
}

std::string Times(std::size_t count) {
  return count == 1 ? "once" : fmt::format("{} times", count);
}

std::string TimeJump(const Finding& f) {
  if (f.whole) {
    return fmt::format(
        "grid '{}' of trial '{}' lasts {} and shares no time with the other grids, the longest of which "
        "lasts {}",
        f.grid, f.trial, Seconds(f.size), Seconds(f.usual));
  }
  return fmt::format("the clock of grid '{}' in trial '{}' jumps {}, at {}: by {} instead of {}", f.grid,
                     f.trial, Times(f.spans.size()), Seconds(f.spans.front().from), Seconds(f.size),
                     Seconds(f.usual));
}

// "next to trial 'b'"; of a channel: that is what the other trials relate it to.
std::string Compared(const Finding& f) {
  if (f.undecided) return "as compared to " + f.other;
  return fmt::format("next to {}, as compared to the other trials", f.other);
}

std::string UnitText(const Finding& f) {
  const std::string compared = f.among > 0 ? fmt::format("as compared to the {} other trials", f.among - 1)
                               : f.other.empty() ? "for its unit " + (f.unit.empty() ? "1" : f.unit)
                                                 : Compared(f);
  return f.size > 1
             ? fmt::format("{} is about {} times too large {}", Where(f), Readable(f.size, 3), compared)
             : fmt::format("{} is about {} times too small {}", Where(f), Readable(1 / f.size, 3), compared);
}

std::string SignText(const Finding& f) {
  if (f.among > 0)
    return fmt::format("{} has the opposite sign of that of the {} other trials", Where(f), f.among - 1);
  if (f.other.empty()) return fmt::format("{} has the wrong sign", Where(f));
  return fmt::format("{} has the opposite sign {} (correlation with what is expected {:.2f}, usual {:.2f})",
                     Where(f), Compared(f), f.size, f.usual);
}

// Of a marker next to the others of its segment, or of a channel that repeats that of other trials.
std::string AwayText(const Finding& f) {
  if (f.among > 0) {
    return fmt::format("{} differs by up to {} ({}) from {}, which it repeats elsewhere within {}", Where(f),
                       WithUnit(f.size, f.unit), SpansText(f), f.other, WithUnit(f.usual, f.unit));
  }
  return fmt::format(
      "{} is away from where the markers of its segment say by up to {} ({}): its distances to {} change by "
      "{} else",
      Where(f), WithUnit(f.size, f.unit), SpansText(f), f.other, WithUnit(f.usual, f.unit));
}

std::string PhraseOf(const Finding& f) {
  switch (f.kind) {
    case FindingKind::kTimeJump:
      return TimeJump(f);
    case FindingKind::kDropout:
      return fmt::format("{} drops out {} ({}): it jumps by {} to one value and back", Where(f),
                         Times(f.spans.size()), SpansText(f), WithUnit(f.size, f.unit));
    case FindingKind::kSpike:
      if (!f.other.empty()) return AwayText(f);
      return fmt::format("{} has {} of up to {} ({})", Where(f),
                         f.spans.size() == 1 ? "a spike" : fmt::format("{} spikes", f.spans.size()),
                         WithUnit(f.size, f.unit), SpansText(f));
    case FindingKind::kDisplaced:
      if (!f.other.empty()) return AwayText(f);
      return fmt::format("{} jumps away by {} and back ({})", Where(f), WithUnit(f.size, f.unit),
                         SpansText(f));
    case FindingKind::kStuck:
      return fmt::format("{} is stuck {} ({}), longest at {} for {}", Where(f), Times(f.spans.size()),
                         SpansText(f), WithUnit(f.size, f.unit), Seconds(f.usual));
    case FindingKind::kClipping:
      return fmt::format("{} is clipped at {}, {} of its samples ({})", Where(f), WithUnit(f.size, f.unit),
                         Percent(f.usual), SpansText(f));
    case FindingKind::kUnit:
      return UnitText(f);
    case FindingKind::kSign:
      return SignText(f);
    case FindingKind::kAxis:
      return fmt::format("{} is measured along another axis: it agrees with {}", Where(f), f.other);
    case FindingKind::kLag:
      return fmt::format("{} is out of step with {}: {} {}{} ({})", Where(f), f.other,
                         Seconds(std::abs(f.size - f.usual)), f.size > f.usual ? "late" : "early",
                         f.usual == 0 ? "" : fmt::format(", usual are {}", Seconds(f.usual)), SpansText(f));
    case FindingKind::kDrift:
      return fmt::format("the level of {} at rest drifts by {} ({}), its scatter there is {}", Where(f),
                         WithUnit(f.size, f.unit), SpansText(f), WithUnit(f.usual, f.unit));
    case FindingKind::kOddCycle:
      return fmt::format(
          "{} of {} cycles of {} are unlike the others ({}): they differ by up to {} RMS, usual are {}",
          f.spans.size(), f.among, Where(f), SpansText(f), WithUnit(f.size, f.unit),
          WithUnit(f.usual, f.unit));
    case FindingKind::kOddTrial:
      return fmt::format("{} is unlike that of the {} other trials: it differs by {} RMS, usual are {}",
                         Where(f), f.among - 1, WithUnit(f.size, f.unit), WithUnit(f.usual, f.unit));
    case FindingKind::kTwoFeet:
      return fmt::format(
          "in trial '{}' a second foot is on plate '{}' {} of {} times ({}): it is loaded for up to {}, "
          "usual are {}",
          f.trial, f.other, f.spans.size(), f.among, SpansText(f), Seconds(f.size), Seconds(f.usual));
    case FindingKind::kInconsistent:
      return fmt::format("{} and {} are no rotation: their norm differs from 1 by up to {} ({})", Where(f),
                         f.other, Readable(f.size, 3), SpansText(f));
    case FindingKind::kNothingUsable:
      return "no training trial has a usable measured channel left";
  }
  return {};
}

std::string Advice(const Finding& f) {
  switch (f.kind) {
    case FindingKind::kTimeJump:
      return f.whole ? "state the unit of the times in the import map, or export all grids of a trial with "
                       "one clock"
                     : "cut the trial there, or export it again";
    case FindingKind::kDropout:
    case FindingKind::kSpike:
    case FindingKind::kDisplaced:
    case FindingKind::kStuck:
      return "replace it by a gap";
    case FindingKind::kClipping:
      return "record with a larger range, or leave these samples out: where it is clipped only a bound is "
             "known";
    case FindingKind::kUnit:
      return "state the unit in the import map";
    case FindingKind::kSign:
      return "import it with scale: -1, or leave the trial out";
    case FindingKind::kAxis:
      return "rename the channels on import; OpenSim's axes are x forward, y up, z right";
    case FindingKind::kLag:
      return "shift its times before the import, or leave the trial out; a time offset can also be fitted as "
             "an effect";
    case FindingKind::kDrift:
      return "subtract the level at rest, or fit an offset or a drift as an effect";
    case FindingKind::kOddCycle:
    case FindingKind::kOddTrial:
      return "look at what was measured there; a gap is better than a wrong value";
    case FindingKind::kTwoFeet:
      return "leave these steps out";
    case FindingKind::kInconsistent:
      return "one of the four is wrong there: look which, and replace it by a gap";
    case FindingKind::kNothingUsable:
      return "correct the import as stated above, give another trial the role train, or record again";
  }
  return {};
}

}  // namespace

std::string FindingPhrase(const Finding& finding) {
  return PhraseOf(finding);
}

std::string FindingText(const Finding& finding) {
  return Capitalised(PhraseOf(finding)) + ".";
}

std::string AdviceText(const Finding& finding) {
  const std::string undecided =
      finding.undecided ? fmt::format("either that or {} is wrong; ", finding.other) : "";
  return Capitalised(undecided + Advice(finding)) + ".";
}

std::string MaskText(const std::vector<MaskedSpan>& mask) {
  if (mask.empty()) return {};
  std::set<std::string> channels;
  std::set<std::string> trials;
  double seconds = 0;
  for (const MaskedSpan& m : mask) {
    channels.insert(m.channel);
    trials.insert(m.trial);
    seconds += m.span.to - m.span.from;
  }
  return fmt::format("{} of {} in {}, {} in all",
                     mask.size() == 1 ? "1 span" : fmt::format("{} spans", mask.size()),
                     Some({channels.begin(), channels.end()}),
                     trials.size() == 1 ? fmt::format("trial '{}'", *trials.begin())
                                        : fmt::format("{} trials", trials.size()),
                     Seconds(seconds));
}

}  // namespace sinew::text
