#include "identify/uncertainty/competing_minima.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identify/execution/shared_loop.h"
#include "identify/solvers/local_fit.h"

namespace sinew::uncertainty {
namespace {

// A point that is not yet at its minimum may lie this many times the allowed rise above the best one.
constexpr double kNearlyWithin = 1.5;
// Points nearer than this share of an interval are likely to lead to the same minimum.
constexpr double kSameGroup = 0.3;
constexpr std::size_t kMaxGroups = 40;
// Of a short search, which tells to which group an end of an interval leads, and of one to a minimum.
constexpr long kShort = 30;
constexpr long kLong = 200;
// Share of the evaluations for the short ones.
constexpr double kShortShare = 0.5;
// All evaluations together, over those of the search.
constexpr double kEffort = 1;
// A local search ends where its next step gains less than this share of the rise.
constexpr double kTolerance = 1e-8;

struct Searched {
  LocalMinimum end;
  bool converged = false;
};

class Competition {
 public:
  Competition(const LeastSquares& problem, const CompetitionQuestion& question)
      : problem_(problem),
        q_(question),
        left_(static_cast<long>(kEffort *
                                static_cast<double>(question.search_evaluations > 0
                                                        ? question.search_evaluations
                                                        : static_cast<long>(question.points.size())))) {}

  std::vector<LocalMinimum> Run() {
    std::vector<LocalMinimum> points = FromEnds();
    for (const TraceEntry& point : q_.points) {
      if (point.cost <= q_.best.cost + kNearlyWithin * q_.rise) points.push_back({point.cost, point.x});
    }
    std::vector<LocalMinimum> ends = {q_.best};
    for (Searched& searched : SearchFrom(Groups(std::move(points)), kLong)) {
      // A point below the best one counts, wherever the search from it would end.
      if (searched.converged || searched.end.cost < q_.best.cost) ends.push_back(std::move(searched.end));
    }
    return Different(std::move(ends));
  }

  [[nodiscard]] long evaluations() const { return evaluations_; }

 private:
  static void Sort(std::vector<LocalMinimum>& points) {
    std::stable_sort(points.begin(), points.end(),
                     [](const LocalMinimum& a, const LocalMinimum& b) { return a.cost < b.cost; });
  }

  [[nodiscard]] bool IsFar(const Vector& x, const std::vector<LocalMinimum>& from, double share) const {
    return std::all_of(from.begin(), from.end(), [&](const LocalMinimum& other) {
      return DistanceInWidths(other.x, x, q_.width) >= share;
    });
  }

  std::vector<LocalMinimum> FromEnds() {
    const auto most = static_cast<std::size_t>(kShortShare * static_cast<double>(left_) / kShort);
    std::vector<Vector> starts(q_.ends.begin(),
                               q_.ends.begin() + static_cast<std::ptrdiff_t>(std::min(most, q_.ends.size())));
    std::vector<LocalMinimum> points;
    for (Searched& searched : SearchFrom(starts, kShort)) {
      if (searched.end.cost <= q_.best.cost + kNearlyWithin * q_.rise)
        points.push_back(std::move(searched.end));
    }
    return points;
  }

  [[nodiscard]] std::vector<Vector> Groups(std::vector<LocalMinimum> points) const {
    Sort(points);
    const std::size_t most = std::min(kMaxGroups, static_cast<std::size_t>(std::max(left_, 0L) / kLong));
    std::vector<LocalMinimum> groups = {q_.best};
    for (LocalMinimum& point : points) {
      if (groups.size() > most) break;
      if (IsFar(point.x, groups, kSameGroup)) groups.push_back(std::move(point));
    }
    std::vector<Vector> starts;
    for (std::size_t i = 1; i < groups.size(); ++i) starts.push_back(std::move(groups[i].x));
    return starts;
  }

  std::vector<Searched> SearchFrom(const std::vector<Vector>& starts, long most) {
    std::vector<Searched> searched(starts.size(), Searched{{q_.best.cost, q_.best.x}, false});
    std::vector<long> used(starts.size());
    std::vector<std::optional<solvers::LocalFit>> fits(MakeExecutor(q_.threads)->workers());
    ForEachShared(problem_.setup().record, q_.threads, starts.size(), [&](std::size_t i, std::size_t worker) {
      if (q_.interrupt != nullptr && q_.interrupt->load(std::memory_order_relaxed)) return;
      if (!fits[worker]) fits[worker].emplace(problem_, q_.penalty);
      solvers::LocalFit& fit = *fits[worker];
      const long before = fit.evaluations();
      solvers::LocalFit::Outcome outcome = fit.Minimize(starts[i], -1, {kTolerance * q_.rise, 0}, most);
      used[i] = fit.evaluations() - before;
      searched[i] = {{outcome.cost, std::move(outcome.x)}, outcome.converged};
    });
    for (const long n : used) {
      evaluations_ += n;
      left_ -= n;
    }
    return searched;
  }

  [[nodiscard]] std::vector<LocalMinimum> Different(std::vector<LocalMinimum> ends) const {
    Sort(ends);
    std::vector<LocalMinimum> minima;
    for (LocalMinimum& end : ends) {
      if (end.cost > q_.best.cost + q_.rise) break;
      if (IsFar(end.x, minima, kSameShare)) minima.push_back(std::move(end));
    }
    return minima;
  }

  const LeastSquares& problem_;
  const CompetitionQuestion& q_;
  long left_;
  long evaluations_ = 0;
};

}  // namespace

double DistanceInWidths(const Vector& a, const Vector& b, const Vector& width) {
  double largest = 0;
  for (Eigen::Index i = 0; i < width.size(); ++i) {
    if (width[i] > 0) largest = std::max(largest, std::abs(a[i] - b[i]) / width[i]);
  }
  return largest;
}

std::vector<LocalMinimum> CompetingMinima(const LeastSquares& problem, const CompetitionQuestion& question,
                                          long& evaluations) {
  Competition competition(problem, question);
  std::vector<LocalMinimum> minima = competition.Run();
  evaluations += competition.evaluations();
  return minima;
}

}  // namespace sinew::uncertainty
