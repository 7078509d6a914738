#include "identify/diagnosis/score/quantised_channels.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/observation/quantisation.h"

namespace sinew::diagnosis {
namespace {

std::string EffectOf(const std::string& channel) {
  return channel + ".quantisation";
}

}  // namespace

Result<std::vector<Quantisation>> FindQuantisation(const Problem& problem, const Vector& point) {
  constexpr double kQuantisationTolerance = 0.02;  // of QuantisationStep
  struct Channel {
    std::string unit;
    std::vector<double> measured;
    double squares = 0;
  };
  std::map<std::string, Channel> channels;
  const Layout& layout = problem.layout();
  std::vector<bool> wanted(layout.size(), false);
  for (std::size_t b = 0; b < layout.size(); ++b) wanted[b] = layout[b].role == BlockRole::kTrain;
  Prediction prediction(layout);
  const auto workspace = problem.NewWorkspace();
  SINEW_TRY(problem.Predict({point, wanted, false, nullptr}, *workspace, prediction));
  for (std::size_t b = 0; b < layout.size(); ++b) {
    if (!wanted[b]) continue;
    const Block& block = layout[b];
    const auto predicted = prediction.values(static_cast<int>(b));
    Channel& channel = channels[block.channel];
    channel.unit = block.unit;
    for (std::size_t i = 0; i < block.measured.size(); ++i) {
      channel.measured.push_back(block.measured[i]);
      channel.squares += std::pow(predicted[block.sample[i]] - block.measured[i], 2);
    }
  }
  std::vector<Quantisation> found;
  for (const auto& [name, channel] : channels) {
    const auto step = QuantisationStep(channel.measured);
    const std::string of_channel = EffectOf(name);
    const bool known = std::any_of(problem.effects().begin(), problem.effects().end(),
                                   [&](const Effect& effect) { return effect.name == of_channel; });
    if (!step || !known || !(channel.squares > 0)) continue;
    const auto samples = static_cast<double>(channel.measured.size());
    double largest = 0;
    for (const double value : channel.measured) largest = std::max(largest, std::abs(value));
    found.push_back({name, channel.unit, of_channel, *step,
                     kQuantisationTolerance * *step / std::max(1.0, largest / *step),
                     samples * (*step * *step / 12) / (channel.squares / samples)});
  }
  return found;
}

void RemoveQuantisation(const Problem& problem, std::vector<Candidate>& candidates) {
  for (const Block& block : problem.layout()) {
    candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                    [&](const Candidate& c) {
                                      const std::string kind = c.effect.substr(0, c.effect.rfind('@'));
                                      return kind == EffectOf(block.channel);
                                    }),
                     candidates.end());
  }
}

}  // namespace sinew::diagnosis
