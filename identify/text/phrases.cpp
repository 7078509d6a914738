#include "identify/text/phrases.h"

#include <cctype>
#include <cmath>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/text/sentence.h"

namespace sinew::text {
namespace {

constexpr std::size_t kMaxNames = 4;

}  // namespace

std::string And(const std::vector<std::string>& names) {
  if (names.size() < 2) return Join(names, "");
  return Join({names.begin(), names.end() - 1}, ", ") + " and " + names.back();
}

std::string Some(std::vector<std::string> names) {
  if (names.size() > kMaxNames + 1) {
    const std::size_t others = names.size() - kMaxNames;
    names.resize(kMaxNames);
    names.push_back(fmt::format("{} others", others));
  }
  return And(names);
}

std::string Unit(const std::string& unit) {
  return unit == "1" || unit.empty() ? "" : " " + unit;
}

std::string WithUnit(double value, const std::string& unit, int digits) {
  return Readable(value, digits) + Unit(unit);
}

std::string Percent(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

std::string Chance(double p) {
  return p < 0.001 ? "p < 0.001" : fmt::format("p = {:.2g}", p);
}

std::string Capitalised(std::string text) {
  const auto first_word = text.substr(0, text.find(' '));
  if (first_word.find('_') != std::string::npos) return text;  // a name, which is written in one way only
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string TrialGroup(const std::vector<std::string>& trials) {
  if (trials.size() < 2) return Join(trials, "");
  return fmt::format("{} and {} more", trials.front(), trials.size() - 1);
}

std::string LeftOutText(const LeftOutData& data) {
  const std::string trials = TrialGroup(data.trials);
  if (!data.window) return trials;
  const auto& [from, to] = *data.window;
  if (!std::isfinite(to)) return fmt::format("{} from {} s on", trials, Readable(from, 3));
  return fmt::format("{} from {} to {} s", trials, Readable(from, 3), Readable(to, 3));
}

const char* ToString(SentenceKind kind) {
  switch (kind) {
    case SentenceKind::kSummary:
      return "summary";
    case SentenceKind::kIdentifiable:
      return "identifiable";
    case SentenceKind::kWeak:
      return "weak";
    case SentenceKind::kOffMinimum:
      return "off_minimum";
    case SentenceKind::kAtBound:
      return "at_bound";
    case SentenceKind::kNotIdentifiable:
      return "not_identifiable";
    case SentenceKind::kOpenDirection:
      return "open_direction";
    case SentenceKind::kSharedParameter:
      return "shared_parameter";
    case SentenceKind::kDerived:
      return "derived";
    case SentenceKind::kPrediction:
      return "prediction";
    case SentenceKind::kInconclusive:
      return "inconclusive";
    case SentenceKind::kAdvice:
      return "advice";
    case SentenceKind::kWithdrawn:
      return "withdrawn";
    case SentenceKind::kVerdict:
      return "verdict";
    case SentenceKind::kLevel:
      return "level";
    case SentenceKind::kCause:
      return "cause";
    case SentenceKind::kAlternative:
      return "alternative";
    case SentenceKind::kMoreGeneralLaw:
      return "more_general_law";
    case SentenceKind::kUnknownTerm:
      return "unknown_term";
    case SentenceKind::kParameterChange:
      return "parameter_change";
    case SentenceKind::kNoHeldOutTrial:
      return "no_held_out_trial";
    case SentenceKind::kGain:
      return "gain";
    case SentenceKind::kWorseTrial:
      return "worse_trial";
    case SentenceKind::kWorseTrials:
      return "worse_trials";
    case SentenceKind::kDetectable:
      return "detectable";
  }
  return "?";
}

std::vector<std::string> TextsOf(const std::vector<Sentence>& sentences) {
  std::vector<std::string> texts;
  for (const Sentence& sentence : sentences) texts.push_back(sentence.text);
  return texts;
}

bool IsSubordinate(const Sentence& sentence) {
  return sentence.kind == SentenceKind::kAlternative || sentence.kind == SentenceKind::kMoreGeneralLaw;
}

}  // namespace sinew::text
