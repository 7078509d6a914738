#include "problems/ankle_on_dynamometer/effects.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sinew {
namespace {

constexpr double kUnused = 1;

struct BaseEntry {
  int slot;
  const char* name;
  const char* unit;
  const char* meaning;
  double lower;
  double upper;
  double start;
  bool log;
  double prior;  // standard deviation about the start, of the logarithm if it is log; 0: none
  const char* source;
};

// Priors: what is usual in the literature, wide. Straps on soft tissue give 2 to 5 N/mm across; heel pad and
// sole some 10 to 100 kN per m and dm2.
constexpr BaseEntry kBase[] = {
    {kAttachmentInertia, "attachment_inertia", "kg*m^2", "of attachment and motor about the machine's axis",
     1e-4, 2, 0.05, true, 0, ""},
    {kAttachmentGravity, "attachment_gravity", "N*m",
     "weight of the attachment times the distance of its centre of mass from the axis", 0, 50, 2, false, 0,
     ""},
    {kAttachmentGravityAngle, "attachment_gravity_angle", "rad",
     "direction of the attachment's centre of mass at the machine's angle 0, from the toes' direction", -1.6,
     1.6, 0, false, 0, ""},
    {kAttachmentFriction, "attachment_friction", "N*m*s/rad", "viscous friction of the attachment", 0, 20,
     0.1, false, 0, ""},
    {kSoleStiffness, "sole_stiffness", "N/m^3", "pressure under the sole per depth", 1e4, 1e9, 5e6, true, 1.5,
     "thesis eq 5.1"},
    {kSoleFriction, "sole_friction", "1", "friction of the sole on the plate", 0, 2, 0.2, false, 0.15,
     "Hollars"},
    {kStrapStiffness, "strap_stiffness", "N/m", "force of a strap per lengthening, as it was strapped on",
     200, 1e6, 5e3, true, 1, "2 to 5 N/mm across cuffs on soft tissue"},
    {kStrapExponent, "strap_exponent", "1/m", "relative growth of a strap's stiffness per lengthening", 1,
     1000, 80, true, 1, "Fung 1967"},
    {kStrapPretension, "strap_pretension", "N", "force of a strap as it was strapped on", 0, 500, 40, false,
     40, ""},
    {kPassiveStiffness, "passive_stiffness", "N*m/rad",
     "of the ankle against dorsiflexion, at its rest angle", 0, 200, 8, false, 0, "Riener, Edrich 1999"},
    {kPassiveExponent, "passive_exponent", "1/rad", "relative growth of that stiffness per angle", 0.1, 20, 4,
     true, 0.7, "Riener, Edrich 1999"},
    {kPassiveLinear, "passive_linear_stiffness", "N*m/rad", "constant stiffness of the ankle", 0, 200, 5,
     false, 0, ""},
    {kPassiveDamping, "passive_damping", "N*m*s/rad", "viscous damping of the ankle", 0, 20, 0.3, false, 0,
     ""},
};

constexpr BaseEntry kOfMuscles[] = {
    {kAnkleShape, "shape", "1", "shape of the activation against neural drive, A", -4, 0, -0.5, false, 0,
     "thesis eq 4.1"},
    {kAnkleFilterTime, "filter_time", "s", "time constant of the activation dynamics, both poles", 0.002, 0.2,
     0.02, true, 1, "Lloyd, Besier 2003"},
    {kAnkleDelay, "delay", "s", "electromechanical", 0, 0.15, 0.03, false, 0.02, "Lloyd, Besier 2003"},
};

Parameter Base(const BaseEntry& entry) {
  Parameter p = BaseParameter(entry.name, entry.unit, entry.meaning, entry.lower, entry.upper, entry.start);
  p.source = entry.source;
  if (entry.log) p.scale = Scale::kLog;
  if (entry.prior > 0) p.prior = {entry.log ? std::log(entry.start) : entry.start, entry.prior};
  return p;
}

void AddRobotEffects(ParameterListBuilder& add) {
  add.BeginEffect("dry_friction", Level::kRobot, "friction of the attachment that does not grow with speed",
                  "slow passive rotations of the attachment alone, both ways")
      .Is(Occurrence::kCommon)
      .Positive(kDryFriction, "dry_friction", "N*m", "Coulomb friction of the attachment", 20);
  add.BeginEffect("directional_friction", Level::kRobot,
                  "the motor holds against another torque in one direction than in the other",
                  "slow passive rotations of the attachment alone, both ways")
      .TwoSided(kOneWayFriction, "directional_friction", "N*m", "friction with positive velocity alone", 20);
  add.BeginEffect("friction_with_load", Level::kRobot, "friction that grows with the torque of the foot",
                  "slow rotations against contractions of several sizes")
      .Positive(kFrictionWithLoad, "friction_with_load", "1", "friction per torque between plate and foot",
                0.5);
  add.BeginEffect("attachment_stiffness", Level::kRobot, "cables or hoses of the attachment pull it back",
                  "slow passive rotations of the attachment alone over the whole range")
      .TwoSided(kAttachmentStiffness, "attachment_stiffness", "N*m/rad", "of what turns with the attachment",
                50);
}

void AddBoundaryEffects(ParameterListBuilder& add) {
  add.BeginEffect("axis_offset", Level::kBoundary, "the machine's axis is not that of the ankle",
                  "passive rotations over the whole range, with the foot moved on the plate in between")
      .Is(Occurrence::kCommon)
      .TwoSided(kAxisX, "axis_offset_x", "m", "machine's axis before the ankle", 0.05)
      .TwoSided(kAxisY, "axis_offset_y", "m", "machine's axis above the ankle", 0.05);
  add.BeginEffect("strap_loosening", Level::kBoundary, "the straps grow longer during a trial",
                  "the same contraction at the begin and at the end of a trial")
      .TwoSided(kStrapLoosening, "strap_loosening", "m/s", "lengthening of the straps per time", 0.01);
  add.BeginEffect("sole_exponent", Level::kBoundary, "the sole grows stiffer with depth",
                  "isometric plantarflexion of several sizes with the foot's own angle measured")
      .Number(kSoleExponent, "sole_exponent", "1", "exponent of the sole's depth beyond 1", -0.5, 2);
  add.BeginEffect(
         "boundary_relaxation", Level::kBoundary,
         "sole, straps and soft tissue relax: the force between foot and plate decays after a change",
         "steps of the contraction that are held for seconds")
      .Positive(kBoundaryRelaxation, "boundary_relaxation_stiffness", "N*m/rad", "of the part that relaxes",
                1000)
      .Number(kBoundaryRelaxationTime, "boundary_relaxation_time", "s",
              "after which it has decayed to a third", 0.02, 20, 0.5);
  add.Probes({0.1, 0.5, 2});
}

void AddHumanEffects(ParameterListBuilder& add, bool muscles) {
  add.BeginEffect("passive_hysteresis", Level::kHuman,
                  "the passive ankle resists motion by a moment that does not grow with speed",
                  "passive rotations at two speeds, both ways")
      .Positive(kPassiveHysteresis, "passive_hysteresis", "N*m", "half of the loop's height", 20);
  add.BeginEffect("passive_relaxation", Level::kHuman,
                  "the passive moment of the ankle decays after a stretch",
                  "a passive rotation that is held for ten seconds")
      .Is(Occurrence::kCommon)
      .Positive(kPassiveRelaxation, "passive_relaxation_stiffness", "N*m/rad", "of the part that relaxes",
                200)
      .Number(kPassiveRelaxationTime, "passive_relaxation_time", "s", "after which it has decayed to a third",
              0.02, 20, 0.5);
  add.Probes({0.1, 0.5, 2});
  if (!muscles) return;
  add.BeginEffect("fatigue", Level::kHuman, "the muscles pull less for the same EMG as a trial goes on",
                  "the same contraction at the begin and at the end of a long trial")
      .Is(Occurrence::kCommon)
      .TwoSided(kFatigue, "fatigue", "1/s", "share by which the activation falls per second", 0.1);
  add.BeginEffect("unseen_drive", Level::kHuman, "the muscles are active beyond what their EMG shows",
                  "a trial in which the person is told to relax")
      .TwoSided(kUnseenDrive, "unseen_drive", "1", "excitation beyond the measured one", 0.3);
  add.BeginEffect("emg_crosstalk", Level::kHuman, "electrodes see the other muscles too",
                  "contractions of single muscles")
      .Is(Occurrence::kCommon)
      .Number(kEmgCrossTalk, "emg_crosstalk", "1", "share of the other muscles' mean excitation", -0.1, 0.6);
  add.BeginEffect("antagonist", Level::kHuman,
                  "a plantarflexor without electrode is active together with the others",
                  "the same contraction with an electrode on the antagonist")
      .TwoSided(kAntagonist, "antagonist", "N*m", "its moment at full activation of the others", 100);
  add.BeginEffect("force_enhancement", Level::kHuman, "force is larger after an active stretch",
                  "isometric contractions with and without a stretch before")
      .TwoSided(kStretchForce, "force_enhancement", "1",
                "relative gain per optimal length of stretch of the fibre", 1);
  add.BeginEffect("force_depression", Level::kHuman, "force is smaller after active shortening",
                  "isometric contractions with and without shortening before")
      .TwoSided(kShorteningForce, "force_depression", "1",
                "relative loss per optimal length of shortening of the fibre", 1);
}

}  // namespace

std::vector<double> AnkleDefaults(const AnkleSettings& settings) {
  std::vector<double> values(kAnkleSlots + settings.muscles.size() * kAnkleMuscleSlots, 0);
  for (const BaseEntry& entry : kBase) values[static_cast<std::size_t>(entry.slot)] = entry.start;
  for (const BaseEntry& entry : kOfMuscles) values[static_cast<std::size_t>(entry.slot)] = entry.start;
  values[kSoleDissipation] = 0.5;
  values[kSoleCompression] = 0.001;
  values[kStrapDamping] = 0.5;
  values[kPassiveAngle] = -0.2;
  values[kBoundaryRelaxationTime] = kUnused;
  values[kPassiveRelaxationTime] = kUnused;
  for (std::size_t m = 0; m < settings.muscles.size(); ++m) {
    for (const AnkleMuscleSlot factor : {kAnkleStrength, kAnkleSlackLength, kAnkleOptimalLength})
      values[static_cast<std::size_t>(SlotOfMuscle(m, factor))] = 1;
  }
  return values;
}

Result<ParameterList> ListAnkleParameters(const AnkleSettings& settings) {
  ParameterList list;
  const auto slots = kAnkleSlots + settings.muscles.size() * kAnkleMuscleSlots;
  ParameterListBuilder add(list, static_cast<int>(slots));
  for (const BaseEntry& entry : kBase) add.Add(Base(entry), entry.slot);
  if (!settings.muscles.empty()) {
    for (const BaseEntry& entry : kOfMuscles) add.Add(Base(entry), entry.slot);
  }
  const auto add_group = [&](const char* name, const char* meaning, AnkleMuscleSlot slot, double lower,
                             double upper, double prior) {
    std::map<std::string, int> known;
    for (std::size_t m = 0; m < settings.muscles.size(); ++m) {
      const std::string& group = settings.muscles[m].group;
      const auto place = static_cast<std::size_t>(SlotOfMuscle(m, slot));
      const auto found = known.find(group);
      if (found != known.end()) {
        list.index[place] = found->second;
        list.parameters[static_cast<std::size_t>(found->second)].shared_by.push_back(
            settings.muscles[m].name);
        continue;
      }
      Parameter p = BaseParameter(fmt::format("{}.{}", name, group), "1", meaning, lower, upper, 1);
      p.scale = Scale::kLog;
      p.shared_by = {settings.muscles[m].name};
      if (prior > 0) p.prior = {0, prior};
      known[group] = add.Add(std::move(p), static_cast<int>(place));
    }
  };
  add_group("strength", "factor on the isometric force", kAnkleStrength, 0.2, 4, 0);
  add_group("tendon_slack_length", "factor on the tendon slack length", kAnkleSlackLength, 0.9, 1.1, 0.02);

  for (const auto& [name, change] : settings.parameters) {
    SINEW_ASSIGN(const int index, FindParameter(list.parameters, name));
    Parameter& p = list.parameters[static_cast<std::size_t>(index)];
    p.lower = change.lower.value_or(p.lower);
    p.upper = change.upper.value_or(p.upper);
    const bool log = p.scale == Scale::kLog;
    if (change.start) {
      p.start = *change.start;
      if (p.prior) p.prior->mean = log ? std::log(p.start) : p.start;
    }
    if (change.prior) p.prior = {log ? std::log(p.start) : p.start, *change.prior};
    if (!(p.lower < p.upper && p.start >= p.lower && p.start <= p.upper && (!log || p.lower > 0)))
      return Fail("parameters: {}: start {} and range {} to {}, expected a start within a range{}", name,
                  p.start, p.lower, p.upper, log ? " above 0" : "");
  }
  AddRobotEffects(add);
  AddBoundaryEffects(add);
  AddHumanEffects(add, !settings.muscles.empty());
  AddMomentPort(settings.knots, !settings.muscles.empty(), kMomentTerm, add);
  for (std::size_t m = 0; m < settings.knots.activation.size(); ++m)
    AddActivationPort(settings.knots.activation[m], settings.muscles[m].name,
                      SlotOfMuscle(m, kActivationTerm), add);
  return list;
}

template <class T>
StrappedFoot<T> FootOf(const AnkleSettings& settings, const std::vector<T>& values) {
  StrappedFoot<T> foot;
  const auto at = [&](int slot) -> const T& { return values[static_cast<std::size_t>(slot)]; };
  const auto moves = [&](int slot) { return !IsAlwaysZero(at(slot)); };
  for (std::size_t m = 0; m < settings.muscles.size(); ++m) {
    const AnkleMuscle& from = settings.muscles[m];
    HillMuscle<T> muscle;
    muscle.optimal_length = from.optimal_length * at(SlotOfMuscle(m, kAnkleOptimalLength));
    muscle.tendon_slack_length = from.tendon_slack_length * at(SlotOfMuscle(m, kAnkleSlackLength));
    muscle.isometric_force = T(from.isometric_force);
    muscle.strength = at(SlotOfMuscle(m, kAnkleStrength));
    muscle.pennation = T(from.pennation);
    foot.muscles.push_back(muscle);
    foot.history.emplace_back(at(kStretchForce), at(kShorteningForce));
  }
  foot.remembers = moves(kStretchForce) || moves(kShorteningForce);
  foot.antagonist = at(kAntagonist);
  foot.passive = {at(kPassiveStiffness), at(kPassiveExponent), at(kPassiveAngle),
                  at(kPassiveLinear),    at(kPassiveDamping),  at(kPassiveHysteresis)};
  foot.passive_relaxation = {at(kPassiveRelaxation), at(kPassiveRelaxationTime)};
  foot.boundary_relaxation = {at(kBoundaryRelaxation), at(kBoundaryRelaxationTime)};
  BoundaryLaw<T>& b = foot.boundary;
  b.sole_stiffness = at(kSoleStiffness);
  b.sole_dissipation = at(kSoleDissipation);
  b.sole_compression = at(kSoleCompression);
  b.sole_exponent = at(kSoleExponent);
  b.bent_sole = moves(kSoleExponent);
  b.friction = at(kSoleFriction);
  b.strap_stiffness = at(kStrapStiffness);
  b.strap_exponent = at(kStrapExponent);
  b.strap_pretension = at(kStrapPretension);
  b.strap_damping = at(kStrapDamping);
  b.strap_loosening = at(kStrapLoosening);
  b.axis_x = at(kAxisX);
  b.axis_y = at(kAxisY);
  foot.attachment = {at(kAttachmentInertia),  at(kAttachmentGravity),  at(kAttachmentGravityAngle),
                     at(kAttachmentFriction), at(kDryFriction),        at(kOneWayFriction),
                     at(kFrictionWithLoad),   at(kAttachmentStiffness)};
  foot.unknown = MomentOf(settings.knots.moment, &at(kMomentTerm));
  return foot;
}

template StrappedFoot<double> FootOf(const AnkleSettings& settings, const std::vector<double>& values);
template StrappedFoot<Dual<8>> FootOf(const AnkleSettings& settings, const std::vector<Dual<8>>& values);

}  // namespace sinew
