#include "identify/diagnosis/select/imitating_sets.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/column_space.h"
#include "base/decompositions.h"
#include "identify/diagnosis/score/shortlist.h"
#include "identify/diagnosis/select/candidate_sets.h"
#include "identify/diagnosis/select/linearised_model.h"

namespace sinew::diagnosis {
namespace {

using Set = std::vector<int>;

constexpr double kDependent = 1e-7;     // of columns of unit length, the rest after the projection
constexpr std::size_t kExtended = 24;   // sets of one size that are extended
constexpr std::size_t kMostSets = 6;    // that are returned
constexpr double kLeftOfSquare = 0.02;  // 1 - 0.99^2

// A candidate at one of its probes, or a cause of the model, with its columns.
struct Member {
  int candidate = 0;
  int probe = -1;  // -1: a cause of the model
  Eigen::Index first = 0;
  Eigen::Index size = 0;
};

enum class Sign { kBoth, kPositive, kNegative };

// Members by their index, and what they leave of the square.
struct Subset {
  std::vector<std::size_t> members;
  double left = 0;
  double penalised = 0;
};

class Regression {
 public:
  Regression(const std::vector<Candidate>& candidates, const LinearisedModel& model, const Set& causes)
      : candidates_(candidates),
        model_(model),
        causes_(causes),
        space_(model.BaseWithout(causes), kDependent) {}

  // False if nothing remains of the causes once the other parameters are fitted.
  bool Prepare() {
    Vector change = Vector::Zero(model_.residual().size());
    for (const int cause : causes_) {
      std::optional<Vector> one = model_.TangentOf(cause);
      if (!one) one = model_.SecantOf(cause);
      if (!one) return false;
      change += *one;
    }
    target_ = change - model_.residual();
    const Vector distinct = space_.TakenFrom(target_);
    changed_ = space_.TakenFrom(change).squaredNorm();
    residual_ = model_.residual().squaredNorm();
    whole_ = distinct.squaredNorm();
    if (!(changed_ > residual_ * kDependent)) return false;
    Collect();
    gram_ = columns_.transpose() * columns_;
    moment_ = columns_.transpose() * distinct;
    return true;
  }

  // The sets that are predicted to fit best.
  [[nodiscard]] std::vector<Subset> Best() const {
    std::map<Set, Subset> best_of;
    std::vector<Subset> smaller{{}};
    for (std::size_t size = 1; size <= causes_.size(); ++size) {
      std::vector<Subset> made = Extended(smaller);
      for (const Subset& one : made) {
        const auto [known, is_new] = best_of.emplace(SetOf(one), one);
        if (!is_new && one.penalised < known->second.penalised) known->second = one;
      }
      // All pairs are made; of larger sets, those that begin with the best of them.
      if (size > 1 && made.size() > kExtended) made.resize(kExtended);
      smaller = std::move(made);
    }
    std::vector<Subset> wanted;
    for (const auto& [set, one] : best_of) {
      if (IsWanted(set) && one.left - residual_ < kLeftOfSquare * changed_) wanted.push_back(one);
    }
    Sort(wanted);
    if (wanted.size() > kMostSets) wanted.resize(kMostSets);
    return wanted;
  }

  [[nodiscard]] Set SetOf(const Subset& subset) const {
    Set set;
    for (const std::size_t m : subset.members) set.push_back(members_[m].candidate);
    std::sort(set.begin(), set.end());
    return set;
  }

  // Points with the set in the place of the causes; the other parameters moved with them by several shares,
  // because where they have to move far, to first order may be too far.
  [[nodiscard]] std::vector<Vector> Starts(const Subset& subset, const Refit& model) const {
    const Vector change = *Solved(subset);
    const Vector moved = space_.Solve(target_ - Unprojected(subset) * change)
                             .col(0)
                             .cwiseProduct(model_.fit().Slopes(model.x));
    std::vector<Vector> starts;
    for (const double share : {1.0, 0.5, 0.0}) {
      Vector start = model.point;
      for (const int cause : causes_) model_.Remove(cause, start);
      const FitSetup& setup = model_.fit().setup();
      for (std::size_t v = 0; v < setup.free.size(); ++v) {
        const Parameter& p = setup.parameters[static_cast<std::size_t>(setup.free[v])];
        double& value = start[setup.free[v]];
        value = std::clamp(value + share * moved[static_cast<Eigen::Index>(v)], p.lower, p.upper);
      }
      Put(subset, change, model, start);
      starts.push_back(std::move(start));
    }
    return starts;
  }

 private:
  void Collect() {
    std::vector<Vector> raw;
    const auto sign_of = [](bool positive, bool negative) {
      return positive ? Sign::kPositive : negative ? Sign::kNegative : Sign::kBoth;
    };
    const auto add = [&](Member member, const Matrix& all, const std::vector<Eigen::Index>& own) {
      if (own.empty()) return;
      member.first = static_cast<Eigen::Index>(raw.size());
      member.size = static_cast<Eigen::Index>(own.size());
      for (const Eigen::Index k : own) {
        raw.emplace_back(all.col(k));
        if (member.probe >= 0) {
          const DesignColumn& column = model_.design().columns[static_cast<std::size_t>(k)];
          signs_.push_back(sign_of(column.positive, column.negative));
        } else {
          const Parameter& p = model_.fit().setup().parameters[static_cast<std::size_t>(
              model_.fit().setup().free[static_cast<std::size_t>(k)])];
          signs_.push_back(sign_of(p.null_value <= p.lower, p.null_value >= p.upper));
        }
      }
      members_.push_back(member);
    };
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const int c = static_cast<int>(i);
      const Candidate& candidate = candidates_[i];
      if (!candidate.primary() || candidate.parameters.empty()) continue;
      if (Contains(causes_, c)) {
        add({c, -1}, model_.base(), model_.VariablesOf(c));
        continue;
      }
      for (std::size_t probe = 0; probe < candidate.probes.size(); ++probe) {
        const int at = static_cast<int>(probe);
        add({c, at}, model_.columns(), model_.ColumnsOf(c, at));
      }
    }
    raw_.resize(model_.residual().size(), static_cast<Eigen::Index>(raw.size()));
    for (std::size_t k = 0; k < raw.size(); ++k) raw_.col(static_cast<Eigen::Index>(k)) = raw[k];
    columns_ = space_.TakenFrom(raw_);
    // What the other parameters can do is no column of its own.
    for (Eigen::Index k = 0; k < columns_.cols(); ++k) {
      if (!(columns_.col(k).norm() > kDependent * raw_.col(k).norm())) columns_.col(k).setZero();
    }
  }

  [[nodiscard]] std::vector<Eigen::Index> ColumnsOf(const Subset& subset) const {
    std::vector<Eigen::Index> all;
    for (const std::size_t m : subset.members) {
      for (Eigen::Index k = 0; k < members_[m].size; ++k) all.push_back(members_[m].first + k);
    }
    return all;
  }

  // Coefficients of the columns of the set; nothing if they are linear combinations of each other, or beyond
  // their bounds.
  [[nodiscard]] std::optional<Vector> Solved(const Subset& subset) const {
    const std::vector<Eigen::Index> own = ColumnsOf(subset);
    const auto n = static_cast<Eigen::Index>(own.size());
    Vector scale(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index k = own[static_cast<std::size_t>(i)];
      if (!(gram_(k, k) > 0)) return {};
      scale[i] = 1 / std::sqrt(gram_(k, k));
    }
    Matrix normal(n, n);
    Vector moment(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index k = own[static_cast<std::size_t>(i)];
      moment[i] = scale[i] * moment_[k];
      for (Eigen::Index j = 0; j < n; ++j)
        normal(i, j) = scale[i] * scale[j] * gram_(k, own[static_cast<std::size_t>(j)]);
    }
    const Eigen::LDLT<Matrix> factors(normal);
    if (!(factors.vectorD().minCoeff() > kDependent)) return {};
    Vector change = scale.cwiseProduct(Vector(factors.solve(moment)));
    for (Eigen::Index i = 0; i < n; ++i) {
      if (IsImpossible(own[static_cast<std::size_t>(i)], change[i])) return {};
    }
    return change;
  }

  // Beyond a bound on which the null lies.
  [[nodiscard]] bool IsImpossible(Eigen::Index column, double change) const {
    const Sign sign = signs_[static_cast<std::size_t>(column)];
    return (sign == Sign::kPositive && change < 0) || (sign == Sign::kNegative && change > 0);
  }

  [[nodiscard]] double Price(const Subset& subset) const {
    double price = 0;
    for (const std::size_t m : subset.members)
      price +=
          kPerParameter *
          static_cast<double>(candidates_[static_cast<std::size_t>(members_[m].candidate)].parameters.size());
    return price;
  }

  // Every set with one member more, best first; members in increasing order of their index.
  [[nodiscard]] std::vector<Subset> Extended(const std::vector<Subset>& smaller) const {
    std::map<std::vector<std::size_t>, Subset> made;
    for (const Subset& from : smaller) {
      for (std::size_t m = 0; m < members_.size(); ++m) {
        const bool has = std::any_of(from.members.begin(), from.members.end(), [&](std::size_t other) {
          return members_[other].candidate == members_[m].candidate;
        });
        if (has) continue;
        Subset next = from;
        next.members.insert(std::upper_bound(next.members.begin(), next.members.end(), m), m);
        if (made.count(next.members) > 0) continue;
        const std::optional<Vector> change = Solved(next);
        if (!change) continue;
        next.left = whole_;
        const std::vector<Eigen::Index> own = ColumnsOf(next);
        for (std::size_t i = 0; i < own.size(); ++i)
          next.left -= (*change)[static_cast<Eigen::Index>(i)] * moment_[own[i]];
        next.penalised = next.left + Price(next);
        made.emplace(next.members, std::move(next));
      }
    }
    std::vector<Subset> sets;
    for (auto& [members, one] : made) sets.push_back(std::move(one));
    Sort(sets);
    return sets;
  }

  static void Sort(std::vector<Subset>& sets) {
    std::stable_sort(sets.begin(), sets.end(),
                     [](const Subset& a, const Subset& b) { return a.penalised < b.penalised; });
  }

  [[nodiscard]] bool IsWanted(const Set& set) const {
    const auto shared = std::count_if(set.begin(), set.end(), [&](int c) { return Contains(causes_, c); });
    if (shared == static_cast<std::ptrdiff_t>(set.size())) return false;
    return set.size() < causes_.size() || shared + 1 < static_cast<std::ptrdiff_t>(set.size());
  }

  [[nodiscard]] Matrix Unprojected(const Subset& subset) const {
    const std::vector<Eigen::Index> own = ColumnsOf(subset);
    Matrix all(raw_.rows(), static_cast<Eigen::Index>(own.size()));
    for (std::size_t i = 0; i < own.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = raw_.col(own[i]);
    return all;
  }

  void Put(const Subset& subset, const Vector& change, const Refit& model, Vector& point) const {
    Eigen::Index at = 0;
    for (const std::size_t m : subset.members) {
      const Member& member = members_[m];
      const Vector own = change.segment(at, member.size);
      at += member.size;
      if (member.probe >= 0) {
        model_.Add(member.candidate, member.probe, own, point);
      } else {
        Keep(member.candidate, own, model, point);
      }
    }
  }

  // A cause that stays: columns are those of the variables, from the null on.
  void Keep(int cause, const Vector& change, const Refit& model, Vector& point) const {
    const FitSetup& setup = model_.fit().setup();
    for (const int index : candidates_[static_cast<std::size_t>(cause)].parameters)
      point[index] = model.point[index];
    const Vector slopes = model_.fit().Slopes(model.x);
    const std::vector<Eigen::Index> own = model_.VariablesOf(cause);
    for (std::size_t i = 0; i < own.size(); ++i) {
      const int index = setup.free[static_cast<std::size_t>(own[i])];
      const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
      point[index] =
          std::clamp(p.null_value + slopes[own[i]] * change[static_cast<Eigen::Index>(i)], p.lower, p.upper);
    }
  }

  const std::vector<Candidate>& candidates_;
  const LinearisedModel& model_;
  const Set& causes_;
  ColumnSpace space_;        // of the parameters that are no causes
  Vector target_;            // [m] what the causes change, less the residual
  double changed_ = 0;       // squares: of what the causes change ...
  double residual_ = 0;      // ... of the residual ...
  double whole_ = 0;         // ... of the target, all but the first beside the other parameters
  std::vector<Sign> signs_;  // [K] possible ones of the coefficients
  Matrix raw_;               // [m x K]
  Matrix columns_;           // [m x K] beside the other parameters
  Matrix gram_;              // [K x K]
  Vector moment_;            // [K]
  std::vector<Member> members_;
};

}  // namespace

Result<std::map<Set, std::vector<Vector>>> FindImitatingSets(const Problem& problem,
                                                             const std::vector<Candidate>& candidates,
                                                             const Refit& model, const Vector& nulls) {
  std::map<Set, std::vector<Vector>> sets;
  if (model.released.size() < 2) return sets;
  LinearisedModel linearised(problem, candidates, model, nulls);
  SINEW_TRY(linearised.Linearise());
  Regression regression(candidates, linearised, model.released);
  if (!regression.Prepare()) return sets;
  for (const auto& subset : regression.Best())
    sets[regression.SetOf(subset)] = regression.Starts(subset, model);
  return sets;
}

}  // namespace sinew::diagnosis
