#include "cli/diagnosis_text.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/terminal.h"
#include "identify/files/diagnosis_json.h"

namespace sinew {
namespace {

constexpr int kWidth = 100;          // columns
constexpr std::size_t kMaxRows = 8;  // of a list that goes on in the JSON and the report

std::string WithUnit(double value, const std::string& unit, int digits = 3) {
  return Readable(value, digits) + (unit == "1" || unit.empty() ? "" : " " + unit);
}

std::string Line(const std::string& sentence, int indent) {
  return Wrapped(sentence, indent, kWidth);
}

std::string PValue(double p) {
  return p < 1e-4 ? "p < 0.0001" : "p = " + Readable(p, 2);
}

std::string Percent(double fraction) {
  return fmt::format("{:.0f} %", 100 * fraction);
}

std::string Interval(const DiagnosedParameter& p) {
  if (!p.at_bound.empty()) return "at its " + p.at_bound + " bound";
  if (!IsDetermined(p)) return "not determined by these data";
  return fmt::format("95 % interval {} to {}", Readable(p.ci95[0]), Readable(p.ci95[1]));
}

std::string Sizes(const std::vector<DiagnosedParameter>& parameters) {
  std::vector<std::string> sizes;
  for (const DiagnosedParameter& p : parameters)
    sizes.push_back(fmt::format("{} = {} ({})", p.name, WithUnit(p.value, p.unit), Interval(p)));
  return Join(sizes, ", ");
}

std::string Fit(const Diagnosis& d) {
  std::string text;
  for (const FitQuality& train : d.base_fit) {
    if (train.role != BlockRole::kTrain) continue;
    std::string line = fmt::format("{}: train {} RMSE (R2 {:.3f})", train.channel,
                                   WithUnit(train.rmse, train.unit, 2), train.r2);
    for (const FitQuality& held_out : d.base_fit) {
      if (held_out.role != BlockRole::kValidate || held_out.channel != train.channel) continue;
      line +=
          fmt::format(", validate {} (R2 {:.3f})", WithUnit(held_out.rmse, held_out.unit, 2), held_out.r2);
    }
    text += Line(line, 4);
  }
  for (const NoiseFloor& floor : d.noise) {
    text += Line(fmt::format("{}: noise floor {} ({})", floor.channel, WithUnit(floor.sigma, floor.unit, 2),
                             floor.basis),
                 4);
  }
  return text;
}

std::string BaseModel(const Diagnosis& d) {
  std::string text =
      Line(fmt::format("Base model {}: {}", d.base.stop.converged() ? "converged" : "did NOT converge",
                       d.base.stop.test),
           2);
  for (const DiagnosedParameter& p : d.base_parameters)
    text += Line(fmt::format("{} = {} ({})", p.name, WithUnit(p.value, p.unit), Interval(p)), 4);
  return text + Fit(d);
}

std::string Where(const Diagnosis& d) {
  std::string text;
  std::size_t shown = 0;
  for (const Structure& s : d.structure) {
    if (s.explained_fraction <= 0 || shown == 3) break;
    if (shown++ == 0) text += Line("Where the residual is:", 2);
    text += Line(fmt::format("{} against {}: {} of its variance{}", s.channel, s.signal,
                             Percent(s.explained_fraction), s.shape.empty() ? "" : ", " + s.shape),
                 4);
  }
  return text;
}

// The sentences name the causes; this is how sure they are.
std::string HowSure(const Diagnosis& d) {
  std::string text;
  for (const Cause& c : d.causes) {
    std::string line = fmt::format("{}: {}; ", c.effect, Sizes(c.parameters));
    if (c.left_out > 0) {
      line += fmt::format("trials left out of the fit are missed by {} less", Percent(1 - c.left_out));
      text += Line(line, 4);
      continue;
    }
    line += fmt::format("{}, delta LR {:.1f}, delta BIC {:.1f}", PValue(c.p_value), c.delta_lr, c.delta_bic);
    if (c.size > 0) line += fmt::format("; {} times what would just be noticed", Readable(c.size, 2));
    text += Line(line, 4);
  }
  return text.empty() ? "" : Line("Evidence:", 2) + text;
}

// "a, b, c and 4 more"
std::string Some(const std::vector<std::string>& parts) {
  if (parts.size() <= kMaxRows) return Join(parts, "; ");
  return Join({parts.begin(), parts.begin() + kMaxRows}, "; ") +
         fmt::format("; and {} more", parts.size() - kMaxRows);
}

std::string RuledOut(const Diagnosis& d) {
  std::vector<std::string> noticed;
  std::map<std::string, std::vector<std::string>> not_judged;  // by the reason
  for (const EffectScore& s : d.scores) {
    const auto is = [&](const auto& found) { return found.effect == s.effect; };
    if (!s.known || std::any_of(d.causes.begin(), d.causes.end(), is)) continue;
    if (std::any_of(d.alternatives.begin(), d.alternatives.end(), is)) continue;
    if (!s.judged) {
      not_judged[s.why_not].push_back(s.effect);
    } else if (s.smallest_detectable > 0) {
      noticed.push_back(fmt::format("{} {}", s.detectable_parameter,
                                    WithUnit(s.smallest_detectable, s.detectable_unit, 2)));
    }
  }
  std::string text;
  if (!noticed.empty()) {
    const std::string which = d.causes.empty() ? "Effects" : "Other effects";
    text += Line(which + " would have been noticed (95 %) above these sizes: " + Some(noticed) + ".", 2);
  }
  for (const auto& [why, effects] : not_judged)
    text += Line(fmt::format("Not judged: {}: {}.", Some(effects), why), 2);
  return text;
}

}  // namespace

std::string DiagnosisText(const Diagnosis& diagnosis) {
  std::string text;
  for (const std::string& sentence : diagnosis.sentences) {
    const bool belongs_to_cause =
        sentence.rfind("Could also be", 0) == 0 || sentence.rfind("A richer law", 0) == 0;
    text += Line(sentence, belongs_to_cause ? 4 : 2);
  }
  text += HowSure(diagnosis) + Where(diagnosis) + BaseModel(diagnosis) + RuledOut(diagnosis);
  for (const std::string& warning : diagnosis.warnings) text += Line("warning: " + warning, 2);
  return text;
}

}  // namespace sinew
