// The ankle of a person whose foot is strapped to a dynamometer: attachment, straps and sole, passive ankle
// and muscles in one simulation. SCIENCE section 6; docs/ankle_on_dynamometer.md.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/problem.h"
#include "problems/ankle_on_dynamometer/data.h"
#include "problems/ankle_on_dynamometer/effects.h"

namespace sinew {

struct FootSolutions;

/// The plate follows the measured angle of the machine. Channels per trial: machine_torque, and of a trial
/// with a foot on the plate ankle_angle and MUSCLE_fibre_length.
class AnkleProblem final : public Problem {
 public:
  /// Errors: those of PrepareAnkleData and ListAnkleParameters.
  static Result<std::unique_ptr<AnkleProblem>> Make(const Dataset& data, AnkleSettings settings,
                                                    double margin = 0);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return list_.parameters; }
  [[nodiscard]] const Layout& layout() const override { return data_.layout; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return list_.effects; }
  /// ankle_moment, and activation.MUSCLE of every muscle.
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return list_.ports; }
  /// Attachment alone, passive, active, and everything at once, as far as there are trials.
  [[nodiscard]] const std::vector<FitStep>& steps() const override { return steps_; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  /// Trials are predicted in parallel.
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override {
    return "half the sum of squared residuals in units of their noise";
  }
  /// Steps of the integration are fixed, and every stage is solved to rounding: strips of the sole that touch
  /// and let go leave kinks that no search resolves further.
  [[nodiscard]] double cost_noise_level() const override { return 1e-7; }
  /// machine_angle, machine_velocity, and the excitations' mean.
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override;
  /// Per trial, under ankle_on_dynamometer/TRIAL: what the machine's torque is made of, forces between foot
  /// and plate, powers; under inverse what of the measured torque is left for the muscles; under before the
  /// parts of the torque at the values that fits start from.
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;

  [[nodiscard]] const AnkleData& data() const { return data_; }

 private:
  struct Scratch;
  struct TrialScratch;
  AnkleProblem(AnkleData data, ParameterList list);
  void AddZero(AnkleTrial& trial);
  void ListSteps();
  Status PredictTrial(std::size_t trial, const Query& query, TrialScratch& scratch,
                      Prediction& prediction) const;
  // The values of a trial, unless the last ones were of the same parameters.
  Status RunPlain(const AnkleTrial& trial, TrialScratch& scratch) const;
  // Whether the parameter changes the attachment's own torque alone, not how the foot moves.
  [[nodiscard]] bool IsOfAttachment(int parameter) const;
  // Derivatives for some of the trial's columns; `moves`: they change how the foot moves.
  Status Differentiate(const AnkleTrial& trial, const Query& query, const std::vector<std::size_t>& places,
                       bool moves, TrialScratch& scratch, Prediction& prediction) const;
  Status WriteInverseView(const AnkleTrial& trial, const Vector& parameters, FootSolutions& solutions,
                          Hdf5Node& node) const;
  void WriteBefore(const AnkleTrial& trial, FootSolutions& solutions, Hdf5Node& node) const;
  [[nodiscard]] std::vector<double> ValuesAt(const Vector& parameters) const;

  AnkleData data_;
  ParameterList list_;
  std::vector<double> defaults_;
  std::vector<FitStep> steps_;
};

/// The parameters with default ranges, without data.
[[nodiscard]] std::vector<Parameter> DefaultAnkleParameters();

}  // namespace sinew
