#include "identify/files/diagnosis_json.h"

#include <algorithm>

#include "identify/files/json_values.h"
#include "identify/text/diagnosis_sentences.h"
#include "identify/text/effects.h"
#include "identify/text/phrases.h"
#include "identify/text/shapes.h"
#include "identify/text/warnings.h"

namespace sinew::files {
namespace {

Json FiniteAll(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(Finite(value));
  return json;
}

Json Interval(const std::array<double, 2>& ci95) {
  return Json{Finite(ci95[0]), Finite(ci95[1])};
}

template <class Part, class Function>
Json List(const std::vector<Part>& parts, Function to_json) {
  Json json = Json::array();
  for (const Part& part : parts) json.push_back(to_json(part));
  return json;
}

Json FromParameter(const DiagnosedParameter& p) {
  return {{"name", p.name},
          {"value", Finite(p.value)},
          {"unit", p.unit},
          {"std_error", IsDetermined(p) ? Finite(p.std_error) : Json(nullptr)},
          {"ci95", IsDetermined(p) ? Interval(p.ci95) : Json(nullptr)},
          {"at_bound", p.at_bound.empty() ? Json(nullptr) : Json(p.at_bound)},
          {"before", Finite(p.before)}};
}

Json FromFit(const FitQuality& q) {
  return {{"role", ToString(q.role)}, {"channel", q.channel}, {"unit", q.unit}, {"rmse", Finite(q.rmse)},
          {"mae", Finite(q.mae)},     {"r2", Finite(q.r2)},   {"n", q.n}};
}

Json FromNoise(const NoiseFloor& floor) {
  return {{"channel", floor.channel},
          {"unit", floor.unit},
          {"sigma", Finite(floor.sigma)},
          {"rmse", Finite(floor.rmse)},
          {"basis", text::BasisText(floor.basis)},
          {"basis_kind", ToString(floor.basis)}};
}

Json FromTest(const ResidualTest& test) {
  return {{"channel", test.channel},
          {"test", test.name},
          {"statistic", Finite(test.statistic)},
          {"p_value", Finite(test.p_value)}};
}

Json FromStructure(const Structure& s) {
  return {{"channel", s.channel},
          {"signal", s.signal},
          {"explained_fraction", Finite(s.explained_fraction)},
          {"shape", text::ShapeText(s.shape)},
          {"shape_kind", ToString(s.shape.kind)},
          {"shape_explained", Finite(s.shape.explained)},
          {"signal_unit", s.unit},
          {"knots", FiniteAll(s.knots)},
          {"curve", FiniteAll(s.curve)}};
}

Json FromCause(const Cause& c) {
  return {{"effect", c.effect},
          {"level", ToString(c.level)},
          {"kind", ToString(c.kind)},
          {"sentence", text::DescriptionOf(c)},
          {"parameters", List(c.parameters, FromParameter)},
          {"p_value", Finite(c.p_value)},
          {"delta_lr", Finite(c.delta_lr)},
          {"delta_bic", Finite(c.delta_bic)},
          {"size", Finite(c.size)},
          {"interval_contains_null", c.interval_contains_null},
          {"left_out", Finite(c.left_out)}};
}

Json FromAlternative(const Alternative& a) {
  return {{"instead_of", a.instead_of},
          {"effect", a.effect},
          {"level", ToString(a.level)},
          {"sentence", a.description},
          {"parameters", List(a.parameters, FromParameter)},
          {"delta_lr", Finite(a.delta_lr)},
          {"left_out", Finite(a.left_out)},
          {"delta_bic", Finite(a.delta_bic)},
          {"correlation", Finite(a.correlation)},
          {"same_class", a.same_class},
          {"contains_cause", a.contains_cause},
          {"separating_size", Finite(a.separating_size)},
          {"less_common", a.less_common},
          {"separated_by", a.separated_by}};
}

Json FromUnknown(const UnknownFinding& u) {
  return {{"kind", ToString(u.kind)},
          {"name", u.name},
          {"port", u.port},
          {"signal", u.signal},
          {"shape", text::ShapeText(u)},
          {"nearest_law", text::LawText(u)},
          {"shape_kind", ToString(u.shape.kind)},
          {"shape_explained", Finite(u.shape.explained)},
          {"frequency", u.kind == UnknownKind::kPeriodic ? Finite(u.frequency) : Json(nullptr)},
          {"signal_unit", u.signal_unit},
          {"unit", u.unit},
          {"p_value", Finite(u.p_value)},
          {"held_out_reduction", Finite(u.held_out_reduction)},
          {"knots", FiniteAll(u.knots)},
          {"curve", FiniteAll(u.curve)},
          {"deviation", FiniteAll(u.deviation)},
          {"inseparable_from", u.inseparable_from}};
}

Json FromGain(const Gain& g) {
  return {{"channel", g.channel},
          {"unit", g.unit},
          {"validate_rmse_before", Finite(g.before)},
          {"validate_rmse_after", Finite(g.after)},
          {"reduction", Finite(g.reduction)},
          {"ci95", Interval(g.ci95)},
          {"gap_closed", Finite(g.gap_closed)}};
}

Json Detectable(const EffectScore& s) {
  if (!(s.smallest_detectable > 0)) return nullptr;
  return {{"parameter", s.detectable_parameter},
          {"value", Finite(s.smallest_detectable)},
          {"unit", s.detectable_unit}};
}

Json FromProbe(const ProbeValue& at) {
  return {{"parameter", at.parameter}, {"unit", at.unit}, {"value", Finite(at.value)}};
}

Json FromWithdrawn(const WithdrawnCause& w) {
  Json worst = nullptr;
  if (w.worst) {
    worst = {{"trial", w.worst->trial},
             {"channel", w.worst->channel},
             {"unit", w.worst->unit},
             {"rmse_without", Finite(w.worst->without)},
             {"rmse_with", Finite(w.worst->with)}};
  }
  return {{"effect", w.effect},
          {"reason", text::ReasonText(w)},
          {"delta_lr", Finite(w.delta_lr)},
          {"held_out_loss", Finite(w.held_out_loss)},
          {"worst", worst},
          {"terms", w.terms}};
}

Json FromLevel(const LevelEvidence& l) {
  return {{"level", ToString(l.level)},    {"standing", ToString(l.standing)}, {"effects", l.effects},
          {"parameters", l.parameters},    {"delta_lr", Finite(l.delta_lr)},   {"behind", Finite(l.behind)},
          {"left_out", Finite(l.left_out)}};
}

Json FromScore(const Diagnosis& diagnosis, const EffectScore& s) {
  return {{"effect", s.effect},
          {"level", ToString(s.level)},
          {"finding", FindingOf(diagnosis, s)},
          {"known", s.known},
          {"probe", text::ProbeText(s.probe)},
          {"probe_values", List(s.probe, FromProbe)},
          {"degrees", s.degrees},
          {"statistic", Finite(s.statistic)},
          {"unwhitened", Finite(s.unwhitened)},
          {"p_value", Finite(s.p_value)},
          {"family_p_value", Finite(s.family_p_value)},
          {"judged", s.judged},
          {"why_not", text::ReasonText(s.why_not)},
          {"why_not_kind", ToString(s.why_not)},
          {"refitted", s.refitted},
          {"delta_lr", s.refitted ? Finite(s.delta_lr) : Json(nullptr)},
          {"delta_bic", s.refitted ? Finite(s.delta_bic) : Json(nullptr)},
          {"smallest_detectable", Detectable(s)}};
}

Json FromBase(const Diagnosis& d) {
  return {{"stop_reason", ToString(d.base.stop.kind)},
          {"stop_test", d.base.stop.test},
          {"converged", d.base.stop.converged()},
          {"cost", Finite(d.base.cost)},
          {"parameters", List(d.base_parameters, FromParameter)},
          {"fit", List(d.base_fit, FromFit)},
          {"noise_floor", List(d.noise, FromNoise)},
          {"tests", List(d.tests, FromTest)}};
}

}  // namespace

const char* FindingOf(const Diagnosis& diagnosis, const EffectScore& score) {
  const auto names = [&](const auto& found) { return found.effect == score.effect; };
  const auto any = [&](const auto& list) { return std::any_of(list.begin(), list.end(), names); };
  if (any(diagnosis.causes)) return "cause";
  if (any(diagnosis.alternatives)) return "alternative";
  if (any(diagnosis.withdrawn)) return "withdrawn";
  const auto is_term = [&](const UnknownFinding& u) { return u.name == score.effect; };
  if (std::any_of(diagnosis.unknown_terms.begin(), diagnosis.unknown_terms.end(), is_term))
    return "unknown_term";
  return score.judged ? "ruled_out" : "not_judged";
}

std::string DiagnosisJson(const Diagnosis& diagnosis, const Provenance& provenance,
                          const DiagnosisOptions& options) {
  Json json = ResultHead("sinew.diagnosis/1", provenance);
  json["seed"] = options.seed;
  json["seconds"] = Finite(diagnosis.seconds);
  json["verdict"] = ToString(diagnosis.verdict);
  json["concluded"] = diagnosis.concluded();
  json["inconclusive_kind"] = ToString(diagnosis.inconclusive);
  json["wanders"] = diagnosis.strongly_autocorrelated;
  json["held_out_shortfall"] = diagnosis.held_out_shortfall;
  const std::vector<text::Sentence> sentences = text::Sentences(diagnosis);
  json["sentences"] = text::TextsOf(sentences);
  json["sentence_facts"] = FromSentences(sentences);
  json["warnings"] = text::Warnings(diagnosis);
  json["warning_facts"] = FromWarnings(diagnosis.warnings);
  json["alarm_level"] = options.alarm_level;
  json["threshold"] = Finite(diagnosis.threshold);
  json["family_p_value"] = Finite(diagnosis.family_p_value);
  json["base"] = FromBase(diagnosis);
  json["structure"] = List(diagnosis.structure, FromStructure);
  json["levels"] = List(diagnosis.levels, FromLevel);
  json["causes"] = List(diagnosis.causes, FromCause);
  json["alternatives"] = List(diagnosis.alternatives, FromAlternative);
  json["withdrawn"] = List(diagnosis.withdrawn, FromWithdrawn);
  json["ruled_out"] = Json::array();
  json["not_judged"] = Json::array();
  for (const EffectScore& s : diagnosis.scores) {
    const std::string finding = FindingOf(diagnosis, s);
    if (finding == "ruled_out" && s.known) {
      json["ruled_out"].push_back(
          {{"effect", s.effect}, {"p_value", Finite(s.p_value)}, {"smallest_detectable", Detectable(s)}});
    }
    if (finding == "not_judged")
      json["not_judged"].push_back(
          {{"effect", s.effect}, {"why", text::ReasonText(s.why_not)}, {"why_kind", ToString(s.why_not)}});
  }
  json["gain"] = diagnosis.gain.empty() ? Json(nullptr) : FromGain(diagnosis.gain.front());
  json["gains"] = List(diagnosis.gain, FromGain);
  json["left_out"] = List(diagnosis.left_out, text::LeftOutText);
  json["left_out_trials"] = List(diagnosis.left_out, [](const LeftOutData& data) { return data.trials; });
  json["left_out_windows"] = List(diagnosis.left_out, [](const LeftOutData& data) {
    return data.window ? Json::array({Finite(data.window->front()), Finite(data.window->back())}) : Json();
  });
  json["ladder"] = List(diagnosis.ladder, [](const LadderStep& step) {
    return Json{{"effects", step.effects}, {"error", Finite(step.error)}};
  });
  json["chosen_shares"] = List(diagnosis.chosen_shares, [](const ChosenShare& one) {
    return Json{{"effect", one.effect}, {"share", Finite(one.share)}};
  });
  json["unknown_terms"] = List(diagnosis.unknown_terms, FromUnknown);
  json["extended_parameters"] = List(diagnosis.extended_parameters, FromParameter);
  json["extended_fit"] = List(diagnosis.extended_fit, FromFit);
  json["scores"] = List(diagnosis.scores, [&](const EffectScore& s) { return FromScore(diagnosis, s); });
  // Names of files and trials are bytes; what is not UTF-8 is replaced instead of thrown at.
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace sinew::files
