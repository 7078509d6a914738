// The trials of an OdeProblem as multiple shooting sees them.
#pragma once

#include <algorithm>
#include <cmath>
#include <exception>
#include <vector>

#include "base/text.h"
#include "identify/shooting/shooting_model.h"
#include "problems/declaration/values.h"
#include "problems/ode/ode_integrator.h"

namespace sinew {

/// @tparam Problem an OdeProblem @tparam N its number of states
template <class Problem, int N>
class OdeWindows final : public shooting::Model {
 public:
  /// @param problem must outlive this. @param compared [layout size] the blocks that are measured against
  /// @param typical [N] typical change of each state
  OdeWindows(const Problem& problem, const std::vector<bool>& compared, Vector typical)
      : problem_(problem), compared_(compared), typical_(std::move(typical)) {
    for (const Block& block : problem.layout()) {
      std::vector<int> samples(block.prediction_time.size(), -1);
      for (std::size_t i = 0; i < block.sample.size(); ++i)
        samples[static_cast<std::size_t>(block.sample[i])] = static_cast<int>(i);
      sample_of_row_.push_back(std::move(samples));
    }
  }

  [[nodiscard]] int states() const override { return N; }
  [[nodiscard]] std::size_t trials() const override { return problem_.stretches_.size(); }
  [[nodiscard]] std::size_t stops(std::size_t trial) const override {
    return problem_.stretches_[trial].stops.size();
  }
  [[nodiscard]] std::vector<std::size_t> ComparedStops(std::size_t trial) const override {
    std::vector<std::size_t> stops;
    const auto& samples = problem_.stretches_[trial].samples;
    for (std::size_t stop = 0; stop < samples.size(); ++stop) {
      const bool compared = std::any_of(samples[stop].begin(), samples[stop].end(),
                                        [this](const auto& sample) { return SampleOf(sample) >= 0; });
      if (compared) stops.push_back(stop);
    }
    return stops;
  }
  [[nodiscard]] Vector MeasuredState(std::size_t trial, std::size_t stop) const override {
    Vector state(N);
    for (int i = 0; i < N; ++i) state[i] = problem_.MeasuredState(trial, stop, i);
    return state;
  }
  [[nodiscard]] bool IsKnown(std::size_t /*trial*/, int component) const override {
    return problem_.start_[static_cast<std::size_t>(component)].known;
  }
  [[nodiscard]] Vector TypicalState() const override { return typical_; }

  Status Shoot(const shooting::Window& window, const Vector& parameters, const Vector& state,
               const std::vector<int>& free, bool derivatives, shooting::Shot& shot) const override {
    try {
      return ShootUnguarded(window, parameters, state, free, derivatives, shot);
    } catch (const std::exception& exception) {
      return Fail("the model threw: {}", OneLine(exception.what()));
    }
  }

 private:
  using Lanes = typename Problem::LaneNumber;
  static constexpr std::size_t kWidth = Problem::kLaneCount;

  template <class Sample>
  [[nodiscard]] int SampleOf(const Sample& sample) const {
    const auto b = static_cast<std::size_t>(sample.block);
    return compared_[b] ? sample_of_row_[b][static_cast<std::size_t>(sample.row)] : -1;
  }

  Status ShootUnguarded(const shooting::Window& window, const Vector& parameters, const Vector& state,
                        const std::vector<int>& free, bool derivatives, shooting::Shot& shot) const {
    const auto& stretch = problem_.stretches_[window.trial];
    const auto& trial = problem_.trials()[window.trial];
    const std::size_t last = window.joined ? window.end + 1 : window.end;
    const std::vector<double> stops(stretch.stops.begin() + static_cast<std::ptrdiff_t>(window.first),
                                    stretch.stops.begin() + static_cast<std::ptrdiff_t>(last));
    struct Row {
      int block;
      std::size_t sample;
      std::size_t stop;  // of the window
    };
    std::vector<Row> rows;
    std::vector<std::size_t> first_row{0};
    for (std::size_t stop = window.first; stop < window.end; ++stop) {
      for (const auto& sample : stretch.samples[stop]) {
        if (SampleOf(sample) >= 0)
          rows.push_back({sample.block, static_cast<std::size_t>(SampleOf(sample)), stop - window.first});
      }
      first_row.push_back(rows.size());
    }
    shot.Prepare(static_cast<Eigen::Index>(rows.size()), N, static_cast<Eigen::Index>(free.size()),
                 window.joined, derivatives);
    std::vector<double> plain;
    for (const int index : trial.parameter_of) plain.push_back(index < 0 ? 0 : parameters[index]);
    std::vector<OdeStep> steps;
    // What a pass makes of every stop, for double and for dual numbers.
    const auto pass = [&](const auto& values, auto begin, const auto& put) -> Status {
      using T = typename decltype(begin)::value_type;
      const auto rate = problem_.RateOf(values);
      const auto sink = [&](int stop, const std::array<T, static_cast<std::size_t>(N)>& x) {
        const auto s = static_cast<std::size_t>(stop);
        if (window.joined && s + 1 == stops.size()) {
          for (int i = 0; i < N; ++i) put(-1 - i, x[static_cast<std::size_t>(i)], 1.0, 0.0);
          return;
        }
        for (std::size_t r = first_row[s]; r < first_row[s + 1]; ++r) {
          const Block& block = problem_.layout()[static_cast<std::size_t>(rows[r].block)];
          put(static_cast<int>(r), problem_.OutputAt(rows[r].block, values, stops[s], x),
              block.WeightOf(rows[r].sample), block.measured[rows[r].sample]);
        }
      };
      if constexpr (std::is_same_v<T, double>) {
        return IntegrateOde(rate, stops.front(), stops, begin, problem_.accuracy_, steps, sink);
      } else {
        RepeatOde(rate, stops.front(), stops, begin, steps, sink);
        return {};
      }
    };
    std::array<double, static_cast<std::size_t>(N)> begin;
    for (int i = 0; i < N; ++i) begin[static_cast<std::size_t>(i)] = state[i];
    SINEW_TRY(pass(Values<double>(plain, trial.inputs, trial.conditions), begin,
                   [&](int row, double value, double weight, double measured) {
                     (row < 0 ? shot.end[-1 - row] : shot.residual[row]) = weight * (value - measured);
                   }));
    if (derivatives) {
      std::vector<std::pair<int, int>> lanes;  // slot, or -1 - state; column
      for (int i = 0; i < N; ++i) lanes.emplace_back(-1 - i, i);
      for (std::size_t k = 0; k < free.size(); ++k) {
        const auto slot = std::find(trial.parameter_of.begin(), trial.parameter_of.end(), free[k]);
        if (slot != trial.parameter_of.end())
          lanes.emplace_back(static_cast<int>(slot - trial.parameter_of.begin()), static_cast<int>(k) + N);
      }
      for (std::size_t first = 0; first < lanes.size(); first += kWidth) {
        const std::size_t count = std::min(kWidth, lanes.size() - first);
        std::vector<Lanes> dual(plain.begin(), plain.end());
        std::array<Lanes, static_cast<std::size_t>(N)> moved;
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = begin[i];
        for (std::size_t lane = 0; lane < count; ++lane) {
          const int of = lanes[first + lane].first;
          Lanes& number =
              of < 0 ? moved[static_cast<std::size_t>(-1 - of)] : dual[static_cast<std::size_t>(of)];
          number.d[lane] = 1;
        }
        SINEW_TRY(pass(Values<Lanes>(dual, trial.inputs, trial.conditions), moved,
                       [&](int row, const Lanes& value, double weight, double /*measured*/) {
                         Matrix& by_state = row < 0 ? shot.end_by_state : shot.by_state;
                         Matrix& by_parameter = row < 0 ? shot.end_by_parameter : shot.by_parameter;
                         const Eigen::Index at = row < 0 ? -1 - row : row;
                         for (std::size_t lane = 0; lane < count; ++lane) {
                           const int column = lanes[first + lane].second;
                           (column < N ? by_state(at, column) : by_parameter(at, column - N)) =
                               weight * value.d[lane];
                         }
                       }));
      }
    }
    if (!shot.IsFinite()) return Fail("trial '{}': the prediction is not finite", trial.name);
    return {};
  }

  const Problem& problem_;
  std::vector<bool> compared_;
  Vector typical_;
  std::vector<std::vector<int>> sample_of_row_;  // [blocks][rows] sample, or -1
};

}  // namespace sinew
