#include "identify/diagnosis/select/choice_of_sets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/random.h"

namespace sinew::diagnosis {
namespace {

// Measured with a numerical prototype on 36 cases that chose them and 36 others: of the effects that matter
// 90 % are named, 97 % of the named ones are true.
constexpr double kNearBest = 1.25;         // error of the answer over the least one, at most
constexpr double kLeastGain = 0.85;        // error with a cause over that without it, at most ...
constexpr double kLeastGainedFolds = 0.6;  // ... and share of the folds in which it is smaller, at least
constexpr double kLikely = 0.8;            // ... unless the error with the cause is below this share
constexpr double kTie = 1.05;              // error over the least one, up to which sets of one size are equal
constexpr int kResamples = 1000;

double LogOf(double error) {
  return std::log(std::max(error, std::numeric_limits<double>::min()));
}

// Whether a cause is kept. @param share error with it over that without it @param gained share of the folds
// in which the error is smaller with it
bool Suffices(double share, double gained) {
  return share <= kLikely || (share <= kLeastGain && gained >= kLeastGainedFolds);
}

class Choice {
 public:
  explicit Choice(const std::vector<JudgedSet>& sets) : sets_(sets) {
    for (const JudgedSet& set : sets) {
      logs_.emplace_back();
      for (const double error : set.fold_errors) logs_.back().push_back(LogOf(error));
    }
  }

  // @param weights [folds] sum 1
  std::size_t Choose(const std::vector<double>& weights) {
    means_.assign(sets_.size(), 0);
    for (std::size_t k = 0; k < sets_.size(); ++k) {
      for (std::size_t f = 0; f < weights.size(); ++f) means_[k] += weights[f] * logs_[k][f];
    }
    return Pruned(SimplestNearBest(), weights);
  }

 private:
  [[nodiscard]] std::size_t SimplestNearBest() const {
    const double limit = *std::min_element(means_.begin(), means_.end()) + std::log(kNearBest);
    std::size_t size = std::numeric_limits<std::size_t>::max();
    for (std::size_t k = 0; k < sets_.size(); ++k) {
      if (means_[k] <= limit) size = std::min(size, sets_[k].released.size());
    }
    return BestOfSize(size);
  }

  // The number of sets if there is none.
  [[nodiscard]] std::size_t BestOfSize(std::size_t size) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < sets_.size(); ++k) {
      if (sets_[k].released.size() == size) least = std::min(least, means_[k]);
    }
    std::size_t chosen = sets_.size();
    for (std::size_t k = 0; k < sets_.size(); ++k) {
      if (sets_[k].released.size() != size || means_[k] > least + std::log(kTie)) continue;
      if (chosen == sets_.size() || Rank(k) < Rank(chosen)) chosen = k;
    }
    return chosen;
  }

  [[nodiscard]] std::tuple<int, int, double> Rank(std::size_t k) const {
    return {sets_[k].at_bound, sets_[k].rarity, means_[k]};
  }

  [[nodiscard]] std::size_t Pruned(std::size_t chosen, const std::vector<double>& weights) const {
    const auto is_worth = [&](std::size_t more, std::size_t less) {
      return less == sets_.size() ||
             Suffices(std::exp(means_[more] - means_[less]), GainedFolds(more, less, weights));
    };
    for (;;) {
      const std::size_t size = sets_[chosen].released.size();
      const std::size_t smaller = size == 0 ? sets_.size() : BestOfSize(size - 1);
      const std::size_t without = LeastWithoutOne(chosen);
      if (!is_worth(chosen, smaller)) {
        chosen = smaller;
      } else if (!is_worth(chosen, without)) {
        chosen = without;
      } else {
        return chosen;
      }
    }
  }

  // Of the sets with one cause less, the one with the least error; the number of sets if there is none.
  [[nodiscard]] std::size_t LeastWithoutOne(std::size_t of) const {
    const std::vector<int>& all = sets_[of].released;
    std::size_t least = sets_.size();
    for (std::size_t k = 0; k < sets_.size(); ++k) {
      const std::vector<int>& some = sets_[k].released;
      if (some.size() + 1 != all.size() || !std::includes(all.begin(), all.end(), some.begin(), some.end()))
        continue;
      if (least == sets_.size() || means_[k] < means_[least]) least = k;
    }
    return least;
  }

  [[nodiscard]] double GainedFolds(std::size_t with, std::size_t without,
                                   const std::vector<double>& weights) const {
    double gained = 0;
    for (std::size_t f = 0; f < weights.size(); ++f)
      gained += logs_[with][f] < logs_[without][f] ? weights[f] : 0;
    return gained;
  }

  const std::vector<JudgedSet>& sets_;
  std::vector<std::vector<double>> logs_;
  std::vector<double> means_;
};

}  // namespace

double GeometricMean(const std::vector<double>& errors) {
  if (errors.empty()) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const double error : errors) sum += LogOf(error);
  return std::exp(sum / static_cast<double>(errors.size()));
}

bool IsNeeded(const std::vector<double>& with, const std::vector<double>& without) {
  if (with.empty() || with.size() != without.size()) return false;
  double gained = 0;
  for (std::size_t f = 0; f < with.size(); ++f) gained += with[f] < without[f] ? 1 : 0;
  return Suffices(GeometricMean(with) / GeometricMean(without), gained / static_cast<double>(with.size()));
}

std::size_t ChooseSet(const std::vector<JudgedSet>& sets) {
  const std::size_t folds = sets.front().fold_errors.size();
  return Choice(sets).Choose(std::vector<double>(folds, 1.0 / static_cast<double>(folds)));
}

std::vector<double> ChosenShares(const std::vector<JudgedSet>& sets, std::uint64_t seed) {
  std::vector<double> shares(sets.size(), 0);
  if (sets.empty()) return shares;
  const std::size_t folds = sets.front().fold_errors.size();
  Choice choice(sets);
  Random random(seed);
  std::vector<double> weights(folds);
  for (int draw = 0; draw < kResamples; ++draw) {
    std::fill(weights.begin(), weights.end(), 0);
    for (std::size_t f = 0; f < folds; ++f) weights[random.Index(folds)] += 1.0 / static_cast<double>(folds);
    shares[choice.Choose(weights)] += 1.0 / kResamples;
  }
  return shares;
}

}  // namespace sinew::diagnosis
