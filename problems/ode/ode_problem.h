// A model of one's own made of ordinary differential equations: states, a right-hand side that is templated
// on the scalar, inputs and outputs that are channels of a data set.
//
//   dx/dt = f(p, t, x, inputs(t)),    channel(t) = g(p, t, x)
//
//   class Tank final : public OdeProblem<Tank, 1> {
//    public:
//     explicit Tank(const Dataset& data) : OdeProblem(data) { ... parameter(...), input(...), observe(...) }
//     template <class T>
//     void derivative(const Values<T>& p, double t, const State<T>& x, State<T>& dx) const { ... }
//   };
//
// Sensitivities are exact (dual numbers). docs/own_model.md shows how to write one.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/dual_math.h"
#include "base/text.h"
#include "problems/declaration/declared_problem.h"
#include "problems/ode/ode_integrator.h"

namespace sinew {

/// @tparam Derived has `template <class T> void derivative(const Values<T>& p, double t, const State<T>& x,
/// State<T>& dx) const`, t in s of the trial's own clock. @tparam N number of states
///
/// A trial is integrated from its first to its last observed sample. Initial states are values of each trial
/// (`initial_CHANNEL@TRIAL`): for a state that is observed directly they are declared of themselves, with the
/// first measured value as start and a quarter of the channel's span on both sides as bounds; for all others
/// say initial(i, ...). Inputs run straight between their samples, and steps of the integrator end there.
///
/// Accuracy: the estimated error of a step is at most 1e-9 of the magnitude of each state (set_accuracy);
/// what that adds up to over a trial depends on the equations. The answer is deterministic to the last bit.
/// A time offset of an observed channel looks beyond its samples along a straight line.
template <class Derived, int N>
class OdeProblem : public DeclaredProblem {
 public:
  template <class T>
  using State = std::array<T, static_cast<std::size_t>(N)>;

  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const final {
    std::vector<OdeStep> steps;  // of the trial that is predicted
    return PredictTrials(query, prediction, [&](std::size_t trial, const auto& values, const auto& set) {
      return Run(trial, query.blocks, values, steps, set);
    });
  }

  [[nodiscard]] Status CheckDeclaration() const override {
    SINEW_TRY(DeclaredProblem::CheckDeclaration());
    for (int i = 0; i < N; ++i) {
      if (start_[Index(i)].slot < 0 && !start_[Index(i)].known)
        return Fail("state {} has no initial value: expected initial({}, name, unit), or observe it", i, i);
    }
    for (std::size_t t = 0; t < trials().size(); ++t) SINEW_TRY(CheckInputs(t));
    return {};
  }

  /// Steps of the integrator may change by a bit of the parameters, predictions then by a bit of the
  /// accuracy.
  [[nodiscard]] double cost_noise_level() const override { return accuracy_.relative; }

 protected:
  /// A state, to be observed as it is.
  struct StateReference {
    int index = 0;
  };

  explicit OdeProblem(const Dataset& data) : DeclaredProblem(data) {}

  [[nodiscard]] static StateReference state(int index) { return {index}; }

  /// A channel that measures a state. @param unit checked against the data's, if not empty
  void observe(const std::string& channel, StateReference of, const std::string& unit = "") {
    if (of.index < 0 || of.index >= N) {
      Complain(fmt::format("channel '{}' observes state {}, expected 0 .. {}", channel, of.index, N - 1));
      return;
    }
    const int observation = AddChannel(channel, unit);
    const auto i = Index(of.index);
    outputs_.push_back({[i](const auto&, double, const auto& x) { return x[i]; },
                        [i](const auto&, double, const auto& x) { return x[i]; }});
    Plan();
    StartFrom(of.index, channel, observation);
  }

  /// A channel that measures a function of the states: [this](const auto& p, double t, const auto& x) { ...
  /// }.
  template <class Function>
  void observe(const std::string& channel, Function function, const std::string& unit = "") {
    AddChannel(channel, unit);
    outputs_.push_back({function, function});
    Plan();
  }

  /// The initial value of a state as a value of each trial, `initial_NAME@TRIAL`; of one that is observed it
  /// can be declared anew, for other bounds.
  ParameterBuilder initial(int state, const std::string& name, const std::string& unit) {
    Start& start = start_[Index(state)];
    if (start.slot < 0) {
      ParameterBuilder made = per_trial("initial_" + name, unit);
      start.slot = ParameterHandle(made).slot;
    }
    return {*this, start.slot};
  }

  /// Every trial begins with this value of the state.
  void initial(int state, double value) {
    start_[Index(state)].known = true;
    start_[Index(state)].value = value;
  }

  /// @param relative largest estimated error of a step, of the magnitude of each state, in 1e-14 .. 1e-2
  void set_accuracy(double relative) {
    if (!(relative >= 1e-14 && relative <= 1e-2))
      Complain(fmt::format("accuracy {} of the integration: expected 1e-14 .. 1e-2", relative));
    accuracy_.relative = relative;
  }

 private:
  struct Output {
    std::function<double(const Values<double>&, double, const State<double>&)> plain;
    std::function<Lanes(const Values<Lanes>&, double, const State<Lanes>&)> dual;

    [[nodiscard]] double At(const Values<double>& p, double t, const State<double>& x) const {
      return plain(p, t, x);
    }
    [[nodiscard]] Lanes At(const Values<Lanes>& p, double t, const State<Lanes>& x) const {
      return dual(p, t, x);
    }
  };
  struct Start {
    int slot = -1;
    bool known = false;
    double value = 0;
  };
  struct Sample {
    int block = 0;
    Eigen::Index row = 0;
  };
  /// A part of a trial that is integrated in one go, from a state of its own.
  struct Window {
    double begin = 0;
    std::vector<double> stops;                 ///< where something is predicted, and kinks of inputs
    std::vector<std::vector<Sample>> samples;  ///< [stops] what is predicted there
  };

  static constexpr std::size_t Index(int state) { return static_cast<std::size_t>(state); }

  void Plan() {
    windows_.assign(trials().size(), Window());
    for (std::size_t t = 0; t < trials().size(); ++t) {
      Window& window = windows_[t];
      std::vector<std::pair<double, Sample>> samples;
      for (const int b : trials()[t].blocks) {
        const auto& time = layout()[static_cast<std::size_t>(b)].prediction_time;
        for (std::size_t i = 0; i < time.size(); ++i)
          samples.push_back({time[i], {b, static_cast<Eigen::Index>(i)}});
      }
      if (samples.empty()) continue;
      for (const SampledInput& in : trials()[t].inputs) {
        for (const double kink : in.time) samples.push_back({kink, {-1, 0}});
      }
      std::stable_sort(samples.begin(), samples.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      const auto predicted = [](const auto& sample) { return sample.second.block >= 0; };
      const auto first = std::find_if(samples.begin(), samples.end(), predicted);
      const auto last = std::find_if(samples.rbegin(), samples.rend(), predicted).base();
      window.begin = first->first;
      for (auto at = first; at != last; ++at) {
        if (window.stops.empty() || at->first > window.stops.back()) {
          window.stops.push_back(at->first);
          window.samples.emplace_back();
        }
        if (at->second.block >= 0) window.samples.back().push_back(at->second);
      }
    }
  }

  /// The initial value of a state that is measured.
  void StartFrom(int index, const std::string& channel, int observation) {
    Start& start = start_[Index(index)];
    double least = INFINITY;
    double most = -INFINITY;
    double begin = 0;  // of the first trial that measures it, for those that do not
    std::vector<double> first(trials().size(), NAN);
    std::string unit;
    for (std::size_t t = 0; t < trials().size(); ++t) {
      for (const int b : trials()[t].blocks) {
        if (ObservationOf(b) != observation) continue;
        const Block& block = layout()[static_cast<std::size_t>(b)];
        first[t] = block.measured.front();
        unit = block.unit;
        if (!(least <= most)) begin = first[t];
        for (const double value : block.measured) {
          least = std::min(least, value);
          most = std::max(most, value);
        }
      }
    }
    if (!(least <= most)) return;  // no trial measures it: AddChannel reported it
    accuracy_.typical[Index(index)] = std::max(std::abs(least), std::abs(most));
    if (start.known || start.slot >= 0) return;
    double reach = 0.25 * (most - least);
    if (reach == 0) reach = most != 0 ? 0.25 * std::abs(most) : 1;
    initial(index, channel, unit).start(0).bounds(0, 1).meaning(channel + " when the trial begins");
    for (std::size_t t = 0; t < trials().size(); ++t) {
      Parameter& p = ParameterOf(start.slot, t);
      p.start = std::isnan(first[t]) ? begin : first[t];
      p.lower = p.start - reach;
      p.upper = p.start + reach;
    }
  }

  /// An input that ends before what is predicted would go on as a constant; one sample is let pass.
  [[nodiscard]] Status CheckInputs(std::size_t t) const {
    const Window& window = windows_[t];
    if (window.stops.empty()) return {};
    for (const SampledInput& in : trials()[t].inputs) {
      const double sample = (in.time.back() - in.time.front()) / static_cast<double>(in.time.size());
      if (in.time.front() > window.begin + sample || in.time.back() < window.stops.back() - sample) {
        return Fail("trial '{}': an input is known from t = {:.6g} to {:.6g} s, expected {:.6g} to {:.6g} s",
                    trials()[t].name, in.time.front(), in.time.back(), window.begin, window.stops.back());
      }
    }
    return {};
  }

  template <class T, class Set>
  Status Run(std::size_t t, const std::vector<bool>& wanted, const Values<T>& values,
             std::vector<OdeStep>& steps, const Set& set) const {
    const Window& window = windows_[t];
    State<T> state;
    for (std::size_t i = 0; i < state.size(); ++i) {
      state[i] = start_[i].known ? T(start_[i].value) : values[ParameterHandle{start_[i].slot}];
    }
    const auto rate = [&](double time, const State<T>& x, State<T>& dx) {
      dx.fill(T(std::numeric_limits<double>::quiet_NaN()));  // what is not set is found
      static_cast<const Derived&>(*this).derivative(values, time, x, dx);
    };
    const auto sink = [&](int stop, const State<T>& x) {
      for (const Sample& sample : window.samples[static_cast<std::size_t>(stop)]) {
        if (!wanted[static_cast<std::size_t>(sample.block)]) continue;
        const Output& output = outputs_[static_cast<std::size_t>(ObservationOf(sample.block))];
        set(sample.block, sample.row, output.At(values, window.stops[static_cast<std::size_t>(stop)], x));
      }
    };
    if constexpr (std::is_same_v<T, double>) {
      return IntegrateOde(rate, window.begin, window.stops, state, accuracy_, steps, sink);
    } else {
      RepeatOde(rate, window.begin, window.stops, state, steps, sink);
      return {};
    }
  }

  std::array<Start, static_cast<std::size_t>(N)> start_{};
  OdeAccuracy<static_cast<std::size_t>(N)> accuracy_;
  std::vector<Output> outputs_;  // [observations]
  std::vector<Window> windows_;  // [trials]
};

}  // namespace sinew
