#include "identify/diagnosis/select/likelihood_comparison.h"

#include <algorithm>
#include <iterator>

#include "identify/statistics/distributions.h"

namespace sinew::diagnosis {
namespace {

// Least fall of the deviance per sample by a further cause, after a search by cross-validation: 2 % of the
// residual's deviation. Where a misfit dominated the noise, no named law is exact to the last thousandth of
// it, and thousands of samples make what that leaves significant.
constexpr double kLeastGainPerSample = 0.04;
constexpr double kParsimony = 10.8;  // 0.999 quantile of chi-squared with one degree of freedom
constexpr double kDouble = 0.97;     // correlation of traces above which they count as equal

}  // namespace

double SetWidth(const Refit& model) {
  return model.noise.IsColoured() ? kSetWidthColoured : kSetWidth;
}

LikelihoodComparison::LikelihoodComparison(const Problem& problem, const Refitter& refitter,
                                           const std::vector<Candidate>& candidates, const ScoredModel& base,
                                           const DiagnosisOptions& options)
    : problem_(problem),
      refitter_(refitter),
      candidates_(candidates),
      base_(base),
      options_(options),
      refits_(refitter, candidates, base.refit, options),
      shortlist_(candidates, base) {}

Result<ScoredModel> LikelihoodComparison::ScoresOf(const Set& released) const {
  return ScoreModel(problem_, candidates_, at(released), kFurtherLevel, options_.seed);
}

void LikelihoodComparison::CompareAsAfterSearch() {
  found_by_search_ = true;
  refits_.CompareAsAfterSearch();
}

void LikelihoodComparison::DistrustScores() {
  scores_contradicted_ = true;
  refits_.ContinueRefits();
}

std::vector<int> LikelihoodComparison::Singles(const ScoredModel& scored) const {
  return scores_contradicted_ ? shortlist_.All() : shortlist_.Singles(scored);
}

double LikelihoodComparison::Price(const Set& released) const {
  double parameters = 0;
  for (const int c : released) parameters += static_cast<double>(candidate(c).parameters.size());
  return kPerParameter * parameters;
}

double LikelihoodComparison::Penalised(const Refit& refit, const Refit& reference) const {
  return Difference(refit, reference) + Price(refit.released) - Price(reference.released);
}

double LikelihoodComparison::PenalisedByOccurrence(const Refit& refit, const Refit& reference) const {
  return Penalised(refit, reference) + kByOccurrence * (Rarity(refit) - Rarity(reference));
}

double LikelihoodComparison::Rarity(const Refit& refit) const {
  double rarity = 0;
  for (const int c : refit.released) rarity += static_cast<double>(candidate(c).occurrence);
  return rarity;
}

bool LikelihoodComparison::GainsTooLittle(const Refit& larger, const Refit& smaller) const {
  const auto samples = static_cast<double>(base_.design.residual.size());
  if (!found_by_search_ || (larger.holds_input_noise && smaller.holds_input_noise)) return false;
  return Difference(smaller, larger) < kLeastGainPerSample * samples;
}

double LikelihoodComparison::PValue(double delta_lr, const Set& more) const {
  double degrees = 0;
  bool primary = true;
  bool positive = true;
  for (const int c : more) {
    degrees += static_cast<double>(candidate(c).parameters.size());
    primary = primary && candidate(c).primary();
    const Parameter& p =
        base_.refit.setup->parameters[static_cast<std::size_t>(candidate(c).parameters.front())];
    positive = positive && (p.null_value <= p.lower || p.null_value >= p.upper);
  }
  double p = statistics::ChiSquaredUpperTail(std::max(0.0, delta_lr), degrees);
  if (positive && degrees == 1) p *= 0.5;
  if (!primary) p *= 5;
  return base_.family.FamilyPValue(std::min(1.0, p));
}

double LikelihoodComparison::Correlation(int a, int b) const {
  const Score* first = base_.BestOf(a);
  const Score* second = base_.BestOf(b);
  return first != nullptr && second != nullptr ? base_.whitened.Correlation(*first, *second) : 0;
}

bool LikelihoodComparison::IsSimplerDouble(const Set& released, const Refit& best) const {
  const Refit& refit = at(released);
  if (!refit.usable() || released.size() != best.released.size() || Price(released) >= Price(best.released))
    return false;
  if (Difference(refit, best) > kParsimony) return false;
  Set own;
  Set other;
  std::set_difference(released.begin(), released.end(), best.released.begin(), best.released.end(),
                      std::back_inserter(own));
  std::set_difference(best.released.begin(), best.released.end(), released.begin(), released.end(),
                      std::back_inserter(other));
  return own.size() == 1 && Correlation(own.front(), other.front()) > kDouble;
}

}  // namespace sinew::diagnosis
