#include "identify/uncertainty/explain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/text.h"
#include "identify/uncertainty/interval.h"

namespace sinew {
namespace {

// Partners are named if their loading is at least this share of the largest one.
constexpr double kNamedLoading = 0.1;
constexpr std::size_t kMaxPartners = 4;
// Directions in words are drawn to this relative change: large enough to be seen, small enough to be linear.
constexpr double kShownChange = 0.1;

/// "a", "a and b", "a, b and c", "a, b, c and 4 others".
std::string List(std::vector<std::string> names) {
  if (names.size() > kMaxPartners + 1) {
    const std::size_t others = names.size() - kMaxPartners;
    names.resize(kMaxPartners);
    names.push_back(fmt::format("{} others", others));
  }
  if (names.size() == 1) return names.front();
  const std::string last = names.back();
  names.pop_back();
  return Join(names, ", ") + " and " + last;
}

std::string WithUnit(double value, const std::string& unit) {
  return unit == "1" ? fmt::format("{:.3g}", value) : fmt::format("{:.3g} {}", value, unit);
}

/// What a relative change can be told of: sign and size cannot vanish.
bool IsRatioQuantity(const Parameter& parameter, double value) {
  return value != 0 && (parameter.lower >= 0 || parameter.upper <= 0);
}

}  // namespace

double Explainer::value(int variable) const {
  return at_.parameters[problem_.setup().free[static_cast<std::size_t>(variable)]];
}

double Explainer::ErrorAlone(const VectorRef& column) const {
  return noise_.deviation.cwiseProduct(column).norm() / column.squaredNorm();
}

bool Explainer::WideWith(int variable, double error) const {
  return IsWide(parameter(variable), value(variable),
                LinearInterval(problem_, at_.x, variable, quantile_ * error));
}

double Explainer::ErrorTogether(int j) const {
  if (!info_.determined[static_cast<std::size_t>(j)]) return std::numeric_limits<double>::infinity();
  return (info_.columns * info_.inverse.col(j)).cwiseProduct(noise_.deviation).norm();
}

int Explainer::DominantDirection(int j) const {
  const bool lost = !info_.determined[static_cast<std::size_t>(j)];
  int dominant = lost ? info_.rank : 0;
  double largest = -1;
  for (int i = dominant; i < (lost ? static_cast<int>(info_.directions.cols()) : info_.rank); ++i) {
    const double share = std::abs(info_.directions(j, i)) / (lost ? 1 : info_.singular_values[i]);
    if (share > largest) {
      largest = share;
      dominant = i;
    }
  }
  return dominant;
}

std::string Explainer::Partners(int j, int direction) const {
  const double largest = info_.directions.col(direction).cwiseAbs().maxCoeff();
  std::vector<std::pair<double, std::string>> partners;
  for (std::size_t i = 0; i < info_.variables.size(); ++i) {
    const double loading = std::abs(info_.directions(static_cast<Eigen::Index>(i), direction));
    if (static_cast<int>(i) == j || loading < kNamedLoading * largest) continue;
    partners.emplace_back(-loading, parameter(info_.variables[i]).name);
  }
  std::stable_sort(partners.begin(), partners.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (const auto& partner : partners) names.push_back(partner.second);
  return names.empty() ? std::string{} : List(std::move(names));
}

std::string Explainer::NuisancePartners(int j) const {
  const Vector share = info_.nuisance_share.col(j);
  const double largest = share.maxCoeff();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < info_.nuisance.size(); ++i) {
    if (share[static_cast<Eigen::Index>(i)] >= kNamedLoading * largest) {
      names.push_back(parameter(info_.nuisance[i]).name);
    }
  }
  return List(std::move(names));
}

std::string Explainer::DirectionInWords(int direction) const {
  struct Part {
    int variable;
    double change;    ///< [parameter's unit] per unit of the direction
    double relative;  ///< of its value, or of its range
  };
  const double largest_loading = info_.directions.col(direction).cwiseAbs().maxCoeff();
  std::vector<Part> parts;
  double largest = 0;
  for (std::size_t i = 0; i < info_.variables.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    if (std::abs(info_.directions(j, direction)) < kNamedLoading * largest_loading) continue;
    const int variable = info_.variables[i];
    const Parameter& p = parameter(variable);
    const double change = info_.directions(j, direction) / info_.norm[j] * at_.slopes[variable];
    const double scale = IsRatioQuantity(p, value(variable)) ? value(variable) : p.upper - p.lower;
    parts.push_back({variable, change, change / scale});
    largest = std::max(largest, std::abs(change / scale));
  }
  const bool lost = direction >= info_.rank;
  double amount = kShownChange / largest;
  if (!lost) amount = std::min(amount, quantile_ * noise_.residual_scale / info_.singular_values[direction]);
  if (parts.front().change < 0) amount = -amount;

  std::vector<std::string> phrases;
  for (const Part& part : parts) {
    const double change = amount * part.change;
    const Parameter& p = parameter(part.variable);
    const std::string size = IsRatioQuantity(p, value(part.variable))
                                 ? fmt::format("{:.2g} %", 100 * std::abs(amount * part.relative))
                                 : WithUnit(std::abs(change), p.unit);
    phrases.push_back(fmt::format("{} {} by {}", p.name, change > 0 ? "up" : "down", size));
  }
  const std::string first = phrases.front();
  phrases.erase(phrases.begin());
  return fmt::format(
      "{} with {} {}", first, List(std::move(phrases)),
      lost ? "leaves every residual the same" : "changes the residuals by less than their noise");
}

std::string Explainer::WhyUndetermined(int variable) const {
  const std::string prior = parameter(variable).prior ? "; the interval is that of its prior" : "";
  if (at_.status[static_cast<std::size_t>(variable)] == VariableStatus::kNoDependence) {
    const std::vector<std::string> channels = FittedChannels(problem_);
    const bool everywhere = IsWithoutEffectEverywhere(problem_, at_, variable);
    return fmt::format(
        "no fitted channel responds{}: {} {} the same {}{}", everywhere ? "" : " here", List(channels),
        channels.size() == 1 ? "stays" : "stay",
        everywhere ? "over the whole range" : "for small changes, though not over the whole range", prior);
  }
  const int j = info_.index_of(variable);
  if (info_.lost_to_nuisance[static_cast<std::size_t>(j)]) {
    return fmt::format("whatever it changes, {} can undo, which {} fitted as well{}", NuisancePartners(j),
                       info_.nuisance.size() == 1 ? "is" : "are", prior);
  }
  const int direction = DominantDirection(j);
  return fmt::format("only a combination with {} is determined: {}{}", Partners(j, direction),
                     DirectionInWords(direction), prior);
}

std::string Explainer::WhyWide(int variable, const Interval& interval, double error) const {
  const std::string width = Width(variable, interval);
  const auto in_units = [&](double x) {
    return WithUnit(x * at_.slopes[variable], parameter(variable).unit);
  };
  const int j = info_.index_of(variable);
  const double plain = ErrorTogether(j);
  if (!WideWith(variable, plain)) {
    if (!WideWith(variable, error)) return width + ": the fit worsens slowly away from the best value";
    return fmt::format(
        "{}: the residuals are not independent; if they were, its standard error would be {} "
        "instead of {}",
        width, in_units(plain), in_units(error));
  }
  const std::string instead = std::isfinite(plain) ? " instead of " + in_units(plain) : "";
  const double alone = ErrorAlone(at_.jacobian.col(variable));
  if (WideWith(variable, alone)) {
    return fmt::format(
        "{}: the excitation is too small, even if all other values were known its standard error "
        "would be {}",
        width, in_units(alone));
  }
  const double without_nuisance = ErrorAlone(info_.columns.col(j));
  if (WideWith(variable, without_nuisance)) {
    return fmt::format(
        "{}: {} can undo nearly all that it changes; if known, its standard error would be {}{}", width,
        NuisancePartners(j), in_units(alone), instead);
  }
  return fmt::format("{}: it is hard to tell from {}; with them known its standard error would be {}{}",
                     width, Partners(j, DominantDirection(j)), in_units(without_nuisance), instead);
}

std::string Explainer::WhyAtBound(int variable) const {
  const Parameter& p = parameter(variable);
  const bool lower = at_.status[static_cast<std::size_t>(variable)] == VariableStatus::kAtLower;
  return fmt::format("the best value lies on its {} bound {}, and the fit would still improve beyond it",
                     lower ? "lower" : "upper", WithUnit(lower ? p.lower : p.upper, p.unit));
}

std::string Explainer::WhyIdentifiable(int variable, const Interval& interval) const {
  return Width(variable, interval);
}

std::string Explainer::Width(int variable, const Interval& interval) const {
  const Parameter& p = parameter(variable);
  if (interval.lower_open && interval.upper_open) return "the 95 % interval reaches both bounds";
  const double width = interval.upper - interval.lower;
  std::string text =
      IsRatioQuantity(p, value(variable))
          ? fmt::format("the 95 % interval is +-{:.2g} % of the value",
                        50 * width / std::abs(value(variable)))
          : fmt::format("the 95 % interval takes {:.2g} % of its range", 100 * width / (p.upper - p.lower));
  if (interval.lower_open || interval.upper_open) {
    text += fmt::format(" and open at the {} bound", interval.lower_open ? "lower" : "upper");
  }
  return text;
}

std::vector<std::string> Explainer::OpenDirections(const std::vector<int>& wide_variables) const {
  std::set<int> directions;
  for (int i = info_.rank; i < info_.directions.cols(); ++i) directions.insert(i);
  for (const int variable : wide_variables) {
    const int j = info_.index_of(variable);
    if (j < 0) continue;
    const bool together = WideWith(variable, ErrorTogether(j));
    if (together && !WideWith(variable, ErrorAlone(info_.columns.col(j))))
      directions.insert(DominantDirection(j));
  }
  std::vector<std::string> sentences;
  for (const int direction : directions) {
    const Vector loadings = info_.directions.col(direction).cwiseAbs();
    const auto involved = (loadings.array() >= kNamedLoading * loadings.maxCoeff()).count();
    if (involved >= 2) sentences.push_back(DirectionInWords(direction));
  }
  return sentences;
}

}  // namespace sinew
