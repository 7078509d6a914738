#include "problems/nms/effects.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace sinew {
namespace {

constexpr const char* kThesis = "thesis ch. 4";

class Builder {
 public:
  Builder(const NmsSettings& settings, const NmsData& data,
          const std::vector<std::array<double, kMuscleSlots>>& rest)
      : settings_(settings), data_(data), rest_(rest) {
    list_.arm_offset.assign(settings.joints.size(), -1);
  }

  NmsParameterList Take() {
    std::stable_sort(list_.places.begin(), list_.places.end(),
                     [](const NmsPlace& a, const NmsPlace& b) { return a.way < b.way; });
    return std::move(list_);
  }

  void AddBase() {
    for (const NmsParameterSetting& setting : settings_.parameters) {
      const auto& names = MuscleParameterNames();
      const auto name = std::find_if(names.begin(), names.end(),
                                     [&](const MuscleParameterName& n) { return n.slot == setting.slot; });
      const int parameter = static_cast<int>(list_.parameters.size());
      double start = 0;
      for (const std::string& muscle : setting.muscles) {
        const int m = IndexOf(muscle);
        const double value = rest_[static_cast<std::size_t>(m)][setting.slot];
        list_.places.push_back(
            {parameter, m, setting.slot, NmsPlace::kSets, setting.relative ? value : 1, -1});
        start += (setting.relative ? 1 : value) / static_cast<double>(setting.muscles.size());
      }
      start = std::clamp(start, setting.lower, setting.upper);
      Parameter made = BaseParameter(setting.group + "." + name->name, setting.relative ? "1" : name->unit,
                                     name->meaning, setting.lower, setting.upper, start);
      if (setting.slot == kFilterMean && !setting.relative) made.unit = settings_.model.as_ceinms ? "1" : "s";
      if (setting.relative) made.meaning += ", as a factor on the subject's";
      if (setting.prior) made.prior = GaussianPrior{start, *setting.prior};
      made.source = name->source;
      if (setting.muscles.size() > 1) made.shared_by = setting.muscles;
      add_.Add(std::move(made));
    }
  }

  void AddExcitation() {
    add_.BeginEffect("emg_drift", Level::kSensor, "the EMG increases or decreases with time, as with fatigue",
                     "the same contraction at the begin and at the end of the trial",
                     "Merletti, Knaflitz, De Luca 1990");
    OfAllMuscles(
        add_.AddNumber("emg_drift", "1/s", "share by which the excitation is larger per second", -0.05, 0.05),
        kEmgDrift, NmsPlace::kAdds);
    add_.BeginEffect("co_contraction", Level::kHuman,
                     "all muscles are more active than measured by a constant",
                     "a rest phase, and EMG normalised after its floor is taken off", kThesis);
    OfAllMuscles(add_.AddNumber("co_contraction", "1", "excitation beyond the measured one", -0.1, 0.2),
                 kCoContraction, NmsPlace::kAdds);
    if (data_.muscles.size() > 2) {
      add_.BeginEffect("cross_talk", Level::kSensor, "electrodes record the other muscles too",
                       "contractions of one muscle at a time", "De Luca, Merletti 1988");
      OfAllMuscles(add_.AddNumber("cross_talk", "1",
                                  "share of the others' mean excitation in the measured one", -0.1, 0.5),
                   kCrossTalk, NmsPlace::kAdds);
    }
    if (!settings_.model.as_ceinms && !IsBase(kDelay)) {
      add_.BeginEffect("longer_delay", Level::kHuman, "force follows the EMG later than the subject's delay",
                       "sudden contractions at a fixed angle", "Cavanagh, Komi 1979");
      OfAllMuscles(
          add_.AddNumber("longer_delay", "s", "electromechanical delay beyond the subject's", -0.1, 0.15),
          kDelay, NmsPlace::kAdds);
    }
    if (!settings_.model.as_ceinms && !IsBase(kFilterMean)) {
      add_.BeginEffect("slower_activation", Level::kHuman, "activation follows excitation at another speed",
                       "sudden contractions at a fixed angle", kThesis);
      OfAllMuscles(add_.AddNumber("slower_activation", "1",
                                  "time of the activation filter beyond the subject's, as a share", -0.8, 3),
                   kFilterMean, NmsPlace::kScales);
    }
    AddTrials();
  }

  void AddMuscle() {
    add_.BeginEffect("force_enhancement", Level::kHuman, "muscle force is increased after a stretch",
                     "stretches of active muscles, held at their end", "Edman, Elzinga, Noble 1978");
    OfAllMuscles(add_.AddNumber("force_enhancement", "1",
                                "share of the force gained per optimal length of stretch", 0, 3),
                 kEnhancement, NmsPlace::kAdds);
    add_.BeginEffect("force_depression", Level::kHuman, "muscle force is decreased after shortening",
                     "active shortening, held at its end", "Marechal, Plaghki 1979");
    OfAllMuscles(add_.AddNumber("force_depression", "1",
                                "share of the force lost per optimal length of shortening", 0, 2),
                 kDepression, NmsPlace::kAdds);
    if (settings_.model.tendon == TendonMode::kRigid) {
      add_.BeginEffect("compliant_tendon", Level::kHuman, "tendons are compliant",
                       "quick changes of activation at a fixed angle, or ultrasound of the fibres",
                       "thesis eq 4.4");
      OfAllMuscles(add_.AddNumber("compliant_tendon", "1",
                                  "strain of tendons beside that of the subject's curve", 0, 3),
                   kTendonCompliance, NmsPlace::kAdds);
    }
    if (!IsBase(kLargestVelocity)) {
      add_.BeginEffect("contraction_velocity", Level::kHuman,
                       "the largest shortening velocity differs from the assumed one",
                       "trials over a wider range of speeds", "Buchanan et al. 2004");
      OfAllMuscles(add_.AddNumber("contraction_velocity", "1",
                                  "largest shortening velocity beyond the subject's, as a share", -0.7, 2),
                   kLargestVelocity, NmsPlace::kScales);
    }
    if (!IsBase(kLengthChange)) {
      add_.BeginEffect("length_by_activation", Level::kHuman,
                       "the optimal length changes with activation otherwise than assumed",
                       "weak and strong contractions at several angles", "thesis eq 4.2");
      OfAllMuscles(add_.AddNumber("length_by_activation", "1",
                                  "optimal length gained without activation, beyond the "
                                  "subject's",
                                  -0.2, 0.3),
                   kLengthChange, NmsPlace::kAdds);
    }
    if (!IsBase(kOptimalLength)) {
      add_.BeginEffect("fibre_length", Level::kHuman, "fibres are longer or shorter than assumed",
                       "contractions over a wider range of angles", "thesis eq 4.2");
      OfAllMuscles(add_.AddNumber("fibre_length", "1",
                                  "optimal fibre length beyond the subject's, as a share", -0.3, 0.5),
                   kOptimalLength, NmsPlace::kScales);
    }
  }

  void AddJoint(std::size_t j) {
    const std::string& joint = settings_.joints[j];
    const double most = LargestMoment(j);
    if (!(most > 0)) return;
    add_.BeginEffect(
        "arm_offset." + joint, Level::kBoundary, "the joint's axis differs from that of the moment arms",
        "the joint moved slowly without activity, in the machine and by hand", "Delp et al. 2007");
    list_.arm_offset[j] = add_.AddNumber("arm_offset." + joint, "m",
                                         "moment arms of all muscles beyond the stated ones", -0.03, 0.03);
    add_.BeginEffect("angle_offset." + joint, Level::kSensor, "the joint's angle was recorded with an offset",
                     "a posture whose angle is known by other means");
    const int offset =
        add_.AddNumber("angle_offset." + joint, "rad", "true angle beyond the recorded one", -0.3, 0.3);
    for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
      const auto& crosses = data_.muscle_joints[m];
      const auto at = std::find(crosses.begin(), crosses.end(), static_cast<int>(j));
      if (at == crosses.end()) continue;
      list_.places.push_back({offset, static_cast<int>(m),
                              static_cast<MuscleSlot>(kAngleOffset + (at - crosses.begin())), NmsPlace::kAdds,
                              1, -1});
    }
    AddMissingMuscles(j, most);
    AddMomentsOfMotion(j, most);
  }

 private:
  [[nodiscard]] int IndexOf(const std::string& muscle) const {
    return static_cast<int>(std::find(data_.muscles.begin(), data_.muscles.end(), muscle) -
                            data_.muscles.begin());
  }
  [[nodiscard]] bool IsBase(MuscleSlot slot) const {
    return std::any_of(settings_.parameters.begin(), settings_.parameters.end(),
                       [&](const NmsParameterSetting& s) { return s.slot == slot; });
  }
  [[nodiscard]] double LargestMoment(std::size_t j) const {
    double trained = 0;
    double most = 0;
    for (const NmsTrial& trial : data_.trials) {
      const Block& block = data_.layout[static_cast<std::size_t>(trial.first_block) + j];
      for (const double m : block.measured) {
        most = std::max(most, std::abs(m));
        if (block.role == BlockRole::kTrain) trained = std::max(trained, std::abs(m));
      }
    }
    return trained > 0 ? trained : most;
  }

  void OfAllMuscles(int parameter, MuscleSlot slot, NmsPlace::Way way, int trial = -1) {
    for (std::size_t m = 0; m < data_.muscles.size(); ++m)
      list_.places.push_back({parameter, static_cast<int>(m), slot, way, 1, trial});
  }
  void AddMoment(int parameter, std::size_t joint, std::vector<Vector> by_trial) {
    list_.moments.push_back({parameter, static_cast<int>(joint), std::move(by_trial)});
  }

  // Electrodes are placed anew, and floors and maxima taken anew, from day to day.
  void AddTrials() {
    std::vector<std::size_t> fitted;
    for (std::size_t t = 0; t < data_.trials.size(); ++t) {
      if (data_.layout[static_cast<std::size_t>(data_.trials[t].first_block)].role == BlockRole::kTrain)
        fitted.push_back(t);
    }
    if (fitted.size() < 2) return;
    for (const std::size_t t : fitted) {
      const std::string& trial = data_.trials[t].name;
      add_.BeginEffect("emg_gain@" + trial, Level::kSensor,
                       "the EMG of one trial is too large or too small by a factor",
                       "a contraction of known moment in every trial", kThesis, trial);
      OfAllMuscles(add_.AddNumber("emg_gain@" + trial, "1",
                                  "excitation of the trial beyond the measured one, as a share", -0.5, 1),
                   kEmgGain, NmsPlace::kAdds, static_cast<int>(t));
      add_.BeginEffect("emg_offset@" + trial, Level::kSensor,
                       "the EMG of one trial is too large or too small by a constant",
                       "a rest phase in every trial", kThesis, trial);
      OfAllMuscles(add_.AddNumber("emg_offset@" + trial, "1",
                                  "excitation of the trial beyond the measured one", -0.1, 0.1),
                   kCoContraction, NmsPlace::kAdds, static_cast<int>(t));
    }
  }

  // It is active with those that were measured: with their mean excitation, delayed and smoothed as theirs.
  void AddMissingMuscles(std::size_t j, double most) {
    for (const bool plus : {true, false}) {
      std::vector<Vector> by_trial;
      bool any = false;
      for (const NmsTrial& trial : data_.trials) {
        const Vector& pull = plus ? trial.pull_plus[j] : trial.pull_minus[j];
        any = any || pull.any();
        by_trial.push_back(plus ? pull : Vector(-pull));
      }
      if (!any) continue;
      const std::string name =
          std::string("missing_muscle") + (plus ? "_plus." : "_minus.") + settings_.joints[j];
      add_.BeginEffect(
          name, Level::kHuman,
          std::string("a muscle without electrode adds to the moment of those that move the joint towards ") +
              (plus ? "larger" : "smaller") + " angles",
          "electrodes on the muscles that have none", kThesis);
      AddMoment(
          add_.AddNumber(name, "N*m", "its moment at full activation of the measured ones", 0, 3 * most), j,
          std::move(by_trial));
    }
  }

  void AddMomentsOfMotion(std::size_t j, double most) {
    if (data_.trials.front().motion.size() <= j || data_.trials.front().motion[j].angle.size() == 0) return;
    const std::string& joint = settings_.joints[j];
    double low = 1e9;
    double high = -1e9;
    double fastest = 0;
    double hardest = 0;
    for (const NmsTrial& trial : data_.trials) {
      const NmsMotion& motion = trial.motion[j];
      low = std::min(low, motion.angle.minCoeff());
      high = std::max(high, motion.angle.maxCoeff());
      fastest = std::max(fastest, motion.velocity.cwiseAbs().maxCoeff());
      hardest = std::max(hardest, motion.acceleration.cwiseAbs().maxCoeff());
    }
    if (!(high > low)) return;
    const double middle = 0.5 * (low + high);
    const auto add = [&](int parameter, auto&& moment) {
      std::vector<Vector> by_trial;
      for (const NmsTrial& trial : data_.trials) by_trial.push_back(moment(trial.motion[j]));
      AddMoment(parameter, j, std::move(by_trial));
    };
    const double stiff = 2 * most / (high - low);
    add_.BeginEffect("passive_stiffness." + joint, Level::kHuman, "the joint itself is elastic",
                     "the joint moved slowly without activity", "Riener, Edrich 1999");
    add(add_.AddNumber("passive_stiffness." + joint, "N*m/rad",
                       "passive moment per angle from the middle of the range", 0, stiff),
        [&](const NmsMotion& m) { return Vector(middle - m.angle.array()); });
    add_.BeginEffect("joint_damping." + joint, Level::kHuman, "the joint itself is damped",
                     "the joint moved without activity at several speeds", "Weiss, Kearney, Hunter 1986");
    add(add_.AddNumber("joint_damping." + joint, "N*m*s/rad", "passive moment per speed", 0, most / fastest),
        [&](const NmsMotion& m) { return Vector(-m.velocity); });
    add_.BeginEffect("inertial_moment." + joint, Level::kBoundary,
                     "moments of inertia of segment or machine are left in the measured moment",
                     "the same motion without activity, or without a person in the machine", "thesis ch. 6");
    add(add_.AddNumber("inertial_moment." + joint, "kg*m2", "measured moment per acceleration",
                       -most / hardest, most / hardest),
        [&](const NmsMotion& m) { return Vector(m.acceleration); });
    add_.BeginEffect("segment_weight." + joint, Level::kBoundary,
                     "the weight of the segment is left in the measured moment",
                     "the joint held still without activity at several angles", "thesis ch. 6");
    add(add_.AddNumber("weight_sine." + joint, "N*m", "measured moment per sine of the angle", -most, most),
        [&](const NmsMotion& m) { return Vector(m.angle.array().sin()); });
    add(add_.AddNumber("weight_cosine." + joint, "N*m", "measured moment per cosine of the angle", -most,
                       most),
        [&](const NmsMotion& m) { return Vector(m.angle.array().cos()); });
    add_.BeginEffect("machine_friction." + joint, Level::kRobot,
                     "the machine's friction is left in the measured moment",
                     "the same motion without a person in the machine", "thesis ch. 6");
    // Smooth within a few hundredths of the highest speed.
    const double slow = 0.03 * fastest;
    add(add_.AddNumber("machine_friction." + joint, "N*m", "measured moment against the motion", 0,
                       0.5 * most),
        [&](const NmsMotion& m) { return Vector(-(m.velocity.array() / slow).tanh()); });
  }

  const NmsSettings& settings_;
  const NmsData& data_;
  const std::vector<std::array<double, kMuscleSlots>>& rest_;
  NmsParameterList list_;
  ParameterListBuilder add_{list_};
};

}  // namespace

NmsParameterList ListNmsParameters(const NmsSettings& settings, const NmsData& data,
                                   const std::vector<std::array<double, kMuscleSlots>>& rest) {
  Builder builder(settings, data, rest);
  builder.AddBase();
  builder.AddExcitation();
  builder.AddMuscle();
  for (std::size_t j = 0; j < settings.joints.size(); ++j) builder.AddJoint(j);
  return builder.Take();
}

}  // namespace sinew
