#include "identify/diagnosis/held_out_validation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/column_space.h"
#include "base/constants.h"
#include "identify/diagnosis/held_out_sensitivity.h"
#include "identify/diagnosis/score/shortlist.h"

namespace sinew::diagnosis {
namespace {

// Least change of the held-out residuals by a cause, in units of the noise variance, from which a worse
// prediction rejects it: with the right cause this happens by chance in 1 of 75 cases.
constexpr double kMinChange = 20;
constexpr double kLowQuantile = -2.33;  // standard normal quantile of 0.01
// Shortfall of the held-out gain that counts: as a share of the gain, or by what it leaves at least, per
// sample (2 % of the residual's deviation). No law and no integrator is exact to the last thousandth of a
// large misfit.
constexpr double kShortfallShare = 0.1;
constexpr double kLeastLeftPerSample = 0.04;
constexpr double kMinChangeShare =
    0.05;  // the same as a share of the remaining error, if that dominates the noise

// Held-out loss with a cause over that without it, at most, for the cause to be restored: 15 % of the error,
// as for a cause that is chosen by cross-validation.
constexpr double kRestored = 0.85 * 0.85;

class HeldOutValidation {
 public:
  explicit HeldOutValidation(DiagnosisState& state) : state_(state), selection_(state.selection) {}

  Result<std::vector<WithdrawnCause>> Run() {
    const noise::NoiseModel noise = selection_.model.noise;
    state_.held_out.FitUnder(selection_.model.holds_input_noise ? &noise : nullptr);
    auto told = RejectOneAfterTheOther();
    state_.held_out.FitUnder(nullptr);
    return told;
  }

 private:
  Result<std::vector<WithdrawnCause>> RejectOneAfterTheOther() {
    while (!selection_.causes.empty()) {
      state_.held_out.Align(state_.base.refit.point, selection_.model.point);
      SINEW_ASSIGN(const auto of_base, Residuals(state_.base.refit.point));
      SINEW_ASSIGN(const auto with, Residuals(selection_.model.point));
      const double together = Gain(of_base, with);
      const bool rejected = together < 0 && ChangesEnoughToJudge(of_base, with) &&
                            PredictsWorse(state_.base.refit, of_base, with);
      Rejection worst = FindWorst(rejected);
      if (worst.cause == selection_.causes.size()) {
        selection_.held_out_shortfall = ShortfallOfGain(of_base, with);
        if (selection_.held_out_shortfall > 0) selection_.structure_left = true;
        break;
      }
      if (worst.gain >= 0) {
        worst.gain = together;
        worst.worst = WorstTrace(of_base, with);
      }
      Withdraw(std::move(worst));
    }
    if (!withdrawn_.empty() && !selection_.cross_validated) CompareWithTheRest();
    while (selection_.cross_validated && Restore()) {
    }
    std::vector<WithdrawnCause> told;
    for (Withdrawn& one : withdrawn_) told.push_back(std::move(one.told));
    return told;
  }

  struct Rejection {
    std::size_t cause = 0;
    double gain = 0;  // reduction of the held-out loss by the cause
    Refit without;
    std::optional<TraceErrors> worst;  // the trace that it makes worse most
  };

  struct Withdrawn {
    ChosenCause cause;
    Vector point;  // [P] of the model with it
    WithdrawnCause told;
  };

  // Priors belong to the likelihood.
  [[nodiscard]] Result<std::vector<Vector>> Residuals(const Vector& point) const {
    return selection_.cross_validated ? state_.held_out.Residuals(point)
                                      : state_.held_out.ResidualsWithPriors(point);
  }

  // Reduction of the held-out loss by the model.
  [[nodiscard]] double Gain(const std::vector<Vector>& before, const std::vector<Vector>& with) const {
    return state_.Loss(before, selection_.model.noise) - state_.Loss(with, selection_.model.noise);
  }

  [[nodiscard]] bool ChangesEnoughToJudge(const std::vector<Vector>& before,
                                          const std::vector<Vector>& with) const {
    const double loss = state_.Loss(Moved(before, with), selection_.model.noise);
    if (selection_.cross_validated) return loss > kMinChangeShare * state_.Loss(with, selection_.model.noise);
    if (loss <= kMinChange) return false;
    double sum = 0;
    double squares = 0;
    for (const double gain : GainsOfGroups(before, with)) {
      sum += gain;
      squares += gain * gain;
    }
    return squares == 0 || sum < kLowQuantile * std::sqrt(squares);
  }

  // Changes of the held-out residuals by the errors of the fitted values, whitened, without what the trials'
  // own nuisance values absorb. Empty where they cannot be computed, or a misfit dominates the noise.
  [[nodiscard]] Matrix ErrorsOf(const Refit& refit) const {
    if (selection_.cross_validated) return {};
    const auto covariance = state_.CovarianceOf(refit);
    if (!covariance) return {};
    Matrix nuisance;
    const auto changes = HeldOutSensitivity(state_.problem, state_.held_out, refit,
                                            state_.held_out.Fitted(refit.point), *covariance, nuisance);
    if (!changes || !changes->allFinite() || !nuisance.allFinite()) return {};
    const Matrix white = state_.held_out.Whitened(*changes, selection_.model.noise);
    if (nuisance.cols() == 0) return white;
    constexpr double kSingular = 1e-10;
    return ColumnSpace(state_.held_out.Whitened(nuisance, selection_.model.noise), kSingular)
        .TakenFrom(white);
  }

  [[nodiscard]] Vector WhitenedStack(const std::vector<Vector>& residuals) const {
    Eigen::Index rows = 0;
    for (const Vector& block : residuals) rows += block.size();
    Vector stack(rows);
    rows = 0;
    for (const Vector& block : residuals) {
      stack.segment(rows, block.size()) = block;
      rows += block.size();
    }
    return state_.held_out.Whitened(stack, selection_.model.noise);
  }

  // Whether held-out trials are less likely under the model than without the cause, the errors of the fitted
  // values of both allowed for: where small differences grow, these change the prediction by more than an
  // effect does, and a worse prediction says little.
  [[nodiscard]] bool PredictsWorse(const Refit& without, const std::vector<Vector>& before,
                                   const std::vector<Vector>& with) const {
    const Matrix of_without = ErrorsOf(without);
    const Matrix of_model = ErrorsOf(selection_.model);
    if (of_without.size() == 0 || of_model.size() == 0) return true;
    return PredictiveDeviance(WhitenedStack(with), of_model) >
           PredictiveDeviance(WhitenedStack(before), of_without);
  }

  [[nodiscard]] static std::vector<Vector> Moved(std::vector<Vector> before,
                                                 const std::vector<Vector>& with) {
    for (std::size_t b = 0; b < before.size(); ++b) before[b] -= with[b];
    return before;
  }

  // Gains per group of samples. Samples of a group share an error, so that the noise model underestimates the
  // variation by chance; gains of groups are independent.
  [[nodiscard]] std::vector<double> GainsOfGroups(const std::vector<Vector>& before,
                                                  const std::vector<Vector>& with) const {
    std::vector<double> gains = state_.held_out.InnovationsOfGroups(before, selection_.model.noise);
    const std::vector<double> left = state_.held_out.InnovationsOfGroups(with, selection_.model.noise);
    for (std::size_t g = 0; g < gains.size(); ++g) gains[g] -= left[g];
    return gains;
  }

  [[nodiscard]] double ShortfallOfGain(const std::vector<Vector>& before,
                                       const std::vector<Vector>& with) const {
    if (selection_.cross_validated) return 0;
    const std::vector<Vector> moved = Moved(before, with);
    const double squared = state_.Loss(moved, selection_.model.noise);
    const double fitted = FittedChange();
    if (!(squared > 0 && fitted > 0)) return 0;
    double variance = 4 * (1 + squared / fitted) * squared;
    const std::vector<double> expected = state_.held_out.InnovationsOfGroups(moved, selection_.model.noise);
    const std::vector<double> gains = GainsOfGroups(before, with);
    double of_groups = 0;
    for (std::size_t g = 0; g < gains.size(); ++g) of_groups += std::pow(gains[g] - expected[g], 2);
    variance = std::max(variance, of_groups);
    // The errors of the fitted values add to the change, and take twice as much from the gain.
    const Matrix errors = ErrorsOf(selection_.model);
    double lost = 0;
    if (errors.size() > 0) {
      const Vector along = errors.transpose() * WhitenedStack(moved);
      variance = std::max(variance, 4 * (squared + along.squaredNorm()));
      lost = 2 * errors.squaredNorm();
    }
    const double shortfall = squared - Gain(before, with);
    if (!(lost - shortfall < kLowQuantile * std::sqrt(variance))) return 0;
    // What is left lies at least along the change by the causes.
    double samples = 0;
    for (const Vector& block : with) samples += static_cast<double>(block.size());
    const bool matters = shortfall > kShortfallShare * squared ||
                         0.25 * shortfall * shortfall / squared > kLeastLeftPerSample * samples;
    return matters ? shortfall / squared : 0;
  }

  // Squared change of the training residuals by the causes, in units of the noise variance; 0 if it cannot be
  // computed.
  [[nodiscard]] double FittedChange() const {
    LeastSquares fit(state_.problem, *selection_.model.setup);
    const noise::Whitening whitening(selection_.model.noise, TrainStretches(fit));
    fit.set_transform(&whitening);
    auto workspace = fit.NewWorkspace();
    Vector with;
    Vector without;
    if (!fit.Evaluate(selection_.model.x, workspace, with, nullptr)) return 0;
    if (!fit.Evaluate(fit.Variables(state_.base.refit.point), workspace, without, nullptr)) return 0;
    return (with - without).squaredNorm();
  }

  // The cause without which held-out trials are predicted best; the number of causes if all are to be kept.
  [[nodiscard]] Rejection FindWorst(bool rejected_together) const {
    Rejection worst;
    worst.cause = selection_.causes.size();
    worst.gain = rejected_together ? std::numeric_limits<double>::infinity() : 0;
    for (std::size_t i = 0; i < selection_.causes.size(); ++i) {
      const int candidate = selection_.causes[i].candidate;
      if (!state_.candidate(candidate).trial.empty()) continue;
      Refit without = Without(candidate);
      if (!without.usable()) continue;
      state_.held_out.Align(without.point, selection_.model.point);
      const auto before = Residuals(without.point);
      const auto with = Residuals(selection_.model.point);
      if (!before || !with) continue;
      const double gain = Gain(*before, *with);
      const bool counts = gain < worst.gain &&
                          (rejected_together ||
                           (ChangesEnoughToJudge(*before, *with) && PredictsWorse(without, *before, *with)));
      if (counts) worst = {i, gain, std::move(without), WorstTrace(*before, *with)};
    }
    return worst;
  }

  // Nothing if no trace's error grows.
  [[nodiscard]] std::optional<TraceErrors> WorstTrace(const std::vector<Vector>& before,
                                                      const std::vector<Vector>& with) const {
    double most = 0;
    std::optional<TraceErrors> worst;
    for (std::size_t b = 0; b < state_.held_out.blocks().size(); ++b) {
      const double more = with[b].squaredNorm() - before[b].squaredNorm();
      if (more <= most) continue;
      most = more;
      const Block& block = state_.problem.layout()[static_cast<std::size_t>(state_.held_out.blocks()[b])];
      const auto rmse = [&](const Vector& r) {
        return r.norm() / std::sqrt(static_cast<double>(r.size())) / block.weight;
      };
      worst = {block.trial, block.channel, block.unit, rmse(before[b]), rmse(with[b])};
    }
    return worst;
  }

  [[nodiscard]] Refit Without(int candidate) const {
    std::vector<int> rest;
    for (const int c : selection_.model.released) {
      if (c != candidate) rest.push_back(c);
    }
    if (rest.empty()) return state_.base.refit;
    Vector start = selection_.model.point;
    for (const int index : state_.candidate(candidate).parameters)
      start[index] = state_.base.refit.point[index];
    return state_.Fit(rest, {start});
  }

  // A cause may have been rejected because of another one that is rejected, too: it is judged again without
  // that. @return true if one was restored
  bool Restore() {
    const auto now = Residuals(selection_.model.point);
    if (!now) return false;
    double least = kRestored * state_.Loss(*now, selection_.model.noise);
    std::optional<Refit> better;
    std::size_t restored = withdrawn_.size();
    for (std::size_t i = 0; i < withdrawn_.size(); ++i) {
      const int candidate = withdrawn_[i].cause.candidate;
      std::vector<int> released = selection_.model.released;
      released.insert(std::lower_bound(released.begin(), released.end(), candidate), candidate);
      Vector start = selection_.model.point;
      for (const int index : state_.candidate(candidate).parameters)
        start[index] = withdrawn_[i].point[index];
      Refit refit = state_.Fit(released, {start});
      if (!refit.usable()) continue;
      const auto with = Residuals(refit.point);
      if (!with || !(state_.Loss(*with, refit.noise) < least)) continue;
      least = state_.Loss(*with, refit.noise);
      better = std::move(refit);
      restored = i;
    }
    if (!better) return false;
    selection_.model = std::move(*better);
    selection_.causes.push_back(withdrawn_[restored].cause);
    withdrawn_.erase(withdrawn_.begin() + static_cast<std::ptrdiff_t>(restored));
    return true;
  }

  void Withdraw(Rejection rejection) {
    const ChosenCause cause = selection_.causes[rejection.cause];
    const bool likelihood = !selection_.cross_validated;  // else the units are no likelihoods
    withdrawn_.push_back({cause,
                          selection_.model.point,
                          {state_.candidate(cause.candidate).effect, likelihood ? cause.delta_lr : kNaN,
                           likelihood ? -rejection.gain : kNaN, rejection.worst}});
    if (ReplaceByRival(rejection)) return;
    selection_.model = std::move(rejection.without);
    selection_.causes.erase(selection_.causes.begin() + static_cast<std::ptrdiff_t>(rejection.cause));
    std::vector<Rival> others;
    for (Rival& other : selection_.rivals) {
      if (other.instead_of != cause.candidate) others.push_back(std::move(other));
    }
    selection_.rivals = std::move(others);
    if (!selection_.cross_validated) RefitRivals(cause.candidate);
    selection_.structure_left = true;  // the error that it had explained has no cause now
  }

  // The rivals of the other causes were fitted together with the removed cause. A rival that now explains
  // more than its cause replaces it if held-out trials do not reject that.
  void RefitRivals(int gone) {
    std::vector<Rival> refitted;
    for (Rival& rival : selection_.rivals) {
      std::vector<int> released{rival.candidate};
      for (const int c : selection_.model.released) {
        if (c != rival.instead_of && c != rival.candidate) released.push_back(c);
      }
      std::sort(released.begin(), released.end());
      Vector start = rival.refit.point;
      for (const int index : state_.candidate(gone).parameters) start[index] = state_.base.refit.point[index];
      rival.refit = state_.Fit(released, {start});
      if (rival.refit.usable()) refitted.push_back(std::move(rival));
    }
    selection_.rivals = std::move(refitted);
    const auto best = std::min_element(
        selection_.rivals.begin(), selection_.rivals.end(),
        [&](const Rival& a, const Rival& b) { return state_.Difference(a.refit, b.refit) < 0; });
    if (best != selection_.rivals.end() && state_.Difference(best->refit, selection_.model) < 0 &&
        Generalises(best->refit)) {
      for (ChosenCause& chosen : selection_.causes) {
        if (chosen.candidate == best->instead_of) chosen.candidate = best->candidate;
      }
      const int replaced = best->instead_of;
      const int by = best->candidate;
      selection_.model = best->refit;
      selection_.rivals.erase(best);
      for (Rival& rival : selection_.rivals) {
        if (rival.instead_of == replaced) rival.instead_of = by;
      }
    }
    std::vector<Rival> close;
    for (Rival& rival : selection_.rivals) {
      rival.delta_lr = state_.Difference(rival.refit, selection_.model);
      const bool is_cause = std::any_of(selection_.causes.begin(), selection_.causes.end(),
                                        [&](const ChosenCause& c) { return c.candidate == rival.candidate; });
      const double more = static_cast<double>(state_.candidate(rival.candidate).parameters.size()) -
                          static_cast<double>(state_.candidate(rival.instead_of).parameters.size());
      if (!is_cause && rival.delta_lr >= -2 * kByOccurrence &&
          rival.delta_lr + kPerParameter * more <= SetWidth(selection_.model))
        close.push_back(std::move(rival));
    }
    selection_.rivals = std::move(close);
  }

  // True if held-out trials are predicted no worse than with the model.
  [[nodiscard]] bool Generalises(const Refit& refit) const {
    const auto now = Residuals(selection_.model.point);
    const auto then = Residuals(refit.point);
    return now && then &&
           state_.Loss(*then, selection_.model.noise) <= state_.Loss(*now, selection_.model.noise);
  }

  // Likelihood ratio of each cause against the remaining set without it; its p-value stays that of its
  // selection.
  void CompareWithTheRest() {
    for (ChosenCause& cause : selection_.causes) {
      const Refit without = Without(cause.candidate);
      if (without.usable()) cause.delta_lr = state_.Difference(without, selection_.model);
    }
    RemoveWhatLowersTheLikelihood();
  }

  // A cause without which the remaining set fits better is none.
  void RemoveWhatLowersTheLikelihood() {
    const auto worse = std::find_if(selection_.causes.begin(), selection_.causes.end(),
                                    [](const ChosenCause& cause) { return cause.delta_lr < 0; });
    if (worse == selection_.causes.end()) return;
    const int gone = worse->candidate;
    selection_.model = Without(gone);
    selection_.causes.erase(worse);
    selection_.rivals.erase(std::remove_if(selection_.rivals.begin(), selection_.rivals.end(),
                                           [&](const Rival& rival) { return rival.instead_of == gone; }),
                            selection_.rivals.end());
    selection_.structure_left = true;
    CompareWithTheRest();
  }

  // Replaces the cause by the next alternative of its set that generalises.
  bool ReplaceByRival(const Rejection& rejection) {
    const ChosenCause cause = selection_.causes[rejection.cause];
    const auto before = Residuals(rejection.without.point);
    for (const Rival& rival : selection_.rivals) {
      if (rival.instead_of != cause.candidate || !before) continue;
      if (selection_.cross_validated && rival.left_out > kSameError) continue;
      const auto with = Residuals(rival.refit.point);
      if (!with || state_.Loss(*before, rival.refit.noise) <= state_.Loss(*with, rival.refit.noise)) continue;
      const int next = rival.candidate;
      selection_.model = rival.refit;
      selection_.causes[rejection.cause] = {next, cause.delta_lr - rival.delta_lr, cause.p_value,
                                            cause.left_out * rival.left_out};
      std::vector<Rival> others;
      for (Rival& other : selection_.rivals) {
        if (other.candidate == next) continue;
        if (other.instead_of == cause.candidate) other.instead_of = next;
        others.push_back(std::move(other));
      }
      selection_.rivals = std::move(others);
      return true;
    }
    return false;
  }

  DiagnosisState& state_;
  Selection& selection_;
  std::vector<Withdrawn> withdrawn_;
};

}  // namespace

Result<std::vector<WithdrawnCause>> RejectUnsupportedCauses(DiagnosisState& state) {
  return HeldOutValidation(state).Run();
}

}  // namespace sinew::diagnosis
