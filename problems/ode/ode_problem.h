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
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/dual_math.h"
#include "base/text.h"
#include "identify/shooting/trajectory_plan.h"
#include "problems/declaration/declared_problem.h"
#include "problems/ode/ode_integrator.h"
#include "problems/ode/ode_windows.h"

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
    std::vector<std::vector<OdeStep>> steps;  // of the trajectories of the trial that is predicted
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

  /// Finds out whether small differences grow over a trial (shooting::MakePlan). If so: starts by multiple
  /// shooting, trials cut into trajectories that can be predicted, and finer steps. BindModel calls it.
  Status Prepare() final;

  [[nodiscard]] std::optional<Vector> ImprovedStart(const std::vector<int>& free,
                                                    const std::vector<bool>& compared,
                                                    const Vector& parameters) const final;

  [[nodiscard]] std::vector<Warning> WarningsAt(const Vector& parameters) const override;

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

  /// @param steps >= 1, of the integrator in one simulation: one that needs more has failed
  void set_most_steps(long steps) {
    if (steps < 1) Complain(fmt::format("{} steps of the integration: expected at least 1", steps));
    accuracy_.most_steps = static_cast<std::size_t>(std::max(steps, 1L));
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
    int observation = -1;  ///< that measures the state itself
  };
  struct Sample {
    int block = 0;
    Eigen::Index row = 0;
  };
  /// What is integrated in one go, from a state of its own.
  struct Trajectory {
    std::size_t first = 0;                                ///< stop where it begins
    std::size_t end = 0;                                  ///< stop after its last
    std::array<int, static_cast<std::size_t>(N)> slot{};  ///< of its initial state; -1: known, in start_
  };
  /// A trial from its first to its last prediction.
  struct Stretch {
    std::vector<double> stops;                 ///< where something is predicted, and kinks of inputs
    std::vector<std::vector<Sample>> samples;  ///< [stops] what is predicted there
    std::vector<Trajectory> trajectories;      ///< one, unless small differences grow too much
  };
  template <class, int>
  friend class OdeWindows;
  using Windows = OdeWindows<OdeProblem, N>;
  using LaneNumber = Lanes;
  static constexpr std::size_t kLaneCount = DeclaredProblem::kLanes;
  /// Of one trajectory: times kFine, what the integrator's errors become.
  static constexpr double kMaxGrowth = 1e6;
  static constexpr double kFine = 1e-11;  // accuracy where small differences grow

  static constexpr std::size_t Index(int state) { return static_cast<std::size_t>(state); }

  void Plan() {
    stretches_.assign(trials().size(), Stretch());
    for (std::size_t t = 0; t < trials().size(); ++t) {
      Stretch& stretch = stretches_[t];
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
      for (auto at = first; at != last; ++at) {
        if (stretch.stops.empty() || at->first > stretch.stops.back()) {
          stretch.stops.push_back(at->first);
          stretch.samples.emplace_back();
        }
        if (at->second.block >= 0) stretch.samples.back().push_back(at->second);
      }
    }
  }

  [[nodiscard]] bool IsState(int index) const {
    return std::binary_search(state_parameters_.begin(), state_parameters_.end(), index);
  }

  [[nodiscard]] std::string NameOf(int slot) const {
    const std::string& name =
        parameters()[static_cast<std::size_t>(trials().front().parameter_of[static_cast<std::size_t>(slot)])]
            .name;
    return name.substr(0, name.find('@') + 1);
  }

  /// The value of a state at a stop, on a straight line through the samples about it; NaN if the trial does
  /// not measure it. At the begin the start of its initial value.
  [[nodiscard]] double MeasuredState(std::size_t trial, std::size_t stop, int state) const;

  /// Standard deviations of the states: as measured, else along the states that follow the model.
  [[nodiscard]] Vector TypicalStates(const std::vector<bool>& compared, const Vector& rest) const;

  void TakeOver(const shooting::Plan& plan, const std::vector<int>& free);

  /// The initial value of a state that is measured.
  void StartFrom(int index, const std::string& channel, int observation) {
    Start& start = start_[Index(index)];
    start.observation = observation;
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
    const Stretch& stretch = stretches_[t];
    if (stretch.stops.empty()) return {};
    for (const SampledInput& in : trials()[t].inputs) {
      const double sample = (in.time.back() - in.time.front()) / static_cast<double>(in.time.size());
      if (in.time.front() > stretch.stops.front() + sample ||
          in.time.back() < stretch.stops.back() - sample) {
        return Fail("trial '{}': an input is known from t = {:.6g} to {:.6g} s, expected {:.6g} to {:.6g} s",
                    trials()[t].name, in.time.front(), in.time.back(), stretch.stops.front(),
                    stretch.stops.back());
      }
    }
    return {};
  }

  template <class T>
  [[nodiscard]] auto RateOf(const Values<T>& values) const {
    return [this, &values](double time, const State<T>& x, State<T>& dx) {
      dx.fill(T(std::numeric_limits<double>::quiet_NaN()));  // what is not set is found
      static_cast<const Derived&>(*this).derivative(values, time, x, dx);
    };
  }

  template <class T>
  [[nodiscard]] T OutputAt(int block, const Values<T>& values, double t, const State<T>& x) const {
    return outputs_[static_cast<std::size_t>(ObservationOf(block))].At(values, t, x);
  }

  /// True if a derivative is wanted that a trajectory has: one of its own state, or of what all have.
  [[nodiscard]] bool Moves(std::size_t t, const Trajectory& trajectory, const Values<Lanes>& values) const {
    for (std::size_t s = 0; s < trials()[t].parameter_of.size(); ++s) {
      const int slot = static_cast<int>(s);
      const Lanes& value = values[ParameterHandle{slot}];
      if (std::all_of(value.d.begin(), value.d.end(), [](double d) { return d == 0; })) continue;
      const bool own =
          std::find(trajectory.slot.begin(), trajectory.slot.end(), slot) != trajectory.slot.end();
      if (own || !IsState(trials()[t].parameter_of[s])) return true;
    }
    return false;
  }

  template <class T, class Set>
  Status Run(std::size_t t, const std::vector<bool>& wanted, const Values<T>& values,
             std::vector<std::vector<OdeStep>>& steps, const Set& set) const {
    const Stretch& stretch = stretches_[t];
    const auto run = [&](const Trajectory& trajectory, const std::vector<double>& stops,
                         std::vector<OdeStep>& own_steps) -> Status {
      const auto sink = [&](int at, const State<T>& x) {
        const std::size_t stop = trajectory.first + static_cast<std::size_t>(at);
        for (const Sample& sample : stretch.samples[stop]) {
          if (!wanted[static_cast<std::size_t>(sample.block)]) continue;
          set(sample.block, sample.row, OutputAt(sample.block, values, stretch.stops[stop], x));
        }
      };
      State<T> state;
      for (std::size_t i = 0; i < state.size(); ++i) {
        state[i] = trajectory.slot[i] < 0 ? T(start_[i].value) : values[ParameterHandle{trajectory.slot[i]}];
      }
      const auto rate = RateOf(values);
      if constexpr (std::is_same_v<T, double>) {
        return IntegrateOde(rate, stops.front(), stops, state, accuracy_, own_steps, sink);
      } else {
        RepeatOde(rate, stops.front(), stops, state, own_steps, sink);
        return {};
      }
    };
    if (stretch.stops.empty()) return {};
    if (stretch.trajectories.size() <= 1) {
      steps.resize(1);
      Trajectory whole{0, stretch.stops.size(), {}};
      for (std::size_t i = 0; i < start_.size(); ++i) whole.slot[i] = start_[i].known ? -1 : start_[i].slot;
      return run(whole, stretch.stops, steps.front());
    }
    if constexpr (std::is_same_v<T, double>) steps.assign(stretch.trajectories.size(), {});
    for (std::size_t k = 0; k < stretch.trajectories.size(); ++k) {
      const Trajectory& trajectory = stretch.trajectories[k];
      if constexpr (!std::is_same_v<T, double>) {
        if (!Moves(t, trajectory, values)) {
          for (std::size_t stop = trajectory.first; stop < trajectory.end; ++stop) {
            for (const Sample& sample : stretch.samples[stop]) {
              if (wanted[static_cast<std::size_t>(sample.block)]) set(sample.block, sample.row, T(0));
            }
          }
          continue;
        }
      }
      SINEW_TRY(run(trajectory,
                    {stretch.stops.begin() + static_cast<std::ptrdiff_t>(trajectory.first),
                     stretch.stops.begin() + static_cast<std::ptrdiff_t>(trajectory.end)},
                    steps[k]));
    }
    return {};
  }

  std::array<Start, static_cast<std::size_t>(N)> start_{};
  OdeAccuracy<static_cast<std::size_t>(N)> accuracy_;
  std::vector<Output> outputs_;        // [observations]
  std::vector<Stretch> stretches_;     // [trials]
  std::vector<shooting::Arc> arcs_;    // of all trajectories, with their windows; empty: nothing grows
  std::vector<int> state_parameters_;  // indices of all initial states, if anything grows; increasing
  Vector typical_;
};

}  // namespace sinew

#include "problems/ode/ode_trajectories.h"
