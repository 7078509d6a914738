#include <algorithm>
#include <cctype>
#include <utility>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/identification/identification.h"

namespace sinew {
namespace {

std::string WithUnit(double value, const std::string& unit, int digits = 3) {
  return Readable(value, digits) + (unit == "1" ? "" : " " + unit);
}

// "stiffness, dissipation and static_friction"
std::string And(const std::vector<std::string>& names) {
  if (names.size() < 2) return Join(names, "");
  return Join({names.begin(), names.end() - 1}, ", ") + " and " + names.back();
}

std::string Capitalised(std::string text) {
  const auto first_word = text.substr(0, text.find(' '));
  if (first_word.find('_') != std::string::npos) return text;  // a name, which is written in one way only
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string Determined(const Parameter& p, const ParameterVerdict& v) {
  const std::string interval = fmt::format("{} to {}", Readable(v.ci95_lower), Readable(v.ci95_upper));
  // An unconverged search may stop outside of the interval, which belongs to the minimum near by.
  if (v.value < v.ci95_lower || v.value > v.ci95_upper) {
    return fmt::format("{} = {}: NOT at the best fit, whose 95 % interval is {}; let the search go on.",
                       p.name, WithUnit(v.value, p.unit), interval);
  }
  return fmt::format("{} = {} (95 % interval {}): {}.", p.name, WithUnit(v.value, p.unit), interval,
                     v.verdict == Verdict::kIdentifiable ? "identifiable" : "weak, " + v.reason);
}

// "measuring f would fix it (standard error 0.02)" without the figures, which differ from parameter to
// parameter.
std::string WithoutFigures(const std::string& remedy) {
  std::string plain;
  int depth = 0;
  for (const char c : remedy) {
    if (c == '(') {
      ++depth;
      while (!plain.empty() && plain.back() == ' ') plain.pop_back();
    }
    if (depth == 0) plain += c;
    if (c == ')' && depth > 0) --depth;
  }
  return plain;
}

// What would help parameters that share a reason: one sentence if it is the same for all, else one for each
// remedy.
std::string Remedies(const std::vector<std::pair<std::string, std::string>>& remedy_of) {
  std::vector<std::pair<std::string, std::vector<std::string>>> names_of;
  for (const auto& [name, remedy] : remedy_of) {
    const std::string plain = remedy_of.size() > 1 ? WithoutFigures(remedy) : remedy;
    auto same =
        std::find_if(names_of.begin(), names_of.end(), [&](const auto& told) { return told.first == plain; });
    if (same == names_of.end()) same = names_of.insert(names_of.end(), {plain, {}});
    same->second.push_back(name);
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
std::vector<std::string> Undetermined(const Problem& problem, const std::vector<ParameterVerdict>& verdicts) {
  struct Told {
    std::string reason;
    std::vector<std::pair<std::string, std::string>> remedy_of;
  };
  std::vector<Told> groups;
  for (const ParameterVerdict& v : verdicts) {
    if (v.verdict != Verdict::kNotIdentifiable) continue;
    auto same =
        std::find_if(groups.begin(), groups.end(), [&](const Told& told) { return told.reason == v.reason; });
    if (same == groups.end()) same = groups.insert(groups.end(), {v.reason, {}});
    same->remedy_of.emplace_back(problem.parameters()[static_cast<std::size_t>(v.parameter)].name, v.remedy);
  }
  std::vector<std::string> sentences;
  for (const Told& told : groups) {
    std::vector<std::string> names;
    for (const auto& [name, remedy] : told.remedy_of) names.push_back(name);
    sentences.push_back(
        fmt::format("{}: NOT identifiable: {}.{}", And(names), told.reason, Remedies(told.remedy_of)));
  }
  return sentences;
}

std::vector<std::string> Predictions(const FullPrediction& prediction) {
  std::vector<std::string> sentences;
  for (const FitQuality& train : prediction.pooled) {
    if (train.role != BlockRole::kTrain) continue;
    std::string sentence = fmt::format("{}: train {} RMSE (R2 {:.3f})", Capitalised(train.channel),
                                       WithUnit(train.rmse, train.unit, 2), train.r2);
    for (const FitQuality& validate : prediction.pooled) {
      if (validate.role != BlockRole::kValidate || validate.channel != train.channel) continue;
      sentence +=
          fmt::format(", validate {} (R2 {:.3f})", WithUnit(validate.rmse, validate.unit, 2), validate.r2);
    }
    sentences.push_back(sentence + ".");
  }
  return sentences;
}

}  // namespace

std::vector<std::string> DescribeFindings(const Problem& problem, const Identification& identification) {
  std::vector<std::string> findings;
  const auto& verdicts = identification.uncertainty.parameters;
  for (const ParameterVerdict& v : verdicts) {
    const Parameter& p = identification.setup.parameters[static_cast<std::size_t>(v.parameter)];
    if (v.verdict == Verdict::kIdentifiable || v.verdict == Verdict::kWeak)
      findings.push_back(Determined(p, v));
    if (v.verdict == Verdict::kAtBound) {
      findings.push_back(fmt::format("{} = {}: AT BOUND: {}.", p.name, WithUnit(v.value, p.unit), v.reason));
    }
  }
  for (auto& sentence : Undetermined(problem, verdicts)) findings.push_back(std::move(sentence));
  for (const std::string& direction : identification.uncertainty.directions) {
    findings.push_back("Not determined: " + direction + ".");
  }
  for (auto& sentence : Predictions(identification.prediction)) findings.push_back(std::move(sentence));
  return findings;
}

}  // namespace sinew
