#include "problems/nms/settings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "base/yaml_choice.h"
#include "problems/nms/ceinms/subject.h"

namespace sinew {
namespace {

Status ReadSubject(const YamlReader& yaml, const std::map<std::string, std::string>& files,
                   NmsSettings& settings) {
  SINEW_ASSIGN(const YamlReader name_value, yaml.At("subject"));
  SINEW_ASSIGN(const std::string name, name_value.Text());
  const auto file = files.find(name);
  if (file == files.end())
    return FailAt(yaml.file(), name_value.line(), "the data set holds no file '{}': import it first", name);
  SINEW_ASSIGN(CeinmsSubject read, ReadCeinmsSubject(file->second, name));
  settings.notes = std::move(read.notes);
  settings.subject = std::move(read.subject);
  settings.subject_file = name;
  settings.subject_text = file->second;
  const auto original = files.find(OriginalSubjectName(name));
  if (original != files.end()) settings.subject_original = original->second;
  return {};
}

Status ReadParameter(const YamlReader& yaml, const MuscleParameterName& parameter,
                     const std::vector<std::string>& muscles, NmsSettings& settings) {
  SINEW_TRY(yaml.OnlyKeys({"share", "groups", "lower", "upper", "relative", "prior"}));
  NmsParameterSetting setting;
  setting.slot = parameter.slot;
  for (const auto& [key, target] : {std::pair{"lower", &setting.lower}, std::pair{"upper", &setting.upper}}) {
    SINEW_ASSIGN(const YamlReader value, yaml.At(key));
    SINEW_ASSIGN(*target, value.Number());
  }
  if (!(setting.lower < setting.upper))
    return FailAt(yaml.file(), yaml.line(), "{}: lower {} is not below upper {}", parameter.name,
                  setting.lower, setting.upper);
  SINEW_ASSIGN(setting.relative, ReadChoice<bool>(yaml, "relative", {{"false", false}, {"true", true}}));
  if (yaml.Has("prior")) {
    SINEW_ASSIGN(const YamlReader prior, yaml.At("prior"));
    SINEW_ASSIGN(setting.prior, prior.Number());
    if (!(*setting.prior > 0))
      return FailAt(yaml.file(), prior.line(), "{}: prior: a standard deviation, expected above 0, not {}",
                    parameter.name, *setting.prior);
  }
  if (yaml.Has("groups")) {
    SINEW_ASSIGN(const YamlReader groups, yaml.At("groups"));
    SINEW_ASSIGN(const auto names, groups.Keys());
    std::set<std::string> seen;
    for (const std::string& name : names) {
      SINEW_ASSIGN(const YamlReader list, groups.At(name));
      SINEW_ASSIGN(setting.muscles, list.Texts());
      for (const std::string& muscle : setting.muscles) {
        if (std::find(muscles.begin(), muscles.end(), muscle) == muscles.end())
          return FailAt(yaml.file(), list.line(), "no joint that is fitted has the muscle '{}'{}", muscle,
                        Suggestion(muscle, muscles));
        if (!seen.insert(muscle).second)
          return FailAt(yaml.file(), list.line(), "the muscle '{}' is in two groups of {}", muscle,
                        parameter.name);
      }
      if (setting.muscles.empty()) return FailAt(yaml.file(), list.line(), "group '{}' has no muscle", name);
      setting.group = name;
      settings.parameters.push_back(setting);
    }
    return {};
  }
  SINEW_ASSIGN(const bool alone, ReadChoice<bool>(yaml, "share", {{"single", true}, {"global", false}}));
  if (!alone) {
    setting.group = "all";
    setting.muscles = muscles;
    settings.parameters.push_back(setting);
    return {};
  }
  for (const std::string& muscle : muscles) {
    setting.group = muscle;
    setting.muscles = {muscle};
    settings.parameters.push_back(setting);
  }
  return {};
}

Result<FibreRange> ReadFibreRange(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"lower", "upper", "tolerance", "as"}));
  FibreRange range;
  SINEW_ASSIGN(range.lower, yaml.NumberOr("lower", range.lower));
  SINEW_ASSIGN(range.upper, yaml.NumberOr("upper", range.upper));
  SINEW_ASSIGN(range.tolerance, yaml.NumberOr("tolerance", range.tolerance));
  if (!(range.lower < range.upper))
    return FailAt(yaml.file(), yaml.line(), "fibre_range: lower {} is not below upper {}", range.lower,
                  range.upper);
  if (!(range.tolerance > 0))
    return FailAt(yaml.file(), yaml.line(), "fibre_range: tolerance is {}, expected above 0",
                  range.tolerance);
  SINEW_ASSIGN(range.strict, ReadChoice<bool>(yaml, "as", {{"penalty", false}, {"constraint", true}}));
  return range;
}

// @param known the parameters that the settings have
Status ReadSteps(const YamlReader& yaml, const std::vector<std::string>& known, NmsSettings& settings) {
  SINEW_ASSIGN(const auto steps, yaml.Items());
  const auto read = [&](const YamlReader& step, const char* key, const std::vector<std::string>& names,
                        const char* what, std::vector<std::string>& chosen) -> Status {
    SINEW_ASSIGN(const YamlReader list, step.At(key));
    SINEW_ASSIGN(chosen, list.Texts());
    if (chosen.empty()) return FailAt(yaml.file(), list.line(), "steps: {}: expected at least one", key);
    for (const std::string& name : chosen) {
      if (std::find(names.begin(), names.end(), name) == names.end())
        return FailAt(yaml.file(), list.line(), "steps: '{}' is no {} that is fitted{}", name, what,
                      Suggestion(name, names));
    }
    return {};
  };
  for (const YamlReader& step : steps) {
    SINEW_TRY(step.OnlyKeys({"joints", "parameters"}));
    NmsStep made;
    made.joints = settings.joints;
    if (step.Has("joints")) SINEW_TRY(read(step, "joints", settings.joints, "joint", made.joints));
    SINEW_TRY(read(step, "parameters", known, "parameter", made.parameters));
    settings.steps.push_back(std::move(made));
  }
  return {};
}

}  // namespace

std::vector<std::string> MusclesOf(const Subject& subject, const std::vector<std::string>& joints) {
  std::vector<std::string> muscles;
  for (const auto& [joint, movers] : subject.dofs) {
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) continue;
    for (const std::string& muscle : movers) {
      if (std::find(muscles.begin(), muscles.end(), muscle) == muscles.end()) muscles.push_back(muscle);
    }
  }
  return muscles;
}

const std::vector<MuscleParameterName>& MuscleParameterNames() {
  static const std::vector<MuscleParameterName> kNames{
      {"filter_mean", kFilterMean, "", "mean pole of the activation filter", "Lloyd, Besier 2003"},
      {"filter_spread", kFilterSpread, "1", "distance of the filter's poles, squared", "Lloyd, Besier 2003"},
      {"shape", kShape, "1", "shape factor of the activation curve", "thesis eq 4.1"},
      {"delay", kDelay, "s", "electromechanical delay", "thesis ch. 4"},
      {"optimal_length", kOptimalLength, "m", "optimal fibre length", "thesis eq 4.2"},
      {"tendon_slack_length", kTendonSlackLength, "m", "tendon slack length", "thesis eq 4.4"},
      {"isometric_force", kIsometricForce, "N", "greatest isometric force", "thesis eq 4.3"},
      {"strength", kStrength, "1", "factor on the greatest isometric force", "thesis eq 4.3"},
      {"pennation", kPennation, "rad", "pennation angle at optimal length", "thesis eq 4.4"},
      {"length_change", kLengthChange, "1", "optimal length gained without activation", "thesis eq 4.2"},
      {"damping", kDamping, "1", "damping of the fibre", "thesis eq 4.3"},
      {"largest_velocity", kLargestVelocity, "1/s", "greatest shortening velocity in optimal lengths",
       "Buchanan et al. 2004"},
  };
  return kNames;
}

Result<NmsSettings> ReadNmsSettings(const YamlReader& yaml, const std::map<std::string, std::string>& files) {
  SINEW_TRY(yaml.OnlyKeys({"subject", "tendon", "activation", "as_ceinms", "joints", "objective",
                           "fibre_range", "steps", "mode", "parameters"}));
  NmsSettings settings;
  SINEW_TRY(ReadSubject(yaml, files, settings));
  SINEW_ASSIGN(settings.model.tendon, ReadChoice<TendonMode>(yaml, "tendon",
                                                             {{"rigid", TendonMode::kRigid},
                                                              {"equilibrium", TendonMode::kEquilibrium},
                                                              {"elastic", TendonMode::kElastic}}));
  SINEW_ASSIGN(settings.model.shape,
               ReadChoice<ActivationShape>(yaml, "activation",
                                           {{"exponential", ActivationShape::kExponential},
                                            {"piecewise", ActivationShape::kPiecewise}}));
  SINEW_ASSIGN(settings.model.as_ceinms,
               ReadChoice<bool>(yaml, "as_ceinms", {{"false", false}, {"true", true}}));
  SINEW_ASSIGN(settings.objective,
               ReadChoice<NmsObjective>(
                   yaml, "objective", {{"noise", NmsObjective::kNoise}, {"thesis", NmsObjective::kThesis}}));
  if (yaml.Has("fibre_range")) {
    SINEW_ASSIGN(const YamlReader range, yaml.At("fibre_range"));
    SINEW_ASSIGN(settings.fibre_range, ReadFibreRange(range));
  }
  std::vector<std::string> known;
  for (const auto& [joint, muscles] : settings.subject.dofs) known.push_back(joint);
  settings.joints = known;
  if (yaml.Has("joints")) {
    SINEW_ASSIGN(const YamlReader joints, yaml.At("joints"));
    SINEW_ASSIGN(settings.joints, joints.Texts());
    if (settings.joints.empty()) return FailAt(yaml.file(), joints.line(), "joints: expected at least one");
    for (const std::string& joint : settings.joints) {
      if (std::find(known.begin(), known.end(), joint) == known.end())
        return FailAt(yaml.file(), joints.line(), "the subject has no joint coordinate '{}'{}", joint,
                      Suggestion(joint, known));
    }
  }
  const std::vector<std::string> muscles = MusclesOf(settings.subject, settings.joints);
  for (const std::string& name : muscles) {
    const SubjectMuscle& muscle = *settings.subject.Find(name);
    if (settings.model.as_ceinms || (muscle.c1 <= 0 && muscle.c2 <= 0)) continue;
    settings.notes.push_back(
        fmt::format("muscle '{}': C1 = {}, C2 = {}; above 0 there is no time constant, and the filter begins "
                    "with next to none",
                    name, muscle.c1, muscle.c2));
  }
  if (yaml.Has("mode")) {
    SINEW_ASSIGN(const YamlReader mode, yaml.At("mode"));
    SINEW_ASSIGN(settings.mode, ReadNmsMode(mode, muscles, settings.joints));
  }
  SINEW_ASSIGN(const YamlReader parameters, yaml.At("parameters"));
  SINEW_ASSIGN(const auto keys, parameters.Keys());
  std::vector<std::string> names;
  for (const MuscleParameterName& parameter : MuscleParameterNames()) names.emplace_back(parameter.name);
  SINEW_TRY(parameters.OnlyKeys(names));
  for (const MuscleParameterName& parameter : MuscleParameterNames()) {
    if (std::find(keys.begin(), keys.end(), parameter.name) == keys.end()) continue;
    SINEW_ASSIGN(const YamlReader one, parameters.At(parameter.name));
    SINEW_TRY(ReadParameter(one, parameter, muscles, settings));
  }
  if (settings.parameters.empty())
    return FailAt(yaml.file(), parameters.line(), "parameters: nothing is to be found");
  if (yaml.Has("steps")) {
    SINEW_ASSIGN(const YamlReader steps, yaml.At("steps"));
    SINEW_TRY(ReadSteps(steps, keys, settings));
  }
  return settings;
}

Result<MuscleCurves> CurvesOf(const Subject& subject, bool as_ceinms) {
  const auto curve = [&](SubjectCurve which) {
    const CurvePoints& points = subject.curves[which];
    return as_ceinms ? MuscleCurve::Natural(points.x, points.y) : MuscleCurve::Smooth(points.x, points.y);
  };
  SINEW_ASSIGN(auto active, curve(kActiveForceLength));
  SINEW_ASSIGN(auto passive, curve(kPassiveForceLength));
  SINEW_ASSIGN(auto velocity, curve(kForceVelocity));
  SINEW_ASSIGN(auto tendon, curve(kTendonForceStrain));
  return MuscleCurves{std::move(active), std::move(passive), std::move(velocity), std::move(tendon)};
}

std::array<double, kMuscleSlots> SlotsOf(const SubjectMuscle& muscle, bool as_ceinms, double rate) {
  double mean = 0.5 * (muscle.c1 + muscle.c2);
  double spread = std::pow(0.5 * (muscle.c1 - muscle.c2) / (1 + mean), 2);
  if (!as_ceinms) {
    // Poles decay at rates that do not depend on the sampling; a coefficient of 0 has no memory at all.
    constexpr double kFastest = 1e-6;
    const double fast = -std::log(std::clamp(-muscle.c1, kFastest, 1 - kFastest)) * rate;
    const double slow = -std::log(std::clamp(-muscle.c2, kFastest, 1 - kFastest)) * rate;
    mean = 2 / (fast + slow);
    spread = std::pow((fast - slow) / (fast + slow), 2);
  }
  std::array<double, kMuscleSlots> slots{};
  slots[kFilterMean] = mean;
  slots[kFilterSpread] = spread;
  slots[kShape] = muscle.shape_factor;
  slots[kDelay] = muscle.delay;
  slots[kOptimalLength] = muscle.optimal_fibre_length;
  slots[kTendonSlackLength] = muscle.tendon_slack_length;
  slots[kIsometricForce] = muscle.maximal_isometric_force;
  slots[kStrength] = muscle.strength_coefficient;
  slots[kPennation] = muscle.pennation_angle;
  slots[kLengthChange] = muscle.percentage_change;
  slots[kDamping] = muscle.damping;
  slots[kLargestVelocity] = muscle.maximal_contraction_velocity;
  return slots;
}

void StoreSlots(const std::array<double, kMuscleSlots>& slots, bool as_ceinms, double rate,
                SubjectMuscle& muscle) {
  const double root = std::sqrt(slots[kFilterSpread]);
  const double mean = slots[kFilterMean];
  if (as_ceinms) {
    muscle.c1 = mean + (1 + mean) * root;
    muscle.c2 = mean - (1 + mean) * root;
  } else {
    muscle.c1 = -std::exp(-(1 + root) / (mean * rate));
    muscle.c2 = -std::exp(-(1 - root) / (mean * rate));
  }
  muscle.shape_factor = slots[kShape];
  muscle.delay = slots[kDelay];
  muscle.optimal_fibre_length = slots[kOptimalLength];
  muscle.tendon_slack_length = slots[kTendonSlackLength];
  muscle.maximal_isometric_force = slots[kIsometricForce];
  muscle.strength_coefficient = slots[kStrength];
  muscle.pennation_angle = slots[kPennation];
  muscle.percentage_change = slots[kLengthChange];
  muscle.damping = slots[kDamping];
  muscle.maximal_contraction_velocity = slots[kLargestVelocity];
}

}  // namespace sinew
