#include "problems/nms/excitation/mode.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sinew {
namespace {

struct ModeName {
  NmsModeType type;
  const char* name;
};
constexpr ModeName kModes[] = {{NmsModeType::kOpenLoop, "open_loop"},
                               {NmsModeType::kHybrid, "hybrid"},
                               {NmsModeType::kAssisted, "assisted"},
                               {NmsModeType::kOptimised, "optimised"}};

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The first trial in which a signal of the muscle was not recorded; empty: in none.
std::string TrialWithout(const Dataset& data, const Subject& subject, const std::string& muscle) {
  const std::vector<std::string> sources = ExcitationSources(subject, muscle);
  for (const auto& [name, trial] : data.trials) {
    const auto grid = trial.grids.find("excitations");
    const bool all = grid != trial.grids.end() && !sources.empty() &&
                     std::all_of(sources.begin(), sources.end(), [&](const std::string& source) {
                       return grid->second.channels.count(source) > 0;
                     });
    if (!all) return name;
  }
  return {};
}

Result<std::vector<std::string>> ReadNames(const YamlReader& yaml, const std::string& key,
                                           const std::string& what, const std::vector<std::string>& known) {
  SINEW_ASSIGN(const YamlReader list, yaml.At(key));
  SINEW_ASSIGN(auto names, list.Texts());
  for (const std::string& name : names) {
    if (!Contains(known, name))
      return FailAt(yaml.file(), list.line(), "mode: {}: there is no {} '{}'{}", key, what, name,
                    Suggestion(name, known));
  }
  return names;
}

Status CheckWeight(const char* name, double weight, bool may_be_0) {
  if (std::isfinite(weight) && (weight > 0 || (may_be_0 && weight == 0))) return {};
  return Fail("{} = {}: expected a number {} 0", name, weight, may_be_0 ? "of at least" : "above");
}

Status CheckMuscles(const char* list, const std::vector<std::string>& names,
                    const std::vector<std::string>& muscles) {
  for (const std::string& name : names) {
    if (!Contains(muscles, name))
      return Fail("{}: no joint that is fitted has the muscle '{}'{}", list, name, Suggestion(name, muscles));
  }
  return {};
}

}  // namespace

Result<NmsModeType> ParseNmsMode(const std::string& word) {
  std::vector<std::string> names;
  for (const ModeName& mode : kModes) {
    if (word == mode.name) return mode.type;
    names.emplace_back(mode.name);
  }
  return Fail("there is no mode '{}'{}", word, Suggestion(word, names));
}

std::string ToString(NmsModeType type) {
  return std::find_if(std::begin(kModes), std::end(kModes), [&](const ModeName& m) { return m.type == type; })
      ->name;
}

std::vector<std::string> ExcitationSources(const Subject& subject, const std::string& muscle) {
  if (subject.channels.empty()) return {muscle};
  std::vector<std::string> sources;
  for (const auto& [channel, excited] : subject.channels) {
    if (Contains(excited, muscle)) sources.push_back(channel);
  }
  return sources;
}

Result<NmsMode> ReadNmsMode(const YamlReader& yaml, const std::vector<std::string>& muscles,
                            const std::vector<std::string>& joints) {
  SINEW_TRY(yaml.OnlyKeys({"type", "alpha", "beta", "gamma", "synthesise", "adjust", "joints"}));
  NmsMode mode;
  SINEW_ASSIGN(const YamlReader type, yaml.At("type"));
  SINEW_ASSIGN(const std::string word, type.Text());
  const auto parsed = ParseNmsMode(word);
  if (!parsed) return FailAt(yaml.file(), type.line(), "mode: type: {}", parsed.error().message);
  mode.type = *parsed;
  struct Weight {
    const char* name;
    double& value;
    bool may_be_0;
  };
  for (const Weight& weight :
       {Weight{"alpha", mode.weights.alpha, false}, Weight{"beta", mode.weights.beta, true},
        Weight{"gamma", mode.weights.gamma, true}}) {
    SINEW_ASSIGN(weight.value, yaml.NumberOr(weight.name, weight.value));
    const Status status = CheckWeight(weight.name, weight.value, weight.may_be_0);
    if (status) continue;
    SINEW_ASSIGN(const YamlReader at, yaml.At(weight.name));
    return FailAt(yaml.file(), at.line(), "mode: {}", status.error().message);
  }
  if (yaml.Has("synthesise")) {
    SINEW_ASSIGN(mode.synthesise, ReadNames(yaml, "synthesise", "muscle", muscles));
  }
  if (yaml.Has("adjust")) {
    SINEW_ASSIGN(mode.adjust, ReadNames(yaml, "adjust", "muscle", muscles));
  }
  if (yaml.Has("joints")) {
    SINEW_ASSIGN(mode.joints, ReadNames(yaml, "joints", "joint that is fitted", joints));
  }
  return mode;
}

Result<FreeMuscles> ChooseFreeMuscles(const NmsMode& mode, const std::vector<std::string>& muscles,
                                      const Subject& subject, const Dataset& data) {
  SINEW_TRY(CheckWeight("alpha", mode.weights.alpha, false));
  SINEW_TRY(CheckWeight("beta", mode.weights.beta, true));
  SINEW_TRY(CheckWeight("gamma", mode.weights.gamma, true));
  FreeMuscles chosen;
  if (mode.type == NmsModeType::kOptimised) {
    if (mode.synthesise || (mode.adjust && !mode.adjust->empty()))
      return Fail("mode optimised finds the excitations of all muscles: expected no list of muscles");
    chosen.synthesised = muscles;
    return chosen;
  }
  if (mode.synthesise) SINEW_TRY(CheckMuscles("synthesise", *mode.synthesise, muscles));
  if (mode.adjust) SINEW_TRY(CheckMuscles("adjust", *mode.adjust, muscles));
  for (const std::string& muscle : muscles) {
    const std::string without = TrialWithout(data, subject, muscle);
    const bool listed = mode.synthesise && Contains(*mode.synthesise, muscle);
    const bool synthesised = mode.synthesise ? listed : !without.empty();
    const bool adjust =
        mode.adjust ? Contains(*mode.adjust, muscle) : mode.type == NmsModeType::kAssisted && !synthesised;
    if (listed && mode.adjust && adjust)
      return Fail("the muscle '{}' is to be synthesised and to be adjusted: expected one of them", muscle);
    if (!without.empty() && (adjust || !synthesised)) {
      return Fail("trial '{}': the muscle '{}' has no measured excitation: expected it among those to {}",
                  without, muscle, "synthesise");
    }
    if (synthesised) {
      chosen.synthesised.push_back(muscle);
      if (without.empty())
        chosen.notes.push_back(fmt::format("muscle '{}': its measured excitation is not looked at", muscle));
    } else if (adjust) {
      chosen.adjusted.push_back(muscle);
    }
  }
  if (chosen.synthesised.empty() && chosen.adjusted.empty()) {
    return Fail(
        "mode {}: every muscle has a measured excitation and none is to be synthesised or adjusted: "
        "nothing to find",
        ToString(mode.type));
  }
  return chosen;
}

}  // namespace sinew
