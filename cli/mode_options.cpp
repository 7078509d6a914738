#include "cli/mode_options.h"

#include <cstdio>

#include "base/text.h"
#include "cli/terminal.h"

namespace sinew {

void ModeOptions::AddTo(Command command) {
  command.Add("--mode", type, "nms: where excitations come from; default: `mode` of the settings")
      .Shows("open_loop|hybrid|assisted|optimised");
  command.Add("--alpha", change.alpha, "Weight of the squared errors of the moments").Shows("W");
  command.Add("--beta", change.beta, "Weight of the squared excitations").Shows("W");
  command.Add("--gamma", change.gamma, "Weight of the distance to the measured excitations").Shows("W");
  command.Add("--synthesise", change.synthesise, "Muscles whose excitation is found").Split(',').Shows("M,N");
  command.Add("--adjust", change.adjust, "Muscles whose measured excitation is adjusted")
      .Split(',')
      .Shows("M,N");
}

Status ModeOptions::CheckFor(const std::string& problem) {
  const bool details = change.HasDetails();
  if (problem != "nms" && (details || !type.empty()))
    return Fail("--mode, its weights and its muscles: the problem '{}' has none, only nms has", problem);
  if (type == "open_loop" && details)
    return Fail("--mode open_loop takes excitations as measured: expected neither weights nor muscles");
  if (type.empty()) return {};
  const auto parsed = ParseNmsMode(type);
  if (!parsed) return Fail("--mode: {}", parsed.error().message);
  change.type = *parsed;
  return {};
}

void PrintExcitations(const ExcitationMode& mode, bool table) {
  std::vector<std::vector<std::string>> rows{
      {"trial", "frames", "objective per frame", "above the least by at most"}};
  std::vector<std::string> notes = mode.free().notes;
  for (const FoundExcitations& found : mode.found()) {
    rows.push_back({found.trial, std::to_string(found.time.size()),
                    fmt::format("{:.4g}", found.objective.mean()), fmt::format("{:.2g}", found.gap.mean())});
    const auto without = static_cast<int>(found.time.size()) - found.followed;
    if (without > 0)
      notes.push_back(fmt::format("trial '{}': {} frames have no measured moment", found.trial, without));
    for (std::size_t m = 0; m < found.slack.size(); ++m) {
      if (found.slack[m] == 0) continue;
      notes.push_back(
          fmt::format("trial '{}', {}: in {} of {} frames its tendon is slack and no excitation changes its "
                      "force within a "
                      "frame, so it is not found in time; a rigid tendon does not have that",
                      found.trial, mode.muscles()[m], found.slack[m], found.time.size()));
    }
    if (found.unsettled > 0)
      notes.push_back(
          fmt::format("trial '{}': the search did not converge in {} frames", found.trial, found.unsettled));
  }
  const ExcitationWeights& weights = mode.mode().weights;
  if (table) {
    Print(stdout, fmt::format("mode {}: alpha {:g}, beta {:g}, gamma {:g}; excitations of {} muscles were "
                              "found, of {} adjusted\n",
                              ToString(mode.mode().type), weights.alpha, weights.beta, weights.gamma,
                              mode.free().synthesised.size(), mode.free().adjusted.size()));
    Print(stdout, Table(rows, 1));
  }
  for (const std::string& note : notes) Print(stderr, Wrapped("note: " + note, 0));
}

}  // namespace sinew
