#include "cli/excitation_mode.h"

#include <cstdio>

#include "base/text.h"
#include "cli/terminal.h"

namespace sinew {

void ModeWords::AddTo(Command command) {
  command.Add("--mode", type, "nms: where excitations come from; default: `mode` of the settings")
      .Shows("open_loop|hybrid|assisted|optimised");
  command.Add("--alpha", alpha, "Weight of the squared errors of the moments").Shows("W");
  command.Add("--beta", beta, "Weight of the squared excitations").Shows("W");
  command.Add("--gamma", gamma, "Weight of the distance to the measured excitations").Shows("W");
  command.Add("--synthesise", synthesise, "Muscles whose excitation is found").Split(',').Shows("M,N");
  command.Add("--adjust", adjust, "Muscles whose measured excitation is adjusted").Split(',').Shows("M,N");
}

Status ModeWords::CheckFor(const std::string& problem) const {
  const bool others = alpha || beta || gamma || !synthesise.empty() || !adjust.empty();
  if (problem != "nms" && (others || !type.empty()))
    return Fail("--mode, its weights and its muscles: the problem '{}' has none, only nms has", problem);
  if (type == "open_loop" && others)
    return Fail("--mode open_loop takes excitations as measured: expected neither weights nor muscles");
  if (type.empty()) return {};
  const auto parsed = ParseNmsMode(type);
  return parsed ? Status() : Fail("--mode: {}", parsed.error().message);
}

Result<NmsMode> ModeWords::Over(NmsMode mode) const {
  if (!type.empty()) {
    SINEW_ASSIGN(const NmsModeType parsed, ParseNmsMode(type));
    if (mode.type != parsed) {
      mode.type = parsed;
      mode.synthesise.reset();
      mode.adjust.reset();
    }
  }
  if (alpha) mode.weights.alpha = *alpha;
  if (beta) mode.weights.beta = *beta;
  if (gamma) mode.weights.gamma = *gamma;
  if (!synthesise.empty()) mode.synthesise = synthesise;
  if (!adjust.empty()) mode.adjust = adjust;
  const bool any = alpha || beta || gamma || !synthesise.empty() || !adjust.empty();
  if (mode.type == NmsModeType::kOpenLoop && any)
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

void ExcitationMode::Print() const {
  std::vector<std::vector<std::string>> rows{
      {"trial", "frames", "objective per frame", "above the least by at most"}};
  std::vector<std::string> notes = free_.notes;
  for (const FoundExcitations& found : found_) {
    rows.push_back({found.trial, std::to_string(found.time.size()),
                    fmt::format("{:.4g}", found.objective.mean()), fmt::format("{:.2g}", found.gap.mean())});
    const auto without = static_cast<int>(found.time.size()) - found.followed;
    if (without > 0)
      notes.push_back(fmt::format("trial '{}': {} frames have no moment to follow", found.trial, without));
    for (std::size_t m = 0; m < found.slack.size(); ++m) {
      if (found.slack[m] == 0) continue;
      notes.push_back(
          fmt::format("trial '{}', {}: in {} of {} frames its tendon hangs slack and no excitation moves its "
                      "force within a "
                      "frame, so it is not found in time; a rigid tendon does not have that",
                      found.trial, problem_.data().muscles[m], found.slack[m], found.time.size()));
    }
    if (found.unsettled > 0)
      notes.push_back(
          fmt::format("trial '{}': the search did not settle in {} frames", found.trial, found.unsettled));
  }
  std::printf(
      "mode %s: alpha %g, beta %g, gamma %g; excitations of %zu muscles were found, of %zu adjusted\n",
      ToString(mode_.type).c_str(), mode_.weights.alpha, mode_.weights.beta, mode_.weights.gamma,
      free_.synthesised.size(), free_.adjusted.size());
  std::fputs(Table(rows, 1).c_str(), stdout);
  for (const std::string& note : notes) std::fputs(Wrapped("note: " + note, 0).c_str(), stderr);
}

Result<Binding> BindWithMode(const BindingOptions& options, const ModeWords& words,
                             std::unique_ptr<ExcitationMode>& mode) {
  return Bind(options, [&](const Dataset& data, const YamlReader& yaml) -> Result<BoundProblem> {
    SINEW_TRY(yaml.OnlyKeys({"nms"}));
    SINEW_ASSIGN(const YamlReader section, yaml.At("nms"));
    SINEW_ASSIGN(NmsSettings settings, ReadNmsSettings(section, data.files));
    SINEW_ASSIGN(NmsMode asked, words.Over(settings.mode));
    if (asked.type == NmsModeType::kOpenLoop) return BoundProblem();
    const std::vector<std::string> muscles = MusclesOf(settings.subject, settings.joints);
    SINEW_ASSIGN(FreeMuscles free, ChooseFreeMuscles(asked, muscles, settings.subject, data));
    SINEW_ASSIGN(auto problem, NmsProblem::Make(data, std::move(settings), free.synthesised));
    BoundProblem bound;
    bound.notes = problem->data().notes;
    mode = std::make_unique<ExcitationMode>(*problem, std::move(asked), std::move(free));
    bound.problem = std::move(problem);
    return bound;
  });
}

}  // namespace sinew
