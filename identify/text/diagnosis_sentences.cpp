#include "identify/text/diagnosis_sentences.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/text/effects.h"
#include "identify/text/phrases.h"
#include "identify/text/shapes.h"

namespace sinew::text {
namespace {

std::vector<Sentence> Inconclusives(const Diagnosis& d) {
  std::string why;
  std::string advice;
  switch (d.inconclusive) {
    case Inconclusive::kNone:
      return {};
    case Inconclusive::kBaseFitNotConverged:
      why = fmt::format("the base fit did not converge ({})", d.base.stop.test);
      advice =
          "A cause named on top of an unfinished fit would be a guess. Give better starts or bounds, or fix "
          "what the data do not determine.";
      break;
    case Inconclusive::kNoiseTooLarge:
      why =
          "the residual of the base model is about as large as what was measured, and varies from sample to "
          "sample as noise does";
      advice =
          "No effect can be named in such noise. Reduce the noise, excite the system more, or give the base "
          "model better starts.";
      break;
  }
  return {{SentenceKind::kInconclusive, "Nothing can be concluded: " + why + ".", {}},
          {SentenceKind::kAdvice, advice, {}}};
}

// What limits every verdict but "unexplained": channels whose noise level is not known.
std::string UnknownNoise(const Diagnosis& d) {
  std::vector<std::string> channels;
  for (const Warning& w : d.warnings) {
    for (std::size_t i = 0; w.kind == WarningKind::kNoiseLevelUnknown && i + 1 < w.names.size(); i += 2)
      channels.push_back(w.names[i]);
  }
  if (channels.empty()) return {};
  return fmt::format(
      " The noise level of {} is not known, so that this rests on tests of the residual alone: an error that "
      "resembles noise is not excluded.",
      And(channels));
}

std::string ShortfallText(const Diagnosis& d) {
  if (!(d.held_out_shortfall > 0)) return {};
  return fmt::format("; they reduce the error of held-out trials {} less than predicted",
                     Percent(d.held_out_shortfall));
}

std::string VerdictText(const Diagnosis& d) {
  const std::string chance = "(family-wise " + Chance(d.family_p_value) + ")";
  switch (d.verdict) {
    case DiagnosisVerdict::kAdequate:
      return fmt::format("Adequate: no effect in the library improves the fit beyond chance {}.", chance) +
             UnknownNoise(d);
    case DiagnosisVerdict::kExplained:
      return fmt::format("Misfit beyond chance {}: {}.", chance,
                         d.causes.size() == 1 ? "one known cause explains it"
                                              : fmt::format("{} known causes explain it", d.causes.size())) +
             UnknownNoise(d);
    case DiagnosisVerdict::kAmbiguous:
      return fmt::format("Misfit beyond chance {}: more than one known cause could explain it.", chance) +
             UnknownNoise(d);
    case DiagnosisVerdict::kUnexplained:
      if (d.strongly_autocorrelated)
        return "Unexplained: the residual is larger at low frequencies than the noise that the data state or "
               "show, or than that of instruments usually is; no known effect explains it, and no test can "
               "distinguish it from autocorrelated noise.";
      return fmt::format("Unexplained: misfit beyond chance {}, and {}.", chance,
                         d.causes.empty() ? "no known effect explains it"
                                          : "the known effects do not explain all of it" + ShortfallText(d));
  }
  return {};
}

std::string InBrackets(const LevelEvidence& level) {
  return fmt::format("{} [{}]", And(level.effects), ToString(level.level));
}

// What the best other level lacks; nothing if it is not known.
std::string BehindText(const LevelEvidence& level) {
  if (level.effects.empty()) return {};
  if (level.left_out > 0)
    return fmt::format("{} alone {} {} of the error of data left out of the fit", InBrackets(level),
                       level.effects.size() == 1 ? "leaves" : "leave", Percent(level.left_out));
  if (!std::isfinite(level.behind)) return {};
  return fmt::format("{} {} {:.1f} less in -2 log L (each parameter counts 4)", InBrackets(level),
                     level.effects.size() == 1 ? "explains" : "explain", level.behind);
}

// Which level, before which effect.
void AddLevels(const Diagnosis& d, std::vector<Sentence>& sentences) {
  Sentence sentence{SentenceKind::kLevel, {}, {}};
  std::vector<std::string> blamed;
  std::vector<std::string> possible;
  std::vector<std::string> behind;
  for (const LevelEvidence& level : d.levels) {
    const std::string name = ToString(level.level);
    if (level.standing == LevelStanding::kBlamed) blamed.push_back(name);
    if (level.standing == LevelStanding::kPossible) possible.push_back(name);
  }
  if (blamed.empty()) return;
  sentence.about = blamed;
  sentence.about.insert(sentence.about.end(), possible.begin(), possible.end());
  std::string& text = sentence.text;
  text = fmt::format("{}: {}", blamed.size() == 1 ? "Level" : "Levels", And(blamed));
  if (!possible.empty())
    text += fmt::format(", or {} in place of {}: these data do not tell them apart", And(possible),
                        blamed.size() == 1 ? "it" : "one of them");
  const bool one_suffices = std::any_of(d.levels.begin(), d.levels.end(), [](const LevelEvidence& level) {
    return level.standing == LevelStanding::kBlamed && level.suffices;
  });
  // Of several levels, what each alone lacks, or only those that lack nothing; of one, what the best other
  // one lacks.
  for (const LevelEvidence& level : d.levels) {
    const bool told = blamed.size() > 1
                          ? level.standing == LevelStanding::kBlamed && level.suffices == one_suffices
                          : level.standing != LevelStanding::kBlamed;
    const std::string lacks = told ? BehindText(level) : "";
    if (!lacks.empty()) behind.push_back(lacks);
    if (blamed.size() == 1 && !behind.empty()) break;
  }
  if (behind.empty()) {
    text += ".";
  } else if (blamed.size() > 1) {
    text += (one_suffices ? ". One level may be enough: " : ". No level suffices alone: ") +
            Join(behind, "; ") + ".";
  } else {
    text += (possible.empty() ? ". The best of another level: " : "; ") + behind.front() + ".";
  }
  sentences.push_back(std::move(sentence));
}

Sentence CauseSentence(const Cause& cause) {
  std::string text = fmt::format("Cause [{}]: {} ({}); {}", ToString(cause.level), DescriptionOf(cause),
                                 cause.effect, ParametersText(cause.parameters));
  if (cause.left_out > 0)
    text += fmt::format("; the error of data left out of the fit is {} lower with it",
                        Percent(1 - cause.left_out));
  if (cause.interval_contains_null)
    text += "; its interval contains the value without this effect, so these data do not determine its size";
  return {SentenceKind::kCause, text + ".", {cause.effect}};
}

Sentence AlternativeSentence(const Cause& cause, const Alternative& other) {
  Sentence sentence{SentenceKind::kAlternative, {}, {other.effect, cause.effect}};
  std::string& text = sentence.text;
  const bool worse = other.left_out > kSameError;
  std::string comparison =
      other.left_out > 0 ? fmt::format("the error of data left out of the fit is {} of that with the cause",
                                       Percent(other.left_out))
                         : fmt::format("delta LR {:.1f}", other.delta_lr);
  if (worse) comparison += ", but which of the two is chosen changes with the data that are left out";
  text = fmt::format("{} [{}]: {} ({}); {}; {}.",
                     !other.contains_cause ? "Could also be"
                     : worse               ? "A more general law fits nearly as well"
                                           : "A more general law fits as well",
                     ToString(other.level), other.description, other.effect, ParametersText(other.parameters),
                     comparison);
  if (other.contains_cause) {
    sentence.kind = SentenceKind::kMoreGeneralLaw;
    text += " It contains the cause as a special case and is not needed.";
    return sentence;
  }
  text += other.same_class ? std::string(" The two have nearly the same effect on the data")
                           : fmt::format(" Their effects on the data correlate {:.2f}", other.correlation);
  if (std::isfinite(other.separating_size) && cause.size > 0 && other.separating_size > cause.size) {
    text += fmt::format("; such data would separate them from {} times this size on",
                        Readable(other.separating_size / cause.size, 2));
  }
  text += ".";
  if (other.less_common) text += " It is less common in practice.";
  if (!other.separated_by.empty()) text += " To distinguish them: " + other.separated_by + ".";
  return sentence;
}

// Each explains what is left on its own, all but the first are alternatives; those that cross-validation has
// chosen explain it together.
Sentence UnknownSentence(const UnknownFinding& unknown, bool first, bool together) {
  std::string text = first ? "Not in the library: " : together ? "Also not in the library: " : "Or instead: ";
  const std::string law = LawText(unknown);
  switch (unknown.kind) {
    case UnknownKind::kDrift:
      text += fmt::format("{} is not constant, it {}, from {} to {}", unknown.port, ShapeText(unknown),
                          Readable(unknown.curve.front()), WithUnit(unknown.curve.back(), unknown.unit));
      break;
    case UnknownKind::kPeriodic:
      text += fmt::format(
          "something periodic in time adds to {}: {}, amplitude {}", unknown.port, ShapeText(unknown),
          WithUnit(*std::max_element(unknown.curve.begin(), unknown.curve.end()), unknown.unit));
      break;
    case UnknownKind::kCurve:
      text += fmt::format("something adds to {} as a function of {}", unknown.port, unknown.signal);
      if (const std::string shape = ShapeText(unknown); !shape.empty())
        text += fmt::format(" ({}{})", shape, law.empty() ? "" : "; nearest known law: " + law);
      break;
  }
  text += fmt::format("; held-out RMSE changes by {:+.0f} %.",
                      std::round(-100 * unknown.held_out_reduction) + 0.0);  // no -0
  if (!unknown.inseparable_from.empty())
    text +=
        fmt::format(" A part of it is the same as a change of {}: these data determine only both together.",
                    Join(unknown.inseparable_from, ", "));
  return {SentenceKind::kUnknownTerm, std::move(text), {unknown.name}};
}

// What became of a base parameter; nothing where the change is not worth telling.
void AddChange(const Diagnosis& d, const DiagnosedParameter& base, const DiagnosedParameter& now,
               std::vector<Sentence>& sentences) {
  std::string text = d.causes.size() == 1 ? "Without this effect " : "Without these effects ";
  if (!base.at_bound.empty()) {
    text += fmt::format("{} of the base model was at its {} bound", now.name, base.at_bound);
  } else if (base.value == 0 || now.value == 0 || base.value * now.value < 0) {
    text += fmt::format("{} of the base model was off by {}", now.name,
                        WithUnit(base.value - now.value, now.unit));
  } else {
    const double share = base.value / now.value - 1;
    if (std::abs(share) < 0.005) return;
    text += fmt::format("the base model {}estimated {}{}", share > 0 ? "over" : "under",
                        now.value < 0 ? "the size of " : "", now.name);
    constexpr double kLargestShare = 10;  // beyond it a percentage of a value near zero says nothing
    if (share < kLargestShare) text += " by " + Percent(std::abs(share));
  }
  text += fmt::format(": {} -> {}.", Readable(base.value), WithUnit(now.value, now.unit));
  sentences.push_back({SentenceKind::kParameterChange, std::move(text), {now.name}});
}

void AddChanges(const Diagnosis& d, std::vector<Sentence>& sentences) {
  if (d.causes.empty()) return;
  for (const DiagnosedParameter& p : d.extended_parameters) {
    const auto base = std::find_if(d.base_parameters.begin(), d.base_parameters.end(),
                                   [&](const DiagnosedParameter& b) { return b.name == p.name; });
    if (base == d.base_parameters.end() || !(std::abs(p.value - base->value) > 1.96 * p.std_error)) continue;
    AddChange(d, *base, p, sentences);
  }
}

Sentence GainSentence(const Gain& gain) {
  constexpr double kAll = 0.995;  // what is rounded to 100 %
  std::string text =
      fmt::format("Held-out trials, {}: {} -> {} RMSE ({:+.0f} %, 95 % interval {:+.0f} .. {:+.0f} %)",
                  gain.channel, Readable(gain.before), WithUnit(gain.after, gain.unit), -100 * gain.reduction,
                  -100 * gain.ci95[1], -100 * gain.ci95[0]);
  if (std::isfinite(gain.gap_closed) && gain.gap_closed > 0) {
    text += fmt::format("; removes {} of the error above the noise floor",
                        gain.gap_closed >= kAll ? "all" : Percent(gain.gap_closed));
  }
  return {SentenceKind::kGain, text + ".", {gain.channel}};
}

// Held-out trials that the extended model predicts worse than the base model.
void AddWorsened(const Diagnosis& d, std::vector<Sentence>& sentences) {
  constexpr double kWorse = 1.02;
  constexpr std::size_t kMaximum = 3;
  std::vector<std::pair<double, Sentence>> worse;
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
      return std::sqrt(squares / static_cast<double>(trace.measured.size()));
    };
    worse.emplace_back(
        before / after,
        Sentence{SentenceKind::kWorseTrial,
                 fmt::format(
                     "Held-out trial '{}' is predicted WORSE by the extended model: {} {} -> {} RMSE.",
                     trace.trial, trace.channel, Readable(rmse(before)), WithUnit(rmse(after), trace.unit)),
                 {trace.trial, trace.channel}});
  }
  std::stable_sort(worse.begin(), worse.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < std::min(worse.size(), kMaximum); ++i) sentences.push_back(worse[i].second);
  if (worse.size() > kMaximum) {
    sentences.push_back({SentenceKind::kWorseTrials,
                         fmt::format("{} of {} held-out traces are predicted worse.", worse.size(), held_out),
                         {}});
  }
}

void AddDetectable(const Diagnosis& d, std::vector<Sentence>& sentences) {
  constexpr std::size_t kMaximum = 4;
  Sentence sentence{SentenceKind::kDetectable, {}, {}};
  std::vector<std::string> parts;
  for (const EffectScore& score : d.scores) {
    if (!score.known || !score.judged || !(score.smallest_detectable > 0) || parts.size() == kMaximum)
      continue;
    sentence.about.push_back(score.detectable_parameter);
    parts.push_back(score.detectable_parameter + " above " +
                    WithUnit(score.smallest_detectable, score.detectable_unit, 2));
  }
  if (parts.empty()) return;
  sentence.text = "With these data, " + Join(parts, ", ") + " would have been noticed (95 %).";
  sentences.push_back(std::move(sentence));
}

}  // namespace

std::vector<Sentence> Sentences(const Diagnosis& d) {
  if (!d.concluded()) return Inconclusives(d);
  std::vector<Sentence> sentences;
  for (const WithdrawnCause& cause : d.withdrawn) {
    sentences.push_back({SentenceKind::kWithdrawn,
                         fmt::format("Withdrawn: {}: {}.", cause.effect, ReasonText(cause)),
                         {cause.effect}});
  }
  sentences.push_back({SentenceKind::kVerdict, VerdictText(d), {}});
  AddLevels(d, sentences);
  for (const Cause& cause : d.causes) {
    sentences.push_back(CauseSentence(cause));
    for (const Alternative& other : d.alternatives) {
      if (other.instead_of == cause.effect) sentences.push_back(AlternativeSentence(cause, other));
    }
  }
  for (std::size_t i = 0; i < d.unknown_terms.size(); ++i)
    sentences.push_back(UnknownSentence(d.unknown_terms[i], i == 0, !d.left_out.empty()));
  AddChanges(d, sentences);
  if (!d.has_held_out) {
    sentences.push_back({SentenceKind::kNoHeldOutTrial,
                         "No held-out trial: whether a finding generalises to other data is unknown.",
                         {}});
  }
  if (!d.causes.empty() || !d.unknown_terms.empty()) {
    for (const Gain& gain : d.gain) sentences.push_back(GainSentence(gain));
    AddWorsened(d, sentences);
  }
  if (d.verdict == DiagnosisVerdict::kAdequate) AddDetectable(d, sentences);
  return sentences;
}

std::string WhyInconclusive(const Diagnosis& d) {
  switch (d.inconclusive) {
    case Inconclusive::kNone:
      return {};
    case Inconclusive::kBaseFitNotConverged:
      return "the base model was not fitted: " + d.base.stop.test;
    case Inconclusive::kNoiseTooLarge:
      return "the noise is too large to name a cause";
  }
  return {};
}

std::string ProgressText(const DiagnosisProgress& progress) {
  switch (progress.step) {
    case DiagnosisStep::kBaseFit:
      return "fitting the base model";
    case DiagnosisStep::kScore:
      return "scoring the library";
    case DiagnosisStep::kRefit:
      return "refitting the strongest effects";
    case DiagnosisStep::kCrossValidate:
      return fmt::format("cross-validation: {:.3g} of the base model's error on left-out trials with {}",
                         progress.left_out_share, Join(progress.effects, ", "));
    case DiagnosisStep::kDiscover:
      return "searching for a term outside the library";
  }
  return {};
}

}  // namespace sinew::text
