#include "identify/files/diagnosis_file.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "base/constants.h"
#include "base/text.h"
#include "identify/equal_noise_view.h"
#include "identify/files/diagnosis_json.h"
#include "identify/files/run_groups.h"
#include "identify/files/trace.h"
#include "identify/text/diagnosis_sentences.h"
#include "identify/text/effects.h"
#include "identify/text/shapes.h"
#include "identify/text/warnings.h"

namespace sinew {
namespace {

// A group with one dataset per column: texts, or numbers (0 and 1 for bool).
template <class Row>
class Columns {
 public:
  Columns(const std::vector<Row>& rows, Hdf5Node& node) : rows_(rows), node_(node) {}

  template <class Function>
  Columns& Add(const char* name, Function value) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value(std::declval<const Row&>()))>>) {
      std::vector<double> numbers;
      for (const Row& row : rows_) numbers.push_back(static_cast<double>(value(row)));
      node_.At(name).SetVector(std::move(numbers));
    } else {
      std::vector<std::string> texts;
      for (const Row& row : rows_) texts.emplace_back(value(row));
      node_.At(name).data = std::move(texts);
    }
    return *this;
  }

 private:
  const std::vector<Row>& rows_;
  Hdf5Node& node_;
};

// A parameter of a cause or an alternative beside the effect's name.
struct OfEffect {
  std::string effect;
  DiagnosedParameter parameter;
};

template <class Finding>
std::vector<OfEffect> ParametersOf(const std::vector<Finding>& findings) {
  std::vector<OfEffect> rows;
  for (const Finding& finding : findings) {
    for (const DiagnosedParameter& p : finding.parameters) rows.push_back({finding.effect, p});
  }
  return rows;
}

std::vector<OfEffect> WithoutEffect(const std::vector<DiagnosedParameter>& parameters) {
  std::vector<OfEffect> rows;
  for (const DiagnosedParameter& p : parameters) rows.push_back({"", p});
  return rows;
}

void WriteDiagnosed(const std::vector<OfEffect>& rows, Hdf5Node& node) {
  Columns(rows, node)
      .Add("effect", [](const OfEffect& r) { return r.effect; })
      .Add("name", [](const OfEffect& r) { return r.parameter.name; })
      .Add("unit", [](const OfEffect& r) { return r.parameter.unit; })
      .Add("value", [](const OfEffect& r) { return r.parameter.value; })
      .Add("std_error",
           [](const OfEffect& r) { return IsDetermined(r.parameter) ? r.parameter.std_error : kNaN; })
      .Add("ci95_lower",
           [](const OfEffect& r) { return IsDetermined(r.parameter) ? r.parameter.ci95[0] : kNaN; })
      .Add("ci95_upper",
           [](const OfEffect& r) { return IsDetermined(r.parameter) ? r.parameter.ci95[1] : kNaN; })
      .Add("before", [](const OfEffect& r) { return r.parameter.before; });
}

void WriteFit(const std::vector<FitQuality>& fit, Hdf5Node& node) {
  Columns(fit, node)
      .Add("role", [](const FitQuality& q) { return ToString(q.role); })
      .Add("channel", [](const FitQuality& q) { return q.channel; })
      .Add("unit", [](const FitQuality& q) { return q.unit; })
      .Add("rmse", [](const FitQuality& q) { return q.rmse; })
      .Add("mae", [](const FitQuality& q) { return q.mae; })
      .Add("r2", [](const FitQuality& q) { return q.r2; })
      .Add("n", [](const FitQuality& q) { return q.n; });
}

void WriteScores(const Diagnosis& diagnosis, Hdf5Node& node) {
  using Score = EffectScore;
  Columns(diagnosis.scores, node)
      .Add("effect", [](const Score& s) { return s.effect; })
      .Add("level", [](const Score& s) { return ToString(s.level); })
      .Add("finding", [&](const Score& s) { return files::FindingOf(diagnosis, s); })
      .Add("probe", [](const Score& s) { return text::ProbeText(s.probe); })
      .Add("why_not", [](const Score& s) { return text::ReasonText(s.why_not); })
      .Add("why_not_kind", [](const Score& s) { return ToString(s.why_not); })
      .Add("detectable_parameter", [](const Score& s) { return s.detectable_parameter; })
      .Add("detectable_unit", [](const Score& s) { return s.detectable_unit; })
      .Add("known", [](const Score& s) { return s.known; })
      .Add("judged", [](const Score& s) { return s.judged; })
      .Add("refitted", [](const Score& s) { return s.refitted; })
      .Add("degrees", [](const Score& s) { return s.degrees; })
      .Add("statistic", [](const Score& s) { return s.statistic; })
      .Add("unwhitened", [](const Score& s) { return s.unwhitened; })
      .Add("p_value", [](const Score& s) { return s.p_value; })
      .Add("family_p_value", [](const Score& s) { return s.family_p_value; })
      .Add("delta_lr", [](const Score& s) { return s.refitted ? s.delta_lr : kNaN; })
      .Add("delta_bic", [](const Score& s) { return s.refitted ? s.delta_bic : kNaN; })
      .Add("smallest_detectable",
           [](const Score& s) { return s.smallest_detectable > 0 ? s.smallest_detectable : kNaN; });
}

void WriteFindings(const Diagnosis& diagnosis, Hdf5Node& node) {
  Columns(diagnosis.levels, node.At("levels"))
      .Add("level", [](const LevelEvidence& l) { return ToString(l.level); })
      .Add("standing", [](const LevelEvidence& l) { return ToString(l.standing); })
      .Add("effects", [](const LevelEvidence& l) { return Join(l.effects, ","); })
      .Add("parameters", [](const LevelEvidence& l) { return l.parameters; })
      .Add("delta_lr", [](const LevelEvidence& l) { return l.delta_lr; })
      .Add("behind", [](const LevelEvidence& l) { return l.behind; })
      .Add("left_out", [](const LevelEvidence& l) { return l.left_out; });
  Columns(diagnosis.causes, node.At("causes"))
      .Add("effect", [](const Cause& c) { return c.effect; })
      .Add("level", [](const Cause& c) { return ToString(c.level); })
      .Add("kind", [](const Cause& c) { return ToString(c.kind); })
      .Add("sentence", [](const Cause& c) { return text::DescriptionOf(c); })
      .Add("p_value", [](const Cause& c) { return c.p_value; })
      .Add("delta_lr", [](const Cause& c) { return c.delta_lr; })
      .Add("delta_bic", [](const Cause& c) { return c.delta_bic; })
      .Add("size", [](const Cause& c) { return c.size; });
  WriteDiagnosed(ParametersOf(diagnosis.causes), node.At("cause_parameters"));
  Columns(diagnosis.alternatives, node.At("alternatives"))
      .Add("instead_of", [](const Alternative& a) { return a.instead_of; })
      .Add("effect", [](const Alternative& a) { return a.effect; })
      .Add("level", [](const Alternative& a) { return ToString(a.level); })
      .Add("sentence", [](const Alternative& a) { return a.description; })
      .Add("separated_by", [](const Alternative& a) { return a.separated_by; })
      .Add("delta_lr", [](const Alternative& a) { return a.delta_lr; })
      .Add("delta_bic", [](const Alternative& a) { return a.delta_bic; })
      .Add("correlation", [](const Alternative& a) { return a.correlation; })
      .Add("same_class", [](const Alternative& a) { return a.same_class; })
      .Add("contains_cause", [](const Alternative& a) { return a.contains_cause; })
      .Add("separating_size", [](const Alternative& a) { return a.separating_size; });
  WriteDiagnosed(ParametersOf(diagnosis.alternatives), node.At("alternative_parameters"));
  Columns(diagnosis.ladder, node.At("ladder"))
      .Add("effects", [](const LadderStep& step) { return Join(step.effects, ","); })
      .Add("error", [](const LadderStep& step) { return step.error; });
  Columns(diagnosis.chosen_shares, node.At("chosen_shares"))
      .Add("effect", [](const ChosenShare& one) { return one.effect; })
      .Add("share", [](const ChosenShare& one) { return one.share; });
  Columns(diagnosis.withdrawn, node.At("withdrawn"))
      .Add("effect", [](const WithdrawnCause& w) { return w.effect; })
      .Add("reason", [](const WithdrawnCause& w) { return text::ReasonText(w); })
      .Add("delta_lr", [](const WithdrawnCause& w) { return w.delta_lr; })
      .Add("held_out_loss", [](const WithdrawnCause& w) { return w.held_out_loss; });
  Columns(diagnosis.gain, node.At("gain"))
      .Add("channel", [](const Gain& g) { return g.channel; })
      .Add("unit", [](const Gain& g) { return g.unit; })
      .Add("before", [](const Gain& g) { return g.before; })
      .Add("after", [](const Gain& g) { return g.after; })
      .Add("reduction", [](const Gain& g) { return g.reduction; })
      .Add("ci95_lower", [](const Gain& g) { return g.ci95[0]; })
      .Add("ci95_upper", [](const Gain& g) { return g.ci95[1]; })
      .Add("gap_closed", [](const Gain& g) { return g.gap_closed; });
}

void WriteNoise(const Diagnosis& diagnosis, Hdf5Node& node) {
  Columns(diagnosis.noise, node.At("noise"))
      .Add("channel", [](const NoiseFloor& f) { return f.channel; })
      .Add("unit", [](const NoiseFloor& f) { return f.unit; })
      .Add("basis", [](const NoiseFloor& f) { return text::BasisText(f.basis); })
      .Add("basis_kind", [](const NoiseFloor& f) { return ToString(f.basis); })
      .Add("sigma", [](const NoiseFloor& f) { return f.sigma; })
      .Add("rmse", [](const NoiseFloor& f) { return f.rmse; });
  Columns(diagnosis.tests, node.At("tests"))
      .Add("channel", [](const ResidualTest& t) { return t.channel; })
      .Add("test", [](const ResidualTest& t) { return t.name; })
      .Add("statistic", [](const ResidualTest& t) { return t.statistic; })
      .Add("p_value", [](const ResidualTest& t) { return t.p_value; });
}

void WriteCurves(const Diagnosis& diagnosis, Hdf5Node& node) {
  int number = 0;
  for (const Structure& s : diagnosis.structure) {
    Hdf5Node& curve = node.At("structure/" + std::to_string(++number));
    curve.attributes["channel"] = s.channel;
    curve.attributes["signal"] = s.signal;
    curve.attributes["signal_unit"] = s.unit;
    curve.attributes["explained_fraction"] = s.explained_fraction;
    curve.attributes["shape"] = text::ShapeText(s.shape);
    curve.attributes["shape_kind"] = std::string(ToString(s.shape.kind));
    curve.At("knots").SetVector(s.knots);
    curve.At("curve").SetVector(s.curve);
  }
  number = 0;
  for (const UnknownFinding& u : diagnosis.unknown_terms) {
    Hdf5Node& curve = node.At("unknown_terms/" + std::to_string(++number));
    curve.attributes["kind"] = std::string(ToString(u.kind));
    curve.attributes["name"] = u.name;
    curve.attributes["port"] = u.port;
    curve.attributes["signal"] = u.signal;
    curve.attributes["signal_unit"] = u.signal_unit;
    curve.attributes["unit"] = u.unit;
    curve.attributes["shape"] = text::ShapeText(u);
    curve.attributes["shape_kind"] = std::string(ToString(u.shape.kind));
    curve.attributes["nearest_law"] = text::LawText(u);
    curve.attributes["inseparable_from"] = Join(u.inseparable_from, ",");
    curve.attributes["p_value"] = u.p_value;
    curve.attributes["held_out_reduction"] = u.held_out_reduction;
    curve.At("knots").SetVector(u.knots);
    curve.At("curve").SetVector(u.curve);
    curve.At("deviation").SetVector(u.deviation);
  }
  for (const TracePair& t : diagnosis.traces) {
    Hdf5Node& trace = node.At("traces/" + t.trial + "/" + t.channel);
    trace.attributes["role"] = std::string(ToString(t.role));
    trace.attributes["unit"] = t.unit;
    trace.At("time").SetVector(t.time);
    trace.At("measured").SetVector(t.measured);
    trace.At("before").SetVector(t.before);
    trace.At("after").SetVector(t.after);
  }
}

void WriteRun(const Problem& problem, const Diagnosis& diagnosis, const Provenance& provenance,
              const DiagnosisOptions& options, Hdf5Node& run) {
  files::WriteProvenance(provenance, kDiagnoseSolver, options.seed, run);
  const Stop& stop = diagnosis.base.stop;
  const bool interrupted = options.interrupt != nullptr && options.interrupt->load();
  run.attributes["finished"] = std::int64_t{interrupted ? 0 : 1};
  run.attributes["stop_reason"] = std::string(ToString(stop.kind));
  run.attributes["stop_test"] = stop.test;
  run.attributes["converged"] = std::int64_t{stop.converged() ? 1 : 0};
  run.attributes["usable"] = std::int64_t{stop.usable() && diagnosis.concluded() ? 1 : 0};
  run.attributes["iterations"] = std::int64_t{diagnosis.base.iterations};
  run.attributes["seconds"] = diagnosis.seconds;
  run.attributes["cost"] = diagnosis.base.cost;
  run.attributes["objective"] =
      problem.weights_are_noise_levels() ? problem.objective() : EqualNoiseView(problem).objective();
  files::WriteSentences(text::Sentences(diagnosis), diagnosis.warnings, text::Warnings(diagnosis), run);
}

// The base fit's choice, and what the diagnosis released.
FitSetup ExtendedSetup(const Diagnosis& diagnosis) {
  FitSetup setup = diagnosis.setup;
  std::vector<int> free;
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const auto is = [&](const DiagnosedParameter& p) { return p.name == setup.parameters[i].name; };
    const auto& extended = diagnosis.extended_parameters;
    const bool released = std::any_of(extended.begin(), extended.end(), is);
    if (released || setup.IsFree(static_cast<int>(i))) free.push_back(static_cast<int>(i));
  }
  setup.free = std::move(free);
  return setup;
}

}  // namespace

Result<Hdf5Node> DiagnosisTree(const Problem& problem, const Diagnosis& diagnosis,
                               const Provenance& provenance, const DiagnosisOptions& options) {
  Hdf5Node root;
  WriteRun(problem, diagnosis, provenance, options, root.At("run"));
  const FitSetup extended = ExtendedSetup(diagnosis);
  std::vector<std::string> free;
  for (const int i : extended.free) free.push_back(extended.parameters[static_cast<std::size_t>(i)].name);
  files::WriteTrace(SearchRecord(), free, root);  // readers of run files expect it; a diagnosis keeps none

  Hdf5Node& node = root.At("diagnosis");
  node.attributes["sinew_schema"] = std::string("diagnosis/1");
  node.attributes["verdict"] = std::string(ToString(diagnosis.verdict));
  node.attributes["wanders"] = std::int64_t{diagnosis.strongly_autocorrelated ? 1 : 0};
  node.attributes["held_out_shortfall"] = diagnosis.held_out_shortfall;
  node.attributes["alarm_level"] = options.alarm_level;
  node.attributes["threshold"] = diagnosis.threshold;
  node.attributes["family_p_value"] = diagnosis.family_p_value;
  node.attributes["inconclusive_kind"] = std::string(ToString(diagnosis.inconclusive));
  const Hdf5Node& run = root.At("run");
  node.At("sentences").data = run.Find("findings")->data;
  node.At("sentence_kinds").data = run.Find("finding_kinds")->data;
  node.At("warnings").data = run.Find("warnings")->data;
  node.At("warning_kinds").data = run.Find("warning_kinds")->data;
  WriteDiagnosed(WithoutEffect(diagnosis.base_parameters), node.At("base_parameters"));
  WriteDiagnosed(WithoutEffect(diagnosis.extended_parameters), node.At("extended_parameters"));
  WriteFit(diagnosis.base_fit, node.At("base_fit"));
  WriteFit(diagnosis.extended_fit, node.At("extended_fit"));
  WriteNoise(diagnosis, node);
  WriteScores(diagnosis, node.At("scores"));
  WriteFindings(diagnosis, node);
  WriteCurves(diagnosis, node);

  const auto parameters = static_cast<Eigen::Index>(problem.parameters().size());
  if (!diagnosis.base.stop.usable() || diagnosis.extended_point.size() != parameters) return root;
  files::WriteParameters(extended, diagnosis.extended_point, root.At("parameters"));
  const Vector& before = diagnosis.base_point;
  root.At("parameters/before").SetVector({before.data(), before.data() + before.size()});
  SINEW_ASSIGN(const FullPrediction prediction, PredictAll(problem, diagnosis.extended_point));
  files::WritePredictions(problem.layout(), prediction, root);
  SINEW_TRY(problem.WriteDetails(diagnosis.extended_point, root.At("details")));
  return root;
}

}  // namespace sinew
