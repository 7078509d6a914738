#include "identify/text/warnings.h"

#include <algorithm>
#include <cmath>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/noise/difference_noise.h"
#include "identify/text/phrases.h"

namespace sinew::text {
namespace {

// "5 of 200 evaluations failed and were rejected; the first because A; in all 4 because B, 1 because A"
std::string FailedEvaluations(const Warning& w) {
  std::string text =
      fmt::format("{:.0f} of {:.0f} evaluations failed and were rejected; the first because {}", w.numbers[0],
                  w.numbers[1], w.message);
  if (w.names.size() < 2) return text;
  for (std::size_t i = 0; i < w.names.size() && i + 2 < w.numbers.size(); ++i)
    text += fmt::format("{}{:.0f} because {}", i == 0 ? "; in all " : ", ", w.numbers[i + 2], w.names[i]);
  return text;
}

std::string DependentResiduals(const Warning& w) {
  std::vector<std::string> channels;
  for (std::size_t i = 0; i < w.names.size(); ++i)
    channels.push_back(fmt::format("{} {:.2f}", w.names[i], w.numbers[i + 1]));
  return fmt::format(
      "the residuals are autocorrelated (lag one: {}): intervals were widened up to {:.1f} times",
      Join(channels, ", "), w.numbers[0]);
}

std::string CompetingMinima(const Warning& w) {
  std::vector<std::string> values;
  for (std::size_t i = 0; i < w.names.size(); ++i)
    values.push_back(fmt::format("{} {}", w.names[i], Readable(w.numbers[i + 2], 2)));
  return fmt::format(
      "{:.0f} minima were found whose costs differ by {} % or less, which the noise does not distinguish: "
      "the "
      "values are those of the lowest, and another seed or slightly other data may end at another one; the "
      "intervals hold all of them. In widths of these intervals the values that differ most do so by: {}",
      w.numbers[0], Readable(100 * w.numbers[1], 2), Join(values, ", "));
}

// Where the errors are, of one channel and trial and of others that have the same.
std::string Concentrated(const Warning& w) {
  constexpr std::size_t kShown = 3;
  std::string text = fmt::format(
      "{} of the squared error of {} in trial '{}' lie within {} s around t = {} s", Percent(w.numbers[0]),
      w.names[0], w.names[1], Readable(w.numbers[1], 2), Readable(w.numbers[2], 3));
  std::vector<std::string> others;
  for (std::size_t i = 1; 2 * i + 1 < w.names.size(); ++i)
    others.push_back(fmt::format("{} in '{}' around {} s", w.names[2 * i], w.names[2 * i + 1],
                                 Readable(w.numbers[3 * i + 2], 3)));
  if (others.empty()) return text;
  if (others.size() > kShown + 1) {
    const std::size_t more = others.size() - kShown;
    others.resize(kShown);
    others.push_back(fmt::format("{} more", more));
  }
  return text + "; likewise " + And(others);
}

std::string HeldFromSteps(const Warning& w) {
  constexpr std::size_t kShown = 4;
  const std::size_t shown = std::min(w.names.size(), kShown);
  const std::string more =
      w.names.size() > kShown ? fmt::format(" and {} more", w.names.size() - kShown) : "";
  return fmt::format(
      "the last step holds what earlier steps found ({}{}); errors and intervals contain theirs, but its "
      "data do not "
      "correct them",
      Join({w.names.begin(), w.names.begin() + static_cast<std::ptrdiff_t>(shown)}, ", "), more);
}

std::string CrossValidated(const Warning& w, const std::vector<LeftOutData>& left_out) {
  std::vector<std::string> groups;
  for (const LeftOutData& data : left_out) groups.push_back(LeftOutText(data));
  const std::string some = w.numbers[1] > w.numbers[0] ? fmt::format(" ({:.0f} of {:.0f} trials searched)",
                                                                     w.numbers[0], w.numbers[1])
                                                       : "";
  return fmt::format(
      "the misfit is much larger than the noise, and the known effects do not explain all of it: causes were "
      "chosen by cross-validation over {}{}, and intervals are jackknife intervals over the same",
      Join(groups, "; "), some);
}

// Which noise is unknown, why, and what would give it.
std::string NoiseLevelUnknown(const Warning& w) {
  std::vector<std::string> channels;
  bool samples_help = false;
  for (std::size_t i = 0; i + 1 < w.names.size(); i += 2) {
    const std::string& why = w.names[i + 1];
    std::string because = "filtered, interpolated or computed: no noise is visible";
    if (why == "few_samples") because = "too few samples in a row";
    if (why == "correlated") because = "its noise is correlated";
    if (why == "constant") because = "it does not change";
    samples_help = samples_help || why == "few_samples" || why == "smooth";
    channels.push_back(w.names[i] + " (" + because + ")");
  }
  std::string text = fmt::format(
      "the noise level of {} is neither stated by the data nor visible in them: what the model leaves cannot "
      "be "
      "compared with it. The instrument's accuracy (attribute sigma of the channel) would give it",
      And(channels));
  if (samples_help) text += fmt::format("; so would {} unfiltered samples in a row", noise::kSamplesForNoise);
  return text;
}

std::string Text(const Warning& w, const std::vector<LeftOutData>& left_out) {
  switch (w.kind) {
    case WarningKind::kFailedEvaluations:
      return FailedEvaluations(w);
    case WarningKind::kNotConverged:
      return fmt::format("the search did not converge ({}): the answer is the best point so far", w.message);
    case WarningKind::kNotAMinimum:
      return fmt::format(
          "the solution was not a minimum: a local search lowered the cost from {:.6g} to {:.6g}; errors and "
          "intervals refer to the better point",
          w.numbers[0], w.numbers[1]);
    case WarningKind::kSearchUnfinished:
      return "a local search from the solution did not converge: errors and intervals are rough";
    case WarningKind::kBetterFit:
      return fmt::format(
          "there is a better fit: on the way to an interval the cost fell from {:.6g} to {:.6g}; search "
          "again "
          "with more starts or a global solver",
          w.numbers[0], w.numbers[1]);
    case WarningKind::kBetterPointTaken:
      return fmt::format(
          "the search ended at a cost of {:.6g}; {:.6g} was found while intervals were computed, and is the "
          "answer: there may be lower minima",
          w.numbers[0], w.numbers[1]);
    case WarningKind::kCompetingMinima:
      return CompetingMinima(w);
    case WarningKind::kDependentResiduals:
      return DependentResiduals(w);
    case WarningKind::kActiveConstraint:
      return fmt::format("constraint {} is active: standard errors do not account for it", w.names[0]);
    case WarningKind::kHeldFromSteps:
      return HeldFromSteps(w);
    case WarningKind::kUnfinishedStart:
      return w.names[0] + " is of a run that was not finished: its values are those of the best point so far";
    case WarningKind::kStatedCost:
      return fmt::format(
          "{} states the cost {}, but its values have the cost {}: it was changed, or made by "
          "another build of this program",
          w.names[0], Readable(w.numbers[0], 6), Readable(w.numbers[1], 6));
    case WarningKind::kNoiseAbsorbsMisfit:
      return "the residual is so large and smooth that a noise model would absorb the misfit: neighbouring "
             "errors are taken as independent, which makes p-values and intervals too small";
    case WarningKind::kEqualNoise:
      return "the objective gives every trial the same share, whatever its noise: the base model was fitted "
             "and "
             "models are compared under one noise level per channel, the same in all trials";
    case WarningKind::kCrossValidated:
      return CrossValidated(w, left_out);
    case WarningKind::kNoiseLevelUnknown:
      return NoiseLevelUnknown(w);
    case WarningKind::kNoValidationTrial:
      return "there is no validation trial: no gain can be measured, and no cause withdrawn";
    case WarningKind::kFreeTermExplainsMore:
      return fmt::format(
          "a free curve or change, {}, explains the error better than the named causes (delta LR less the "
          "price of its parameters {} against {}): they resemble the cause, which may not be in the library",
          w.names[0], Readable(w.numbers[0], 3), Readable(w.numbers[1], 3));
    case WarningKind::kOddTrial:
      if (w.numbers[3] != 0)
        return fmt::format(
            "trial '{}' is out of step with the model that is fitted to the other {:.0f}: its {} is {} by {} "
            "s "
            "(error {} RMS, {} in step), or an input is {}. Check the times of its channels",
            w.names[1], w.numbers[2] - 1, w.names[0], w.numbers[3] > 0 ? "late" : "early",
            Readable(std::abs(w.numbers[3]), 2), WithUnit(w.numbers[0], w.names[2], 2),
            WithUnit(w.numbers[1], w.names[2], 2), w.numbers[3] > 0 ? "early" : "late");
      return fmt::format(
          "trial '{}' contradicts the other {:.0f}: the model that is fitted to those predicts its {} with "
          "an "
          "error of {} RMS, theirs are {} at most. Check its channels (sign, unit, time, inputs too), or "
          "what "
          "was different in it; fitted without it, the parameters would be others",
          w.names[1], w.numbers[2] - 1, w.names[0], WithUnit(w.numbers[0], w.names[2], 2),
          WithUnit(w.numbers[1], w.names[2], 2));
    case WarningKind::kErrorConcentration:
      return Concentrated(w) + ": check the measurement there; a gap is better than a wrong value";
    case WarningKind::kErrorDrift:
      return Concentrated(w) +
             ", and errors grow up to there: the prediction drifts, as where nothing feeds the position back "
             "(open loop) and small errors add up; that is no sign of a wrong measurement";
    case WarningKind::kDataCheck:
    case WarningKind::kOther:
      return w.message;
  }
  return {};
}

std::vector<std::string> Texts(const std::vector<Warning>& warnings,
                               const std::vector<LeftOutData>& left_out) {
  std::vector<std::string> texts;
  for (const Warning& warning : warnings)
    texts.push_back((warning.step.empty() ? "" : warning.step + ": ") + Text(warning, left_out));
  return texts;
}

}  // namespace

std::vector<std::string> Warnings(const Identification& identification) {
  return Texts(identification.warnings, {});
}

std::vector<std::string> Warnings(const std::vector<Warning>& warnings) {
  return Texts(warnings, {});
}

std::vector<std::string> Warnings(const Diagnosis& diagnosis) {
  return Texts(diagnosis.warnings, diagnosis.left_out);
}

}  // namespace sinew::text
