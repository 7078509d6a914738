// Muscles driven by EMG that move joints: which parameters explain the measured moments? Thesis ch. 4;
// SCIENCE section 3.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/problem.h"
#include "problems/nms/data.h"
#include "problems/nms/effects.h"

namespace sinew {

/// What the moments of one trial are made of, at some parameters.
struct NmsParts {
  std::vector<std::array<double, kMuscleSlots>> slots;  ///< [muscles]
  std::vector<std::vector<Vector>> arms;                ///< [joints][muscles of the joint] [N, m]
  std::vector<Vector> beyond;                           ///< [joints] [N, N m] of no muscle
};

/// Parameters GROUP.NAME (see MuscleParameterNames), one per group of muscles that share it. Channels
/// JOINT_moment = sum over muscles of moment arm times tendon force.
class NmsProblem final : public Problem {
 public:
  /// @param unmeasured muscles without EMG, to be excited later. Errors: those of PrepareNmsData; a curve
  /// that is no curve.
  static Result<std::unique_ptr<NmsProblem>> Make(const Dataset& data, NmsSettings settings,
                                                  const std::vector<std::string>& unmeasured = {});

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return list_.parameters; }
  [[nodiscard]] const Layout& layout() const override { return data_.layout; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return list_.effects; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override;
  [[nodiscard]] bool weights_are_noise_levels() const override {
    return settings_.objective != NmsObjective::kThesis;
  }
  /// Angle, velocity and mean excitation.
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override;
  [[nodiscard]] const std::vector<FitStep>& steps() const override { return steps_; }
  /// Muscles whose fibres leave the lengths of active force, in training trials.
  [[nodiscard]] std::vector<Warning> WarningsAt(const Vector& parameters) const override;
  /// C1 and C2 of the activation filters, one pair per muscle or, where all its muscles have the same, group.
  [[nodiscard]] std::vector<DerivedQuantity> DerivedQuantities() const override;
  /// CEINMS's f: the sum over fitted trials and joints of the mean squared error of the moment over its
  /// variance.
  [[nodiscard]] std::vector<FigureOfMerit> FiguresOfMerit(
      const Vector& parameters, const std::vector<Vector>& predicted) const override;
  /// Per trial, under nms/TRIAL: time; MUSCLE/{activation, fibre_length, fibre_velocity, force}; and
  /// subject, the file of the subject with these parameters in it.
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;

  [[nodiscard]] const NmsData& data() const { return data_; }
  [[nodiscard]] const NmsSettings& settings() const { return settings_; }
  [[nodiscard]] const MuscleCurves& curves() const { return curves_; }
  [[nodiscard]] NmsParts PartsAt(const Vector& parameters, std::size_t trial) const;
  /// Another excitation of a muscle than the one that was measured. @param time [M >= 2, s, increasing]
  /// @param excitation [M, 0..1]
  void Excite(std::size_t trial, std::size_t muscle, std::vector<double> time,
              std::vector<double> excitation);
  /// The subject with these parameters; effects are left out.
  [[nodiscard]] Subject SubjectAt(const Vector& parameters) const;
  /// Every muscle of one trial. Errors: those of ComputeMuscleForce.
  Status MusclesAt(const Vector& parameters, std::size_t trial,
                   std::vector<MuscleTrace<double>>& muscles) const;

 private:
  using Slots = std::vector<std::array<double, kMuscleSlots>>;  // [muscles]
  /// A parameter that moves a slot, and how much.
  struct Slope {
    int parameter = 0;
    MuscleSlot slot = kStrength;
    double factor = 1;
  };
  struct Scratch;

  NmsProblem(NmsSettings settings, NmsData data, MuscleCurves curves);
  void AddPulls();
  void ListColumns();
  void ListSteps();
  Status PredictTrial(std::size_t t, const Query& query, Scratch& scratch, Prediction& prediction) const;
  template <class T>
  Status AddMuscle(std::size_t t, int muscle, const Query& query, Scratch& scratch, MuscleTrace<T>& trace,
                   Prediction& prediction) const;
  Status AddMuscle(std::size_t t, int muscle, const Query& query, Scratch& scratch,
                   Prediction& prediction) const;
  template <class T>
  void AddFibreLength(std::size_t t, std::size_t muscle, const T& optimal, const MuscleTrace<T>& trace,
                      const Query& query, const Scratch& scratch, Prediction& prediction) const;
  void AddMoments(std::size_t t, const Query& query, Prediction& prediction) const;
  /// Numbers of the muscles in a trial; with slopes [muscles] too if they are wanted.
  void SlotsAt(const Vector& parameters, std::size_t trial, Slots& slots,
               std::vector<std::vector<Slope>>* slopes) const;

  NmsSettings settings_;
  NmsData data_;
  MuscleCurves curves_;
  Slots rest_;  // of the subject
  NmsParameterList list_;
  std::vector<FitStep> steps_;
};

}  // namespace sinew
