#include "identify/uncertainty/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/constants.h"
#include "identify/execution/fit_record.h"
#include "identify/execution/shared_loop.h"
#include "identify/solvers/local_fit.h"
#include "identify/uncertainty/profile_end.h"

namespace sinew::uncertainty {
namespace {

// Ends are found to this share of their distance, far below what a 95 % interval is worth, or as closely as
// the noise level of the cost allows.
constexpr double kEndTolerance = 2e-3;
// Refits stop when the next step would change the rise by this share; half of it is the error of the end.
constexpr double kRefitTolerance = 1e-3;
constexpr int kMaxPoints = 30;
constexpr long kMaxRefitEvaluations = 60;

/// A point on the profile: distance from the minimum, and root of the rise of the cost over the one allowed.
struct Point {
  double distance = 0;
  double height = 0;
  Vector x;
  bool converged = true;
};

double EndTolerance(const LeastSquares& problem, double cost, const ProfileRequest& request) {
  // Half of an error of the rise is that of the end.
  return std::max(kEndTolerance, problem.problem().cost_noise_level() * cost / request.rise / 2);
}

/// The search for one end.
class EndSearch {
 public:
  EndSearch(solvers::LocalFit& fit, const Vector& minimum, double cost, const ProfileRequest& request,
            double sign, long max_evaluations, const std::atomic<bool>* interrupt)
      : fit_(fit),
        minimum_(minimum),
        cost_(cost),
        request_(request),
        sign_(sign),
        last_(fit.evaluations() + max_evaluations),
        interrupt_(interrupt),
        end_tolerance_(EndTolerance(fit.least_squares(), cost, request)),
        inner_{0, 0, minimum, true},
        lowest_{cost, {}} {}

  ProfileEnd Run() {
    const double here = minimum_[request_.variable];
    const double room = sign_ > 0 ? 1 - here : here;
    if (room <= 0) return {here, true};
    double distance = std::min(request_.step, room);
    for (int i = 0; i < kMaxPoints; ++i) {
      if (interrupt_ != nullptr && interrupt_->load(std::memory_order_relaxed))
        return Failure(ProfileFailure::kInterrupted);
      if (fit_.evaluations() >= last_) return Failure(ProfileFailure::kBudgetSpent);
      Point point = Evaluate(distance);
      if (std::abs(point.height - 1) <= end_tolerance_ || (point.height < 1 && distance >= room)) {
        if (!point.converged) return {At(distance), false, ProfileFailure::kRefitNotConverged};
        return {At(distance), point.height < 1 && distance >= room};
      }
      Narrow(std::move(point));
      if (has_outer_ && outer_.distance - inner_.distance <= end_tolerance_ * outer_.distance) {
        if (std::isinf(outer_.height)) return Failure(ProfileFailure::kNoPrediction);
        return {At(outer_.distance), false};  // the cost jumps here
      }
      distance = Next(room);
    }
    return Failure(ProfileFailure::kRoughCost);
  }

  [[nodiscard]] const LowestCost& lowest() const { return lowest_; }

 private:
  [[nodiscard]] double At(double distance) const {
    return std::clamp(minimum_[request_.variable] + sign_ * distance, 0.0, 1.0);
  }
  [[nodiscard]] ProfileEnd Failure(ProfileFailure why) const { return {At(inner_.distance), false, why}; }

  /// Refits all others with this variable at a distance. They start from the straight line through the
  /// minimum and the point that is known next to it; from the tangent if there is none.
  Point Evaluate(double distance) {
    Vector start = minimum_;
    if (inner_.distance > 0) {
      start += (inner_.x - minimum_) * (distance / inner_.distance);
    } else {
      start += sign_ * distance * request_.tangent;
    }
    start[request_.variable] = At(distance);
    const solvers::LocalFit::Outcome outcome =
        fit_.Minimize(start, request_.variable, {kRefitTolerance * request_.rise, 0},
                      std::min(kMaxRefitEvaluations, last_ - fit_.evaluations()));
    if (outcome.cost < lowest_.cost) lowest_ = {outcome.cost, outcome.x};
    const double rise = (outcome.cost - cost_) / request_.rise;
    return {distance, std::isfinite(rise) ? std::sqrt(std::max(rise, 0.0)) : kInfinity, outcome.x,
            outcome.converged};
  }

  void Narrow(Point point) {
    const bool inside = point.height < 1;
    // Illinois: an end that stays twice in a row loses half of its weight.
    if (inside && last_was_inside_ == 1) outer_weight_ *= 0.5;
    if (!inside && last_was_inside_ == 0) inner_weight_ *= 0.5;
    (inside ? inner_weight_ : outer_weight_) = 1;
    last_was_inside_ = inside ? 1 : 0;
    has_outer_ = has_outer_ || !inside;
    (inside ? inner_ : outer_) = std::move(point);
  }

  [[nodiscard]] double Next(double room) const {
    if (!has_outer_) {
      constexpr double kSmallestGrowth = 1.2;
      constexpr double kLargestGrowth = 4;
      const double growth = inner_.height > 0 ? 1.02 / inner_.height : kLargestGrowth;
      return std::min(room, inner_.distance * std::clamp(growth, kSmallestGrowth, kLargestGrowth));
    }
    const double width = outer_.distance - inner_.distance;
    if (std::isinf(outer_.height)) return inner_.distance + 0.5 * width;
    const double below = (1 - inner_.height) * inner_weight_;
    const double above = (outer_.height - 1) * outer_weight_;
    return inner_.distance + width * std::clamp(below / (below + above), 0.02, 0.98);
  }

  solvers::LocalFit& fit_;
  const Vector& minimum_;
  double cost_;
  const ProfileRequest& request_;
  double sign_;
  long last_;
  const std::atomic<bool>* interrupt_;
  double end_tolerance_;
  Point inner_;
  Point outer_;
  bool has_outer_ = false;
  int last_was_inside_ = -1;
  double inner_weight_ = 1;
  double outer_weight_ = 1;
  LowestCost lowest_;
};

/// One end, and what its search has cost.
struct FoundEnd {
  ProfileEnd end;
  LowestCost lowest;
  long evaluations = 0;
};

Digest QuestionOf(const LeastSquares& problem, const Vector& minimum, double cost,
                  const ProfileRequest& request, double sign, const ProfileOptions& options) {
  Digest question;
  problem.AddTo(question);
  question.Add("end of a profile").Add(minimum.data(), static_cast<std::size_t>(minimum.size()));
  question.Add(cost).Add(static_cast<double>(request.variable)).Add(request.rise).Add(request.step);
  question.Add(request.tangent.data(), static_cast<std::size_t>(request.tangent.size()));
  question.Add(sign).Add(static_cast<double>(options.max_evaluations)).Add(options.penalty);
  return question;
}

constexpr std::size_t kAnswerNumbers = 5;  // before the lowest point

Answer ToAnswer(const FoundEnd& found) {
  Answer answer;
  answer.numbers = {found.end.x, found.end.open ? 1.0 : 0.0,
                    static_cast<double>(static_cast<int>(found.end.failure)), found.lowest.cost,
                    static_cast<double>(found.evaluations)};
  answer.numbers.insert(answer.numbers.end(), found.lowest.x.begin(), found.lowest.x.end());
  return answer;
}

bool Restore(const Answer& answer, FoundEnd& found) {
  if (answer.numbers.size() < kAnswerNumbers) return false;
  found.end = {answer.numbers[0], answer.numbers[1] != 0,
               static_cast<ProfileFailure>(static_cast<int>(answer.numbers[2]))};
  found.lowest.cost = answer.numbers[3];
  found.evaluations = static_cast<long>(answer.numbers[4]);
  found.lowest.x =
      Eigen::Map<const Vector>(answer.numbers.data() + kAnswerNumbers,
                               static_cast<Eigen::Index>(answer.numbers.size() - kAnswerNumbers));
  return true;
}

}  // namespace

std::vector<Profile> ProfileIntervals(const LeastSquares& problem, const Vector& minimum, double cost,
                                      const std::vector<ProfileRequest>& requests,
                                      const ProfileOptions& options, long& evaluations) {
  const std::size_t ends = 2 * requests.size();
  std::vector<Profile> profiles(requests.size());
  if (ends == 0) return profiles;
  solvers::LocalFit at_minimum(problem, options.penalty);
  const bool has_model = static_cast<bool>(at_minimum.ModelAt(minimum));
  evaluations += at_minimum.evaluations();
  const auto is_stopped = [&] {
    return options.interrupt != nullptr && options.interrupt->load(std::memory_order_relaxed);
  };
  const auto find = [&](solvers::LocalFit& fit, const ProfileRequest& request, double sign) {
    FoundEnd found{{}, {cost, {}}, 0};
    const long before = fit.evaluations();
    std::optional<ProfileEnd> end;
    if (has_model && !is_stopped()) {
      end = FindEnd(fit,
                    {minimum, cost, at_minimum.model(), request, sign, EndTolerance(problem, cost, request),
                     options.max_evaluations, options.interrupt},
                    found.lowest);
    }
    if (end) {
      found.end = *end;
    } else {
      const long left = options.max_evaluations - (fit.evaluations() - before);
      EndSearch search(fit, minimum, cost, request, sign, left, options.interrupt);
      found.end = search.Run();
      if (search.lowest().cost < found.lowest.cost) found.lowest = search.lowest();
    }
    found.evaluations = fit.evaluations() - before;
    return found;
  };

  std::vector<FoundEnd> found(ends);
  std::vector<std::optional<solvers::LocalFit>> fits(MakeExecutor(options.threads)->workers());
  FitRecord* const record = problem.setup().record;
  ForEachShared(record, options.threads, ends, [&](std::size_t i, std::size_t worker) {
    const ProfileRequest& request = requests[i / 2];
    const double sign = i % 2 == 0 ? -1 : 1;
    Digest question;
    if (record != nullptr) {
      question = QuestionOf(problem, minimum, cost, request, sign, options);
      if (const auto known = record->Find(question); known && Restore(*known, found[i])) return;
    }
    if (!fits[worker]) fits[worker].emplace(problem, options.penalty);
    found[i] = find(*fits[worker], request, sign);
    // An interruption may also look like another failure.
    if (record != nullptr && !is_stopped()) record->Keep(question, ToAnswer(found[i]));
  });
  for (std::size_t i = 0; i < ends; ++i) {
    evaluations += found[i].evaluations;
    (i % 2 == 0 ? profiles[i / 2].lower : profiles[i / 2].upper) = found[i].end;
  }
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const LowestCost& below = found[2 * i].lowest;
    const LowestCost& above = found[2 * i + 1].lowest;
    profiles[i].lowest = below.cost <= above.cost ? below : above;
  }
  return profiles;
}

}  // namespace sinew::uncertainty
