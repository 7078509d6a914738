#include "problems/ankle_on_dynamometer/settings.h"

namespace sinew {
namespace {

Result<FootStrap> ReadStrap(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"foot", "plate"}));
  FootStrap strap;
  SINEW_ASSIGN(const YamlReader foot, yaml.At("foot"));
  SINEW_ASSIGN(const auto point, foot.Numbers(2));
  strap.foot_x = point[0];
  strap.foot_y = point[1];
  SINEW_ASSIGN(const YamlReader plate, yaml.At("plate"));
  SINEW_ASSIGN(strap.plate_x, plate.Number());
  return strap;
}

Status ReadFoot(const YamlReader& yaml, FootGeometry& foot) {
  SINEW_TRY(yaml.OnlyKeys({"ankle_height", "heel", "toe", "width", "mass", "mass_x", "mass_y", "inertia"}));
  SINEW_ASSIGN(foot.ankle_height, yaml.NumberOr("ankle_height", foot.ankle_height, 1e-3, 1));
  SINEW_ASSIGN(foot.heel, yaml.NumberOr("heel", foot.heel, 1e-3, 1));
  SINEW_ASSIGN(foot.toe, yaml.NumberOr("toe", foot.toe, 1e-3, 1));
  SINEW_ASSIGN(foot.width, yaml.NumberOr("width", foot.width, 1e-3, 1));
  SINEW_ASSIGN(foot.mass, yaml.NumberOr("mass", foot.mass, 0, 100));
  SINEW_ASSIGN(foot.mass_x, yaml.NumberOr("mass_x", foot.mass_x, -1, 1));
  SINEW_ASSIGN(foot.mass_y, yaml.NumberOr("mass_y", foot.mass_y, -1, 1));
  SINEW_ASSIGN(foot.inertia, yaml.NumberOr("inertia", foot.inertia, 1e-6, 10));
  return {};
}

Result<double> Required(const YamlReader& yaml, const char* key, double lower, double upper) {
  SINEW_TRY(yaml.At(key));
  return yaml.NumberOr(key, lower, lower, upper);
}

Result<AnkleMuscle> ReadMuscle(const std::string& name, const YamlReader& yaml) {
  constexpr std::size_t kMostCoefficients = 8;
  SINEW_TRY(yaml.OnlyKeys({"isometric_force", "optimal_length", "tendon_slack_length", "pennation", "length",
                           "arm", "group", "excitation"}));
  AnkleMuscle muscle;
  muscle.name = name;
  SINEW_ASSIGN(muscle.isometric_force, Required(yaml, "isometric_force", 1e-3, 1e6));
  SINEW_ASSIGN(muscle.optimal_length, Required(yaml, "optimal_length", 1e-4, 1));
  SINEW_ASSIGN(muscle.tendon_slack_length, Required(yaml, "tendon_slack_length", 1e-4, 2));
  SINEW_ASSIGN(muscle.pennation, yaml.NumberOr("pennation", 0, 0, 1.4));
  SINEW_ASSIGN(muscle.path.length_at_zero, Required(yaml, "length", 1e-4, 3));
  SINEW_ASSIGN(const YamlReader arm, yaml.At("arm"));
  SINEW_ASSIGN(muscle.path.arm, arm.Numbers(0));
  if (muscle.path.arm.empty() || muscle.path.arm.size() > kMostCoefficients)
    return FailAt(arm.file(), arm.line(), "arm: {} numbers, expected 1 to {} coefficients of a polynomial",
                  muscle.path.arm.size(), kMostCoefficients);
  SINEW_ASSIGN(muscle.group, yaml.TextOr("group", name));
  SINEW_ASSIGN(muscle.excitation, yaml.TextOr("excitation", name));
  return muscle;
}

Result<std::optional<double>> Optional(const YamlReader& yaml, const char* key) {
  if (!yaml.Has(key)) return std::optional<double>();
  SINEW_ASSIGN(const YamlReader value, yaml.At(key));
  SINEW_ASSIGN(const double number, value.Number());
  return std::optional<double>(number);
}

Result<AnkleParameterChange> ReadChange(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"start", "lower", "upper", "prior"}));
  AnkleParameterChange change;
  SINEW_ASSIGN(change.start, Optional(yaml, "start"));
  SINEW_ASSIGN(change.lower, Optional(yaml, "lower"));
  SINEW_ASSIGN(change.upper, Optional(yaml, "upper"));
  SINEW_ASSIGN(change.prior, Optional(yaml, "prior"));
  if (change.prior && !(*change.prior > 0))
    return FailAt(yaml.file(), yaml.line(), "prior: {}, expected a standard deviation above 0",
                  *change.prior);
  return change;
}

}  // namespace

Result<AnkleSettings> ReadAnkleSettings(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"foot", "straps", "strips", "gravity", "shank_tilt", "transition_velocity", "step",
                           "angle_cutoff", "rate", "torque_zero", "muscles", "parameters"}));
  AnkleSettings settings;
  FootGeometry& foot = settings.foot;
  if (yaml.Has("foot")) {
    SINEW_ASSIGN(const YamlReader section, yaml.At("foot"));
    SINEW_TRY(ReadFoot(section, foot));
  }
  foot.straps = DefaultStraps();
  if (yaml.Has("straps")) {
    SINEW_ASSIGN(const YamlReader list, yaml.At("straps"));
    SINEW_ASSIGN(const auto items, list.Items());
    foot.straps.clear();
    for (const YamlReader& item : items) {
      SINEW_ASSIGN(const FootStrap strap, ReadStrap(item));
      foot.straps.push_back(strap);
    }
  }
  SINEW_ASSIGN(const double strips, yaml.NumberOr("strips", foot.strips, 1, 1000));
  foot.strips = static_cast<int>(strips);
  SINEW_ASSIGN(foot.gravity, yaml.NumberOr("gravity", foot.gravity, 0, 1000));
  SINEW_ASSIGN(foot.shank_tilt, yaml.NumberOr("shank_tilt", 0, -3.2, 3.2));
  SINEW_ASSIGN(foot.transition_velocity,
               yaml.NumberOr("transition_velocity", foot.transition_velocity, 1e-5, 10));
  SINEW_ASSIGN(settings.step, yaml.NumberOr("step", settings.step, 1e-5, 0.1));
  SINEW_ASSIGN(settings.angle_cutoff, yaml.NumberOr("angle_cutoff", settings.angle_cutoff, -1, 1e5));
  SINEW_ASSIGN(settings.rate, yaml.NumberOr("rate", 0, 0, 1e6));
  SINEW_ASSIGN(settings.torque_zero, yaml.NumberOr("torque_zero", 0, 0, 1e3));
  if (yaml.Has("muscles")) {
    SINEW_ASSIGN(const YamlReader section, yaml.At("muscles"));
    SINEW_ASSIGN(const auto names, section.Keys());
    for (const std::string& name : names) {
      SINEW_ASSIGN(const YamlReader at, section.At(name));
      SINEW_ASSIGN(auto muscle, ReadMuscle(name, at));
      settings.muscles.push_back(std::move(muscle));
    }
  }
  if (yaml.Has("parameters")) {
    SINEW_ASSIGN(const YamlReader section, yaml.At("parameters"));
    SINEW_ASSIGN(const auto names, section.Keys());
    for (const std::string& name : names) {
      SINEW_ASSIGN(const YamlReader at, section.At(name));
      SINEW_ASSIGN(settings.parameters[name], ReadChange(at));
    }
  }
  settings.knots = KnotsOver(AnkleRanges(), settings.muscles.size());
  return settings;
}

}  // namespace sinew
