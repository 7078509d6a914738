#include "identify/diagnosis/select/equivalent_effects.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/column_space.h"
#include "identify/diagnosis/score/shortlist.h"
#include "identify/diagnosis/select/linearised_model.h"
#include "identify/execution/shared_loop.h"

namespace sinew::diagnosis {
namespace {

constexpr double kLeftOfTrace = 0.141;    // sqrt(1 - 0.99^2)
constexpr double kSameOfResidual = 0.05;  // difference of two predictions over the residual, at most
constexpr double kSingular = 1e-7;
constexpr double kWorthExchanging = 1;  // penalised deviance
constexpr double kTiedDeviance = 0.01;  // of two models that only rounding tells apart
constexpr double kTiedShare = 1e-4;     // the same of errors of left-out data
constexpr int kMaxReplaced = 8;         // each lowers it, so that the loop would end without this limit

class Exchange {
 public:
  explicit Exchange(const DiagnosisState& state)
      : state_(state),
        model_(state.problem, state.candidates, state.selection.model, state.base.refit.point) {}

  Status Linearise() { return model_.Linearise(); }

  /// Effects that imitate this cause, each with points [P] where it has taken its place.
  struct Substitute {
    int candidate = 0;
    double correlation = 0;
    std::vector<Vector> starts;
  };
  [[nodiscard]] std::vector<Substitute> Of(int cause) const {
    const ColumnSpace space(model_.BaseWithout({cause}), kSingular);
    std::vector<Trace> traces;
    for (const std::optional<Vector>& whole : {model_.TangentOf(cause), model_.SecantOf(cause)}) {
      if (!whole) continue;
      Trace trace{*whole, space.TakenFrom(*whole)};
      if (trace.distinct.norm() > kSingular * whole->norm()) traces.push_back(std::move(trace));
    }
    std::vector<Substitute> found;
    for (std::size_t c = 0; c < state_.candidates.size(); ++c) {
      if (!MayReplace(cause, static_cast<int>(c))) continue;
      std::optional<Substitute> best;
      for (std::size_t probe = 0; probe < state_.candidates[c].probes.size(); ++probe) {
        for (const Trace& trace : traces) {
          auto made = AtProbe(static_cast<int>(c), static_cast<int>(probe), cause, trace, space);
          if (made && (!best || made->correlation > best->correlation)) best = std::move(made);
        }
      }
      if (best) found.push_back(std::move(*best));
    }
    return found;
  }

 private:
  // What a cause changes in the whitened residuals.
  struct Trace {
    Vector whole;
    Vector distinct;  // that the other fitted parameters cannot compensate
  };

  // Known, released in no fit yet, and not the fault of another trial.
  [[nodiscard]] bool MayReplace(int cause, int other) const {
    const Candidate& candidate = state_.candidate(other);
    const auto& released = state_.selection.model.released;
    const bool is_rival = std::any_of(
        state_.selection.rivals.begin(), state_.selection.rivals.end(),
        [&](const Rival& rival) { return rival.candidate == other && rival.instead_of == cause; });
    return candidate.known && !candidate.parameters.empty() && !is_rival &&
           std::find(released.begin(), released.end(), other) == released.end() &&
           (candidate.trial.empty() || candidate.trial == state_.candidate(cause).trial);
  }

  // The change of the candidate's parameters, and of the other fitted ones, that does what the cause does.
  [[nodiscard]] std::optional<Substitute> AtProbe(int candidate, int probe, int cause, const Trace& trace,
                                                  const ColumnSpace& space) const {
    const std::vector<Eigen::Index> own = model_.ColumnsOf(candidate, probe);
    if (own.empty()) return {};
    Matrix columns(model_.columns().rows(), static_cast<Eigen::Index>(own.size()));
    for (std::size_t i = 0; i < own.size(); ++i)
      columns.col(static_cast<Eigen::Index>(i)) = model_.columns().col(own[i]);
    const ColumnSpace imitation(space.TakenFrom(columns), kSingular);
    const double left = imitation.TakenFrom(trace.distinct).norm() / trace.distinct.norm();
    if (!(left < kLeftOfTrace)) return {};
    const Vector change = imitation.Solve(trace.distinct);
    const Vector moved = space.Solve(trace.whole - columns * change);
    Substitute made{candidate, std::sqrt(1 - left * left), {}};
    // Where the others have to move far, to first order may be too far.
    const Vector& x = state_.selection.model.x;
    for (const double share : {1.0, 0.5, 0.0}) {
      Vector start = model_.fit().Parameters((x + share * moved).cwiseMax(0).cwiseMin(1));
      model_.Remove(cause, start);
      model_.Add(candidate, probe, change, start);
      made.starts.push_back(std::move(start));
    }
    return made;
  }

  const DiagnosisState& state_;
  LinearisedModel model_;
};

// Weighted residuals of the training data.
Result<Vector> ResidualsOf(const DiagnosisState& state, const Refit& refit) {
  const LeastSquares fit(state.problem, *refit.setup);
  auto workspace = fit.NewWorkspace();
  Vector residual;
  SINEW_TRY(fit.Evaluate(refit.x, workspace, residual, nullptr));
  return Vector(residual.head(fit.data_rows()));
}

double PriceOf(const DiagnosisState& state, int candidate) {
  return kPerParameter * static_cast<double>(state.candidate(candidate).parameters.size());
}

// The rival that the substitute is; nothing if it fits differently.
std::optional<Rival> Judged(const DiagnosisState& state, int cause, const Exchange::Substitute& substitute,
                            const Vector& residual) {
  const Refit& model = state.selection.model;
  std::vector<int> released{substitute.candidate};
  for (const int c : model.released) {
    if (c != cause) released.push_back(c);
  }
  std::sort(released.begin(), released.end());
  Rival rival{substitute.candidate, cause, state.Fit(released, substitute.starts), 0, substitute.correlation};
  if (!rival.refit.usable()) return {};
  if (!state.selection.cross_validated) {
    rival.delta_lr = state.Difference(rival.refit, model);
    const double more = PriceOf(state, substitute.candidate) - PriceOf(state, cause);
    if (rival.delta_lr + more > SetWidth(model)) return {};
    return rival;
  }
  const auto other = ResidualsOf(state, rival.refit);
  if (!other || !((*other - residual).norm() <= kSameOfResidual * residual.norm())) return {};
  rival.delta_lr = std::numeric_limits<double>::quiet_NaN();
  rival.left_out = other->norm() / residual.norm();
  return rival;
}

// All rivals by equivalence, of every cause.
Result<std::vector<Rival>> FindEquivalents(const DiagnosisState& state) {
  Exchange exchange(state);
  SINEW_TRY(exchange.Linearise());
  SINEW_ASSIGN(const Vector residual, ResidualsOf(state, state.selection.model));
  std::vector<std::pair<int, Exchange::Substitute>> wanted;
  for (const ChosenCause& cause : state.selection.causes) {
    for (Exchange::Substitute& one : exchange.Of(cause.candidate))
      wanted.emplace_back(cause.candidate, std::move(one));
  }
  std::vector<std::optional<Rival>> made(wanted.size());
  ForEachShared(state.options.record, state.options.threads, wanted.size(), [&](std::size_t i, std::size_t) {
    made[i] = Judged(state, wanted[i].first, wanted[i].second, residual);
  });
  std::vector<Rival> rivals;
  for (std::optional<Rival>& rival : made) {
    if (rival) rivals.push_back(std::move(*rival));
  }
  return rivals;
}

// Puts a rival that explains more, or as much with fewer parameters, in the place of its cause.
void PutInPlace(const Rival& better, Selection& selection) {
  for (ChosenCause& cause : selection.causes) {
    if (cause.candidate == better.instead_of) cause.candidate = better.candidate;
    cause.delta_lr -= better.delta_lr;
  }
  std::vector<Rival> others;
  for (Rival& other : selection.rivals) {
    if (other.candidate == better.candidate) continue;
    if (other.instead_of == better.instead_of) other.instead_of = better.candidate;
    other.delta_lr -= better.delta_lr;
    others.push_back(std::move(other));
  }
  selection.model = better.refit;
  selection.rivals = std::move(others);
}

// Of a cause and an alternative that are equally common and that only rounding tells apart, the cause is the
// one that the library has first, so that names do not depend on rounding.
void OrderTies(const DiagnosisState& state, Selection& selection) {
  const auto is_tied_and_first = [&](const Rival& rival) {
    return rival.candidate < rival.instead_of &&
           PriceOf(state, rival.candidate) == PriceOf(state, rival.instead_of) &&
           state.candidate(rival.candidate).occurrence == state.candidate(rival.instead_of).occurrence &&
           (selection.cross_validated ? std::abs(rival.left_out - 1) < kTiedShare
                                      : std::abs(rival.delta_lr) < kTiedDeviance);
  };
  for (;;) {
    const auto found = std::find_if(selection.rivals.begin(), selection.rivals.end(), is_tied_and_first);
    if (found == selection.rivals.end()) return;
    const Rival first = *found;
    Rival second = first;
    second.candidate = first.instead_of;
    second.instead_of = first.candidate;
    second.refit = selection.model;
    second.delta_lr = -first.delta_lr;
    PutInPlace(first, selection);
    selection.rivals.push_back(std::move(second));
  }
}

}  // namespace

Status AddEquivalentEffects(DiagnosisState& state) {
  Selection& selection = state.selection;
  for (int exchanges = 0; !selection.causes.empty(); ++exchanges) {
    SINEW_ASSIGN(std::vector<Rival> rivals, FindEquivalents(state));
    const auto gain = [&](const Rival& rival) {
      return PriceOf(state, rival.instead_of) - PriceOf(state, rival.candidate) - rival.delta_lr;
    };
    const auto best = std::max_element(rivals.begin(), rivals.end(),
                                       [&](const Rival& a, const Rival& b) { return gain(a) < gain(b); });
    const bool better = !selection.cross_validated && best != rivals.end() && gain(*best) > kWorthExchanging;
    if (better && exchanges < kMaxReplaced) {
      PutInPlace(*best, selection);
      continue;
    }
    std::move(rivals.begin(), rivals.end(), std::back_inserter(selection.rivals));
    break;
  }
  OrderTies(state, selection);
  std::stable_sort(selection.rivals.begin(), selection.rivals.end(), [&](const Rival& a, const Rival& b) {
    return selection.cross_validated ? a.left_out < b.left_out : a.delta_lr < b.delta_lr;
  });
  return {};
}

}  // namespace sinew::diagnosis
