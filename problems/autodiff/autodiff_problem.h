// A model of one's own in closed form: a function of parameters, time and inputs per channel, templated on
// the scalar, from which derivatives follow exactly.
//
//   class Pendulum final : public AutoDiffProblem {
//    public:
//     explicit Pendulum(const Dataset& data) : AutoDiffProblem(data) {
//       length_ = parameter("length", "m").bounds(0.1, 2).start(0.9);
//       observe("angle", [this](const auto& p, double t) { return cos(sqrt(kGravity / p[length_]) * t); });
//     }
//   };
//
// docs/own_model.md shows how to write one.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/dual_math.h"
#include "problems/declaration/declared_problem.h"

namespace sinew {

/// A functor is called with Values<double>, and with Values<Dual<N>> where derivatives are wanted.
class AutoDiffProblem : public DeclaredProblem {
 public:
  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const final {
    return PredictTrials(query, prediction, [&](std::size_t trial, const auto& values, const auto& set) {
      return Run(trial, query.blocks, values, set);
    });
  }

 protected:
  explicit AutoDiffProblem(const Dataset& data) : DeclaredProblem(data) {}

  /// A channel sample by sample. @param function (const Values<T>& p, double t [s]) -> T
  /// @param unit checked against the data's, if not empty
  template <class Function>
  void observe(const std::string& channel, Function function, const std::string& unit = "") {
    observe_signal(
        channel,
        [function](const auto& p, const std::vector<double>& time, auto& values) {
          for (std::size_t i = 0; i < time.size(); ++i) values[i] = function(p, time[i]);
        },
        unit);
  }

  /// A channel as a whole, for models that look back (filters, sums).
  /// @param function (const Values<T>& p, const std::vector<double>& time, std::vector<T>& values); values
  /// has the size of time and must keep it
  template <class Function>
  void observe_signal(const std::string& channel, Function function, const std::string& unit = "") {
    AddChannel(channel, unit);
    outputs_.push_back({function, function});
  }

 private:
  struct Output {
    std::function<void(const Values<double>&, const std::vector<double>&, std::vector<double>&)> plain;
    std::function<void(const Values<Lanes>&, const std::vector<double>&, std::vector<Lanes>&)> dual;

    void At(const Values<double>& p, const std::vector<double>& time, std::vector<double>& values) const {
      plain(p, time, values);
    }
    void At(const Values<Lanes>& p, const std::vector<double>& time, std::vector<Lanes>& values) const {
      dual(p, time, values);
    }
  };

  template <class T, class Set>
  Status Run(std::size_t t, const std::vector<bool>& wanted, const Values<T>& values, const Set& set) const {
    std::vector<T> predicted;
    for (const int b : trials()[t].blocks) {
      if (!wanted[static_cast<std::size_t>(b)]) continue;
      const Block& block = layout()[static_cast<std::size_t>(b)];
      predicted.assign(block.prediction_time.size(), T(std::numeric_limits<double>::quiet_NaN()));
      outputs_[static_cast<std::size_t>(ObservationOf(b))].At(values, block.prediction_time, predicted);
      if (predicted.size() != block.prediction_time.size()) {
        return Fail("channel '{}': the model returned {} values, expected {}", block.channel,
                    predicted.size(), block.prediction_time.size());
      }
      for (std::size_t i = 0; i < predicted.size(); ++i) set(b, static_cast<Eigen::Index>(i), predicted[i]);
    }
    return {};
  }

  std::vector<Output> outputs_;  // [observations]
};

}  // namespace sinew
