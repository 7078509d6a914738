#include "identify/diagnosis/wording.h"

#include <algorithm>
#include <cmath>

#include "base/numbers.h"
#include "base/text.h"

namespace sinew {
namespace {

std::string Percent(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

std::string Chance(double p) {
  return p < 0.001 ? "p < 0.001" : fmt::format("p = {:.2g}", p);
}

std::string Unit(const std::string& unit) {
  return unit == "1" ? "" : " " + unit;
}

std::string Headline(const Diagnosis& d) {
  switch (d.verdict) {
    case DiagnosisVerdict::kAdequate:
      return fmt::format(
          "Adequate: no effect in the library improves the fit beyond chance (family-wise {}).",
          Chance(d.family_p_value));
    case DiagnosisVerdict::kExplained:
    case DiagnosisVerdict::kAmbiguous:
      return fmt::format(
          "Something is wrong (family-wise {}), and {}.", Chance(d.family_p_value),
          d.verdict == DiagnosisVerdict::kExplained
              ? (d.causes.size() == 1 ? "one known cause explains it"
                                      : fmt::format("{} known causes explain it", d.causes.size()))
              : "more than one known cause could explain it");
    case DiagnosisVerdict::kUnexplained:
      if (d.strongly_autocorrelated)
        return "Unexplained: the residual wanders much farther than from one sample to the next, which noise "
               "of instruments rarely does; no known effect explains it, and no test can tell it from noise.";
      return fmt::format(
          "Unexplained: something is wrong (family-wise {}), and {}.", Chance(d.family_p_value),
          d.causes.empty() ? "no known effect explains it" : "the known effects do not explain all of it");
  }
  return {};
}

std::string GainSentence(const Gain& gain) {
  std::string text =
      fmt::format("Held-out trials, {}: {}{} -> {}{} RMSE ({:+.0f} %, 95 % interval {:+.0f} .. {:+.0f} %)",
                  gain.channel, Readable(gain.before), Unit(gain.unit), Readable(gain.after), Unit(gain.unit),
                  -100 * gain.reduction, -100 * gain.ci95[1], -100 * gain.ci95[0]);
  if (std::isfinite(gain.gap_closed) && gain.gap_closed > 0)
    text += fmt::format("; {} of the way to the noise floor", Percent(gain.gap_closed));
  return text + ".";
}

std::string AlternativeSentence(const Cause& cause, const Alternative& other) {
  std::string text =
      fmt::format("{} [{}]: {} ({}); {}; delta LR {:.1f}.",
                  other.contains_cause ? "A richer law fits as well" : "Could also be", ToString(other.level),
                  other.sentence, other.effect, DescribeParameters(other.parameters), other.delta_lr);
  if (other.contains_cause)
    return text + " It contains the cause as a special case; what it adds is not needed.";
  text += other.same_class ? std::string(" The two leave nearly the same trace")
                           : fmt::format(" The traces correlate {:.2f}", other.correlation);
  if (std::isfinite(other.separating_size) && cause.size > 0 && other.separating_size > cause.size) {
    text += fmt::format("; data of this kind would separate them from {} times this size on",
                        Readable(other.separating_size / cause.size, 2));
  }
  text += ".";
  if (!other.separated_by.empty()) text += " To tell them apart: " + other.separated_by + ".";
  return text;
}

// Change of a base parameter by the extension; empty if it is not worth a sentence.
std::string Moved(const Diagnosis& d, const DiagnosedParameter& base, const DiagnosedParameter& now) {
  const std::string moves = fmt::format("With {}, {} moves from {} to {}{}: what was missing had ",
                                        d.causes.size() == 1 ? "it" : "them", now.name, Readable(base.value),
                                        Readable(now.value), Unit(now.unit));
  if (!base.at_bound.empty()) return moves + "driven it to its " + base.at_bound + " bound.";
  if (base.value == 0 || now.value == 0 || base.value * now.value < 0)
    return moves + fmt::format("biased it by {}{}.", Readable(base.value - now.value), Unit(now.unit));
  const double share = std::abs(base.value / now.value - 1);
  return share < 0.005 ? "" : moves + fmt::format("biased it by {}.", Percent(share));
}

// Held-out trials that the extended model predicts worse than the base model.
std::vector<std::string> Worsened(const Diagnosis& d) {
  constexpr double kWorse = 1.02;
  constexpr std::size_t kMaximum = 3;
  std::vector<std::pair<double, std::string>> worse;
  std::size_t held_out = 0;
  for (const TracePair& trace : d.traces) {
    if (trace.role != BlockRole::kValidate) continue;
    ++held_out;
    double before = 0;
    double after = 0;
    for (std::size_t i = 0; i < trace.measured.size(); ++i) {
      before += std::pow(trace.before[i] - trace.measured[i], 2);
      after += std::pow(trace.after[i] - trace.measured[i], 2);
    }
    if (!(after > kWorse * kWorse * before)) continue;
    const auto rmse = [&](double squares) {
      return Readable(std::sqrt(squares / static_cast<double>(trace.measured.size())));
    };
    worse.emplace_back(
        before / after,
        fmt::format("Held-out trial '{}' is predicted WORSE by the extended model: {} {} -> {}{} RMSE.",
                    trace.trial, trace.channel, rmse(before), rmse(after), Unit(trace.unit)));
  }
  std::stable_sort(worse.begin(), worse.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < std::min(worse.size(), kMaximum); ++i) sentences.push_back(worse[i].second);
  if (worse.size() > kMaximum)
    sentences.push_back(fmt::format("{} of {} held-out traces are predicted worse.", worse.size(), held_out));
  return sentences;
}

// A discrepancy term explains the remaining error on its own: all but the first are alternatives.
std::string UnknownSentence(const UnknownFinding& unknown, bool alternative) {
  std::string text = alternative ? "Or instead: " : "Not in the library: ";
  switch (unknown.kind) {
    case UnknownKind::kDrift:
      text +=
          fmt::format("{} is not constant, it {}, from {} to {}{}", unknown.port, unknown.shape,
                      Readable(unknown.curve.front()), Readable(unknown.curve.back()), Unit(unknown.unit));
      break;
    case UnknownKind::kPeriodic:
      text += fmt::format(
          "something periodic in time adds to {}: {}, amplitude {}{}", unknown.port, unknown.shape,
          Readable(*std::max_element(unknown.curve.begin(), unknown.curve.end())), Unit(unknown.unit));
      break;
    case UnknownKind::kCurve:
      text += fmt::format("something adds to {} as a function of {} ({}{})", unknown.port, unknown.signal,
                          unknown.shape,
                          unknown.nearest_law.empty() ? "" : "; nearest known law: " + unknown.nearest_law);
      break;
  }
  return text + fmt::format("; held-out RMSE changes by {:+.0f} %.", -100 * unknown.held_out_reduction);
}

}  // namespace

std::string DescribeParameters(const std::vector<DiagnosedParameter>& parameters) {
  std::vector<std::string> parts;
  for (const DiagnosedParameter& p : parameters) {
    parts.push_back(fmt::format("{} = {}{}{}{}", p.name, Readable(p.value), Unit(p.unit),
                                p.std_error > 0 ? " +-" + Readable(1.96 * p.std_error, 2) : "",
                                p.at_bound.empty() ? "" : " (its " + p.at_bound + " bound)"));
  }
  return Join(parts, ", ");
}

std::vector<std::string> DescribeDiagnosis(const Diagnosis& d, bool has_held_out) {
  std::vector<std::string> sentences;
  for (const WithdrawnCause& cause : d.withdrawn)
    sentences.push_back(fmt::format("Withdrawn: {}: {}.", cause.effect, cause.reason));
  sentences.push_back(Headline(d));
  for (const Cause& cause : d.causes) {
    sentences.push_back(fmt::format("Cause [{}]: {} ({}); {}.", ToString(cause.level), cause.sentence,
                                    cause.effect, DescribeParameters(cause.parameters)));
    if (cause.left_out > 0) {
      sentences.back().pop_back();
      sentences.back() += fmt::format("; with it, trials left out of the fit are missed by {} less.",
                                      Percent(1 - cause.left_out));
    }
    for (const Alternative& other : d.alternatives) {
      if (other.instead_of == cause.effect) sentences.push_back(AlternativeSentence(cause, other));
    }
  }
  for (std::size_t i = 0; i < d.unknown_terms.size(); ++i)
    sentences.push_back(UnknownSentence(d.unknown_terms[i], i > 0));
  if (!d.causes.empty()) {
    for (const DiagnosedParameter& p : d.extended_parameters) {
      const auto base = std::find_if(d.base_parameters.begin(), d.base_parameters.end(),
                                     [&](const DiagnosedParameter& b) { return b.name == p.name; });
      if (base == d.base_parameters.end() || !(std::abs(p.value - base->value) > 1.96 * p.std_error))
        continue;
      sentences.push_back(Moved(d, *base, p));
      if (sentences.back().empty()) sentences.pop_back();
    }
  }
  if (!has_held_out) {
    sentences.push_back("No held-out trial: whether a finding carries over to other data cannot be said.");
  }
  if (!d.causes.empty() || !d.unknown_terms.empty()) {
    for (const Gain& gain : d.gain) sentences.push_back(GainSentence(gain));
    for (std::string& sentence : Worsened(d)) sentences.push_back(std::move(sentence));
  }
  if (d.verdict == DiagnosisVerdict::kAdequate) {
    std::vector<const EffectScore*> noticed;
    for (const EffectScore& score : d.scores) {
      if (score.known && score.judged && score.smallest_detectable > 0) noticed.push_back(&score);
    }
    if (!noticed.empty()) {
      std::vector<std::string> parts;
      for (std::size_t i = 0; i < std::min<std::size_t>(noticed.size(), 4); ++i)
        parts.push_back(fmt::format("{} above {}{}", noticed[i]->detectable_parameter,
                                    Readable(noticed[i]->smallest_detectable, 2),
                                    Unit(noticed[i]->detectable_unit)));
      sentences.push_back("With these data, " + Join(parts, ", ") + " would have been noticed (95 %).");
    }
  }
  return sentences;
}

}  // namespace sinew
