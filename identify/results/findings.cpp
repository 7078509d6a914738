#include <algorithm>
#include <cmath>
#include <map>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/results/identification.h"

namespace sinew {
namespace {

std::string WithUnit(double value, const std::string& unit) {
  return Readable(value) + (unit == "1" ? "" : " " + unit);
}

// "stiffness, dissipation and static_friction"
std::string And(const std::vector<std::string>& names) {
  if (names.size() < 2) return Join(names, "");
  return Join({names.begin(), names.end() - 1}, ", ") + " and " + names.back();
}

std::string Capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string Determined(const Parameter& p, const ParameterVerdict& v) {
  return fmt::format("{} = {} (95 % interval {} to {}): {}.", p.name, WithUnit(v.value, p.unit),
                     Readable(v.ci95_lower), Readable(v.ci95_upper),
                     v.verdict == Verdict::kIdentifiable ? "identifiable" : "weak, " + v.reason);
}

// Parameters that share a verdict, its reason and its remedy are told in one sentence.
std::vector<std::string> Undetermined(const Problem& problem, const std::vector<ParameterVerdict>& verdicts) {
  struct Told {
    std::vector<std::string> names;
    const ParameterVerdict* first = nullptr;
  };
  std::vector<Told> groups;
  for (const ParameterVerdict& v : verdicts) {
    if (v.verdict != Verdict::kNotIdentifiable) continue;
    const std::string& name = problem.parameters()[static_cast<std::size_t>(v.parameter)].name;
    auto same = std::find_if(groups.begin(), groups.end(),
                             [&](const Told& told) { return told.first->reason == v.reason; });
    if (same == groups.end()) {
      groups.push_back({{}, &v});
      same = groups.end() - 1;
    }
    same->names.push_back(name);
  }
  std::vector<std::string> sentences;
  for (const Told& told : groups) {
    std::string sentence = fmt::format("{}: NOT identifiable: {}.", And(told.names), told.first->reason);
    if (!told.first->remedy.empty()) sentence += " " + Capitalised(told.first->remedy) + ".";
    sentences.push_back(std::move(sentence));
  }
  return sentences;
}

std::vector<std::string> Predictions(const FullPrediction& prediction) {
  std::vector<std::string> sentences;
  for (const FitQuality& train : prediction.pooled) {
    if (train.role != BlockRole::kTrain) continue;
    std::string sentence = fmt::format("{}: train {} {} RMSE (R2 {:.3f})", Capitalised(train.channel),
                                       Readable(train.rmse, 2), train.unit, train.r2);
    for (const FitQuality& validate : prediction.pooled) {
      if (validate.role != BlockRole::kValidate || validate.channel != train.channel) continue;
      sentence +=
          fmt::format(", validate {} {} (R2 {:.3f})", Readable(validate.rmse, 2), validate.unit, validate.r2);
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
