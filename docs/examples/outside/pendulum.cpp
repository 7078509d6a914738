// A user's model in about 100 lines: a damped pendulum, recorded by a camera.
//
//   angle(t) = amplitude * exp(-damping t) * cos(frequency t + phase),    frequency = sqrt(g / length)
//
// One class declares the parameters, the prediction of the channel, and its derivatives.
// Solvers, verdicts and sensor effects come with it.
#include <sinew/sinew.h>

#include <cstdio>

using namespace sinew;

constexpr double kGravity = 9.81;  // [m/s2]

class Pendulum final : public AutoDiffProblem {
 public:
  explicit Pendulum(const Dataset& data) : AutoDiffProblem(data) {
    length_ = parameter("length", "m").bounds(0.1, 2).start(0.9).meaning("from the pivot to the mass");
    damping_ = parameter("damping", "1/s").bounds(0, 2).start(0.1).meaning("rate of decay");
    parameter("mass", "kg").bounds(0.1, 10).start(1);  // it does not show in the angle: sinew says so
    amplitude_ = per_trial("amplitude", "rad").bounds(0.01, 1).start(0.2);
    phase_ = per_trial("phase", "rad").bounds(-1.5, 1.5).start(0);
    observe("angle", [this](const auto& p, double t) {
      return p[amplitude_] * exp(-p[damping_] * t) * cos(sqrt(kGravity / p[length_]) * t + p[phase_]);
    });
  }

 private:
  ParameterHandle length_, damping_, amplitude_, phase_;
};

// Made-up recordings of a length of 1 m and a damping of 0.15 1/s, with noise of 5 mrad.
Dataset Recordings() {
  Random random(1);
  Dataset data;
  data.synthetic = true;
  for (const double amplitude : {0.3, 0.2}) {
    Trial& trial = data.trials["swing_" + std::to_string(data.trials.size() + 1)];
    trial.role = data.trials.size() == 1 ? Role::kTrain : Role::kValidate;
    Grid& grid = trial.grids["camera"];
    Channel& angle = grid.channels["angle"];
    angle.unit = "rad";
    for (int i = 0; i < 200; ++i) {
      const double t = 0.05 * i;
      grid.time.push_back(t);
      angle.values.push_back(amplitude * std::exp(-0.15 * t) * std::cos(std::sqrt(kGravity) * t + 0.2) +
                             0.005 * random.Normal());
    }
  }
  return data;
}

int main() {
  const auto pendulum = BindModel<Pendulum>(Recordings(), false);
  const auto setup = pendulum ? MakeFitSetup(**pendulum, {}) : tl::unexpected(pendulum.error());
  const auto result = setup ? Identify(**pendulum, *setup, {}) : tl::unexpected(setup.error());
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().message.c_str());
    return 1;
  }
  for (const text::Sentence& finding : text::Findings(*result)) std::printf("%s\n", finding.text.c_str());
  return result->result.stop.converged() && std::abs(result->parameters[0] - 1) < 0.01 ? 0 : 1;
}
