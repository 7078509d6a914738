#include "identify/diagnosis/discover/discovery.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/constants.h"
#include "identify/diagnosis/discover/linear_term.h"
#include "identify/diagnosis/discover/shape.h"
#include "identify/diagnosis/tabulation.h"

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kMaxUnknown = 3;
constexpr double kLarge = 2000;  // statistic above which a linear estimate is only a start value

double Squares(const std::vector<Vector>& residuals) {
  double sum = 0;
  for (const Vector& block : residuals) sum += block.squaredNorm();
  return sum;
}

double Reduction(const std::vector<Vector>& before, const std::vector<Vector>& after) {
  return 1 - std::sqrt(Squares(after) / Squares(before));
}

class DiscoveryStep {
 public:
  DiscoveryStep(DiagnosisState& state, Diagnosis& diagnosis) : state_(state), out_(diagnosis) {}

  Status Run() {
    const Selection& selection = state_.selection;
    if (state_.held_out.exists()) {
      SINEW_ASSIGN(before_, state_.held_out.Residuals(selection.model.point));
    }
    SINEW_ASSIGN(const ScoredModel scored, ScoreModel(state_.problem, state_.candidates, selection.model,
                                                      state_.options.alarm_level, state_.options.seed));
    for (const int c : selection.terms) Describe(c);
    if (selection.line_left && scored.line) AddLine(scored);
    for (std::size_t i = 0; i < std::min(selection.unknown.size(), kMaxUnknown); ++i) {
      const int c = selection.unknown[i];
      if (state_.candidate(c).drifting >= 0) {
        AddDrift(c, selection.unknown_p_value[i], scored.noise);
      } else {
        AddCurve(c, selection.unknown_p_value[i], scored);
      }
    }
    return {};
  }

 private:
  // Adds a curve, to first order unless it is so large that the linearisation is not valid.
  void AddCurve(int c, double p_value, const ScoredModel& scored) {
    UnknownFinding finding = NameCurve(c);
    finding.p_value = p_value;
    const Score* score = scored.BestOf(c);
    const bool large = score == nullptr || score->statistic > kLarge;
    const bool added = large ? RefitCurve(c, scored, finding) : AddToFirstOrder(c, scored.noise, finding);
    if (!added) return;
    finding.shape = FindShape(finding.knots, finding.curve, Weights(finding.deviation));
    out_.unknown_terms.push_back(std::move(finding));
  }

  // A curve that the selected model contains. Its errors are those of the jackknife over what was left out.
  void Describe(int c) {
    const Refit& model = state_.selection.model;
    UnknownFinding finding = NameCurve(c);
    finding.p_value = kNaN;
    Matrix covariance = CurveCovariance(c, model, finding);
    if (auto jackknife = state_.CovarianceOf(model)) covariance = std::move(*jackknife);
    FillCurve(ValuesOf(state_, model, covariance, state_.candidate(c).parameters), finding);
    if (before_) finding.held_out_reduction = ReductionBy(c);
    finding.shape = FindShape(finding.knots, finding.curve, Weights(finding.deviation));
    out_.unknown_terms.push_back(std::move(finding));
  }

  static void FillCurve(const std::vector<DiagnosedParameter>& values, UnknownFinding& finding) {
    for (const DiagnosedParameter& value : values) {
      finding.curve.push_back(value.value);
      finding.deviation.push_back(std::isfinite(value.std_error) ? value.std_error : kNaN);
    }
  }

  static std::vector<double> Weights(const std::vector<double>& deviations) {
    std::vector<double> sure;
    for (const double deviation : deviations) sure.push_back(deviation > 0 ? 1 / (deviation * deviation) : 0);
    return sure;
  }

  // Of the error of held-out trials, by a term of the selected model; 0 if the model without it fails.
  [[nodiscard]] double ReductionBy(int c) const {
    const Refit& model = state_.selection.model;
    std::vector<int> rest;
    for (const int other : model.released) {
      if (other != c) rest.push_back(other);
    }
    Vector start = model.point;
    for (const int index : state_.candidate(c).parameters) start[index] = state_.base.refit.point[index];
    const Refit without = state_.Fit(rest, {start});
    if (!without.usable()) return 0;
    const auto before = state_.held_out.Residuals(without.point);
    return before ? Reduction(*before, *before_) : 0;
  }

  [[nodiscard]] UnknownFinding NameCurve(int c) const {
    UnknownFinding finding;
    finding.name = state_.candidate(c).effect;
    for (const DiscrepancyPort& port : state_.problem.ports()) {
      for (const DiscrepancyTerm& term : port.terms) {
        if (term.name != finding.name) continue;
        finding.port = port.name;
        finding.unit = port.unit;
        finding.signal = term.signal;
        finding.signal_unit = term.signal_unit;
        finding.knots = term.knots;
      }
    }
    return finding;
  }

  // Returns false if the refit failed or held-out trials reject it.
  bool RefitCurve(int c, const ScoredModel& scored, UnknownFinding& finding) {
    std::vector<int> released = state_.selection.model.released;
    released.push_back(c);
    const Refit refit = state_.Fit(released, RefitStarts(scored, state_.candidates, c));
    if (!refit.usable()) return false;
    const Matrix covariance = CurveCovariance(c, refit, finding);
    FillCurve(ValuesOf(state_, refit, covariance, state_.candidate(c).parameters), finding);
    if (before_) {
      const auto after = state_.held_out.Residuals(refit.point);
      if (!after || state_.Loss(*before_, refit.noise) <= state_.Loss(*after, refit.noise)) return false;
      finding.held_out_reduction = Reduction(*before_, *after);
    }
    if (!std::exchange(extended_, true)) out_.extended_point = refit.point;
    return true;
  }

  // A curve of a signal often contains what a base parameter does (the straight line of a stiffness): then
  // only both together are determined, and the curve's errors are those for the fitted value of that
  // parameter.
  [[nodiscard]] Matrix CurveCovariance(int c, const Refit& refit, UnknownFinding& finding) const {
    const Matrix none = Matrix::Zero(refit.x.size(), refit.x.size());
    const auto covariance = state_.refitter->Covariance(refit);
    if (!covariance) return none;
    const std::vector<int>& weights = state_.candidate(c).parameters;
    const auto is_weight = [&](int parameter) {
      return std::find(weights.begin(), weights.end(), parameter) != weights.end();
    };
    bool lost = false;
    std::vector<int> others;
    for (std::size_t v = 0; v < refit.setup->free.size(); ++v) {
      const auto at = static_cast<Eigen::Index>(v);
      const int parameter = refit.setup->free[v];
      if (std::isfinite((*covariance)(at, at))) continue;
      lost = lost || is_weight(parameter);
      if (!is_weight(parameter)) others.push_back(parameter);
    }
    if (!lost || others.empty()) return *covariance;
    for (const int parameter : others)
      finding.inseparable_from.push_back(refit.setup->parameters[static_cast<std::size_t>(parameter)].name);
    const auto given = state_.refitter->Covariance(refit, others);
    return given ? *given : none;
  }

  bool AddToFirstOrder(int c, const noise::NoiseModel& noise, UnknownFinding& finding) {
    const auto term =
        FitLinearTerm(state_.problem, state_.selection.model, state_.candidate(c), noise, state_.held_out);
    if (!term) return false;
    const bool whole =
        finding.knots.empty() || finding.knots.size() == static_cast<std::size_t>(term->values.size());
    if (!whole) return false;
    finding.curve.assign(term->values.begin(), term->values.end());
    finding.deviation.assign(term->deviations.begin(), term->deviations.end());
    if (!term->before.empty()) {
      if (state_.Loss(term->before, noise) <= state_.Loss(term->after, noise)) return false;
      finding.held_out_reduction = Reduction(term->before, term->after);
    }
    if (!std::exchange(extended_, true)) {
      const LeastSquares fit(state_.problem, *state_.selection.model.setup);
      for (std::size_t t = 0; t < fit.train_blocks().size(); ++t)
        state_.added[fit.train_blocks()[t].block] = term->train[t];
      AddHeldOut(term->after, state_.added);
    }
    return true;
  }

  void AddLine(const ScoredModel& scored) {
    constexpr int kPoints = 17;
    const noise::SpectralLine& line = *scored.line;
    const LeastSquares fit(state_.problem, *scored.refit.setup);
    // The sign is negative because the residual is predicted minus measured.
    const Vector amplitudes = -noise::LineAmplitudes(fit, scored.design.residual, line);
    UnknownFinding finding;
    finding.kind = UnknownKind::kPeriodic;
    finding.port = line.channel;
    finding.name = line.channel + "(period)";
    finding.signal = "time";
    finding.signal_unit = "s";
    finding.frequency = line.frequency;
    finding.p_value = scored.AlarmPValue();
    std::map<int, Vector> added;
    double weight = 1;
    for (const auto& train : fit.train_blocks()) {
      const Block& block = state_.problem.layout()[static_cast<std::size_t>(train.block)];
      if (block.channel != line.channel) continue;
      finding.unit = block.unit;
      weight = block.weight;
      added[train.block] = scored.design.residual.segment(train.first_row, block.samples()) +
                           noise::LineAt(block, line, amplitudes);
    }
    for (int i = 0; i < kPoints; ++i) {
      const double turn = static_cast<double>(i) / (kPoints - 1);
      finding.knots.push_back(turn / line.frequency);
      finding.curve.push_back(
          (amplitudes[0] * std::cos(2 * kPi * turn) + amplitudes[1] * std::sin(2 * kPi * turn)) / weight);
      finding.deviation.push_back(kNaN);
    }
    if (before_) {
      std::vector<Vector> after = *before_;
      state_.held_out.Add(
          [&](const Block& block) {
            return block.channel == line.channel ? noise::LineAt(block, line, amplitudes) : Vector();
          },
          after);
      finding.held_out_reduction = Reduction(*before_, after);
      AddHeldOut(after, added);
    }
    EffectScore score;
    score.effect = finding.name;
    score.known = false;
    score.degrees = 2;
    score.statistic = line.statistic;
    score.p_value = line.p_value;
    score.family_p_value = finding.p_value;
    Insert(std::move(score), out_.scores);
    if (finding.held_out_reduction >= 0) {
      state_.added = std::move(added);
      extended_ = true;
    }
    out_.unknown_terms.push_back(std::move(finding));
  }

  void AddDrift(int c, double p_value, const noise::NoiseModel& noise) {
    const Candidate& candidate = state_.candidate(c);
    const Refit& model = state_.selection.model;
    const Parameter& p = model.setup->parameters[static_cast<std::size_t>(candidate.drifting)];
    UnknownFinding finding;
    finding.kind = UnknownKind::kDrift;
    finding.port = p.name;
    finding.name = candidate.effect;
    finding.signal = "time";
    finding.signal_unit = "s";
    finding.unit = p.unit;
    finding.p_value = p_value;
    if (!AddToFirstOrder(c, noise, finding)) return;
    const double change = finding.curve.front();
    const double deviation = finding.deviation.front();
    double longest = 0;
    for (const Block& block : state_.problem.layout())
      longest = std::max(longest, block.prediction_time.back() - block.prediction_time.front());
    const double value = model.point[candidate.drifting];
    finding.knots = {0, longest};
    finding.curve = {value - change, value + change};
    finding.deviation = {deviation, deviation};
    out_.unknown_terms.push_back(std::move(finding));
  }

  void AddHeldOut(const std::vector<Vector>& residuals, std::map<int, Vector>& added) const {
    for (std::size_t i = 0; i < residuals.size(); ++i) added[state_.held_out.blocks()[i]] = residuals[i];
  }

  DiagnosisState& state_;
  Diagnosis& out_;
  std::optional<std::vector<Vector>> before_;  // held-out residuals of the selected model
  bool extended_ = false;                      // the extended model contains one already
};

}  // namespace

Status DiscoverUnknown(DiagnosisState& state, Diagnosis& diagnosis) {
  return DiscoveryStep(state, diagnosis).Run();
}

}  // namespace sinew::diagnosis
