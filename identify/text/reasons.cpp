#include "identify/text/reasons.h"

#include <cmath>
#include <utility>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/text/phrases.h"

namespace sinew::text {
namespace {

std::string Size(double value, const std::string& unit) {
  return fmt::format("{:.3g}{}", value, Unit(unit));
}

std::string IntervalText(const ParameterVerdict& v) {
  if (v.lower_open && v.upper_open) return "the 95 % interval reaches both bounds";
  const Reason& r = v.reason;
  std::string text =
      r.width_of_value ? fmt::format("the 95 % interval is +-{} % of the value", Readable(100 * r.width, 2))
                       : fmt::format("the 95 % interval spans {} % of its range", Readable(100 * r.width, 2));
  if (v.lower_open || v.upper_open)
    text += fmt::format(" and is open at the {} bound", v.lower_open ? "lower" : "upper");
  return text;
}

std::string NoResponse(const Reason& r) {
  const bool everywhere = r.kind == ReasonKind::kNoResponse;
  return fmt::format(
      "no fitted channel responds{}: {} {} unchanged {}", everywhere ? "" : " here", Some(r.channels),
      r.channels.size() == 1 ? "is" : "are",
      everywhere ? "over the whole range" : "for small changes, though not over the whole range");
}

std::string Nuisance(const Reason& r) {
  return fmt::format("the nuisance parameter{} {}", r.partners.size() == 1 ? "" : "s", Some(r.partners));
}

std::string Core(const Parameter& p, const ParameterVerdict& v) {
  const Reason& r = v.reason;
  const std::string without = Size(r.std_error_without, p.unit);
  const std::string instead = std::isfinite(r.std_error) ? " instead of " + Size(r.std_error, p.unit) : "";
  switch (r.kind) {
    case ReasonKind::kDetermined:
      return IntervalText(v);
    case ReasonKind::kAtBound:
      return fmt::format(
          "the best value lies on its {} bound {}, and the fit would still improve beyond it{}",
          r.at_lower ? "lower" : "upper", Size(r.at_lower ? p.lower : p.upper, p.unit),
          r.at_lower && !p.below_lower.empty() ? ": " + p.below_lower : "");
    case ReasonKind::kNoResponse:
    case ReasonKind::kNoResponseHere:
      return NoResponse(r);
    case ReasonKind::kCompensated:
      return "fully compensated by " + Nuisance(r);
    case ReasonKind::kCombination:
      return fmt::format("only a combination with {} is determined: {}", Some(r.partners),
                         DirectionText(r.direction));
    case ReasonKind::kFlatCost:
      return IntervalText(v) + ": the cost rises slowly away from the best value";
    case ReasonKind::kDependentResiduals:
      return fmt::format(
          "{}: the residuals are not independent; if they were, its standard error would be {}{}",
          IntervalText(v), without, instead);
    case ReasonKind::kWeakExcitation:
      return fmt::format(
          "{}: the excitation is too small: with all other values known its standard error would be {}",
          IntervalText(v), without);
    case ReasonKind::kPartiallyCompensated:
      return fmt::format(
          "{}: nearly compensated by {}; with all others known its standard error would be {}{}",
          IntervalText(v), Nuisance(r), without, instead);
    case ReasonKind::kCorrelated:
      return fmt::format("{}: hard to distinguish from {}; with {} known its standard error would be {}{}",
                         IntervalText(v), Some(r.partners), r.partners.size() == 1 ? "it" : "them", without,
                         instead);
    case ReasonKind::kNoiseLevelUnknown:
      return fmt::format(
          "{} residuals do not determine the noise level beside {} fitted values: state sigma or add samples",
          r.residuals, r.fitted);
  }
  return {};
}

const char* FailureText(ProfileFailure failure) {
  switch (failure) {
    case ProfileFailure::kNone:
      return "";
    case ProfileFailure::kInterrupted:
      return "it was interrupted";
    case ProfileFailure::kBudgetSpent:
      return "its evaluations were used up";
    case ProfileFailure::kRefitNotConverged:
      return "a refit of the other values did not converge";
    case ProfileFailure::kNoPrediction:
      return "there is no prediction at its end";
    case ProfileFailure::kRoughCost:
      return "the cost is too rough";
  }
  return "";
}

std::string AdditionText(const AdditionName& addition) {
  switch (addition.kind) {
    case AdditionKind::kChannel:
      return "measuring " + addition.name;
    case AdditionKind::kTrial:
      return "fitting trial " + addition.name + " too";
    case AdditionKind::kKnownValue:
      return "a known value of " + addition.name;
  }
  return {};
}

std::string OptionText(const RemedyOption& option) {
  std::vector<std::string> additions;
  for (const AdditionName& addition : option.additions) additions.push_back(AdditionText(addition));
  return And(additions) + (additions.size() > 1 ? " together" : "");
}

// "measuring a would determine it (std. error 0.1); so would measuring b (0.2) or measuring c (0.3)"
std::string Options(const Parameter& p, const std::vector<RemedyOption>& options, bool figures) {
  std::string text;
  for (std::size_t i = 0; i < options.size(); ++i) {
    const std::string error = fmt::format("{:.2g}{}", options[i].std_error, Unit(p.unit));
    if (i == 0) {
      text = OptionText(options[i]) + " would determine it";
      if (figures) text += " (std. error " + error + ")";
      continue;
    }
    text += (i == 1 ? "; so would " : " or ") + OptionText(options[i]);
    if (figures) text += " (" + error + ")";
  }
  return text;
}

}  // namespace

std::string ReasonText(const Parameter& parameter, const ParameterVerdict& verdict) {
  std::string text = Core(parameter, verdict);
  if (verdict.reason.by_prior) text += "; the interval is that of its prior";
  if (verdict.reason.no_profile != ProfileFailure::kNone) {
    text += fmt::format("; the interval is linear, its profile could not be followed: {}",
                        FailureText(verdict.reason.no_profile));
  }
  return text;
}

std::string RemedyText(const Parameter& parameter, const Remedy& remedy, bool figures) {
  switch (remedy.kind) {
    case RemedyKind::kNone:
      return {};
    case RemedyKind::kAdditions:
      return Options(parameter, remedy.options, figures);
    case RemedyKind::kNoChannel:
      return "no additional channel would make it identifiable" +
             (remedy.options.empty() ? "" : "; " + Options(parameter, remedy.options, figures));
    case RemedyKind::kIndependentNoise:
      return "with independent residuals its error would be small: first explain what is left in them";
    case RemedyKind::kNotPredicted:
      return "the benefit of other channels could not be computed: " + remedy.message;
    case RemedyKind::kOtherBound:
      return "a wider bound if physics allows one; otherwise look for a missing effect";
    case RemedyKind::kMoreSamples:
      return "more samples than fitted values, or a stated noise level";
  }
  return {};
}

std::string DirectionText(const OpenDirection& direction) {
  std::vector<std::string> changes;
  for (const ParameterChange& part : direction.changes) {
    const std::string size = std::isfinite(part.relative)
                                 ? fmt::format("{} %", Readable(100 * std::abs(part.relative), 2))
                                 : Size(std::abs(part.change), part.unit);
    changes.push_back(fmt::format("{} {} by {}", part.parameter, part.change > 0 ? "up" : "down", size));
  }
  if (changes.empty()) return {};
  std::string text = changes.front();
  changes.erase(changes.begin());
  if (!changes.empty()) text += " with " + Some(std::move(changes));
  return text + (direction.lost ? " leaves every residual unchanged"
                                : " changes the residuals by less than their noise");
}

}  // namespace sinew::text
