// Contact of soles with the floor under prescribed motion: which stiffness, dissipation and friction explain
// the measured ground reaction? Thesis ch. 5; SCIENCE section 4.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "identify/alternative_prediction.h"
#include "identify/problem.h"
#include "identify/unmeasured_estimate.h"
#include "problems/contact/data.h"
#include "problems/contact/effects.h"
#include "problems/contact/settings.h"

namespace sinew {

struct PlateChannels;

/// Parameters per group of regions: stiffness, dissipation, static_friction, dynamic_friction,
/// viscous_friction; named so if there is one group, else GROUP.stiffness and so on. Channels per plate:
/// force_x, force_y, force_z, cop_x, cop_z, moment_y. The fitted ones are compared with the measurement; the
/// others are predicted.
///
/// Contact effects (ContactEffect) rest at 0; while they do, the prediction comes from ContactSums and is
/// that of a problem without them, to the last bit.
class ContactProblem final : public Problem {
 public:
  /// Errors: those of PrepareContactData.
  static Result<std::unique_ptr<ContactProblem>> Make(const Dataset& data, ContactSettings settings,
                                                      double margin = 0);

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return list_.parameters; }
  [[nodiscard]] const Layout& layout() const override { return data_.layout; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return list_.effects; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override;
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override;
  [[nodiscard]] std::string objective() const override;
  /// With motion errors: springs that touch or leave the floor bend the cost at as many places as there are
  /// springs and instants; a search cannot settle between two of them more closely than this.
  [[nodiscard]] double cost_noise_level() const override { return settings_.motion_errors ? 1e-6 : 0; }
  /// With motion errors: how far the foot of each stance moved from the recorded motion [mm, degrees].
  [[nodiscard]] std::vector<FigureOfMerit> FiguresOfMerit(
      const Vector& parameters, const std::vector<Vector>& predicted) const override;
  /// Per trial and region: outline of the faces, pressure and slip of each at every instant, centre of
  /// pressure.
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override;
  /// With motion errors, of held-out stances without their plates: by the mean deviation of the fitted
  /// stances, and by the dynamics of the whole body where the trial holds them, else with the mean load of
  /// the fitted stances; and by the mean measured curve of the fitted stances over the duration of a stance,
  /// mirrored for the other foot. Known of a held-out stance are its begin and its end.
  [[nodiscard]] std::vector<AlternativePrediction> Alternatives(const Vector& parameters) const override;
  /// With motion errors, of stances whose plate measured nothing: by the dynamics of the whole body where the
  /// trial holds them, else by the mean deviation and the mean load of the fitted stances.
  [[nodiscard]] std::optional<UnmeasuredEstimate> EstimateUnmeasured(const Vector& parameters) const override;
  /// The plate's measured vertical force, and depth and slip speed of the deepest spring.
  [[nodiscard]] Vector AtPriors(const Vector& parameters, const Vector& priors, CarryOver how) const override;
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override;

  [[nodiscard]] const ContactData& data() const { return data_; }
  [[nodiscard]] const ContactSettings& settings() const { return settings_; }

  /// Channels per plate, see kContactChannels.
  static constexpr std::size_t kChannels = 6;

  /// Parameters of one group, in the model's terms.
  [[nodiscard]] static ElasticFoundation Foundation(const Vector& parameters, int group);

 private:
  // The prior of the pose's errors.
  [[nodiscard]] std::vector<FigureOfMerit> PriorFigures(const Vector& parameters) const;
  ContactProblem(ContactSettings settings, ContactData data);
  struct Scratch;
  struct ContactWorkspace;
  [[nodiscard]] Status PredictInstant(const Stance& stance, int t, const std::array<bool, kChannels>& wanted,
                                      const Query& query, Scratch& scratch, Prediction& prediction) const;
  void DifferentiatePose(const Stance& stance, int t, const std::array<bool, kChannels>& wanted,
                         const Query& query, const PlateChannels& channels, Scratch& scratch,
                         Prediction& prediction) const;
  /// Sets the places of the soles that are parameters. @param places [parts of the stance, m] zero elsewhere
  void SolePlacesInto(const Stance& stance, const Vector& parameters, std::vector<Vec3>& places) const;
  /// Of the place's parameter for a group. @param slot index into places_
  [[nodiscard]] int PlaceIndex(std::size_t slot, int group) const {
    const int groups =
        data_.effects.first() / (kContactParametersPerGroup + static_cast<int>(places_.size()));
    return groups * (kContactParametersPerGroup + static_cast<int>(slot)) + group;
  }
  /// Those with a block of a role.
  [[nodiscard]] std::vector<const Stance*> StancesOf(BlockRole role) const;
  /// Of the feet in the fitted stances [stances][T], forces that are measured and not fitted as measured;
  /// nothing where they cannot be predicted.
  [[nodiscard]] std::optional<std::vector<std::vector<ContactLoad>>> FittedLoads(
      const Vector& parameters) const;
  [[nodiscard]] ContactEffectValues EffectsOn(const std::string& plate, const Vector& parameters) const;

  ContactSettings settings_;
  std::vector<int> places_;  // of SolePlace that are parameters
  ContactData data_;
  ParameterList list_;
};

/// The parameters of one group with their default ranges, without data; then those of the contact effects.
[[nodiscard]] std::vector<Parameter> DefaultContactParameters();

}  // namespace sinew
