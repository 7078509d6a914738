// What the emg_shape problem writes into a run file.
#include "models/emg/shape_basis.h"
#include "problems/emg_shape/prediction/band.h"
#include "problems/emg_shape/problem.h"

namespace sinew {
namespace {

constexpr int kPhases = 101;

void DescribeTrial(const EmgShapeTrial& trial, Hdf5Node& node) {
  std::vector<double> begin;
  std::vector<double> end;
  for (const MovementCycle& cycle : trial.cycles) {
    begin.push_back(cycle.begin_s);
    end.push_back(cycle.end_s);
  }
  node.At("begin").SetVector(begin);
  node.At("end").SetVector(end);
  node.At("time").SetVector(trial.time);
}

}  // namespace

Status EmgShapeProblem::WriteDetails(const Vector& parameters, Hdf5Node& details) const {
  std::vector<double> phases;
  for (int i = 0; i < kPhases; ++i) phases.push_back(static_cast<double>(i) / (kPhases - 1));
  const ShapeBasis basis = BasisOf(settings_, data_.knots, data_.reference.period);
  for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
    std::vector<double> control;
    for (std::size_t p = 0; p < list_.parameters.size(); ++p) {
      if (list_.parameters[p].name.rfind(data_.muscles[m].name + ".shape_", 0) == 0)
        control.push_back(parameters[static_cast<Eigen::Index>(p)]);
    }
    std::vector<double> shape;
    for (const double phase : phases) shape.push_back(basis.Value(phase, control.data()));
    Hdf5Node& node = details.At("emg_shape/shapes/" + data_.muscles[m].name);
    node.At("phase").SetVector(phases);
    node.At("shape").SetVector(shape);
  }
  Prediction prediction(data_.layout);
  const auto workspace = NewWorkspace();
  const std::vector<bool> all(data_.layout.size(), true);
  Vector point = parameters;
  for (std::size_t p = 0; p < list_.parameters.size(); ++p) {
    const Parameter& of = list_.parameters[p];
    if (of.kind == ParameterKind::kNuisance && !of.trial.empty()) point[static_cast<Eigen::Index>(p)] = 0;
  }
  SINEW_TRY(Predict({point, all, false, nullptr}, *workspace, prediction));
  SINEW_ASSIGN(const auto band, PredictionBand(*this, parameters));
  for (const EmgShapeTrial& trial : data_.trials) {
    Hdf5Node& node = details.At("emg_shape/trials/" + trial.name);
    DescribeTrial(trial, node);
    for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
      const int b = trial.first_block + static_cast<int>(m);
      const Vector values = prediction.values(b);
      Hdf5Node& muscle = node.At(data_.muscles[m].name);
      muscle.At("predicted").SetVector(std::vector<double>(values.data(), values.data() + values.size()));
      if (band.empty()) continue;
      const Vector& deviation = band[static_cast<std::size_t>(b)];
      muscle.At("deviation")
          .SetVector(std::vector<double>(deviation.data(), deviation.data() + deviation.size()));
    }
  }
  return {};
}

}  // namespace sinew
