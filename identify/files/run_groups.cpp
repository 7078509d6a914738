#include "identify/files/run_groups.h"

#include <algorithm>
#include <limits>

#include "base/constants.h"
#include "base/text.h"
#include "base/version.h"

namespace sinew::files {
void WriteProvenance(const Provenance& provenance, const std::string& solver, std::uint64_t seed,
                     Hdf5Node& run) {
  run.attributes["sinew_schema"] = std::string("run/1");
  run.attributes["problem"] = provenance.problem;
  run.attributes["solver"] = solver;
  run.attributes["seed"] = static_cast<std::int64_t>(seed);
  run.attributes["version"] = std::string(kVersion);
  run.attributes["data_file"] = provenance.data_file;
  run.attributes["data_hash"] = provenance.data_hash;
  run.attributes["title"] = provenance.title;
  run.attributes["synthetic"] = std::int64_t{provenance.synthetic ? 1 : 0};
  if (provenance.starts > 0) run.attributes["starts"] = std::int64_t{provenance.starts};
  if (!provenance.config.empty()) run.At("config").data = provenance.config;
}

void WriteParameters(const FitSetup& setup, const Vector& values, Hdf5Node& node) {
  std::vector<std::string> name, unit, meaning, source, kind, effect, trial, scale;
  std::vector<double> lower, upper, null, start, value, free, mean, deviation;
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    name.push_back(p.name);
    unit.push_back(p.unit);
    meaning.push_back(p.meaning);
    source.push_back(p.source);
    kind.emplace_back(p.kind == ParameterKind::kBase       ? "base"
                      : p.kind == ParameterKind::kNuisance ? "nuisance"
                      : p.kind == ParameterKind::kPrior    ? "prior"
                                                           : "effect");
    effect.push_back(p.effect);
    trial.push_back(p.trial);
    scale.emplace_back(p.scale == Scale::kLog ? "log" : "linear");
    lower.push_back(p.lower);
    upper.push_back(p.upper);
    null.push_back(p.kind == ParameterKind::kEffect ? p.null_value : kNaN);
    start.push_back(p.start);
    value.push_back(values[static_cast<Eigen::Index>(i)]);
    free.push_back(setup.IsFree(static_cast<int>(i)) ? 1 : 0);
    mean.push_back(p.prior ? p.prior->mean : std::nan(""));
    deviation.push_back(p.prior ? p.prior->standard_deviation : std::nan(""));
  }
  const std::pair<const char*, std::vector<std::string>*> texts[] = {
      {"name", &name}, {"unit", &unit},     {"meaning", &meaning}, {"source", &source},
      {"kind", &kind}, {"effect", &effect}, {"trial", &trial},     {"scale", &scale}};
  for (const auto& [key, column] : texts) node.At(key).data = std::move(*column);
  const std::pair<const char*, std::vector<double>*> numbers[] = {
      {"lower", &lower}, {"upper", &upper}, {"null", &null},       {"start", &start},
      {"value", &value}, {"free", &free},   {"prior_mean", &mean}, {"prior_deviation", &deviation}};
  for (const auto& [key, column] : numbers) node.At(key).SetVector(std::move(*column));
}

void WriteSentences(const std::vector<text::Sentence>& findings, const std::vector<Warning>& warnings,
                    const std::vector<std::string>& texts, Hdf5Node& run) {
  std::vector<std::string> kinds;
  for (const text::Sentence& finding : findings) kinds.emplace_back(text::ToString(finding.kind));
  std::vector<std::string> warning_kinds;
  for (const Warning& warning : warnings) warning_kinds.emplace_back(ToString(warning.kind));
  run.At("findings").data = text::TextsOf(findings);
  run.At("finding_kinds").data = std::move(kinds);
  run.At("warnings").data = texts;
  run.At("warning_kinds").data = std::move(warning_kinds);
}

void WritePredictions(const Layout& layout, const FullPrediction& prediction, Hdf5Node& root) {
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Block& block = layout[b];
    const Vector& simulated = prediction.values[b];
    std::vector<double> measured(block.prediction_time.size(), kNaN);
    std::vector<double> residual_time, residual;
    for (std::size_t i = 0; i < block.measured.size(); ++i) {
      const auto at = static_cast<std::size_t>(block.sample[i]);
      measured[at] = block.measured[i];
      residual_time.push_back(block.prediction_time[at]);
      residual.push_back(simulated[block.sample[i]] - block.measured[i]);
    }
    const auto quality = std::find_if(
        prediction.quality.begin(), prediction.quality.end(),
        [&](const FitQuality& q) { return q.trial == block.trial && q.channel == block.channel; });
    const bool compared = quality != prediction.quality.end();
    const std::string place = block.trial + "/" + block.channel;
    Hdf5Node& node = root.At("prediction/" + place);
    node.attributes["unit"] = block.unit;
    node.attributes["quantity"] = block.quantity;
    node.attributes["role"] = std::string(ToString(block.role));
    node.attributes["n"] = std::int64_t{block.samples()};
    node.attributes["rmse"] = compared ? quality->rmse : kNaN;
    node.attributes["r2"] = compared ? quality->r2 : kNaN;
    node.At("time").SetVector(block.prediction_time);
    node.At("simulated").SetVector({simulated.data(), simulated.data() + simulated.size()});
    node.At("measured").SetVector(std::move(measured));
    if (!compared) continue;
    Hdf5Node& rest = root.At("residual/" + place);
    rest.attributes["unit"] = block.unit;
    rest.attributes["role"] = std::string(ToString(block.role));
    rest.At("time").SetVector(std::move(residual_time));
    rest.At("residual").SetVector(std::move(residual));
  }
}

}  // namespace sinew::files
