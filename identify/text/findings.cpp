#include "identify/text/findings.h"

#include <algorithm>
#include <utility>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/text/phrases.h"
#include "identify/text/reasons.h"

namespace sinew::text {
namespace {

const Parameter& ParameterOf(const FitSetup& setup, const ParameterVerdict& verdict) {
  return setup.parameters[static_cast<std::size_t>(verdict.parameter)];
}

// Digits that tell the ends of an interval apart: as numbers, for 1.000 and 1.00 are the same.
int DigitsOf(double lower, double upper) {
  constexpr int kMaxDigits = 12;
  int digits = 3;
  if (lower == upper) return digits;
  const auto printed = [&](double value) { return ParseNumber(Readable(value, digits)); };
  while (digits < kMaxDigits && printed(lower) == printed(upper)) ++digits;
  return digits;
}

Sentence Determined(const Parameter& p, const ParameterVerdict& v) {
  const int digits = DigitsOf(v.ci95_lower, v.ci95_upper);
  const std::string interval =
      fmt::format("{} to {}", Readable(v.ci95_lower, digits), Readable(v.ci95_upper, digits));
  // An unconverged search may stop outside of the interval, which belongs to the minimum near by.
  if (v.value < v.ci95_lower || v.value > v.ci95_upper) {
    return {SentenceKind::kOffMinimum,
            fmt::format("{} = {}: NOT at the best fit, whose 95 % interval is {}; continue the search.",
                        p.name, WithUnit(v.value, p.unit), interval),
            {p.name}};
  }
  const bool sure = v.verdict == Verdict::kIdentifiable;
  return {sure ? SentenceKind::kIdentifiable : SentenceKind::kWeak,
          fmt::format("{} = {} (95 % interval {}): {}.", p.name, WithUnit(v.value, p.unit, digits), interval,
                      sure ? "identifiable" : "weak, " + ReasonText(p, v)),
          {p.name}};
}

struct NamedRemedy {
  const Parameter* parameter;
  const Remedy* remedy;
};

// What would help parameters that share a reason: one sentence if it is the same for all, else one for each
// remedy.
std::string Remedies(const std::vector<NamedRemedy>& remedy_of) {
  std::vector<std::pair<std::string, std::vector<std::string>>> names_of;
  for (const NamedRemedy& one : remedy_of) {
    const std::string text = RemedyText(*one.parameter, *one.remedy, remedy_of.size() == 1);
    auto same =
        std::find_if(names_of.begin(), names_of.end(), [&](const auto& told) { return told.first == text; });
    if (same == names_of.end()) same = names_of.insert(names_of.end(), {text, {}});
    same->second.push_back(one.parameter->name);
  }
  std::string text;
  for (const auto& [remedy, names] : names_of) {
    if (remedy.empty()) continue;
    text += names_of.size() == 1 ? " " + Capitalised(remedy) + "."
                                 : fmt::format(" For {}: {}.", And(names), remedy);
  }
  return text;
}

// Parameters that share a verdict and its reason are told in one sentence.
std::vector<Sentence> Undetermined(const FitSetup& setup, const std::vector<ParameterVerdict>& verdicts) {
  std::vector<std::pair<std::string, std::vector<NamedRemedy>>> groups;  // by the reason
  for (const ParameterVerdict& v : verdicts) {
    if (v.verdict != Verdict::kNotIdentifiable) continue;
    const Parameter& p = ParameterOf(setup, v);
    const std::string reason = ReasonText(p, v);
    auto same =
        std::find_if(groups.begin(), groups.end(), [&](const auto& group) { return group.first == reason; });
    if (same == groups.end()) same = groups.insert(groups.end(), {reason, {}});
    same->second.push_back({&p, &v.remedy});
  }
  std::vector<Sentence> sentences;
  for (const auto& [reason, remedy_of] : groups) {
    std::vector<std::string> names;
    for (const NamedRemedy& one : remedy_of) names.push_back(one.parameter->name);
    sentences.push_back({SentenceKind::kNotIdentifiable,
                         fmt::format("{}: NOT identifiable: {}.{}", And(names), reason, Remedies(remedy_of)),
                         names});
  }
  return sentences;
}

// Who has each shared parameter: parameters of the same group are told in one sentence.
std::vector<Sentence> Shared(const FitSetup& setup, const std::vector<ParameterVerdict>& verdicts) {
  std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> groups;  // members, parameters
  for (const ParameterVerdict& v : verdicts) {
    const Parameter& p = ParameterOf(setup, v);
    if (p.shared_by.size() < 2) continue;
    auto same = std::find_if(groups.begin(), groups.end(),
                             [&](const auto& group) { return group.first == p.shared_by; });
    if (same == groups.end()) same = groups.insert(groups.end(), {p.shared_by, {}});
    same->second.push_back(p.name);
  }
  std::vector<Sentence> sentences;
  for (const auto& [members, names] : groups)
    sentences.push_back(
        {SentenceKind::kSharedParameter, fmt::format("{}: shared by {}.", And(names), And(members)), names});
  return sentences;
}

std::vector<Sentence> Derived(const std::vector<DerivedResult>& results) {
  std::vector<Sentence> sentences;
  for (const DerivedResult& one : results) {
    const int digits = one.interval ? DigitsOf(one.ci95_lower, one.ci95_upper) : 3;
    const std::string interval = one.interval
                                     ? fmt::format("95 % interval {} to {}", Readable(one.ci95_lower, digits),
                                                   Readable(one.ci95_upper, digits))
                                     : "no interval";
    sentences.push_back({SentenceKind::kDerived,
                         fmt::format("{} = {} ({}): derived from {}.", one.name,
                                     WithUnit(one.value, one.unit, digits), interval, And(one.from)),
                         {one.name}});
  }
  return sentences;
}

// ": walk36 16.5, walk45 23.4": each of several held-out trials; empty where there is one, or too many to
// list.
std::string EachHeldOut(const std::vector<FitQuality>& quality, const std::string& channel) {
  constexpr std::size_t kMaxHeldOutTrials = 6;
  std::vector<std::string> trials;
  for (const FitQuality& one : quality) {
    if (one.role == BlockRole::kValidate && one.channel == channel)
      trials.push_back(fmt::format("{} {}", one.trial, Readable(one.rmse, 2)));
  }
  return trials.size() < 2 || trials.size() > kMaxHeldOutTrials ? "" : ": " + Join(trials, ", ");
}

std::vector<Sentence> Predictions(const std::vector<FitQuality>& pooled,
                                  const std::vector<FitQuality>& quality) {
  std::vector<Sentence> sentences;
  for (const FitQuality& train : pooled) {
    if (train.role != BlockRole::kTrain) continue;
    std::string sentence = fmt::format("{}: train {} RMSE (R2 {:.3f})", Capitalised(train.channel),
                                       WithUnit(train.rmse, train.unit, 2), train.r2);
    for (const FitQuality& validate : pooled) {
      if (validate.role != BlockRole::kValidate || validate.channel != train.channel) continue;
      sentence += fmt::format(", validate {} (R2 {:.3f}{})", WithUnit(validate.rmse, validate.unit, 2),
                              validate.r2, EachHeldOut(quality, validate.channel));
    }
    sentences.push_back({SentenceKind::kPrediction, sentence + ".", {train.channel}});
  }
  return sentences;
}

// "13 of 50 parameters are identifiable, 20 weak, 6 not identifiable, 11 at a bound."
Sentence Summary(const std::vector<ParameterVerdict>& verdicts) {
  const auto count = [&](Verdict verdict) {
    return std::count_if(verdicts.begin(), verdicts.end(),
                         [&](const ParameterVerdict& v) { return v.verdict == verdict; });
  };
  const auto identifiable = count(Verdict::kIdentifiable);
  return {SentenceKind::kSummary,
          fmt::format("{} of {} parameters {} identifiable, {} weak, {} not identifiable, {} at a bound.",
                      identifiable, verdicts.size(), identifiable == 1 ? "is" : "are", count(Verdict::kWeak),
                      count(Verdict::kNotIdentifiable), count(Verdict::kAtBound)),
          {}};
}

std::vector<Sentence> Directions(const std::vector<OpenDirection>& directions) {
  constexpr std::size_t kMaxDirections = 5;
  // One that is left out is not worth a sentence that says so.
  const std::size_t told = directions.size() <= kMaxDirections + 1 ? directions.size() : kMaxDirections;
  std::vector<Sentence> sentences;
  for (std::size_t i = 0; i < told; ++i) {
    std::vector<std::string> names;
    for (const ParameterChange& part : directions[i].changes) names.push_back(part.parameter);
    sentences.push_back({SentenceKind::kOpenDirection,
                         "Not determined: " + DirectionText(directions[i]) + ".", std::move(names)});
  }
  if (told < directions.size()) {
    sentences.push_back({SentenceKind::kOpenDirection,
                         fmt::format("{} further directions are not determined; the run file lists them.",
                                     directions.size() - told),
                         {}});
  }
  return sentences;
}

// Above this number of parameters the sentences begin with a summary and the prediction error.
constexpr std::size_t kManyParameters = 10;

void Add(const FitSetup& setup, const Uncertainty& uncertainty, const std::vector<DerivedResult>& derived,
         const std::vector<FitQuality>& pooled_fit, const std::vector<FitQuality>& quality,
         const std::string& step, std::vector<Sentence>& findings) {
  const std::size_t first = findings.size();
  const auto append = [&](std::vector<Sentence> some) {
    for (Sentence& sentence : some) findings.push_back(std::move(sentence));
  };
  const bool many = uncertainty.parameters.size() > kManyParameters;
  if (many) {
    findings.push_back(Summary(uncertainty.parameters));
    append(Predictions(pooled_fit, quality));
  }
  for (const ParameterVerdict& v : uncertainty.parameters) {
    const Parameter& p = ParameterOf(setup, v);
    if (v.verdict == Verdict::kIdentifiable || v.verdict == Verdict::kWeak)
      findings.push_back(Determined(p, v));
    if (v.verdict == Verdict::kAtBound) {
      findings.push_back(
          {SentenceKind::kAtBound,
           fmt::format("{} = {}: AT BOUND: {}.", p.name, WithUnit(v.value, p.unit), ReasonText(p, v)),
           {p.name}});
    }
  }
  append(Undetermined(setup, uncertainty.parameters));
  append(Directions(uncertainty.directions));
  append(Shared(setup, uncertainty.parameters));
  append(Derived(derived));
  if (!many) append(Predictions(pooled_fit, quality));
  if (step.empty()) return;
  for (std::size_t i = first; i < findings.size(); ++i) {
    findings[i].text.insert(0, step + ": ");
    findings[i].step = step;
  }
}

// "Vertical force, held out: 4.6 N; predicted from the recorded motion alone 217 N; ..."
std::vector<Sentence> Alternatives(const Identification& identification) {
  std::vector<Sentence> sentences;
  if (identification.alternatives.empty()) return sentences;
  for (const FitQuality& own : identification.pooled_fit) {
    if (own.role == BlockRole::kPredicted) continue;
    std::string sentence =
        fmt::format("{}, {}: {}", Capitalised(own.channel),
                    own.role == BlockRole::kTrain ? "fitted" : "held out", WithUnit(own.rmse, own.unit, 2));
    bool compared = false;
    for (const AlternativeQuality& alternative : identification.alternatives) {
      for (std::size_t i = 0; i < alternative.pooled.size(); ++i) {
        const FitQuality& other = alternative.pooled[i];
        if (other.role != own.role || other.channel != own.channel) continue;
        sentence += fmt::format("; predicted {} {}", alternative.name, WithUnit(other.rmse, other.unit, 2));
        const double half_width = alternative.pooled_half_width[i];
        if (half_width > 0) sentence += fmt::format(" (95 % band +-{})", WithUnit(half_width, other.unit, 2));
        compared = true;
      }
    }
    if (compared) sentences.push_back({SentenceKind::kPrediction, sentence + ".", {own.channel}});
  }
  return sentences;
}

// "walk_left_2, not measured, from the motion of the whole body: vertical force 3 to 812 N (95 % band +-37
// N); ..." One sentence for each trial and origin.
std::vector<Sentence> Unmeasured(const Identification& identification) {
  std::vector<Sentence> sentences;
  const UnmeasuredChannel* before = nullptr;
  for (const UnmeasuredChannel& channel : identification.unmeasured) {
    if (before == nullptr || before->trial != channel.trial || before->from != channel.from)
      sentences.push_back({SentenceKind::kPrediction,
                           fmt::format("{}, not measured, from {}", channel.trial, channel.from),
                           {channel.trial}});
    sentences.back().text +=
        fmt::format("{} {} {} to {} (95 % band +-{})", sentences.back().about.size() == 1 ? ":" : ";",
                    channel.quantity, Readable(channel.lowest, 2), WithUnit(channel.highest, channel.unit, 2),
                    WithUnit(channel.mean_half_width, channel.unit, 2));
    sentences.back().about.push_back(channel.channel);
    before = &channel;
  }
  for (Sentence& sentence : sentences) sentence.text += ".";
  return sentences;
}

}  // namespace

std::vector<Sentence> Findings(const Identification& identification) {
  std::vector<Sentence> findings;
  for (const FinishedStep& step : identification.steps)
    Add(step.setup, step.uncertainty, step.derived, step.pooled_fit, {}, step.name, findings);
  Add(identification.setup, identification.uncertainty, identification.derived, identification.pooled_fit,
      identification.prediction.quality, "", findings);
  for (Sentence& sentence : Alternatives(identification)) findings.push_back(std::move(sentence));
  for (Sentence& sentence : Unmeasured(identification)) findings.push_back(std::move(sentence));
  return findings;
}

std::string Meaning(const FigureOfMerit& figure) {
  switch (figure.source) {
    case PriorSource::kNone:
      return figure.meaning;
    case PriorSource::kHeld:
      return figure.meaning + "; held as requested";
    case PriorSource::kChosen:
      return figure.meaning + "; chosen by the marginal likelihood, and taken as exact by the intervals";
    case PriorSource::kUndetermined:
      return figure.meaning + "; not chosen by the data, since no fit comes near the noise";
  }
  return figure.meaning;
}

}  // namespace sinew::text
