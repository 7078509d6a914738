// Makes one case of the benchmark: a data file without a label, and the truth beside it.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "benchmarks/hidden_effects/further_trial.h"
#include "benchmarks/hidden_effects/oracle.h"
#include "datasets/io/dataset_file.h"

namespace sinew {
namespace {

constexpr const char* kUsage =
    "usage: hidden_effects_generate --kind none|single|pair|outsider --seed N [--size S] "
    "[--noise white|ar|other] [--effect NAME]... [--experiment multisine|trapezoid|over_the_top|cascade] "
    "[--no-correlations] "
    "[--also same|rest|creep|hold|fast|sharp]... --out F.h5 --truth T.json | --list\n";

struct Options {
  std::string kind = "single";
  std::string noise = "white";
  std::string experiment = "multisine";
  std::string out;
  std::string truth;
  std::vector<std::string> effects;
  std::vector<std::string> also;  // kinds of trials that come on top of the ordinary ones
  std::uint64_t seed = 1;
  double size = 2;
  bool correlations = true;
};

Result<Options> ReadOptions(const std::vector<std::string>& words) {
  Options options;
  const std::map<std::string, std::string*> texts{{"--kind", &options.kind},
                                                  {"--noise", &options.noise},
                                                  {"--experiment", &options.experiment},
                                                  {"--out", &options.out},
                                                  {"--truth", &options.truth}};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--no-correlations") {
      options.correlations = false;
      continue;
    }
    if (i + 1 >= words.size()) return Fail("{}: expected a value", word);
    const std::string& value = words[++i];
    const auto text = texts.find(word);
    if (text != texts.end()) {
      *text->second = value;
    } else if (word == "--effect") {
      options.effects.push_back(value);
    } else if (word == "--also") {
      options.also.push_back(value);
    } else if (word == "--seed") {
      const auto seed = ParseInteger(value);
      if (!seed || *seed < 0) return Fail("--seed {}: expected a whole number of at least 0", value);
      options.seed = static_cast<std::uint64_t>(*seed);
    } else if (word == "--size") {
      const auto size = ParseNumber(value);
      if (!size || !(*size > 0 && *size <= 1000)) return Fail("--size {}: expected 0 to 1000", value);
      options.size = *size;
    } else {
      return Fail("'{}' is not known\n{}", word, kUsage);
    }
  }
  const auto one_of = [](const std::string& name, const std::string& value,
                         const std::vector<std::string>& known) -> Status {
    if (std::find(known.begin(), known.end(), value) != known.end()) return {};
    return Fail("{} {}: expected one of {}", name, value, Join(known, ", "));
  };
  SINEW_TRY(one_of("--kind", options.kind, {"none", "single", "pair", "outsider"}));
  SINEW_TRY(one_of("--noise", options.noise, {"white", "ar", "other"}));
  SINEW_TRY(
      one_of("--experiment", options.experiment, {"multisine", "trapezoid", "over_the_top", "cascade"}));
  for (const std::string& effect : options.effects) {
    SINEW_TRY(one_of("--effect", effect, options.kind == "outsider" ? OutsiderNames() : LibraryEffects()));
  }
  for (const std::string& kind : options.also) SINEW_TRY(one_of("--also", kind, FurtherKinds()));
  const std::size_t most = options.kind == "none" ? 0 : options.kind == "pair" ? 2 : 1;
  if (options.effects.size() > most) return Fail("--kind {} takes at most {} --effect", options.kind, most);
  if (options.out.empty() || options.truth.empty()) return Fail("--out and --truth are needed\n{}", kUsage);
  return options;
}

// Random streams of the seed: one per choice, so that a choice does not influence the others.
enum Stream : std::uint64_t { kJoint = 1, kNoise, kChoice, kExperiment, kAlso };

Random StreamOf(const Options& options, std::uint64_t stream) {
  return Random(Random::StreamSeed(options.seed, stream));
}

Result<DrivePlan> DrawPlan(const Options& options) {
  SynthesisRequest request;
  Random joint = StreamOf(options, kJoint);
  request.set["inertia"] = joint.Uniform(0.02, 0.06);
  request.set["viscous_friction"] = joint.Uniform(0.02, 0.1);
  request.set["gravity_torque"] = joint.Uniform(0.2, 1);
  request.set["known_noise"] = 0;
  request.set["excitation"] = options.experiment == "trapezoid" ? 1 : 0;
  if (options.experiment == "cascade") request.set["cascade"] = 2;
  if (options.experiment == "over_the_top") {
    request.set["excitation"] = 2;
    request.set["duration"] = 12;
    request.set["position_noise"] = 0.002;
  }
  Random noise = StreamOf(options, kNoise);
  if (options.noise == "ar") {
    const double rho[] = {0.5, 0.8, 0.9};
    request.set["noise_rho"] = rho[noise.Index(3)];
  } else if (options.noise == "other") {
    request.set["noise_slow"] = 0.5;
    request.set["noise_rho"] = 0.95;
  }
  request.seed = Random::StreamSeed(options.seed, kExperiment);
  return PlanDrive(request);
}

/// The chosen effect, and its size for the oracle.
struct Hidden {
  std::string name;
  DriveTruth alone;  ///< the joint with this effect only
  double unit_ratio = 0;
  Vector signature;
};

Result<std::optional<Hidden>> TryToHide(const Options& options, const Oracle& oracle, const DrivePlan& plan,
                                        const std::string& name, Random& random) {
  const HiddenEffect effect = DrawHidden(name, oracle.extents(), random);
  SINEW_ASSIGN(auto sized, oracle.Amplitude(effect, kUnitNorm * options.size));
  if (!sized) return std::optional<Hidden>();
  Hidden hidden;
  hidden.name = name;
  hidden.alone = plan.truth;
  effect.apply(sized->amplitude, hidden.alone);
  hidden.signature = std::move(sized->signature);
  SINEW_ASSIGN(const auto unit, oracle.Amplitude(effect, kUnitNorm));
  hidden.unit_ratio = unit ? unit->amplitude / sized->amplitude : 0;
  return std::optional<Hidden>(std::move(hidden));
}

// Of a cascade no torque is recorded: its sensor cannot err.
bool Exists(const Options& options, const std::string& effect) {
  return options.experiment != "cascade" || effect.rfind("torque.", 0) != 0;
}

// A constant torque is what the integral of a loop that was running already carries at the begin: no record
// of a cascade shows it.
bool IsAbsorbed(const Options& options, const std::string& effect) {
  return options.experiment == "cascade" && effect == "torque_offset";
}

// Draws effects until one can have the wanted size with sensible parameters (a hold of one sample, say, may
// not be as large as six units).
Result<std::vector<Hidden>> Hide(const Options& options, const Oracle& oracle, const DrivePlan& plan) {
  std::vector<Hidden> hidden;
  const std::size_t wanted = options.kind == "none" ? 0 : options.kind == "pair" ? 2 : 1;
  std::vector<std::string> names = options.kind == "outsider" ? OutsiderNames() : LibraryEffects();
  if (options.experiment == "over_the_top") {
    // Of a size that is just noticed they are delays below a microsecond; what is then noticed is the
    // straight line between samples of the recorded torque.
    names.erase(std::remove_if(names.begin(), names.end(),
                               [](const std::string& name) {
                                 return name == "torque.time_offset" || name == "torque.low_pass";
                               }),
                names.end());
  }
  names.erase(std::remove_if(names.begin(), names.end(),
                             [&](const std::string& name) { return !Exists(options, name); }),
              names.end());
  Random random = StreamOf(options, kChoice);
  constexpr int kMaxTries = 50;
  for (int tries = 0; hidden.size() < wanted; ++tries) {
    const bool named = hidden.size() < options.effects.size();
    const std::string name = named ? options.effects[hidden.size()] : names[random.Index(names.size())];
    if (!hidden.empty() && hidden.front().name == name) continue;
    if (!named && IsAbsorbed(options, name)) continue;
    SINEW_ASSIGN(auto one, TryToHide(options, oracle, plan, name, random));
    if (one) {
      hidden.push_back(std::move(*one));
    } else if (named || tries > kMaxTries) {
      return Fail("{} cannot have a size of {} in this experiment", name, options.size);
    }
  }
  return hidden;
}

nlohmann::json ParametersOf(const std::string& effect, const DriveTruth& truth) {
  nlohmann::json parameters = nlohmann::json::object();
  for (const DriveTruthEntry& entry : DriveTruthEntries("torque")) {
    if (entry.effect == effect) parameters[entry.parameter] = truth[entry.slot];
  }
  return parameters;
}

std::string DependsOn(const std::string& effect) {
  for (const DriveTruthEntry& entry : DriveTruthEntries("torque")) {
    if (entry.effect == effect) return entry.depends_on;
  }
  return "";
}

// Appends the trials of a further plan to those of a case, to train on.
Status Append(const DrivePlan& further, const std::vector<std::string>& kinds, Dataset& data) {
  SINEW_ASSIGN(Dataset recorded, RecordDrive(further));
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    Trial& trial = recorded.trials.at(fmt::format("train_{}", i + 1));
    trial.task = kinds[i];
    data.trials[fmt::format("train_also_{}_{}", i + 1, kinds[i])] = std::move(trial);
  }
  return data.Check();
}

Status Generate(const Options& options) {
  SINEW_ASSIGN(DrivePlan plan, DrawPlan(options));
  SINEW_ASSIGN(const Oracle oracle, Oracle::Make(plan));
  SINEW_ASSIGN(const std::vector<Hidden> hidden, Hide(options, oracle, plan));

  // Further trials are drawn after the effect was sized, and do not change the ordinary trials.
  SINEW_ASSIGN(DrivePlan further, PlanFurther(plan, options.also, Random::StreamSeed(options.seed, kAlso)));
  const DriveTruth joint = plan.truth;
  for (const Hidden& one : hidden) {
    for (const DriveTruthEntry& entry : DriveTruthEntries("torque")) {
      if (entry.effect == one.name) plan.truth[entry.slot] = one.alone[entry.slot];
    }
  }
  further.truth = plan.truth;
  std::vector<DriveTrial> recorded = plan.trials;
  recorded.insert(recorded.end(), further.trials.begin(), further.trials.end());
  SINEW_ASSIGN(const double scale, CommandScale(plan.truth, recorded));

  nlohmann::json truth;
  truth["schema"] = "sinew.hidden_effect/1";
  truth["kind"] = options.kind;
  truth["seed"] = options.seed;
  truth["experiment"] = options.experiment;
  truth["size"] = options.size;
  if (!options.also.empty()) truth["also"] = options.also;
  truth["unit_norm"] = kUnitNorm;
  truth["base"] = {{"inertia", joint[kInertia]},
                   {"viscous_friction", joint[kViscousFriction]},
                   {"gravity_torque", joint[kGravityTorque]}};
  truth["noise"] = {{"kind", options.noise},
                    {"sigma", plan.position_noise.sigma},
                    {"rho", plan.position_noise.rho},
                    {"slow_share", plan.position_noise.rho > 0 ? plan.position_noise.slow_share : 0}};
  truth["effects"] = nlohmann::json::array();
  const Vector noise = oracle.Noise();
  for (const Hidden& one : hidden) {
    // The model's compression is given by the largest command that was recorded.
    DriveTruth stated = one.alone;
    stated[kCompression] *= scale / plan.trials.front().command_scale;
    nlohmann::json effect{
        {"name", one.name},
        {"parameters", ParametersOf(one.name, stated)},
        {"norm", one.signature.norm()},
        {"unit_share_of_amplitude", one.unit_ratio},
        {"statistic", one.signature.norm() + one.signature.dot(noise) / one.signature.norm()}};
    if (options.kind == "outsider") effect["depends_on"] = DependsOn(one.name);
    for (const std::string& other : LibraryEffects()) {
      if (!options.correlations || other == one.name || !Exists(options, other)) continue;
      SINEW_ASSIGN(effect["correlations"][other], oracle.Correlation(one.signature, other));
    }
    truth["effects"].push_back(std::move(effect));
  }
  if (hidden.size() == 2) {
    truth["pair_correlation"] =
        std::abs(hidden[0].signature.normalized().dot(hidden[1].signature.normalized()));
  }
  Vector whole;
  if (hidden.size() == 1) {
    whole = hidden.front().signature;
  } else {
    SINEW_ASSIGN(whole, oracle.Signature(plan.truth));
  }
  truth["oracle_norm"] = whole.norm();

  SINEW_ASSIGN(Dataset data, RecordDrive(plan));
  if (!options.also.empty()) SINEW_TRY(Append(further, options.also, data));
  SINEW_TRY(WriteDataset(options.out, data));
  std::ofstream file(options.truth);
  file << truth.dump(1) << "\n";
  if (!file) return Fail("{}: cannot be written", options.truth);
  return {};
}

}  // namespace
}  // namespace sinew

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words == std::vector<std::string>{"--list"}) {
    for (const auto& name : sinew::LibraryEffects()) std::printf("library %s\n", name.c_str());
    for (const auto& name : sinew::OutsiderNames()) std::printf("outsider %s\n", name.c_str());
    return 0;
  }
  const auto options = sinew::ReadOptions(words);
  const sinew::Status done = options ? sinew::Generate(*options) : tl::unexpected(options.error());
  if (!done) {
    std::fprintf(stderr, "hidden_effects_generate: error: %s\n", done.error().message.c_str());
    return 2;
  }
  return 0;
}
