// A problem that is linear in its parameters, with effects and a port, so that a diagnosis can be checked by
// hand.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/constants.h"
#include "base/random.h"
#include "identify/problem.h"

namespace sinew {

/// y = gain u + rate du/dt + effects, for an input u(t) of several sines that differs from trial to trial.
/// Effects: quadratic u|u| (>= 0), step sign(u), drift, offset, twin (1.001 times the step plus a little),
/// absent (changes nothing), stretch tanh(u / width) with probe values; per trial an offset. Port y with
/// y(u), y(time), whose values at the knots are parameters y(u)[0] ... The data can also contain errors that
/// none of these describes (Truth).
class LinearLaws final : public Problem {
 public:
  struct Truth {
    double gain = 2;
    double rate = 0.3;
    std::vector<std::pair<std::string, double>> effects;  ///< parameter name, value
    double unknown = 0;                                   ///< times cos(4 u): no effect of the library
    double noise = 0.1;
    double correlation = 0;    ///< AR(1)
    std::string only_trial;    ///< effects are there in this trial alone
    double gain_change = 0;    ///< times u and time, from -1 at the begin of a trial to 1 at its end
    double hum = 0;            ///< amplitude of a sine in time, in phase with the begin of every trial ...
    double hum_frequency = 5;  ///< [Hz]
    double slow_error = 0;  ///< amplitude of a slow sine whose phase and rate differ from trial to trial: no
                            ///< effect describes it
    /// The reading may be rounded (effect y.quantisation, known by name alone) to multiples of this; 0: it
    /// is not.
    std::optional<double> reading_step;
    bool starts = false;  ///< a nuisance value per trial that decays with exp(-time)
    /// Effect lopsided: u|u| for u > 0 and for u < 0 with a size of its own each; it contains quadratic.
    bool lopsided = false;
    bool scale = false;  ///< effect scale: adds a share of the whole law, which gain and rate can do too
    std::vector<std::pair<std::string, Level>> levels;  ///< of effects that are not of the robot
    double held_out_share = 1;                          ///< of the effects, in held-out trials
    int knots = 8;                                      ///< of y(u) and y(time)
    bool beside_causes = false;                         ///< both are DiscrepancyTerm::beside_causes
    bool free_offset = false;  ///< the offset of all trials is a base parameter, no effect
    /// Held-out trials: standard deviation of the gain of every 25 samples about the law; where it is > 0,
    /// their blocks have groups (Block::group).
    double cycle_scatter = 0;
  };

  LinearLaws(const Truth& truth, std::uint64_t seed, int train = 4, int validate = 2, int samples = 250)
      : seed_(seed) {
    AddParameters(train, samples, truth);
    if (truth.lopsided) {
      AddEffect("lopsided", -5, 5);
      Add("lopsided_left", -5, 5, 0, "lopsided");
      effects_.back().parameters.push_back(static_cast<int>(parameters_.size()) - 1);
    }
    if (truth.scale) AddEffect("scale", -5, 5);
    if (truth.starts) AddStarts(train + validate);
    if (truth.reading_step) AddEffect("y.quantisation", 0, 1);
    for (const auto& [name, level] : truth.levels) {
      for (Effect& effect : effects_) {
        if (effect.name == name) effect.level = level;
      }
    }
    Random random(seed);
    for (int t = 0; t < train + validate; ++t) AddTrial(truth, t, t < train, samples, random);
  }

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return ports_; }

  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const override {
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      if (!query.blocks[b]) continue;
      auto values = prediction.values(static_cast<int>(b));
      values.setZero();
      for (std::size_t c = 0; c < layout_[b].columns.size(); ++c) {
        const int index = layout_[b].columns[c];
        if (index == stretch_ + 1) {
          if (query.Differentiates(index)) {
            auto column = prediction.derivatives(static_cast<int>(b)).col(static_cast<Eigen::Index>(c));
            for (Eigen::Index i = 0; i < values.size(); ++i) {
              const double w = query.parameters[index];
              const double x = inputs_[b][static_cast<std::size_t>(i)] / w;
              column[i] = -query.parameters[stretch_] * x / w / (std::cosh(x) * std::cosh(x));
            }
          }
          continue;
        }
        if (query.parameters[index] == 0 && !query.Differentiates(index)) continue;
        const Vector column = index == stretch_ ? StretchColumn(b, query.parameters[stretch_ + 1])
                                                : Vector(columns_[b].col(index));
        if (query.parameters[index] != 0) values += query.parameters[index] * column;
        if (query.Differentiates(index))
          prediction.derivatives(static_cast<int>(b)).col(static_cast<Eigen::Index>(c)) = column;
      }
    }
    return {};
  }

  [[nodiscard]] int Index(const std::string& name) const {
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (parameters_[i].name == name) return static_cast<int>(i);
    }
    return -1;
  }

 private:
  [[nodiscard]] const std::string& Name(int index) const {
    return parameters_[static_cast<std::size_t>(index)].name;
  }

  Parameter& Add(const std::string& name, double lower, double upper, double start,
                 const std::string& effect) {
    Parameter p;
    p.name = name;
    p.unit = "1";
    p.meaning = name;
    p.lower = lower;
    p.upper = upper;
    p.start = start;
    p.effect = effect;
    p.kind = effect.empty() ? ParameterKind::kBase : ParameterKind::kEffect;
    parameters_.push_back(p);
    return parameters_.back();
  }
  void AddEffect(const std::string& name, double lower, double upper) {
    Add(name + "_size", lower, upper, 0, name);
    effects_.push_back({name,
                        Level::kRobot,
                        "there is a " + name,
                        "a trial that shows " + name,
                        {static_cast<int>(parameters_.size()) - 1}});
  }

  void AddParameters(int train, int samples, const Truth& truth) {
    Add("gain", -10, 10, 1, "");
    Add("rate", -10, 10, 0, "");
    AddEffect("quadratic", 0, 5);
    AddEffect("step", -5, 5);
    AddEffect("drift", -5, 5);
    if (truth.free_offset) {
      Add("offset_size", -5, 5, 0, "");
    } else {
      AddEffect("offset", -5, 5);
    }
    AddEffect("twin", -5, 5);
    AddEffect("absent", -5, 5);
    AddEffect("stretch", -5, 5);
    stretch_ = static_cast<int>(parameters_.size()) - 1;
    Add("width", 0.05, 1, 0.2, "stretch").null_value = 0.2;
    parameters_.back().probes = {0.1, 0.3};
    effects_.back().parameters.push_back(stretch_ + 1);
    for (int t = 0; t < train; ++t) {
      const std::string trial = TrialName(t);
      Add("offset@" + trial + "_size", -5, 5, 0, "offset@" + trial).trial = trial;
      effects_.push_back({"offset@" + trial,
                          Level::kSensor,
                          "an offset in " + trial,
                          "",
                          {static_cast<int>(parameters_.size()) - 1},
                          trial});
    }
    const double duration = samples * kStep;
    ports_.push_back({"y", "1", "something adds to y", {}});
    AddTerm("u", -2.5, 2.5, truth.knots);
    AddTerm("time", 0, duration, truth.knots);
    for (DiscrepancyTerm& term : ports_.back().terms) term.beside_causes = truth.beside_causes;
  }
  void AddStarts(int trials) {
    for (int t = 0; t < trials; ++t) {
      Parameter& p = Add("start@" + TrialName(t), -5, 5, 0, "");
      p.kind = ParameterKind::kNuisance;
      p.trial = TrialName(t);
    }
  }
  void AddTerm(const std::string& signal, double low, double high, int knots) {
    DiscrepancyTerm term{"y(" + signal + ")", signal, "1", {}, {}};
    for (int k = 0; k < knots; ++k) {
      term.knots.push_back(low + (high - low) * k / (knots - 1));
      Add(term.name + "[" + std::to_string(k) + "]", -20, 20, 0, term.name);
      term.parameters.push_back(static_cast<int>(parameters_.size()) - 1);
    }
    ports_.back().terms.push_back(term);
  }

  static std::string TrialName(int t) { return "trial_" + std::to_string(t + 1); }

  void AddTrial(const Truth& truth, int t, bool train, int samples, Random& random) {
    Block block;
    block.trial = TrialName(t);
    block.channel = "y";
    block.unit = "1";
    block.role = train ? BlockRole::kTrain : BlockRole::kValidate;
    const double phase = random.Uniform(0, 6.28);
    const double other = random.Uniform(0, 6.28);
    std::vector<double> u;
    std::vector<double> slope;
    for (int i = 0; i < samples; ++i) {
      const double time = kStep * i;
      block.prediction_time.push_back(time);
      block.sample.push_back(i);
      u.push_back(1.3 * std::sin(1.7 * time + phase) + 0.9 * std::sin(4.1 * time + other));
      slope.push_back(1.3 * 1.7 * std::cos(1.7 * time + phase) + 0.9 * 4.1 * std::cos(4.1 * time + other));
    }
    inputs_.push_back(u);
    slopes_.push_back(slope);
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (parameters_[i].trial.empty() || parameters_[i].trial == block.trial)
        block.columns.push_back(static_cast<int>(i));
    }
    layout_.push_back(block);
    const std::size_t b = layout_.size() - 1;
    Vector p(static_cast<Eigen::Index>(parameters_.size()));
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      p[static_cast<Eigen::Index>(i)] = parameters_[i].rest_value();
    p[0] = truth.gain;
    p[1] = truth.rate;
    if (truth.only_trial.empty() || truth.only_trial == block.trial) {
      for (const auto& [name, value] : truth.effects)
        p[Index(name)] = train ? value : value * truth.held_out_share;
    }
    columns_.emplace_back(Matrix::Zero(samples, static_cast<Eigen::Index>(parameters_.size())));
    for (const int index : layout_[b].columns) {
      for (int i = 0; i < samples; ++i)
        columns_[b](i, index) = index == stretch_ + 1 ? 0 : Column(b, index, static_cast<std::size_t>(i), p);
    }
    double colour = random.Normal();
    for (int i = 0; i < samples; ++i) {
      double y = truth.unknown * std::cos(4 * u[static_cast<std::size_t>(i)]);
      for (const int index : layout_[b].columns) {
        if (Name(index) != "width") y += p[index] * Column(b, index, static_cast<std::size_t>(i), p);
      }
      layout_[b].measured.push_back(y + truth.noise * colour);
      colour =
          truth.correlation * colour + std::sqrt(1 - truth.correlation * truth.correlation) * random.Normal();
    }
    AddWhatNoEffectIs(truth, t, b);
  }

  // Random numbers of its own, so that a seed means the same trials with and without.
  void AddWhatNoEffectIs(const Truth& truth, int t, std::size_t b) {
    Random random(Random::StreamSeed(seed_, static_cast<std::uint64_t>(t)));
    const double phase = random.Uniform(0, 6.28);
    const double rate = random.Uniform(0.4, 0.8);
    const double end = layout_[b].prediction_time.back();
    const bool scatters = truth.cycle_scatter > 0 && layout_[b].role == BlockRole::kValidate;
    double gain = 0;
    for (std::size_t i = 0; i < layout_[b].measured.size(); ++i) {
      const double time = layout_[b].prediction_time[i];
      double& y = layout_[b].measured[i];
      if (scatters) {
        if (i % 25 == 0) gain = truth.cycle_scatter * random.Normal();
        layout_[b].group.push_back(static_cast<int>(i) / 25);
        y += gain * inputs_[b][i];
      }
      y += truth.gain_change * (2 * time / end - 1) * inputs_[b][i];
      y += truth.hum * std::sin(2 * kPi * truth.hum_frequency * time + 1);
      y += truth.slow_error * std::sin(rate * time + phase);
      if (truth.starts) y += (t % 2 == 0 ? 1 : -0.5) * std::exp(-time);
      if (truth.reading_step && *truth.reading_step > 0)
        y = *truth.reading_step * std::round(y / *truth.reading_step);
    }
  }

  // Derivative of y for a parameter in which it is linear.
  [[nodiscard]] double Column(std::size_t b, int index, std::size_t i, const Vector& p) const {
    const double u = inputs_[b][i];
    const double time = layout_[b].prediction_time[i];
    const std::string& name = Name(index);
    if (name == "gain") return u;
    if (name == "rate") return slopes_[b][i];
    if (name == "quadratic_size") return u * std::abs(u);
    if (name == "lopsided_size") return u > 0 ? u * u : 0;
    if (name == "lopsided_left") return u > 0 ? 0 : -u * u;
    if (name == "step_size") return u > 0 ? 1 : -1;
    if (name == "drift_size") return time - 5;
    if (name == "scale_size") return p[0] * u + p[1] * slopes_[b][i];
    if (name.rfind("start@", 0) == 0) return std::exp(-time);
    if (name == "y.quantisation_size") return 0;
    if (name == "offset_size" || !parameters_[static_cast<std::size_t>(index)].trial.empty()) return 1;
    if (name == "twin_size") return (u > 0 ? 1 : -1) + 0.05 * std::sin(3 * time);
    if (name == "absent_size") return 0;
    if (name == "stretch_size") return std::tanh(u / p[stretch_ + 1]);
    for (const DiscrepancyTerm& term : ports_.front().terms) {
      for (std::size_t k = 0; k < term.parameters.size(); ++k) {
        if (term.parameters[k] != index) continue;
        const LinearBasis basis = LinearBasisAt(term.knots, term.signal == "u" ? u : time);
        if (basis.first == static_cast<int>(k)) return basis.left;
        return basis.first + 1 == static_cast<int>(k) ? basis.right : 0;
      }
    }
    return 0;
  }

  [[nodiscard]] Vector StretchColumn(std::size_t b, double width) const {
    return (Eigen::Map<const Vector>(inputs_[b].data(), static_cast<Eigen::Index>(inputs_[b].size())) / width)
        .array()
        .tanh();
  }

  static constexpr double kStep = 0.04;
  std::uint64_t seed_;
  std::vector<Parameter> parameters_;
  std::vector<Effect> effects_;
  std::vector<DiscrepancyPort> ports_;
  Layout layout_;
  std::vector<std::vector<double>> inputs_;
  std::vector<std::vector<double>> slopes_;
  std::vector<Matrix> columns_;  // per block [samples x P]
  int stretch_ = 0;
};

}  // namespace sinew
