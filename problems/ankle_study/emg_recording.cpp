#include "problems/ankle_study/emg_recording.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "models/emg/envelope.h"
#include "models/emg/sampling.h"
#include "problems/nms/ceinms/subject.h"
#include "problems/nms/muscle/muscle_force.h"
#include "problems/nms/settings.h"

namespace sinew {
namespace {

constexpr double kEnvelopeRate = 200;  // [Hz]
constexpr double kExactRate = 25;      // [Hz] of envelopes without noise
constexpr double kAngleNoise = 1e-3;   // [rad]
constexpr double kReference = 75 * kPi / 180;
constexpr double kMachineInertia = 0.25;  // [kg m2] left in the moment
constexpr double kPushWidth = 0.1;  // [s], standard deviation of the machine's push at the highest angle
constexpr std::array<int, 2> kWithoutElectrode{5, 6};  // of StudyMuscles()

// One recording.
struct Run {
  std::string name;
  Role role = Role::kTrain;
  int speed = 0;  // index
  StudyMotion motion;
  double first = 0;  // [s]
  double last = 0;
  int cycles = 0;
  std::vector<std::vector<double>> pulling;  // at the rate of the raw EMG
};

class Study {
 public:
  Study(const EmgStudyTruth& truth, std::uint64_t seed) : truth_(truth), seed_(seed) {
    const bool exact = truth.Set("exact") != 0;
    rate_ = exact                                              ? kExactRate
            : truth.Set("raw") != 0 || truth.Set("noisy") != 0 ? kStudyEmgRate
                                                               : kEnvelopeRate;
  }

  Result<std::map<std::string, Trial>> Record() {
    std::uint64_t stream = 0;
    for (int s = 0; s < static_cast<int>(truth_.Set("speeds")); ++s) {
      for (const Role role : {Role::kTrain, Role::kValidate}) {
        const int cycles = static_cast<int>(truth_.Set(role == Role::kTrain ? "train" : "validate"));
        if (cycles > 0) Draw(s, role, cycles, Random::StreamSeed(seed_, stream));
        ++stream;
      }
    }
    Normalise();
    std::map<std::string, Trial> trials;
    for (const Run& run : runs_) {
      SINEW_ASSIGN(trials[run.name], Recorded(run, Random::StreamSeed(seed_, stream++)));
    }
    return trials;
  }

 private:
  [[nodiscard]] std::size_t muscles() const { return static_cast<std::size_t>(truth_.Set("muscles")); }

  void Draw(int speed, Role role, int cycles, std::uint64_t seed) {
    Random random(seed);
    Run run;
    const int degrees = kEmgStudyDegrees[static_cast<std::size_t>(speed)];
    run.name = fmt::format("{}_{:03}", role == Role::kTrain ? "train" : "validate", degrees);
    run.role = role;
    run.speed = speed;
    run.motion.speed = degrees * kPi / 180;
    run.cycles = cycles;
    run.first = -0.5 * run.motion.cycle();
    run.last = (cycles + 0.5) * run.motion.cycle();
    StudyMotion reference;
    reference.speed = kReference;
    EmgActivity what;
    what.cycle = run.motion.cycle();
    what.log_speed = std::log(run.motion.speed / kReference);
    what.rhythm = 1 / run.motion.cycle() - 1 / reference.cycle();
    what.speed = speed;
    what.failing = truth_.subject.fails_slow && degrees == 30;
    what.warp_sine = truth_.Effect("warp_sine") * what.log_speed;
    what.warp_cosine = truth_.Effect("warp_cosine") * what.log_speed;
    const EmgSubject& subject = truth_.subject;
    const auto count = static_cast<std::size_t>((run.last - run.first) * rate_) + 1;
    run.pulling = DrawActivity(subject, what, run.first, count, rate_, random);
    SpoilCycles(run);
    runs_.push_back(std::move(run));
  }

  // What happens to single cycles: fatigue, and faults that no effect of the problem describes.
  void SpoilCycles(Run& run) const {
    const auto names = EmgStudyMuscleNames();
    for (std::size_t m = 0; m < names.size(); ++m) {
      const double growth = truth_.Effect(names[m] + ".fatigue");
      const double bursts = truth_.Effect("lost_bursts");
      const double loose = truth_.Effect("loose_electrode");
      if (growth == 0 && bursts == 0 && loose == 0) continue;
      const double floor = truth_.subject.muscles[m].floor;
      for (std::size_t i = 0; i < run.pulling[m].size(); ++i) {
        const double place = (run.first + static_cast<double>(i) / rate_) / run.motion.cycle();
        const double k = std::floor(place);
        double gain = std::exp(growth * (k - 0.5 * (run.cycles - 1)));
        if (m == 0 && bursts != 0 && static_cast<long>(k + 3) % 3 == 0) gain *= 1 - bursts;
        double& e = run.pulling[m][i];
        e = floor + gain * (e - floor);
        if (m == 1 && 2 * place > run.cycles) e *= 1 - loose;
      }
    }
  }

  void Normalise() {
    largest_.assign(truth_.subject.muscles.size(), 0);
    for (const Run& run : runs_) {
      for (std::size_t m = 0; m < largest_.size(); ++m)
        largest_[m] = std::max(largest_[m], *std::max_element(run.pulling[m].begin(), run.pulling[m].end()));
    }
  }

  // What the electrodes are above, as a share of what is normalised to.
  [[nodiscard]] std::vector<std::vector<double>> Seen(const Run& run) const {
    const auto names = EmgStudyMuscleNames();
    std::vector<std::vector<double>> seen = run.pulling;
    for (std::size_t m = 0; m < seen.size(); ++m) {
      for (double& e : seen[m]) e /= largest_[m];
    }
    const std::vector<std::vector<double>> clean = seen;
    for (std::size_t m = 0; m < muscles(); ++m) {
      const double share =
          truth_.Effect("cross_talk." + names[m]) + (truth_.Set("laws") != 0 ? truth_.subject.cross_talk : 0);
      const double floor = truth_.Effect(names[m] + ".floor@" + run.name);
      const double hum = m == 0 ? truth_.Effect("hum") : 0;
      for (std::size_t i = 0; i < seen[m].size(); ++i) {
        double others = 0;
        for (std::size_t o = 0; o < muscles(); ++o)
          others += o == m ? 0 : clean[o][i] / std::max(1.0, static_cast<double>(muscles() - 1));
        seen[m][i] += floor + share * others;
        seen[m][i] += hum * (1 + std::sin(2 * kPi * 1.7 * (run.first + static_cast<double>(i) / rate_)));
      }
    }
    return seen;
  }

  Result<Trial> Recorded(const Run& run, std::uint64_t seed) const {
    Random random(seed);
    Trial trial;
    trial.role = run.role;
    trial.task = "ankle up and down";
    trial.conditions["speed_rad_per_s"] = run.motion.speed;
    SINEW_TRY(RecordEmg(run, random, trial));
    const auto frames = static_cast<std::size_t>((run.last - run.first) * kStudyRate) + 1;
    const auto times = StudyTimes(run.first, kStudyRate, frames);
    RecordMotion(run, times, random, trial);
    if (truth_.Set("moments") != 0) {
      RecordGeometry(run, times, trial);
      SINEW_TRY(RecordMoment(run, times, random, trial));
    }
    return trial;
  }

  Status RecordEmg(const Run& run, Random& random, Trial& trial) const {
    const auto names = EmgStudyMuscleNames();
    const auto seen = Seen(run);
    Grid& grid = trial.grids["excitations"];
    const bool noisy = rate_ == kStudyEmgRate;
    for (std::size_t m = 0; m < muscles(); ++m) {
      std::vector<double> values = seen[m];
      std::vector<double> times = StudyTimes(run.first, rate_, values.size());
      if (noisy) {
        std::vector<double> above = seen[m];
        for (double& e : above) e *= largest_[m];
        std::vector<double> raw = DrawRawEmg(above, random);
        SINEW_ASSIGN(Envelope envelope, ComputeEnvelope(raw, kStudyEmgRate, {}));
        for (double& e : envelope.values) e /= kStudyFullEmg * largest_[m];
        SampledSignal sampled = SampleAtRate(times, envelope.values, kEnvelopeRate);
        if (truth_.Set("raw") != 0) {
          Grid& emg = trial.grids["emg"];
          emg.time = times;
          emg.channels[names[m]] = StudyInput("V", std::move(raw));
        }
        times = std::move(sampled.time);
        values = std::move(sampled.values);
      }
      grid.time = std::move(times);
      grid.channels[names[m]] = {"1", ChannelKind::kMeasured, {}, std::move(values)};
    }
    return {};
  }

  void RecordMotion(const Run& run, const std::vector<double>& times, Random& random, Trial& trial) const {
    Grid& motion = trial.grids["motion"];
    motion.time = times;
    const double noise = truth_.Set("exact") != 0 ? 0 : kAngleNoise;
    std::vector<double> angle;
    for (const double t : times) angle.push_back(run.motion.Get(t).angle + noise * random.Normal());
    motion.channels[kStudyJoint] = StudyInput("rad", std::move(angle));
  }

  static void RecordGeometry(const Run& run, const std::vector<double>& times, Trial& trial) {
    Grid& lengths = trial.grids["lengths"];
    Grid& arms = trial.grids[std::string("moment_arms.") + kStudyJoint];
    lengths.time = arms.time = times;
    for (const std::string& name : EmgStudyMuscleNames()) {
      const auto& all = StudyMuscles();
      const auto& muscle =
          *std::find_if(all.begin(), all.end(), [&](const auto& m) { return m.name == name; });
      std::vector<double> length;
      std::vector<double> arm;
      for (const double t : times) {
        length.push_back(UnitLength(muscle, run.motion.Get(t).angle));
        arm.push_back(MomentArm(muscle, run.motion.Get(t).angle));
      }
      lengths.channels[name] = StudyInput("m", std::move(length));
      arms.channels[name] = StudyInput("m", std::move(arm));
    }
  }

  // The generic person's numbers, of the person's strength.
  [[nodiscard]] std::array<double, kMuscleSlots> TrueSlots(const StudyMuscle& muscle) const {
    SubjectMuscle of;
    of.c1 = of.c2 = -0.7;
    of.shape_factor = muscle.arm[0] > 0 ? -0.8 : -1.2;
    of.delay = 0.04;
    of.optimal_fibre_length = muscle.optimal_length;
    of.pennation_angle = muscle.pennation;
    of.tendon_slack_length = muscle.slack_length * (muscle.arm[0] > 0 ? 0.985 : 1.01);
    of.maximal_isometric_force = muscle.isometric_force;
    of.strength_coefficient = truth_.subject.strength;
    return SlotsOf(of, false, kStudyRate);
  }

  Status RecordMoment(const Run& run, const std::vector<double>& times, Random& random, Trial& trial) const {
    SINEW_ASSIGN(const CeinmsSubject generic, ReadCeinmsSubject(StudySubjectXml(), "subject.xml"));
    SINEW_ASSIGN(const MuscleCurves curves, CurvesOf(generic.subject, false));
    const auto step = static_cast<std::size_t>(kStudyFineRate / kStudyRate);
    const auto fine = StudyTimes(run.first, kStudyFineRate, (times.size() - 1) * step + 1);
    std::vector<StudyMotion::At> motion;
    for (const double t : fine) motion.push_back(run.motion.Get(t));
    std::vector<double> moment(fine.size(), 0);
    const auto add = [&](const StudyMuscle& muscle, const std::vector<double>& excitation) -> Status {
      MuscleSignals signals;
      signals.excitation_time = StudyTimes(run.first, rate_, excitation.size());
      for (const double e : excitation) signals.excitation.push_back(std::min(e, 1.0));
      signals.time = fine;
      for (const auto& at : motion) signals.unit_length.push_back(UnitLength(muscle, at.angle));
      MuscleTrace<double> trace;
      const Status status = ComputeMuscleForce(curves, MuscleModel{}, TrueSlots(muscle), signals, trace);
      if (!status) return Fail("{}, {}: {}", run.name, muscle.name, status.error().message);
      for (std::size_t i = 0; i < fine.size(); ++i)
        moment[i] += MomentArm(muscle, motion[i].angle) * trace.tendon_force[i];
      return {};
    };
    for (std::size_t m = 0; m < truth_.subject.muscles.size(); ++m)
      SINEW_TRY(
          add(StudyMuscles()[static_cast<std::size_t>(truth_.subject.muscles[m].study)], run.pulling[m]));
    // Peroneus brevis is activated as peroneus longus, tertius as tibialis anterior.
    SINEW_TRY(add(StudyMuscles()[static_cast<std::size_t>(kWithoutElectrode[0])], run.pulling[2]));
    SINEW_TRY(add(StudyMuscles()[static_cast<std::size_t>(kWithoutElectrode[1])], run.pulling[4]));
    for (std::size_t i = 0; i < fine.size(); ++i) {
      const double cycle = run.motion.cycle();
      const double since = fine[i] - cycle * std::round(fine[i] / cycle);
      moment[i] += kMachineInertia * motion[i].acceleration -
                   truth_.subject.push * std::exp(-0.5 * since * since / (kPushWidth * kPushWidth));
    }
    Channel channel{"N*m", ChannelKind::kMeasured, {}, {}};
    for (std::size_t i = 0; i < fine.size(); i += step)
      channel.values.push_back(moment[i] + truth_.Set("moment_noise") * random.Normal());
    Grid& grid = trial.grids["moments"];
    grid.time = times;
    grid.channels[std::string(kStudyJoint) + "_moment"] = std::move(channel);
    return {};
  }

  const EmgStudyTruth& truth_;
  std::uint64_t seed_;
  double rate_ = 0;  // [Hz] of the activations
  std::vector<Run> runs_;
  std::vector<double> largest_;  // [muscles] activation, that the EMG is normalised to
};

}  // namespace

Result<std::map<std::string, Trial>> RecordEmgStudy(const EmgStudyTruth& truth, std::uint64_t seed) {
  return Study(truth, seed).Record();
}

}  // namespace sinew
