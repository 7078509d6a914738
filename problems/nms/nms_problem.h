// Muscles driven by EMG that move joints: which parameters explain the measured moments? Thesis ch. 4;
// SCIENCE section 3.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/problem.h"
#include "problems/nms/nms_data.h"

namespace sinew {

/// Parameters GROUP.NAME (see MuscleParameterNames), one per group of muscles that share it. Channels
/// JOINT_moment = sum over muscles of moment arm times tendon force.
class NmsProblem final : public Problem {
 public:
  /// Errors: those of PrepareNmsData; a curve that is no curve.
  static Result<std::unique_ptr<NmsProblem>> Make(const Dataset& data, NmsSettings settings);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return data_.layout; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override;

  [[nodiscard]] const NmsData& data() const { return data_; }
  /// The subject with these parameters.
  [[nodiscard]] Subject SubjectAt(const Vector& parameters) const;

 private:
  /// Where a parameter enters.
  struct Place {
    int muscle = 0;
    MuscleSlot slot = kStrength;
    double factor = 1;  ///< slot = factor * parameter
  };
  struct Scratch;

  NmsProblem(NmsSettings settings, NmsData data, MuscleCurves curves);
  void ListParameters();
  void AddMuscle(const NmsTrial& trial, int muscle, const Query& query, Scratch& scratch,
                 Prediction& prediction) const;
  [[nodiscard]] std::vector<std::array<double, kMuscleSlots>> SlotsAt(const Vector& parameters) const;

  NmsSettings settings_;
  NmsData data_;
  MuscleCurves curves_;
  std::vector<Parameter> parameters_;
  std::vector<std::vector<Place>> places_;                   // [parameters]
  std::vector<std::array<double, kMuscleSlots>> rest_;       // [muscles] of the subject
  std::vector<std::array<int, kMuscleSlots>> parameter_of_;  // [muscles], -1: fixed
};

}  // namespace sinew
