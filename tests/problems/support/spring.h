// A driven spring as a user would write it, for tests of OdeProblem and of the program around it.
#pragma once

#include <cmath>

#include "problems/ode/ode_problem.h"
#include "problems/own_model.h"

namespace sinew {

/// position'' = force / mass - stiffness position - damping velocity - hardening position^3
class Spring final : public OdeProblem<Spring, 2> {
 public:
  explicit Spring(const Dataset& data) : OdeProblem(data) {
    stiffness_ = parameter("stiffness", "1/s2").bounds(5, 80).start(30);
    damping_ = parameter("damping", "1/s").bounds(0.01, 5).start(0.5).log();
    hardening_ = effect("hardening", Level::kBoundary)
                     .description("the spring hardens")
                     .revealing_experiment("larger swings")
                     .parameter("hardening", "1/m2/s2")
                     .bounds(-5, 5)
                     .null(0);
    force_ = input("force", "N");
    mass_ = condition("mass_kg");
    observe("position", state(0), "m");
    initial(1, "velocity", "m/s").bounds(-2, 2).start(0.3);
    observe("power", [this](const auto& p, double t, const auto& x) { return p.input(force_, t) * x[1]; });
  }
  template <class T>
  void derivative(const Values<T>& p, double t, const State<T>& x, State<T>& dx) const {
    dx[0] = x[1];
    dx[1] = p.input(force_, t) / p.condition(mass_) - p[stiffness_] * x[0] - p[damping_] * x[1] -
            p[hardening_] * x[0] * x[0] * x[0];
  }

 private:
  ParameterHandle stiffness_, damping_, hardening_;
  InputHandle force_;
  ConditionHandle mass_;
};

/// Two training trials and one for validation: 2 s, the force every 50 ms, position every 20 ms, power every
/// 30 ms; measured values are those of the model at its start values.
inline Dataset SpringData() {
  Dataset data;
  data.title = "springs";
  data.synthetic = true;
  const char* names[] = {"one", "two", "three"};
  for (int k = 0; k < 3; ++k) {
    Trial& trial = data.trials[names[k]];
    trial.role = k < 2 ? Role::kTrain : Role::kValidate;
    trial.conditions["mass_kg"] = 1 + 0.5 * k;
    const auto add = [&](const char* grid, const char* channel, const char* unit, ChannelKind kind,
                         double step) {
      Grid& on = trial.grids[grid];
      Channel made{unit, kind, std::nullopt, {}};
      for (int i = 0; i * step <= 2 + 1e-9; ++i) {
        on.time.push_back(i * step);
        made.values.push_back(kind == ChannelKind::kInput ? 4 * std::sin((2 + k) * i * step) + k : 0.1);
      }
      on.channels[channel] = made;
    };
    add("motor", "force", "N", ChannelKind::kInput, 0.05);
    add("camera", "position", "m", ChannelKind::kMeasured, 0.02);
    add("meter", "power", "W", ChannelKind::kMeasured, 0.03);
  }
  const Spring spring(data);
  Vector at = RestPoint(spring);
  Prediction prediction(spring.layout());
  const std::vector<bool> all(spring.layout().size(), true);
  const auto workspace = spring.NewWorkspace();
  if (!spring.Predict({at, all, false, nullptr}, *workspace, prediction)) return data;
  for (std::size_t b = 0; b < spring.layout().size(); ++b) {
    const Block& block = spring.layout()[b];
    const Vector values = prediction.values(static_cast<int>(b));
    Trial& trial = data.trials[block.trial];
    Grid& grid = trial.grids[block.channel == "power" ? "meter" : "camera"];
    grid.channels[block.channel].values.assign(values.data(), values.data() + values.size());
  }
  return data;
}

/// With data of its own and settings that say nothing.
inline ProblemEntry SpringEntry() {
  ProblemEntry entry = ModelEntry<Spring>("spring");
  entry.synthesize = [](const SynthesisRequest&) -> Result<Dataset> {
    Dataset data = SpringData();
    data.files["spring.yaml"] = "spring: {}";
    return data;
  };
  return entry;
}

}  // namespace sinew
