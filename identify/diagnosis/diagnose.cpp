// The steps of a diagnosis, in order; what each means stands in docs/diagnosis.md.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/drift.h"
#include "identify/diagnosis/gross_search.h"
#include "identify/diagnosis/held_out_gain.h"
#include "identify/diagnosis/jackknife.h"
#include "identify/diagnosis/rounding.h"
#include "identify/diagnosis/selection.h"
#include "identify/diagnosis/shape.h"
#include "identify/diagnosis/standing.h"
#include "identify/diagnosis/structure.h"
#include "identify/diagnosis/wording.h"
#include "identify/results/held_out.h"

namespace sinew {
namespace {

constexpr double kDetectable = 3.605;   // see Cause::size
constexpr double kPower = 1.645;        // 95 % above a threshold
constexpr double kSeparation = 0.4165;  // see Alternative::separating_size
constexpr double kSameClass = 0.97;
// What a cause changes in held-out trials, in units of their noise's variance, from which a loss there is a
// denial: with the right cause it happens by chance in 1 of 75 cases.
constexpr double kTelling = 20;
constexpr std::size_t kMostUnknown = 3;
// A base fit that needs more of them has no minimum to speak of (it takes 10 to 200).
constexpr long kBaseEvaluations = 400;
constexpr double kNormal95 = 1.959964;

class Examination {
 public:
  Examination(const Problem& problem, const DiagnosisOptions& options)
      : problem_(problem), options_(options), held_out_(problem) {}

  Result<Diagnosis> Run(FitSetup setup) {
    const auto began = std::chrono::steady_clock::now();
    SINEW_TRY(CheckThatThereIsSomethingToDo(setup));
    out_.setup = std::move(setup);
    candidates_ = ListCandidates(problem_, out_.setup);
    RemoveRoundings(problem_, candidates_);
    Say("fitting the base model");
    SINEW_ASSIGN(const bool fitted, FitBase());
    if (fitted) SINEW_TRY(Investigate());
    out_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return std::move(out_);
  }

 private:
  void Say(const std::string& step) const {
    if (options_.progress) options_.progress(step);
  }

  Status CheckThatThereIsSomethingToDo(const FitSetup& setup) const {
    const Layout& layout = problem_.layout();
    int rows = 0;
    for (const Block& block : layout) rows += block.role == BlockRole::kTrain ? block.samples() : 0;
    if (rows == 0)
      return Fail("no training trial has a channel that is compared: there is nothing to diagnose");
    if (rows < 2 * static_cast<int>(setup.free.size()) + 20) {
      return Fail("{} samples are too few to fit {} parameters and to judge what is left", rows,
                  setup.free.size());
    }
    return {};
  }

  // Step 0. False: there is no usable base fit, and the diagnosis says so.
  Result<bool> FitBase() {
    const LeastSquares fit(problem_, out_.setup);
    SolverOptions how;
    how.seed = options_.seed;
    how.threads = options_.threads;
    SINEW_ASSIGN(const auto solver, MakeSolver("ceres", how));
    Evaluator::Options gate;
    gate.interrupt = options_.interrupt;
    gate.budget.max_evaluations = kBaseEvaluations;
    Evaluator evaluator(fit, gate);
    out_.base = solver->Solve(evaluator, fit.Start());
    out_.base_point = fit.Parameters(out_.base.x);
    out_.extended_point = out_.base_point;
    if (!out_.base.stop.usable() || !out_.base.stop.converged()) {
      out_.verdict = DiagnosisVerdict::kUnexplained;
      out_.sentences = {
          fmt::format("Nothing can be concluded: the base fit did not converge ({}).", out_.base.stop.test),
          "A cause named on top of an unfinished fit would be a guess. Give better starts or "
          "bounds, or fix what the data cannot tell."};
      return false;
    }
    refitter_ = std::make_unique<Refitter>(problem_, out_.setup, candidates_);
    return true;
  }

  Status Investigate() {
    Refit base = refitter_->Fit({}, {out_.base_point});
    if (!base.usable()) return Fail("the base model: {}", base.failure);
    if (base.swallowed) {
      refitter_->TakeErrorsForIndependent();
      out_.warnings.push_back(
          "the residual is so large and smooth that a noise model would take the model's place: errors of "
          "neighbouring samples count as independent, which makes p-values and intervals too small");
    }
    out_.base_point = base.point;
    Say("scoring the library");
    SINEW_ASSIGN(base_, StandAt(problem_, candidates_, std::move(base), options_.alarm_level, options_.seed));
    SINEW_TRY(DescribeResidual());
    Say("refitting what answered");
    SINEW_ASSIGN(selection_, Select(problem_, *refitter_, candidates_, base_, options_));
    if (held_out_.exists() && !selection_.causes.empty()) SINEW_TRY(AskHeldOutTrials());
    SINEW_TRY(Report());
    if (selection_.structure_left) SINEW_TRY(DiscoverUnknown());
    SINEW_TRY(MeasureGain());
    Conclude();
    return {};
  }

  Status DescribeResidual() {
    const LeastSquares fit(problem_, *base_.refit.setup);
    SINEW_ASSIGN(const auto residuals, NoiseBlocks(fit, base_.refit.x));
    out_.tests = TestResiduals(residuals);
    SINEW_ASSIGN(out_.structure, FindStructure(problem_, base_.refit.point));
    out_.threshold = base_.family.threshold;
    out_.family_p_value = base_.family.p_value;
    return {};
  }

  // Step 6, first half: a cause that held-out trials deny is withdrawn; if another one of its set carries
  // over, that takes its place. Causes that lean on each other may each look needed and be wrong together:
  // then the whole is compared with the base model, and what is missed least goes first.
  Status AskHeldOutTrials() {
    SINEW_ASSIGN(const auto of_base, held_out_.Residuals(base_.refit.point));
    while (!selection_.causes.empty()) {
      SINEW_ASSIGN(const auto with, held_out_.Residuals(selection_.model.point));
      const double together = GainOnHeldOut(of_base, with);
      const bool denied = together < 0 && IsTelling(of_base, with);
      std::size_t worst = selection_.causes.size();
      double worst_gain = denied ? std::numeric_limits<double>::infinity() : 0;
      Refit worst_without;
      for (std::size_t i = 0; i < selection_.causes.size(); ++i) {
        const ChosenCause& cause = selection_.causes[i];
        if (!candidates_[static_cast<std::size_t>(cause.candidate)].trial.empty()) continue;
        Refit without = Without(cause.candidate);
        if (!without.usable()) continue;
        const auto before = held_out_.Residuals(without.point);
        if (!before) continue;
        const double gain = GainOnHeldOut(*before, with);
        if (gain < worst_gain && (denied || IsTelling(*before, with))) {
          worst = i;
          worst_gain = gain;
          worst_without = std::move(without);
        }
      }
      if (worst == selection_.causes.size()) return {};
      Withdraw(worst, worst_gain < 0 ? worst_gain : together, std::move(worst_without));
    }
    return {};
  }

  // Of held-out residuals: in units of the noise, or, if what is wrong dwarfs it, plain squares.
  [[nodiscard]] double Loss(const std::vector<Vector>& residuals, const NoiseModel& noise) const {
    if (!selection_.gross) return held_out_.Innovations(residuals, noise);
    double squares = 0;
    for (const Vector& block : residuals) squares += block.squaredNorm();
    return squares;
  }

  // How much better the held-out trials are with the model.
  [[nodiscard]] double GainOnHeldOut(const std::vector<Vector>& before,
                                     const std::vector<Vector>& with) const {
    return Loss(before, selection_.model.noise) - Loss(with, selection_.model.noise);
  }

  [[nodiscard]] bool IsTelling(std::vector<Vector> moved, const std::vector<Vector>& with) const {
    constexpr double kShare = 0.05;  // of what is left
    for (std::size_t b = 0; b < moved.size(); ++b) moved[b] -= with[b];
    const double loss = Loss(moved, selection_.model.noise);
    return selection_.gross ? loss > kShare * Loss(with, selection_.model.noise) : loss > kTelling;
  }

  [[nodiscard]] Result<Matrix> CovarianceOf(const Refit& refit) const {
    return selection_.gross ? JackknifeCovariance(problem_, refit) : refitter_->Covariance(refit);
  }

  [[nodiscard]] Refit Fit(const std::vector<int>& released, const std::vector<Vector>& starts) const {
    constexpr double kTolerance = 1e-6;
    return selection_.gross ? refitter_->FitOrdinary(released, starts, kTolerance)
                            : refitter_->Fit(released, starts);
  }

  [[nodiscard]] Refit Without(int candidate) const {
    std::vector<int> rest;
    for (const int c : selection_.model.released) {
      if (c != candidate) rest.push_back(c);
    }
    if (rest.empty()) return base_.refit;
    Vector start = selection_.model.point;
    for (const int index : candidates_[static_cast<std::size_t>(candidate)].parameters)
      start[index] = base_.refit.point[index];
    return Fit(rest, {start});
  }

  void Withdraw(std::size_t which, double gain, Refit without) {
    const ChosenCause cause = selection_.causes[which];
    const auto before = held_out_.Residuals(without.point);
    out_.withdrawn.push_back(
        {candidates_[static_cast<std::size_t>(cause.candidate)].effect,
         selection_.gross
             ? std::string("it improves the fitted trials but makes the held-out trials worse")
             : fmt::format(
                   "it improves the fitted trials (delta LR {:.0f}) but makes the held-out trials worse "
                   "(by {:.0f} in the same units)",
                   cause.delta_lr, -gain)});
    // The next of the set that does carry over.
    for (const Rival& rival : selection_.rivals) {
      if (rival.instead_of != cause.candidate || !before) continue;
      const auto with = held_out_.Residuals(rival.refit.point);
      if (!with || Loss(*before, rival.refit.noise) <= Loss(*with, rival.refit.noise)) continue;
      const int next = rival.candidate;
      selection_.model = rival.refit;
      selection_.causes[which] = {next, cause.delta_lr - rival.delta_lr, cause.p_value};
      std::vector<Rival> others;
      for (Rival& other : selection_.rivals) {
        if (other.candidate == next) continue;
        if (other.instead_of == cause.candidate) other.instead_of = next;
        others.push_back(std::move(other));
      }
      selection_.rivals = std::move(others);
      return;
    }
    selection_.model = std::move(without);
    selection_.causes.erase(selection_.causes.begin() + static_cast<std::ptrdiff_t>(which));
    std::vector<Rival> others;
    for (Rival& other : selection_.rivals) {
      if (other.instead_of != cause.candidate) others.push_back(std::move(other));
    }
    selection_.rivals = std::move(others);
    selection_.structure_left = true;  // what it had taken up in the fitted trials has no name now
  }

  [[nodiscard]] std::vector<DiagnosedParameter> Describe(const Refit& refit, const Matrix& covariance,
                                                         const std::vector<int>& which) const {
    const LeastSquares fit(problem_, *refit.setup);
    const Vector slopes = fit.Slopes(refit.x);
    std::vector<DiagnosedParameter> described;
    for (const int index : which) {
      const auto at = std::lower_bound(refit.setup->free.begin(), refit.setup->free.end(), index);
      if (at == refit.setup->free.end() || *at != index) continue;
      const auto v = static_cast<Eigen::Index>(at - refit.setup->free.begin());
      const Parameter& p = refit.setup->parameters[static_cast<std::size_t>(index)];
      DiagnosedParameter one;
      one.name = p.name;
      one.unit = p.unit;
      one.value = refit.point[index];
      one.before = base_.refit.point[index];
      one.std_error = std::sqrt(std::max(0.0, covariance(v, v))) * std::abs(slopes[v]);
      if (p.scale == Scale::kLog && one.value > 0) {
        const double factor = std::exp(kNormal95 * one.std_error / one.value);
        one.ci95 = {one.value / factor, one.value * factor};
      } else {
        one.ci95 = {one.value - kNormal95 * one.std_error, one.value + kNormal95 * one.std_error};
      }
      one.ci95 = {std::max(one.ci95[0], p.lower), std::min(one.ci95[1], p.upper)};
      described.push_back(std::move(one));
    }
    return described;
  }

  [[nodiscard]] std::vector<int> Findings(const Refit& refit) const {
    std::vector<int> findings;
    for (const int index : refit.setup->free) {
      if (refit.setup->parameters[static_cast<std::size_t>(index)].kind != ParameterKind::kNuisance)
        findings.push_back(index);
    }
    return findings;
  }

  [[nodiscard]] double SizeOf(int candidate, double delta_lr) const {
    const Score* score = base_.BestOf(candidate);
    const double statistic = std::max(delta_lr, score != nullptr ? 0.0 : delta_lr);
    return statistic > 0 ? std::sqrt(statistic) / kDetectable : 0;
  }

  Status Report() {
    SINEW_ASSIGN(const Matrix base_covariance, CovarianceOf(base_.refit));
    out_.base_parameters = Describe(base_.refit, base_covariance, Findings(base_.refit));
    SINEW_ASSIGN(const Matrix covariance, CovarianceOf(selection_.model));
    out_.extended_parameters = Describe(selection_.model, covariance, Findings(selection_.model));
    out_.extended_point = selection_.model.point;
    const double n = selection_.model.rows;
    for (const ChosenCause& chosen : selection_.causes) {
      const Candidate& candidate = candidates_[static_cast<std::size_t>(chosen.candidate)];
      Cause cause;
      cause.effect = candidate.effect;
      cause.level = candidate.level;
      cause.sentence = candidate.says;
      cause.parameters = Describe(selection_.model, covariance, candidate.parameters);
      cause.p_value = chosen.p_value;
      cause.left_out = chosen.left_out;
      cause.delta_lr = chosen.delta_lr;
      cause.delta_bic = chosen.delta_lr - static_cast<double>(candidate.parameters.size()) * std::log(n);
      cause.size = SizeOf(chosen.candidate, chosen.delta_lr);
      out_.causes.push_back(std::move(cause));
    }
    for (const Rival& rival : selection_.rivals) SINEW_TRY(ReportRival(rival, n));
    ReportScores(n);
    return ReportRoundings();
  }

  // Certain without a test; a cause if it makes more of the residual than a test that knew where to look
  // would just detect.
  Status ReportRoundings() {
    SINEW_ASSIGN(const auto roundings, FindRoundings(problem_, selection_.model.point));
    for (const Rounding& rounding : roundings) {
      const double size = std::sqrt(rounding.statistic) / kDetectable;
      EffectScore score;
      score.effect = rounding.effect;
      score.statistic = rounding.statistic;
      score.p_value = size > 1 ? 0 : 1;
      score.family_p_value = score.p_value;
      out_.scores.insert(std::upper_bound(out_.scores.begin(), out_.scores.end(), score,
                                          [](const EffectScore& a, const EffectScore& b) {
                                            return a.statistic > b.statistic;
                                          }),
                         score);
      if (size <= 1) continue;
      Cause cause;
      cause.effect = rounding.effect;
      cause.sentence = rounding.channel + ": the sensor rounds its reading; no model can undo that";
      cause.p_value = 0;
      cause.delta_lr = rounding.statistic;
      cause.delta_bic = rounding.statistic - std::log(selection_.model.rows);
      cause.size = size;
      const double reach = rounding.uncertainty;
      cause.parameters = {{rounding.effect,
                           rounding.unit,
                           rounding.step,
                           reach / kNormal95,
                           {rounding.step - reach, rounding.step + reach},
                           0}};
      out_.causes.push_back(std::move(cause));
      if (!selection_.alarm) selection_.family_p_value = 0;
      selection_.alarm = true;
    }
    return {};
  }

  Status ReportRival(const Rival& rival, double n) {
    const Candidate& candidate = candidates_[static_cast<std::size_t>(rival.candidate)];
    const Candidate& cause = candidates_[static_cast<std::size_t>(rival.instead_of)];
    SINEW_ASSIGN(const Matrix covariance, CovarianceOf(rival.refit));
    Alternative other;
    other.instead_of = cause.effect;
    other.effect = candidate.effect;
    other.level = candidate.level;
    other.sentence = candidate.says;
    other.parameters = Describe(rival.refit, covariance, candidate.parameters);
    other.delta_lr = rival.delta_lr;
    other.delta_bic = rival.delta_lr + (static_cast<double>(candidate.parameters.size()) -
                                        static_cast<double>(cause.parameters.size())) *
                                           std::log(n);
    other.correlation = rival.correlation;
    other.same_class = std::abs(rival.correlation) > kSameClass;
    const double apart = 1 - std::abs(rival.correlation);
    other.separating_size =
        apart > 1e-6 ? std::sqrt(kSeparation / apart) : std::numeric_limits<double>::infinity();
    other.separated_by = candidate.exposed_by.empty() ? cause.exposed_by : candidate.exposed_by;
    out_.alternatives.push_back(std::move(other));
    return {};
  }

  void ReportScores(double n) {
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      const Candidate& candidate = candidates_[c];
      EffectScore score;
      score.effect = candidate.effect;
      score.level = candidate.level;
      score.known = candidate.known;
      const Score* best = base_.BestOf(static_cast<int>(c));
      if (best == nullptr) {
        score.judged = false;
        score.why_not =
            "these data do not show it, or the base parameters can imitate it fully: it changes no fitted "
            "channel";
      } else {
        FillScore(candidate, static_cast<int>(c), *best, score);
      }
      for (const Refit& refit : selection_.tried) {
        if (refit.released != std::vector<int>{static_cast<int>(c)}) continue;
        score.refitted = true;
        score.delta_lr = base_.refit.deviance - refit.deviance;
        score.delta_bic = score.delta_lr - static_cast<double>(candidate.parameters.size()) * std::log(n);
      }
      out_.scores.push_back(std::move(score));
    }
    std::stable_sort(out_.scores.begin(), out_.scores.end(),
                     [](const EffectScore& a, const EffectScore& b) { return a.statistic > b.statistic; });
  }

  void FillScore(const Candidate& candidate, int c, const Score& best, EffectScore& score) const {
    score.probe = candidate.probes[static_cast<std::size_t>(best.probe)].words;
    score.degrees = static_cast<int>(best.directions.size());
    score.statistic = best.statistic;
    score.p_value = best.p_value;
    if (const Score* plain = base_.BestOf(c, base_.plain)) score.unwhitened = plain->statistic;
    for (std::size_t i = 0; i < base_.whitened.scores.size(); ++i) {
      if (base_.whitened.scores[i].candidate == c)
        score.family_p_value = std::min(score.family_p_value, base_.family.score_p_value[i]);
    }
    if (!candidate.known) return;
    const int column = best.columns.front();
    const auto& parameter = out_.setup.parameters[static_cast<std::size_t>(
        base_.design.columns[static_cast<std::size_t>(column)].parameter)];
    score.detectable_parameter = parameter.name;
    score.detectable_unit = parameter.unit;
    score.smallest_detectable = (base_.family.threshold + kPower) / base_.whitened.length[column];
  }

  // Step 7.
  Status DiscoverUnknown() {
    Say("looking for a term that nobody thought of");
    std::optional<std::vector<Vector>> before;
    if (held_out_.exists()) {
      SINEW_ASSIGN(before, held_out_.Residuals(selection_.model.point));
    }
    SINEW_ASSIGN(const Standing standing,
                 StandAt(problem_, candidates_, selection_.model, options_.alarm_level, options_.seed));
    if (selection_.line_left && standing.line) DescribeLine(standing, before);
    for (std::size_t i = 0; i < std::min(selection_.unknown.size(), kMostUnknown); ++i) {
      const int c = selection_.unknown[i];
      if (candidates_[static_cast<std::size_t>(c)].drifting >= 0) {
        DiscoverDrift(c, selection_.unknown_p_value[i], standing.noise);
        continue;
      }
      std::vector<int> released = selection_.model.released;
      released.push_back(c);
      const Refit refit = Fit(released, StartsFor(standing, candidates_, c));
      if (!refit.usable()) continue;
      UnknownFinding finding = DescribeUnknown(c, refit);
      finding.p_value = selection_.unknown_p_value[i];
      if (before) {
        const auto after = held_out_.Residuals(refit.point);
        if (!after) continue;
        const double gain = Loss(*before, refit.noise) - Loss(*after, refit.noise);
        if (gain <= 0) continue;
        double sum_before = 0;
        double sum_after = 0;
        for (std::size_t b = 0; b < before->size(); ++b) {
          sum_before += (*before)[b].squaredNorm();
          sum_after += (*after)[b].squaredNorm();
        }
        finding.held_out_reduction = 1 - std::sqrt(sum_after / sum_before);
      }
      out_.unknown_terms.push_back(std::move(finding));
      if (out_.unknown_terms.size() == 1) unknown_point_ = refit.point;
    }
    return {};
  }

  void DescribeLine(const Standing& standing, const std::optional<std::vector<Vector>>& before) {
    constexpr int kPoints = 17;
    const SpectralLine& line = *standing.line;
    const LeastSquares fit(problem_, *standing.refit.setup);
    // The residual is predicted minus measured.
    const Vector amplitudes = -LineAmplitudes(fit, standing.design.residual, line);
    UnknownFinding finding;
    finding.port = line.channel;
    finding.signal = "time";
    finding.signal_unit = "s";
    finding.shape = fmt::format("periodic, {} Hz", Readable(line.frequency));
    finding.p_value = standing.AlarmPValue();
    double weight = 1;
    for (const Block& block : problem_.layout()) {
      if (block.channel != line.channel || block.role != BlockRole::kTrain) continue;
      finding.unit = block.unit;
      weight = block.weight;
    }
    for (int i = 0; i < kPoints; ++i) {
      const double turn = static_cast<double>(i) / (kPoints - 1);
      finding.knots.push_back(turn / line.frequency);
      finding.curve.push_back(
          (amplitudes[0] * std::cos(2 * M_PI * turn) + amplitudes[1] * std::sin(2 * M_PI * turn)) / weight);
      finding.deviation.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    if (before) {
      std::vector<Vector> after = *before;
      held_out_.Add(
          [&](const Block& block) {
            return block.channel == line.channel ? LineAt(block, line, amplitudes) : Vector();
          },
          after);
      double sum_before = 0;
      double sum_after = 0;
      for (std::size_t b = 0; b < after.size(); ++b) {
        sum_before += (*before)[b].squaredNorm();
        sum_after += after[b].squaredNorm();
      }
      finding.held_out_reduction = 1 - std::sqrt(sum_after / sum_before);
      if (sum_after < sum_before) unknown_residuals_ = std::move(after);
    }
    out_.unknown_terms.push_back(std::move(finding));
  }

  void DiscoverDrift(int c, double p_value, const NoiseModel& noise) {
    const Candidate& candidate = candidates_[static_cast<std::size_t>(c)];
    const auto drift = FitDrift(problem_, selection_.model, candidates_, c, noise);
    if (!drift) return;
    const Parameter& p = out_.setup.parameters[static_cast<std::size_t>(candidate.drifting)];
    UnknownFinding finding;
    finding.port = p.name;
    finding.signal = "time";
    finding.signal_unit = "s";
    finding.unit = p.unit;
    finding.changes_parameter = true;
    finding.shape = drift->change > 0 ? "grows within a trial" : "shrinks within a trial";
    finding.p_value = p_value;
    double longest = 0;
    for (const Block& block : problem_.layout())
      longest = std::max(longest, block.prediction_time.back() - block.prediction_time.front());
    const double value = selection_.model.point[candidate.drifting];
    finding.knots = {0, longest};
    finding.curve = {value - drift->change, value + drift->change};
    finding.deviation = {drift->std_error, drift->std_error};
    if (!drift->before.empty()) {
      if (Loss(drift->before, noise) <= Loss(drift->after, noise)) return;
      double before = 0;
      double after = 0;
      for (std::size_t b = 0; b < drift->before.size(); ++b) {
        before += drift->before[b].squaredNorm();
        after += drift->after[b].squaredNorm();
      }
      finding.held_out_reduction = 1 - std::sqrt(after / before);
    }
    if (out_.unknown_terms.empty()) unknown_residuals_ = drift->after;
    out_.unknown_terms.push_back(std::move(finding));
  }

  [[nodiscard]] UnknownFinding DescribeUnknown(int c, const Refit& refit) const {
    UnknownFinding finding;
    for (const Port& port : problem_.ports()) {
      for (const UnknownTerm& term : port.terms) {
        if (term.name != candidates_[static_cast<std::size_t>(c)].effect) continue;
        finding.port = port.name;
        finding.unit = port.unit;
        finding.signal = term.signal;
        finding.signal_unit = term.signal_unit;
        finding.knots = term.knots;
        const auto covariance = refitter_->Covariance(refit);
        const LeastSquares fit(problem_, *refit.setup);
        const Vector slopes = fit.Slopes(refit.x);
        std::vector<double> sure;
        for (const int index : term.parameters) {
          const auto at = std::lower_bound(refit.setup->free.begin(), refit.setup->free.end(), index);
          const auto v = static_cast<Eigen::Index>(at - refit.setup->free.begin());
          finding.curve.push_back(refit.point[index]);
          finding.deviation.push_back(covariance ? std::sqrt(std::max(0.0, (*covariance)(v, v))) *
                                                       std::abs(slopes[v])
                                                 : std::numeric_limits<double>::quiet_NaN());
          const double deviation = finding.deviation.back();
          sure.push_back(deviation > 0 ? 1 / (deviation * deviation) : 0);
        }
        const Shape shape = DescribeShape(finding.knots, finding.curve, sure, term.signal);
        finding.shape = shape.words;
        finding.nearest_law = shape.law;
      }
    }
    return finding;
  }

  Status MeasureGain() {
    SINEW_ASSIGN(const Vector before, FitHeldOutNuisance(problem_, out_.base_point));
    SINEW_ASSIGN(const Vector after, FitHeldOutNuisance(problem_, out_.extended_point));
    SINEW_ASSIGN(const FullPrediction base, PredictAll(problem_, before));
    SINEW_ASSIGN(const FullPrediction extended, PredictAll(problem_, after));
    out_.base_point = before;
    out_.extended_point = after;
    out_.base_fit = base.pooled;
    out_.extended_fit = extended.pooled;
    for (std::size_t b = 0; b < problem_.layout().size(); ++b) {
      const Block& block = problem_.layout()[b];
      if (block.role == BlockRole::kPredicted || block.samples() == 0) continue;
      TracePair trace{block.trial, block.role, block.channel, block.unit, {}, block.measured, {}, {}};
      for (const int at : block.sample) {
        trace.time.push_back(block.prediction_time[static_cast<std::size_t>(at)]);
        trace.before.push_back(base.values[b][at]);
        trace.after.push_back(extended.values[b][at]);
      }
      out_.traces.push_back(std::move(trace));
    }
    ReportNoise();
    if (!held_out_.exists()) return {};
    SINEW_ASSIGN(const auto residuals_before, held_out_.Residuals(before));
    const bool unknown_only = selection_.causes.empty() && unknown_point_.size() > 0;
    SINEW_ASSIGN(auto residuals_after, held_out_.Residuals(unknown_only ? unknown_point_ : after));
    if (!unknown_residuals_.empty()) residuals_after = unknown_residuals_;
    out_.gain = held_out_.Gains(residuals_before, residuals_after, selection_.model.noise, options_.seed);
    return {};
  }

  void ReportNoise() {
    for (const ChannelNoiseModel& model : selection_.model.noise.channels) {
      NoiseFloor floor;
      floor.channel = model.channel;
      double squares = 0;
      double count = 0;
      for (const TracePair& trace : out_.traces) {
        if (trace.channel != model.channel || trace.role != BlockRole::kTrain) continue;
        for (std::size_t i = 0; i < trace.time.size(); ++i)
          squares += std::pow(trace.before[i] - trace.measured[i], 2);
        count += static_cast<double>(trace.time.size());
      }
      for (const Block& block : problem_.layout()) {
        if (block.channel != model.channel || block.role != BlockRole::kTrain) continue;
        floor.unit = block.unit;
        floor.sigma = NoiseFloorOf(block, selection_.model.noise, problem_.layout()) / block.weight;
        floor.basis = block.sigma ? "stated by the data" : "what is left of the extended model";
        break;
      }
      floor.rmse = count > 0 ? std::sqrt(squares / count) : 0;
      out_.noise.push_back(std::move(floor));
    }
  }

  void Conclude() {
    if (!selection_.alarm) {
      out_.verdict = DiagnosisVerdict::kAdequate;
    } else if (out_.causes.empty() || selection_.structure_left) {
      out_.verdict = DiagnosisVerdict::kUnexplained;
    } else {
      out_.verdict = out_.alternatives.empty() ? DiagnosisVerdict::kExplained : DiagnosisVerdict::kAmbiguous;
    }
    if (!selection_.alarm && IsGross(base_.refit.noise)) {
      out_.warnings.push_back(
          "the residual wanders much farther than from one sample to the next: noise of instruments rarely "
          "does; "
          "if it is no noise, something is wrong that no effect of the library explains");
    }
    out_.family_p_value = selection_.family_p_value;
    if (selection_.gross) {
      out_.left_out = selection_.left_out;
      out_.warnings.push_back(
          "what is wrong dwarfs the noise, and the known effects do not explain all of it: causes were "
          "chosen "
          "by what they predict for " +
          Join(selection_.left_out, "; ") +
          ", each left out of the fit in turn, and intervals show what leaving out one trial does");
    }
    if (!held_out_.exists())
      out_.warnings.push_back(
          "there is no validation trial: no gain can be measured, and no cause withdrawn");
    out_.sentences = DescribeDiagnosis(out_, held_out_.exists());
  }

  const Problem& problem_;
  const DiagnosisOptions& options_;
  HeldOut held_out_;
  std::vector<Candidate> candidates_;
  std::unique_ptr<Refitter> refitter_;
  Standing base_;
  Selection selection_;
  Vector unknown_point_;
  std::vector<Vector> unknown_residuals_;  // of held-out trials, if the first unknown term is a drift
  Diagnosis out_;
};

}  // namespace

const char* ToString(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::kAdequate:
      return "adequate";
    case DiagnosisVerdict::kExplained:
      return "explained";
    case DiagnosisVerdict::kAmbiguous:
      return "ambiguous";
    case DiagnosisVerdict::kUnexplained:
      return "unexplained";
  }
  return "?";
}

Result<Diagnosis> Diagnose(const Problem& problem, FitSetup setup, const DiagnosisOptions& options) {
  return Examination(problem, options).Run(std::move(setup));
}

}  // namespace sinew
