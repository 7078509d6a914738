#include "identify/text/effects.h"

#include <cmath>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/text/phrases.h"

namespace sinew::text {

std::string DescriptionOf(const Cause& cause) {
  if (cause.kind == CauseKind::kQuantisation)
    return cause.channel + ": the sensor rounds its reading; no model can undo that";
  return cause.description;
}

std::string ReasonText(const WithdrawnCause& cause) {
  if (!cause.terms.empty()) {
    return fmt::format(
        "it may be a part of the unknown {}: beside that, it does not improve the prediction of data left "
        "out of "
        "the fit",
        Join(cause.terms, " and "));
  }
  std::string text = "it does not generalise to the held-out trials";
  if (std::isfinite(cause.delta_lr)) {
    text += fmt::format(" (delta LR {:.0f} in the fitted trials, {:.0f} in those)", cause.delta_lr,
                        -cause.held_out_loss);
  }
  if (cause.worst) {
    const TraceErrors& worst = *cause.worst;
    text += fmt::format("; worst in trial '{}': {} {} -> {} RMSE", worst.trial, worst.channel,
                        Readable(worst.without), WithUnit(worst.with, worst.unit));
  }
  return text;
}

std::string ReasonText(NotJudged reason) {
  switch (reason) {
    case NotJudged::kNone:
      return {};
    case NotJudged::kNoDistinctChange:
      return "it changes no fitted channel, or the base parameters compensate it fully";
  }
  return {};
}

std::string ProbeText(const std::vector<ProbeValue>& probe) {
  std::vector<std::string> parts;
  for (const ProbeValue& at : probe)
    parts.push_back(fmt::format("{} = {}", at.parameter, WithUnit(at.value, at.unit)));
  return Join(parts, ", ");
}

std::string BasisText(NoiseBasis basis) {
  switch (basis) {
    case NoiseBasis::kStatedByData:
      return "stated by the data";
    case NoiseBasis::kDifferences:
      return "differences of neighbouring samples of the measured signal";
    case NoiseBasis::kHighFrequencies:
      return "high frequencies of the residual of the extended model";
    case NoiseBasis::kInputs:
      return "noise of the recorded input, carried here by the model";
    case NoiseBasis::kExtendedModel:
      return "residual of the extended model";
  }
  return {};
}

std::string ParametersText(const std::vector<DiagnosedParameter>& parameters) {
  std::vector<std::string> parts;
  for (const DiagnosedParameter& p : parameters) {
    parts.push_back(fmt::format("{} = {}{}{}", p.name, WithUnit(p.value, p.unit),
                                p.std_error > 0 ? " +-" + Readable(1.96 * p.std_error, 2) : "",
                                p.at_bound.empty() ? "" : " (its " + p.at_bound + " bound)"));
  }
  return Join(parts, ", ");
}

}  // namespace sinew::text
