#include "problems/ankle_on_dynamometer/data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/quintic_spline.h"
#include "base/text.h"
#include "datasets/robust.h"
#include "models/dynamometer/smooth_angle.h"
#include "models/emg/sampling.h"

namespace sinew {
namespace {

constexpr const char* kAngle = "machine_angle";
constexpr const char* kTorque = "machine_torque";
constexpr const char* kAnkle = "ankle_angle";
constexpr const char* kExcitations = "excitations";
constexpr const char* kFoot = "foot";
constexpr const char* kPassiveTrial = "passive";
constexpr double kSameTime = 1e-9;  // [s]

Status CheckInput(const std::string& trial, const std::string& name, const Channel& channel,
                  const std::vector<double>& time, const char* unit) {
  if (channel.unit != unit)
    return Fail("trial '{}': {} is in {}, expected {}", trial, name, channel.unit, unit);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(channel.values[i]))
      return Fail(
          "trial '{}': {} has a gap at t = {:.6g} s; expected a value at every time (sinew data cut takes a "
          "part without gaps)",
          trial, name, time[i]);
  }
  return {};
}

double ConditionOr(const Trial& trial, const char* name, double fallback) {
  const auto found = trial.conditions.find(name);
  return found == trial.conditions.end() ? fallback : found->second;
}

struct Sampled {
  std::vector<double> time;
  std::vector<double> values;
  double samples = 1;  // of the recording, in each
};

// Medians over 1 / rate: single samples that jump leave no trace. Slower channels stay as they are.
Sampled AtRate(const Grid& grid, const Channel& channel, double rate) {
  const auto count = static_cast<double>(grid.time.size() - 1);
  const double samples =
      rate > 0 ? std::floor(count / (grid.time.back() - grid.time.front()) / rate + 0.01) : 1;
  if (!(samples >= 2)) return {grid.time, channel.values, 1};
  Sampled sampled;
  sampled.samples = samples;
  const auto n = static_cast<std::size_t>(samples);
  std::vector<double> bin;
  for (std::size_t first = 0; first + n <= grid.time.size(); first += n) {
    bin.clear();
    double time = 0;
    for (std::size_t i = first; i < first + n; ++i) {
      time += grid.time[i] / samples;
      if (std::isfinite(channel.values[i])) bin.push_back(channel.values[i]);
    }
    sampled.time.push_back(time);
    sampled.values.push_back(2 * bin.size() > n ? Median(bin) : NAN);
  }
  return sampled;
}

class Preparation {
 public:
  Preparation(const Dataset& data, AnkleSettings settings, double margin)
      : data_(data),
        margin_(margin),
        prepared_{std::move(settings), MuscleCurves::Default(), {}, {}, {}, {}} {
    for (const AnkleMuscle& muscle : prepared_.settings.muscles) prepared_.paths.push_back(muscle.path);
  }

  Result<AnkleData> Run() {
    for (const auto& [name, trial] : data_.trials) SINEW_TRY(Add(name, trial));
    if (prepared_.trials.empty())
      return Fail(
          "no trial has the channels {} and {}; `sinew list channels ankle_on_dynamometer` shows them",
          kAngle, kTorque);
    for (Block& block : prepared_.layout) block.weight = WeightOf(block);
    prepared_.settings.knots = KnotsOver(Ranges(), prepared_.paths.size());
    NoteWhatIsMissing();
    return std::move(prepared_);
  }

 private:
  Status Add(const std::string& name, const Trial& trial) {
    const auto angle = trial.Find(kAngle);
    const auto torque = trial.Find(kTorque);
    if (!angle && !torque) return {};
    if (!angle || !torque) return Fail("trial '{}' has no channel {}", name, angle ? kTorque : kAngle);
    SINEW_TRY(CheckInput(name, kAngle, *angle.channel, angle.grid->time, "rad"));
    AnkleTrial made;
    made.name = name;
    made.task = ConditionOr(trial, kFoot, 1) == 0           ? AnkleTask::kAttachmentAlone
                : ConditionOr(trial, kPassiveTrial, 0) != 0 ? AnkleTask::kPassive
                                                            : AnkleTask::kActive;
    SINEW_ASSIGN(const auto motion, Smooth(name, angle.grid->time, angle.channel->values));
    SINEW_TRY(AddBlock(made, trial, kTorque, "N*m", AnkleQuantity::kMachineTorque, 0, motion));
    if (made.task != AnkleTask::kAttachmentAlone) {
      SINEW_TRY(AddBlock(made, trial, kAnkle, "rad", AnkleQuantity::kAnkleAngle, 0, motion));
      for (std::size_t m = 0; m < prepared_.settings.muscles.size(); ++m) {
        const std::string channel = prepared_.settings.muscles[m].name + "_fibre_length";
        if (trial.Find(channel))
          SINEW_TRY(AddBlock(made, trial, channel, "m", AnkleQuantity::kFibreLength, m, motion));
      }
    }
    if (made.task == AnkleTask::kActive) SINEW_TRY(AddExcitations(made, trial));
    if (made.task == AnkleTask::kPassive) NoteIfActive(made, trial, motion);
    Discretise(made, motion);
    prepared_.trials.push_back(std::move(made));
    return {};
  }

  // What the signals of unknown terms span. The foot turns about as far as the plate; where its own angle was
  // measured, single samples that jump do not count.
  [[nodiscard]] AnkleRanges Ranges() const {
    constexpr double kJumps = 0.005;  // share of samples at either end
    constexpr double kMore = 0.1;
    const double none = std::numeric_limits<double>::infinity();
    AnkleRanges ranges;
    ranges.machine_angle = {none, -none};
    ranges.duration = 0;
    ranges.excitation.assign(prepared_.paths.size(), 0);
    double fastest = 0;
    std::vector<double> ankle;
    for (const AnkleTrial& trial : prepared_.trials) {
      ranges.duration = std::max(ranges.duration, trial.stops.back() - trial.stops.front());
      if (trial.task == AnkleTask::kAttachmentAlone) continue;
      for (const PlateMotion& plate : trial.plate) {
        ranges.machine_angle.lowest = std::min(ranges.machine_angle.lowest, plate.angle);
        ranges.machine_angle.highest = std::max(ranges.machine_angle.highest, plate.angle);
        fastest = std::max(fastest, std::abs(plate.velocity));
      }
      for (std::size_t m = 0; m < trial.excitations.size(); ++m) {
        for (const double value : trial.excitations[m])
          ranges.excitation[m] = std::max(ranges.excitation[m], value);
      }
      for (const AnkleBlock& block : trial.blocks) {
        const auto& measured = prepared_.layout[static_cast<std::size_t>(block.block)].measured;
        if (block.quantity == AnkleQuantity::kAnkleAngle)
          ankle.insert(ankle.end(), measured.begin(), measured.end());
      }
    }
    if (ranges.machine_angle.lowest > ranges.machine_angle.highest)
      ranges.machine_angle = AnkleRanges().machine_angle;
    ranges.ankle_angle = ranges.machine_angle;
    if (!ankle.empty()) {
      ranges.ankle_angle.lowest = std::min(ranges.ankle_angle.lowest, Quantile(ankle, kJumps));
      ranges.ankle_angle.highest = std::max(ranges.ankle_angle.highest, Quantile(ankle, 1 - kJumps));
    }
    // The foot may turn a little further and faster than the plate.
    const double more = kMore * (ranges.ankle_angle.highest - ranges.ankle_angle.lowest);
    ranges.ankle_angle.lowest -= more;
    ranges.ankle_angle.highest += more;
    ranges.ankle_velocity = {-(1 + kMore) * fastest, (1 + kMore) * fastest};
    // No mean is above the mean of the largest ones.
    if (!ranges.excitation.empty())
      ranges.mean_activation = std::accumulate(ranges.excitation.begin(), ranges.excitation.end(), 0.0) /
                               static_cast<double>(ranges.excitation.size());
    return ranges;
  }

  // The machine's angle without what is faster than the cut-off: its second derivative is needed.
  Result<NaturalQuinticSpline> Smooth(const std::string& name, const std::vector<double>& time,
                                      std::vector<double> values) {
    if (prepared_.settings.angle_cutoff != 0) {
      const auto rate = UniformRate(time);
      if (!rate) return Fail("trial '{}': {}: {}", name, kAngle, rate.error().message);
      auto smooth = SmoothedAngle(values, *rate, prepared_.settings.angle_cutoff);
      if (!smooth) return Fail("trial '{}': {}: {}", name, kAngle, smooth.error().message);
      values = std::move(smooth->values);
    }
    auto spline = NaturalQuinticSpline::Fit(time, std::move(values));
    if (!spline) return Fail("trial '{}': {}: {}", name, kAngle, spline.error().message);
    return std::move(*spline);
  }

  Status AddBlock(AnkleTrial& made, const Trial& trial, const std::string& channel, const char* unit,
                  AnkleQuantity quantity, std::size_t muscle, const NaturalQuinticSpline& motion) {
    const auto found = trial.Find(channel);
    if (found && found.channel->unit != unit)
      return Fail("trial '{}': {} is in {}, expected {}", made.name, channel, found.channel->unit, unit);
    const auto from = found ? found : trial.Find(kTorque);
    const Sampled grid = AtRate(*from.grid, *from.channel, prepared_.settings.rate);
    Block block;
    block.trial = made.name;
    block.channel = channel;
    block.unit = unit;
    block.role = trial.role == Role::kTrain ? BlockRole::kTrain : BlockRole::kValidate;
    const double first = motion.first_time() - kSameTime;
    const double last = motion.last_time() + kSameTime;
    // Beyond the samples, at their mean distance.
    const double apart = grid.time.size() < 2 ? 0.01
                                              : (grid.time.back() - grid.time.front()) /
                                                    static_cast<double>(grid.time.size() - 1);
    const int extra = static_cast<int>(std::ceil(margin_ / apart));
    for (int k = extra; k > 0; --k) {
      const double t = grid.time.front() - k * apart;
      if (t >= first) block.prediction_time.push_back(t);
    }
    const std::size_t before = block.prediction_time.size();
    for (std::size_t i = 0; i < grid.time.size(); ++i) {
      const double t = grid.time[i];
      if (t < first || t > last)
        return Fail("trial '{}': {} is measured at t = {:.6g} s, but {} only from {:.6g} to {:.6g} s",
                    made.name, channel, t, kAngle, motion.first_time(), motion.last_time());
      block.prediction_time.push_back(t);
      if (found && std::isfinite(grid.values[i])) {
        block.sample.push_back(static_cast<int>(before + i));
        block.measured.push_back(grid.values[i]);
      }
    }
    for (int k = 1; k <= extra; ++k) {
      const double t = grid.time.back() + k * apart;
      if (t <= last) block.prediction_time.push_back(t);
    }
    if (block.measured.empty()) {
      if (quantity == AnkleQuantity::kMachineTorque)
        return Fail("trial '{}': {} has no value", made.name, channel);
      block.role = BlockRole::kPredicted;
    } else {
      // The median of normal noise scatters 1.25 times as much as its mean.
      block.sigma = found.channel->sigma;
      if (block.sigma && grid.samples > 1) *block.sigma *= 1.25 / std::sqrt(grid.samples);
    }
    made.stops.insert(made.stops.end(), block.prediction_time.begin(), block.prediction_time.end());
    made.blocks.push_back({static_cast<int>(prepared_.layout.size()), quantity, muscle, {}});
    prepared_.layout.push_back(std::move(block));
    return {};
  }

  // What speaks against a passive trial, or against the signs of its channels.
  void NoteIfActive(const AnkleTrial& made, const Trial& trial, const NaturalQuinticSpline& motion) {
    constexpr double kSilent = 0.05;      // excitation
    constexpr double kOff = 0.2;          // of the reading at rest elsewhere
    constexpr double kLeastRange = 0.15;  // [rad] of a rotation that shows a stiffness
    constexpr double kClear = 0.6;        // correlation
    const auto emg = trial.grids.find(kExcitations);
    for (const AnkleMuscle& muscle : prepared_.settings.muscles) {
      if (emg == trial.grids.end()) break;
      const auto found = emg->second.channels.find(muscle.excitation);
      if (found == emg->second.channels.end()) continue;
      const auto known = Finite(found->second.values);
      const double high = known.empty() ? 0 : Quantile(known, 0.98);
      if (!known.empty() && high < kOff * RestOf(muscle.excitation))
        prepared_.notes.push_back(
            fmt::format("trial '{}': the excitation of {} stays below {:.2g}, less than a fifth of what its "
                        "electrode reads at rest "
                        "elsewhere: was its amplifier off? It cannot show that the muscle was silent",
                        made.name, muscle.name, high));
      if (high > kSilent)
        prepared_.notes.push_back(
            fmt::format("trial '{}' is said to be passive, but the excitation of {} reaches {:.2g}; its "
                        "muscles are taken as "
                        "silent",
                        made.name, muscle.name, high));
    }
    const auto torque = trial.Find(kTorque);
    std::vector<double> angles;
    for (const double t : torque.grid->time) angles.push_back(motion.At(t).value);
    const auto [least, most] = std::minmax_element(angles.begin(), angles.end());
    const double together = Correlation(angles, torque.channel->values);
    if (*most - *least > kLeastRange && together > kClear)
      prepared_.notes.push_back(fmt::format(
          "trial '{}': the torque of the passive ankle rises with the angle (correlation {:.2f}), as if it "
          "pushed "
          "away from rest: is the sign of {} or of {} wrong? Both are positive towards dorsiflexion",
          made.name, together, kAngle, kTorque));
  }

  // Tasks without a fitted trial: what only they tell apart comes from priors and starts.
  void NoteWhatIsMissing() {
    struct Missing {
      AnkleTask task;
      const char* text;
    };
    const Missing all[] = {{AnkleTask::kAttachmentAlone,
                            "no trial of the attachment alone (condition foot = 0) is fitted: its weight and "
                            "inertia are told apart "
                            "from those of foot and passive ankle by priors only"},
                           {AnkleTask::kPassive,
                            "no trial of a person who relaxes (condition passive = 1) is fitted: passive "
                            "ankle, sole and straps are told "
                            "apart from the muscles by active trials only"},
                           {AnkleTask::kActive,
                            "no trial of active muscles is fitted: their strength and activation stay at "
                            "their starts or priors"}};
    for (const Missing& one : all) {
      const bool fitted =
          std::any_of(prepared_.trials.begin(), prepared_.trials.end(), [&](const AnkleTrial& trial) {
            return trial.task == one.task && data_.trials.at(trial.name).role == Role::kTrain;
          });
      if (!fitted && !(one.task == AnkleTask::kActive && prepared_.settings.muscles.empty()))
        prepared_.notes.emplace_back(one.text);
    }
  }

  // The least excitation of a muscle at rest in active trials: what its electrode reads of noise.
  [[nodiscard]] double RestOf(const std::string& excitation) const {
    double rest = std::numeric_limits<double>::infinity();
    for (const auto& [name, trial] : data_.trials) {
      const auto emg = trial.grids.find(kExcitations);
      if (ConditionOr(trial, kPassiveTrial, 0) != 0 || emg == trial.grids.end()) continue;
      const auto found = emg->second.channels.find(excitation);
      if (found == emg->second.channels.end()) continue;
      const auto known = Finite(found->second.values);
      if (!known.empty()) rest = std::min(rest, Quantile(known, 0.02));
    }
    return std::isfinite(rest) ? rest : 0;
  }

  Status AddExcitations(AnkleTrial& made, const Trial& trial) {
    bool cut = false;
    for (const AnkleMuscle& muscle : prepared_.settings.muscles) {
      const auto grid = trial.grids.find(kExcitations);
      if (grid == trial.grids.end())
        return Fail("trial '{}' has no grid '{}'; a trial of a person who relaxes has the condition {} = 1",
                    made.name, kExcitations, kPassiveTrial);
      const auto found = grid->second.channels.find(muscle.excitation);
      if (found == grid->second.channels.end()) {
        std::vector<std::string> names;
        for (const auto& [known, channel] : grid->second.channels) names.push_back(known);
        return Fail("trial '{}': grid '{}' has no channel '{}'{}", made.name, kExcitations, muscle.excitation,
                    Suggestion(muscle.excitation, names));
      }
      SINEW_TRY(CheckInput(made.name, muscle.excitation, found->second, grid->second.time, "1"));
      made.excitation_time = grid->second.time;
      if (made.excitation_time.size() < 2)
        return Fail("trial '{}': grid '{}' has one sample, expected more", made.name, kExcitations);
      std::vector<double> values = found->second.values;
      for (double& value : values) {
        cut = cut || value < 0 || value > 1;
        value = std::clamp(value, 0.0, 1.0);
      }
      made.excitations.push_back(std::move(values));
    }
    if (cut)
      prepared_.notes.push_back(
          fmt::format("trial '{}': excitations outside of 0..1 are cut off", made.name));
    return {};
  }

  void Discretise(AnkleTrial& trial, const NaturalQuinticSpline& motion) {
    std::sort(trial.stops.begin(), trial.stops.end());
    trial.stops.erase(std::unique(trial.stops.begin(), trial.stops.end(),
                                  [](double a, double b) { return b - a < kSameTime; }),
                      trial.stops.end());
    const auto at = [&](double t) {
      const auto value = motion.At(t);
      return PlateMotion{value.value, value.first, value.second};
    };
    for (const double t : trial.stops) trial.plate.push_back(at(t));
    trial.stage_times.push_back(trial.stops.front());
    trial.stage_angles.push_back(trial.plate.front().angle);
    for (std::size_t s = 1; s < trial.stops.size(); ++s) {
      const double span = trial.stops[s] - trial.stops[s - 1];
      const int parts = std::max(1, static_cast<int>(std::ceil(span / prepared_.settings.step - 1e-6)));
      for (int k = 0; k < parts; ++k) {
        AnkleTrial::Step step;
        step.begin = trial.stops[s - 1] + span * k / parts;
        step.length = span / parts;
        step.stop = k + 1 == parts ? static_cast<int>(s) : -1;
        for (int i = 0; i < ImplicitStep::kStages; ++i) {
          const auto stage = static_cast<std::size_t>(i);
          trial.stage_times.push_back(step.begin + step.length * ImplicitStep::kNodes[stage]);
          step.plate[stage] = at(trial.stage_times.back());
          trial.stage_angles.push_back(step.plate[stage].angle);
        }
        trial.steps.push_back(step);
      }
    }
    for (AnkleBlock& block : trial.blocks) {
      for (const double t : prepared_.layout[static_cast<std::size_t>(block.block)].prediction_time) {
        const auto found = std::lower_bound(trial.stops.begin(), trial.stops.end(), t - kSameTime);
        block.stop.push_back(static_cast<std::size_t>(found - trial.stops.begin()));
      }
    }
  }

  // Its stated noise, if all training blocks of the channel state it; else the channel's spread.
  [[nodiscard]] double WeightOf(const Block& block) const {
    bool all_sigma = block.sigma.has_value();
    double squares = 0;
    double samples = 0;
    for (const Block& other : prepared_.layout) {
      if (other.channel != block.channel || other.measured.empty()) continue;
      if (other.role != BlockRole::kTrain && &other != &block) continue;
      all_sigma = all_sigma && other.sigma;
      const Eigen::Map<const Vector> measured(other.measured.data(), other.samples());
      squares += (measured.array() - measured.mean()).square().sum();
      samples += other.samples();
    }
    if (all_sigma) return 1 / *block.sigma;
    const double deviation = samples > 0 ? std::sqrt(squares / samples) : 0;
    if (deviation > 0) return 1 / deviation;
    return block.unit == std::string("rad") ? 100 : block.unit == std::string("m") ? 1000 : 1;
  }

  const Dataset& data_;
  double margin_;
  AnkleData prepared_;
};

}  // namespace

std::string DescribeAnkleChannels() {
  return "machine_angle                               rad  input: of the plate, dorsiflexion positive\n"
         "machine_torque, on any grid                 N*m  measured: of foot and attachment on the motor\n"
         "grid excitations, one channel per muscle    1    input, 0..1; not in passive trials\n"
         "ankle_angle (optional)                      rad  measured: of the foot against the shank\n"
         "MUSCLE_fibre_length (optional)              m    measured\n"
         "conditions of a trial:\n"
         "  foot = 0                   the attachment alone (default 1)\n"
         "  passive = 1                the person relaxes (default 0)\n"
         "files:\n"
         "  ankle_on_dynamometer.yaml  settings with that key (or give --config)\n";
}

Result<AnkleData> PrepareAnkleData(const Dataset& data, AnkleSettings settings, double margin) {
  return Preparation(data, std::move(settings), margin).Run();
}

}  // namespace sinew
