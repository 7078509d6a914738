#include "problems/nms/excitation/excitation_mode.h"

#include "problems/kit/bind.h"

namespace sinew {

bool NmsModeChange::HasDetails() const {
  return alpha || beta || gamma || !synthesise.empty() || !adjust.empty();
}

Result<NmsMode> NmsModeChange::Over(NmsMode mode) const {
  if (type && mode.type != *type) {
    mode.type = *type;
    mode.synthesise.reset();
    mode.adjust.reset();
  }
  if (alpha) mode.weights.alpha = *alpha;
  if (beta) mode.weights.beta = *beta;
  if (gamma) mode.weights.gamma = *gamma;
  if (!synthesise.empty()) mode.synthesise = synthesise;
  if (!adjust.empty()) mode.adjust = adjust;
  if (mode.type == NmsModeType::kOpenLoop && HasDetails())
    return Fail("weights and muscles of a mode were given without --mode hybrid, assisted or optimised");
  return mode;
}

Status ExcitationMode::Find(const Vector& parameters) {
  SINEW_ASSIGN(found_, FindExcitations(problem_, parameters, mode_, free_));
  return {};
}

Status ExcitationMode::AddTo(std::map<std::string, Trial>& trials, const Vector& parameters) const {
  const std::vector<std::string>& muscles = problem_.data().muscles;
  for (std::size_t t = 0; t < found_.size(); ++t) {
    const FoundExcitations& found = found_[t];
    Trial& trial = trials[found.trial];
    std::vector<MuscleTrace<double>> traces;
    SINEW_TRY(problem_.MusclesAt(parameters, t, traces));
    const auto add = [&](const std::string& grid, const std::string& channel, const std::string& unit,
                         std::vector<double> values) {
      trial.grids[grid].time = found.time;
      trial.grids[grid].channels[channel] = {unit, ChannelKind::kMeasured, std::nullopt, std::move(values)};
    };
    const auto values = [](const Vector& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      add("excitations", muscles[m], "1", values(found.excitation[m]));
      if (found.measured[m].size() > 0)
        add("excitations_measured", muscles[m], "1", values(found.measured[m]));
      add("activations", muscles[m], "1", traces[m].activation);
      add("muscle_forces", muscles[m], "N", traces[m].tendon_force);
    }
    add("objective", "objective", "1", values(found.objective));
  }
  return {};
}

Result<BoundMode> BindWithMode(const Dataset& data, const YamlReader& settings, const NmsModeChange& change) {
  SINEW_ASSIGN(const YamlReader section, SettingsSection(settings, "nms"));
  SINEW_ASSIGN(NmsSettings nms, ReadNmsSettings(section, data.files));
  SINEW_ASSIGN(NmsMode mode, change.Over(nms.mode));
  BoundMode made;
  if (mode.type == NmsModeType::kOpenLoop) return made;
  const std::vector<std::string> muscles = MusclesOf(nms.subject, nms.joints);
  SINEW_ASSIGN(FreeMuscles free, ChooseFreeMuscles(mode, muscles, nms.subject, data));
  SINEW_ASSIGN(auto problem, NmsProblem::Make(data, std::move(nms), free.synthesised));
  made.bound.notes = problem->data().notes;
  made.mode = std::make_unique<ExcitationMode>(*problem, std::move(mode), std::move(free));
  made.bound.problem = std::move(problem);
  return made;
}

}  // namespace sinew
