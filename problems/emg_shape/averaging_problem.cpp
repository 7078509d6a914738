#include "problems/emg_shape/averaging_problem.h"

#include <algorithm>
#include <cmath>

#include "models/emg/cycle_warp.h"

namespace sinew {
namespace {

constexpr const char* kSource = "thesis ch. 6, eq 6.1, 6.2";

// The usable cycles of a muscle in a trial, each over 2000 samples.
Status AddCycles(const Trial& trial, const EmgShapeTrial& of, const EmgMuscle& muscle, const Block& block,
                 std::vector<std::vector<double>>& cycles) {
  const Grid& grid = trial.grids.at("excitations");
  const std::vector<double>& values = grid.channels.at(muscle.name).values;
  for (std::size_t c = 0; c < of.cycles.size(); ++c) {
    const bool usable = std::any_of(block.sample.begin(), block.sample.end(), [&](int i) {
      return of.cycle[static_cast<std::size_t>(i)] == static_cast<int>(c);
    });
    if (!usable) continue;
    SINEW_ASSIGN(auto warped, WarpCycle(grid.time, values, of.cycles[c].begin_s, of.cycles[c].end_s));
    cycles.push_back(std::move(warped));
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<AveragingProblem>> AveragingProblem::Make(const Dataset& data,
                                                                 const EmgShapeSettings& settings) {
  SINEW_ASSIGN(EmgShapeData prepared, PrepareEmgShapeData(data, settings));
  if (prepared.trained_speeds() == 0) return Fail("averaging needs training trials");
  std::vector<std::string> names;
  for (const EmgMuscle& muscle : prepared.muscles) names.push_back(muscle.name);
  std::vector<SpeedCycles> speeds;
  for (std::size_t s = 0; s < prepared.speeds.size(); ++s) {
    if (!prepared.speeds[s].trained) continue;
    SpeedCycles at{prepared.speeds[s].speed, std::vector<std::vector<std::vector<double>>>(names.size())};
    for (const EmgShapeTrial& trial : prepared.trials) {
      if (trial.role != BlockRole::kTrain || trial.group != static_cast<int>(s)) continue;
      for (std::size_t m = 0; m < names.size(); ++m) {
        const Block& block = prepared.layout[static_cast<std::size_t>(trial.first_block) + m];
        if (block.role != BlockRole::kTrain) continue;
        const Status added =
            AddCycles(data.trials.at(trial.name), trial, prepared.muscles[m], block, at.muscles[m]);
        if (!added) return Fail("trial '{}', {}: {}", trial.name, names[m], added.error().message);
      }
    }
    speeds.push_back(std::move(at));
  }
  SINEW_ASSIGN(AveragedEmg model, AveragedEmg::Build(names, speeds, {}));
  for (const std::string& note : model.notes()) prepared.notes.push_back(note);
  for (std::size_t m = 0; m < names.size(); ++m) {
    if (!model.has(m)) return Fail("{} has no shape: leave it out of the settings' muscles", names[m]);
  }
  std::unique_ptr<AveragingProblem> problem(new AveragingProblem(std::move(prepared), std::move(model)));
  SINEW_TRY(CheckParameters(problem->parameters()));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  return problem;
}

AveragingProblem::AveragingProblem(EmgShapeData data, AveragedEmg model)
    : data_(std::move(data)), model_(std::move(model)) {
  // With one speed a slope means nothing.
  const bool sloped = data_.trained_speeds() > 1;
  each_ = sloped ? 2 : 1;
  for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
    const ShapeFactor& factor = model_.factor(m);
    const double at_reference = factor.intercept() + factor.slope() * data_.reference.speed;
    const double steepest = 3 * std::max(1.0, std::abs(at_reference)) / data_.reference.speed;
    Parameter size = BaseParameter(data_.muscles[m].name + ".factor", "1",
                                   "shape factor at the reference speed", -0.5, 5, at_reference);
    Parameter slope = BaseParameter(data_.muscles[m].name + ".factor_slope", "s/rad",
                                    "growth of the shape factor with speed", -steepest, steepest,
                                    std::clamp(factor.slope(), -steepest, steepest));
    size.source = slope.source = kSource;
    parameters_.push_back(std::move(size));
    if (sloped) parameters_.push_back(std::move(slope));
  }
  for (const EmgShapeTrial& trial : data_.trials) {
    for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
      const int first = each_ * static_cast<int>(m);
      Block& block = data_.layout[static_cast<std::size_t>(trial.first_block) + m];
      block.columns = sloped ? std::vector<int>{first, first + 1} : std::vector<int>{first};
      std::vector<double> shape;
      for (const double phase : trial.phase)
        shape.push_back(AtPhase(model_.muscle(m).shape, phase - std::floor(phase)));
      shape_.push_back(std::move(shape));
    }
  }
}

Status AveragingProblem::Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const {
  for (const EmgShapeTrial& trial : data_.trials) {
    const double faster = trial.speed - data_.reference.speed;
    for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
      const int b = trial.first_block + static_cast<int>(m);
      if (!query.blocks[static_cast<std::size_t>(b)]) continue;
      const std::vector<double>& samples = shape_[static_cast<std::size_t>(b)];
      const Eigen::Map<const Vector> shape(samples.data(), static_cast<Eigen::Index>(samples.size()));
      const int first = each_ * static_cast<int>(m);
      const bool sloped = each_ > 1;
      const double factor = query.parameters[first] + (sloped ? query.parameters[first + 1] * faster : 0);
      const bool falls_below = factor < 0;  // an EMG is not negative
      prediction.values(b) = (falls_below ? 0 : factor) * shape;
      if (!query.derivatives) continue;
      const double slope = falls_below ? 0 : 1;
      if (query.Differentiates(first)) prediction.derivatives(b).col(0) = slope * shape;
      if (sloped && query.Differentiates(first + 1))
        prediction.derivatives(b).col(1) = slope * faster * shape;
    }
  }
  return {};
}

std::vector<Warning> AveragingProblem::WarningsAt(const Vector& /*parameters*/) const {
  std::vector<Warning> warnings;
  for (const EmgShapeTrial& trial : data_.trials) {
    const std::string warning = model_.RangeWarning(0, trial.speed);
    if (warning.empty()) continue;
    warnings.push_back({WarningKind::kOther, {}, {}, fmt::format("trial '{}': {}", trial.name, warning)});
  }
  return warnings;
}

}  // namespace sinew
