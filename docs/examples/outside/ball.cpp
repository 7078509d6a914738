// An existing simulator behind Problem: a ball that bounces. It has no derivatives, sinew takes
// differences.
#include <sinew/sinew.h>

#include <cstdio>

#include "ball_simulator.h"

using namespace sinew;

class Ball final : public DifferencedProblem {
 public:
  explicit Ball(const Dataset& data) {
    parameters_ = {BaseParameter("restitution", "1", "speed after a bounce / before", 0.3, 0.99, 0.7),
                   BaseParameter("gravity", "m/s2", "of the place", 9, 11, 9.8)};
    for (const auto& [name, trial] : data.trials) {
      const auto found = trial.Find("height");
      if (!found) continue;
      Block block;
      block.trial = name;
      block.channel = "height";
      block.unit = "m";
      block.role = trial.role == Role::kTrain ? BlockRole::kTrain : BlockRole::kValidate;
      block.prediction_time = found.grid->time;
      block.measured = found.channel->values;
      for (int i = 0; i < block.predictions(); ++i) block.sample.push_back(i);
      const int first = static_cast<int>(parameters_.size());  // values of this trial alone
      block.columns = {0, 1, first, first + 1};
      parameters_.push_back(BaseParameter("height@" + name, "m", "of release", 0.2, 3, block.measured[0]));
      parameters_.push_back(BaseParameter("time@" + name, "s", "of release", -0.1, 0.5, 0.1));
      for (int i = first; i < first + 2; ++i) {
        parameters_[i].kind = ParameterKind::kNuisance;
        parameters_[i].trial = name;
      }
      layout_.push_back(block);
    }
  }
  const std::vector<Parameter>& parameters() const override { return parameters_; }
  const Layout& layout() const override { return layout_; }
  double accuracy() const override { return 1e-12; }  // of the simulator

 private:
  Status PredictValues(const Vector& p, const std::vector<bool>& blocks, Workspace& /*workspace*/,
                       Prediction& prediction) const override {
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      if (!blocks[b]) continue;
      const std::vector<int>& columns = layout_[b].columns;
      if (ball_simulate(p[columns[2]], p[columns[3]], p[0], p[1], layout_[b].predictions(),
                        layout_[b].prediction_time.data(), prediction.values(b).data()) != 0)
        return Fail("the simulator refused trial '{}'", layout_[b].trial);
    }
    return {};
  }

  std::vector<Parameter> parameters_;
  Layout layout_;
};

// Made-up recordings: restitution 0.8, gravity 9.81 m/s2, noise of 3 mm.
Dataset Recordings() {
  Random random(1);
  Dataset data;
  data.synthetic = true;
  for (const double release : {1.0, 1.3, 0.8}) {
    Trial& trial = data.trials["drop_" + std::to_string(data.trials.size() + 1)];
    trial.role = data.trials.size() < 3 ? Role::kTrain : Role::kValidate;
    Grid& grid = trial.grids["camera"];
    for (int i = 0; i < 200; ++i) grid.time.push_back(0.01 * i);
    Channel& height = grid.channels["height"];
    height = {"m", ChannelKind::kMeasured, 0.003, std::vector<double>(grid.time.size())};
    ball_simulate(release, 0.07, 0.8, 9.81, 200, grid.time.data(), height.values.data());
    for (double& value : height.values) value += 0.003 * random.Normal();
  }
  return data;
}

int main() {
  const auto ball = BindModel<Ball>(Recordings());
  const auto setup = ball ? MakeFitSetup(**ball, {}) : tl::unexpected(ball.error());
  IdentificationOptions options;
  options.solver = "multistart";
  const auto result = setup ? Identify(**ball, *setup, options) : tl::unexpected(setup.error());
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().message.c_str());
    return 1;
  }
  for (const text::Sentence& finding : text::Findings(*result)) std::printf("%s\n", finding.text.c_str());
  return result->result.stop.converged() && std::abs(result->parameters[0] - 0.8) < 0.005 ? 0 : 1;
}
