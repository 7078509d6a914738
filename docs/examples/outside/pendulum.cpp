// A user's model in about 100 lines: a damped pendulum, recorded by a camera.
//
//   angle(t) = amplitude * exp(-damping t) * cos(frequency t + phase),    frequency = sqrt(g / length)
//
// One class declares the parameters, the prediction of the channel, and its derivatives.
// Solvers, verdicts and sensor effects come with it.
#include <sinew/sinew.h>

#include <cmath>
#include <cstdio>

namespace {

using namespace sinew;

constexpr double kGravity = 9.81;

class Pendulum final : public Problem {
 public:
  Pendulum(std::vector<double> time, std::vector<double> angle) {
    parameters_ = {BaseParameter("length", "m", "from the pivot to the mass", 0.1, 2.0, 0.9),
                   BaseParameter("damping", "1/s", "rate of decay", 0.0, 2.0, 0.1),
                   BaseParameter("amplitude", "rad", "of the swing at t = 0", 0.01, 1.0, 0.2),
                   BaseParameter("phase", "rad", "of the swing at t = 0", -1.5, 1.5, 0.0),
                   // The angle does not depend on it: sinew reports this.
                   BaseParameter("mass", "kg", "at the end", 0.1, 10.0, 1.0)};
    Block block;
    block.trial = "swing";
    block.channel = "angle";
    block.unit = "rad";
    for (int i = 0; i < static_cast<int>(time.size()); ++i) block.sample.push_back(i);
    block.prediction_time = std::move(time);
    block.measured = std::move(angle);
    block.columns = {0, 1, 2, 3, 4};
    layout_.push_back(std::move(block));
  }

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  const Layout& layout() const override { return layout_; }

  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const override {
    const double length = query.parameters[0];
    const double damping = query.parameters[1];
    const double amplitude = query.parameters[2];
    const double phase = query.parameters[3];
    const double frequency = std::sqrt(kGravity / length);
    for (Eigen::Index i = 0; i < prediction.values(0).size(); ++i) {
      const double t = layout_[0].prediction_time[static_cast<std::size_t>(i)];
      const double decay = std::exp(-damping * t);
      const double angle = amplitude * decay * std::cos(frequency * t + phase);
      prediction.values(0)[i] = angle;
      if (!query.derivatives) continue;
      const double by_phase = -amplitude * decay * std::sin(frequency * t + phase);
      prediction.derivatives(0).row(i) << by_phase * t * (-0.5 * frequency / length), -t * angle,
          angle / amplitude, by_phase, 0;
    }
    return {};
  }

 private:
  std::vector<Parameter> parameters_;
  Layout layout_;
};

}  // namespace

int main() {
  // A synthetic recording: length 1 m, damping 0.15 1/s, noise of 5 mrad.
  Random random(1);
  std::vector<double> time;
  std::vector<double> angle;
  for (int i = 0; i < 200; ++i) {
    time.push_back(0.05 * i);
    angle.push_back(0.3 * std::exp(-0.15 * time.back()) * std::cos(std::sqrt(kGravity) * time.back() + 0.2) +
                    0.005 * random.Normal());
  }
  const Pendulum pendulum(time, angle);

  const auto setup = MakeFitSetup(pendulum, {});
  IdentificationOptions options;
  options.solver = "multistart";
  const auto result = setup ? Identify(pendulum, *setup, options) : tl::unexpected(setup.error());
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().message.c_str());
    return 1;
  }
  for (const std::string& finding : result->findings) std::printf("%s\n", finding.c_str());
  const double length = result->parameters[0];
  return result->result.stop.converged() && std::abs(length - 1) < 0.01 ? 0 : 1;
}
