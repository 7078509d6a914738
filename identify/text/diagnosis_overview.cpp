#include "identify/text/diagnosis_overview.h"

#include <algorithm>
#include <map>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/text/diagnosis_sentences.h"
#include "identify/text/effects.h"
#include "identify/text/phrases.h"
#include "identify/text/shapes.h"
#include "identify/text/warnings.h"

namespace sinew::text {
namespace {

constexpr int kOuter = 2;
constexpr int kInner = 4;
constexpr std::size_t kMaxListed = 8;  // of a list that goes on in the JSON and the report

std::string PValue(double p) {
  return p < 1e-4 ? "p < 0.0001" : "p = " + Readable(p, 2);
}

std::string IntervalText(const DiagnosedParameter& p) {
  if (!p.at_bound.empty()) return "at its " + p.at_bound + " bound";
  if (!IsDetermined(p)) return "not determined by these data";
  return fmt::format("95 % interval {} to {}", Readable(p.ci95[0]), Readable(p.ci95[1]));
}

std::string SizeText(const DiagnosedParameter& p) {
  return fmt::format("{} = {} ({})", p.name, WithUnit(p.value, p.unit), IntervalText(p));
}

// "a; b; c; and 4 more"
std::string Listed(const std::vector<std::string>& parts) {
  if (parts.size() <= kMaxListed) return Join(parts, "; ");
  return Join({parts.begin(), parts.begin() + kMaxListed}, "; ") +
         fmt::format("; and {} more", parts.size() - kMaxListed);
}

// The sentences name the causes; this is how sure they are.
void AddEvidence(const Diagnosis& d, std::vector<Line>& lines) {
  if (!d.causes.empty()) lines.push_back({kOuter, "Evidence:"});
  for (const Cause& c : d.causes) {
    std::vector<std::string> sizes;
    for (const DiagnosedParameter& p : c.parameters) sizes.push_back(SizeText(p));
    std::string text = fmt::format("{}: {}; ", c.effect, Join(sizes, ", "));
    if (c.left_out > 0) {
      text += fmt::format("the error of data left out of the fit is {} lower", Percent(1 - c.left_out));
    } else {
      text +=
          fmt::format("{}, delta LR {:.1f}, delta BIC {:.1f}", PValue(c.p_value), c.delta_lr, c.delta_bic);
      if (c.size > 0) text += fmt::format("; {} times the smallest detectable size", Readable(c.size, 2));
    }
    lines.push_back({kInner, std::move(text)});
  }
}

// How the error of left-out data fell with the number of causes.
void AddLadder(const Diagnosis& d, std::vector<Line>& lines) {
  if (d.ladder.size() < 2) return;
  lines.push_back({kOuter, "Error of data left out of the fit, over that of the base model:"});
  for (const LadderStep& step : d.ladder) {
    if (!step.effects.empty()) lines.push_back({kInner, Percent(step.error) + " with " + And(step.effects)});
  }
}

// How firm the choice is.
void AddChosenShares(const Diagnosis& d, std::vector<Line>& lines) {
  constexpr double kLeast = 0.01;
  std::vector<std::string> shares;
  for (const ChosenShare& one : d.chosen_shares) {
    if (one.share >= kLeast) shares.push_back(one.effect + " " + Percent(one.share));
  }
  if (!shares.empty())
    lines.push_back({kOuter, "Chosen, of 1000 resamples of the left-out data: " + Join(shares, ", ")});
}

void AddStructure(const Diagnosis& d, std::vector<Line>& lines) {
  constexpr std::size_t kShown = 3;
  for (std::size_t i = 0; i < std::min(d.structure.size(), kShown); ++i) {
    const Structure& s = d.structure[i];
    if (s.explained_fraction <= 0) break;
    if (i == 0) lines.push_back({kOuter, "Where the residual is:"});
    const std::string shape = ShapeText(s.shape);
    lines.push_back({kInner, fmt::format("{} against {}: {} of its variance{}", s.channel, s.signal,
                                         Percent(s.explained_fraction), shape.empty() ? "" : ", " + shape)});
  }
}

void AddFit(const Diagnosis& d, std::vector<Line>& lines) {
  for (const FitQuality& train : d.base_fit) {
    if (train.role != BlockRole::kTrain) continue;
    std::string text = fmt::format("{}: train {} RMSE (R2 {:.3f})", train.channel,
                                   WithUnit(train.rmse, train.unit, 2), train.r2);
    for (const FitQuality& held_out : d.base_fit) {
      if (held_out.role != BlockRole::kValidate || held_out.channel != train.channel) continue;
      text +=
          fmt::format(", validate {} (R2 {:.3f})", WithUnit(held_out.rmse, held_out.unit, 2), held_out.r2);
    }
    lines.push_back({kInner, std::move(text)});
  }
  for (const NoiseFloor& floor : d.noise) {
    lines.push_back({kInner, fmt::format("{}: noise floor {} ({})", floor.channel,
                                         WithUnit(floor.sigma, floor.unit, 2), BasisText(floor.basis))});
  }
}

void AddBaseModel(const Diagnosis& d, std::vector<Line>& lines) {
  const Stop& stop = d.base.stop;
  lines.push_back({kOuter, fmt::format("Base model {}: {}",
                                       stop.converged() ? "converged" : "did NOT converge", stop.test)});
  for (const DiagnosedParameter& p : d.base_parameters) lines.push_back({kInner, SizeText(p)});
  AddFit(d, lines);
}

void AddRuledOut(const Diagnosis& d, std::vector<Line>& lines) {
  std::vector<std::string> detectable;
  std::map<NotJudged, std::vector<std::string>> not_judged;
  for (const EffectScore& s : d.scores) {
    const auto is = [&](const auto& found) { return found.effect == s.effect; };
    if (!s.known || std::any_of(d.causes.begin(), d.causes.end(), is)) continue;
    if (std::any_of(d.alternatives.begin(), d.alternatives.end(), is)) continue;
    if (!s.judged) {
      not_judged[s.why_not].push_back(s.effect);
    } else if (s.smallest_detectable > 0) {
      detectable.push_back(s.detectable_parameter + " " +
                           WithUnit(s.smallest_detectable, s.detectable_unit, 2));
    }
  }
  if (!detectable.empty()) {
    const std::string which = d.causes.empty() ? "Effects" : "Other effects";
    lines.push_back(
        {kOuter, which + " would have been noticed (95 %) above these sizes: " + Listed(detectable) + "."});
  }
  for (const auto& [why, effects] : not_judged)
    lines.push_back({kOuter, fmt::format("Not judged: {}: {}.", Listed(effects), ReasonText(why))});
}

}  // namespace

std::vector<Line> Overview(const Diagnosis& diagnosis) {
  std::vector<Line> lines;
  for (const Sentence& sentence : Sentences(diagnosis))
    lines.push_back({IsSubordinate(sentence) ? kInner : kOuter, sentence.text});
  AddEvidence(diagnosis, lines);
  AddLadder(diagnosis, lines);
  AddChosenShares(diagnosis, lines);
  AddStructure(diagnosis, lines);
  AddBaseModel(diagnosis, lines);
  AddRuledOut(diagnosis, lines);
  for (const std::string& warning : Warnings(diagnosis)) lines.push_back({kOuter, "warning: " + warning});
  return lines;
}

}  // namespace sinew::text
