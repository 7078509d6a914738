#include "problems/nms/data.h"

#include <algorithm>
#include <cmath>

#include "base/spline.h"
#include "base/text.h"
#include "models/muscle/spline_end.h"
#include "problems/nms/arm_slopes.h"

namespace sinew {
namespace {

constexpr double kSameTime = 1e-6;  // [s]

Result<const Grid*> FindGrid(const Trial& trial, const std::string& name) {
  const auto found = trial.grids.find(name);
  if (found != trial.grids.end()) return &found->second;
  std::vector<std::string> names;
  for (const auto& [grid, content] : trial.grids) names.push_back(grid);
  return Fail("has no grid '{}'{}", name, Suggestion(name, names));
}

Result<std::vector<double>> FindValues(const Grid& grid, const std::string& grid_name,
                                       const std::string& channel, const std::string& unit) {
  const auto found = grid.channels.find(channel);
  if (found == grid.channels.end()) {
    std::vector<std::string> names;
    for (const auto& [name, content] : grid.channels) names.push_back(name);
    return Fail("grid '{}' has no channel '{}'{}", grid_name, channel, Suggestion(channel, names));
  }
  if (found->second.unit != unit)
    return Fail("channel '{}' of grid '{}' has the unit {}, expected {}", channel, grid_name,
                found->second.unit, unit);
  const auto& values = found->second.values;
  const auto gap = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
  if (gap != values.end())
    return Fail("channel '{}' of grid '{}' has a gap at t = {} s", channel, grid_name,
                grid.time[static_cast<std::size_t>(gap - values.begin())]);
  return values;
}

class Preparation {
 public:
  Preparation(const NmsSettings& settings, const std::vector<std::string>& unmeasured)
      : settings_(settings), unmeasured_(unmeasured) {
    out_.notes = settings.notes;
    for (const std::string& joint : settings.joints) {
      std::vector<int> indices;
      for (const auto& [dof, movers] : settings.subject.dofs) {
        if (dof != joint) continue;
        for (const std::string& muscle : movers) indices.push_back(IndexOf(muscle));
      }
      out_.joint_muscles.push_back(std::move(indices));
    }
    out_.muscle_joints.resize(out_.muscles.size());
    for (std::size_t j = 0; j < out_.joint_muscles.size(); ++j) {
      for (const int m : out_.joint_muscles[j])
        out_.muscle_joints[static_cast<std::size_t>(m)].push_back(static_cast<int>(j));
    }
  }

  Result<NmsData> Run(const Dataset& data) {
    for (std::size_t m = 0; m < out_.muscles.size(); ++m) {
      if (out_.muscle_joints[m].size() > kMaxJoints)
        return Fail("the muscle '{}' crosses {} of the joints that are fitted, expected at most {}",
                    out_.muscles[m], out_.muscle_joints[m].size(), kMaxJoints);
    }
    if (data.trials.empty()) return Fail("holds no trial");
    for (const auto& [name, trial] : data.trials) {
      const Status added = Add(name, trial);
      if (!added) return Fail("trial '{}': {}", name, added.error().message);
    }
    AddArmSlopes();
    WeighAlike();
    if (settings_.fibre_range) AddFibreBlocks();
    if (cut_off_ > 0) {
      out_.notes.push_back(fmt::format(
          "{} of {} samples of excitations were outside of 0..1 and were cut off", cut_off_, all_));
    }
    NoteFloors();
    const auto& time = out_.trials.front().time;
    out_.rate = static_cast<double>(time.size() - 1) / (time.back() - time.front());
    return std::move(out_);
  }

 private:
  int IndexOf(const std::string& muscle) {
    const auto found = std::find(out_.muscles.begin(), out_.muscles.end(), muscle);
    if (found == out_.muscles.end()) {
      out_.muscles.push_back(muscle);
      return static_cast<int>(out_.muscles.size()) - 1;
    }
    return static_cast<int>(found - out_.muscles.begin());
  }

  // The mean of the signals that excite the muscle; without a list, the signal of its own name.
  Result<std::vector<double>> Excitation(const Grid& grid, const std::string& muscle) {
    if (IsUnmeasured(muscle)) return std::vector<double>(grid.time.size(), 0);
    const std::vector<std::string> sources = ExcitationSources(settings_.subject, muscle);
    if (sources.empty()) return Fail("no channel of the subject excites the muscle '{}'", muscle);
    for (const std::string& source : sources) {
      if (grid.channels.count(source) == 0 && settings_.mode.type != NmsModeType::kOpenLoop) {
        return Fail(
            "grid 'excitations' has no channel '{}': open loop and every fit need it; the mode {} of the "
            "settings is one of `sinew simulate` alone",
            source, ToString(settings_.mode.type));
      }
    }
    std::vector<double> sum(grid.time.size(), 0);
    for (const std::string& source : sources) {
      SINEW_ASSIGN(const auto values, FindValues(grid, "excitations", source, "1"));
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i] / static_cast<double>(sources.size());
    }
    for (double& e : sum) {
      ++all_;
      if (e >= 0 && e <= 1) continue;
      ++cut_off_;
      e = std::clamp(e, 0.0, 1.0);
    }
    return sum;
  }

  [[nodiscard]] bool IsUnmeasured(const std::string& muscle) const {
    return std::find(unmeasured_.begin(), unmeasured_.end(), muscle) != unmeasured_.end();
  }

  Status Add(const std::string& name, const Trial& trial) {
    NmsTrial made;
    made.name = name;
    SINEW_ASSIGN(const Grid* lengths, FindGrid(trial, "lengths"));
    const Grid* excitations = lengths;  // of its times, where nothing is measured
    if (trial.grids.count("excitations") > 0 ||
        !std::all_of(out_.muscles.begin(), out_.muscles.end(),
                     [&](const std::string& muscle) { return IsUnmeasured(muscle); })) {
      SINEW_ASSIGN(excitations, FindGrid(trial, "excitations"));
    }
    if (excitations->time.size() < 2 || lengths->time.size() < 4)
      return Fail("has {} samples of excitations and {} of lengths, expected 2 and 4",
                  excitations->time.size(), lengths->time.size());
    made.time = lengths->time;
    std::shared_ptr<const std::vector<double>> end_weights;
    if (settings_.model.tendon == TendonMode::kEquilibrium)
      end_weights = std::make_shared<const std::vector<double>>(SplineEndWeights(lengths->time));
    for (const std::string& muscle : out_.muscles) {
      MuscleSignals signals;
      signals.end_weights = end_weights;
      signals.excitation_time = excitations->time;
      SINEW_ASSIGN(signals.excitation, Excitation(*excitations, muscle));
      signals.time = lengths->time;
      SINEW_ASSIGN(signals.unit_length, FindValues(*lengths, "lengths", muscle, "m"));
      made.muscles.push_back(std::move(signals));
    }
    AddOthers(made);
    made.first_block = static_cast<int>(out_.layout.size());
    bool any = false;
    for (std::size_t j = 0; j < settings_.joints.size(); ++j) {
      SINEW_TRY(AddArms(trial, j, made));
      SINEW_TRY(AddMotion(trial, j, made));
      SINEW_ASSIGN(const bool measured, AddBlock(trial, j, made));
      any = any || measured;
    }
    if (!any)
      return Fail("has no measured moment: expected a channel such as {}_moment", settings_.joints.front());
    out_.trials.push_back(std::move(made));
    return {};
  }

  void AddFibreBlocks() {
    const FibreRange& range = *settings_.fibre_range;
    for (NmsTrial& trial : out_.trials) {
      const auto first = out_.layout.begin() + trial.first_block;
      const bool fitted = std::any_of(first, first + static_cast<std::ptrdiff_t>(settings_.joints.size()),
                                      [](const Block& b) { return b.role == BlockRole::kTrain; });
      if (!fitted) continue;
      trial.first_fibre_block = static_cast<int>(out_.layout.size());
      for (const std::string& muscle : out_.muscles) {
        Block block;
        block.trial = trial.name;
        block.channel = muscle + "_fibre_length";
        block.unit = "1";
        block.role = BlockRole::kPredicted;
        block.prediction_time = trial.time;
        block.range = Range{range.lower, range.upper, range.strict};
        block.weight = 1 / range.tolerance;
        // As the thesis divides its penalty too (eq 4.6).
        if (settings_.objective == NmsObjective::kThesis)
          block.weight /= std::sqrt(static_cast<double>(trial.time.size()));
        out_.layout.push_back(std::move(block));
      }
    }
  }

  // An excitation that never comes down in one recording, but does in another: its floor was not taken off,
  // or the muscle was never at rest. What is fitted to one recording then fails on the other.
  void NoteFloors() {
    constexpr double kSurelyMore = 0.03;   // than in the recording where it is lowest
    constexpr double kShareOfPeak = 0.15;  // of the same recording
    for (std::size_t m = 0; m < out_.muscles.size(); ++m) {
      std::vector<double> floors;
      std::vector<double> peaks;
      for (const NmsTrial& trial : out_.trials) {
        std::vector<double> sorted = trial.muscles[m].excitation;
        std::sort(sorted.begin(), sorted.end());
        floors.push_back(sorted[sorted.size() / 100]);
        peaks.push_back(sorted[sorted.size() - 1 - sorted.size() / 100]);
      }
      const auto lowest =
          static_cast<std::size_t>(std::min_element(floors.begin(), floors.end()) - floors.begin());
      for (std::size_t t = 0; t < floors.size(); ++t) {
        if (!(floors[t] > floors[lowest] + kSurelyMore && floors[t] > kShareOfPeak * peaks[t])) continue;
        out_.notes.push_back(fmt::format(
            "the excitation of {} never falls below {:.2g} in trial '{}', but to {:.2g} in '{}': was its "
            "floor taken "
            "off in both? What is fitted to one will not predict the other",
            out_.muscles[m], floors[t], out_.trials[t].name, floors[lowest], out_.trials[lowest].name));
      }
    }
  }

  // For every muscle, the mean excitation of all others.
  static void AddOthers(NmsTrial& made) {
    const std::size_t count = made.muscles.size();
    if (count < 2) return;
    for (std::size_t m = 0; m < count; ++m) {
      std::vector<double>& others = made.muscles[m].others;
      others.assign(made.muscles[m].excitation.size(), 0);
      made.muscles[m].number_of_others = static_cast<int>(count) - 1;
      for (std::size_t other = 0; other < count; ++other) {
        if (other == m) continue;
        for (std::size_t k = 0; k < others.size(); ++k)
          others[k] += made.muscles[other].excitation[k] / static_cast<double>(count - 1);
      }
    }
  }

  // The recorded angle of the joint, if there is one that covers the trial.
  Status AddMotion(const Trial& trial, std::size_t j, NmsTrial& made) {
    made.motion.emplace_back();
    const Trial::Found found = trial.Find(settings_.joints[j]);
    if (!found) return {};
    if (found.channel->unit != "rad")
      return Fail("channel '{}' has the unit {}, expected rad", settings_.joints[j], found.channel->unit);
    std::vector<double> time;
    std::vector<double> angle;
    for (std::size_t i = 0; i < found.grid->time.size(); ++i) {
      if (!std::isfinite(found.channel->values[i])) continue;
      time.push_back(found.grid->time[i]);
      angle.push_back(found.channel->values[i]);
    }
    if (time.size() < 4 || time.front() > made.time.front() + kSameTime ||
        time.back() < made.time.back() - kSameTime)
      return Fail("the angle '{}' does not cover the times of grid 'lengths'", settings_.joints[j]);
    SINEW_ASSIGN(const auto spline, NaturalCubicSpline::Fit(std::move(time), std::move(angle)));
    NmsMotion& motion = made.motion.back();
    const auto count = static_cast<Eigen::Index>(made.time.size());
    motion.angle.resize(count);
    motion.velocity.resize(count);
    motion.acceleration.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = spline.At(made.time[static_cast<std::size_t>(i)]);
      motion.angle[i] = at.value;
      motion.velocity[i] = at.first;
      motion.acceleration[i] = at.second;
    }
    return {};
  }

  Status AddArms(const Trial& trial, std::size_t j, NmsTrial& made) const {
    const std::string grid_name = "moment_arms." + settings_.joints[j];
    SINEW_ASSIGN(const Grid* grid, FindGrid(trial, grid_name));
    const bool alike = grid->time.size() == made.time.size() &&
                       std::equal(grid->time.begin(), grid->time.end(), made.time.begin(),
                                  [](double a, double b) { return std::abs(a - b) < kSameTime; });
    if (!alike) return Fail("grid '{}' has other times than grid 'lengths'", grid_name);
    std::vector<Vector> arms;
    bool any = false;
    for (const int m : out_.joint_muscles[j]) {
      SINEW_ASSIGN(const auto values,
                   FindValues(*grid, grid_name, out_.muscles[static_cast<std::size_t>(m)], "m"));
      arms.emplace_back(Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size())));
      any = any || arms.back().any();
      made.muscles[static_cast<std::size_t>(m)].arms.push_back(values);
    }
    if (!any) return Fail("no muscle has a moment arm in grid '{}': the joint cannot move", grid_name);
    made.arms.push_back(std::move(arms));
    return {};
  }

  // Zero where the angle was not recorded in every trial.
  void AddArmSlopes() {
    for (std::size_t m = 0; m < out_.muscles.size(); ++m) {
      const std::vector<int>& crosses = out_.muscle_joints[m];
      for (std::size_t crossed = 0; crossed < crosses.size(); ++crossed) {
        const std::vector<Vector> slopes = ArmSlopesOf(m, crossed);
        for (std::size_t t = 0; t < out_.trials.size(); ++t) {
          std::vector<double> values(out_.trials[t].time.size(), 0);
          if (!slopes.empty()) values.assign(slopes[t].data(), slopes[t].data() + slopes[t].size());
          out_.trials[t].muscles[m].arm_slopes.push_back(std::move(values));
        }
      }
    }
  }

  [[nodiscard]] std::vector<Vector> ArmSlopesOf(std::size_t m, std::size_t crossed) const {
    const std::vector<int>& crosses = out_.muscle_joints[m];
    const auto recorded = [&](int joint) {
      return std::all_of(out_.trials.begin(), out_.trials.end(), [&](const NmsTrial& trial) {
        return trial.motion[static_cast<std::size_t>(joint)].angle.size() > 0;
      });
    };
    if (!recorded(crosses[crossed])) return {};
    std::vector<int> joints{crosses[crossed]};
    for (const int other : crosses) {
      if (other != joints.front() && recorded(other)) joints.push_back(other);
    }
    std::vector<Vector> arms;
    std::vector<std::vector<Vector>> angles;
    for (const NmsTrial& trial : out_.trials) {
      const std::vector<double>& arm = trial.muscles[m].arms[crossed];
      arms.emplace_back(Eigen::Map<const Vector>(arm.data(), static_cast<Eigen::Index>(arm.size())));
      angles.emplace_back();
      for (const int joint : joints)
        angles.back().push_back(trial.motion[static_cast<std::size_t>(joint)].angle);
    }
    return ArmSlopes(arms, angles);
  }

  // A joint whose moment was not measured is predicted.
  Result<bool> AddBlock(const Trial& trial, std::size_t j, const NmsTrial& made) {
    Block block;
    block.trial = made.name;
    block.channel = settings_.joints[j] + "_moment";
    block.unit = "N*m";
    block.prediction_time = made.time;
    const Trial::Found found = trial.Find(block.channel);
    if (!found) {
      block.role = BlockRole::kPredicted;
      out_.layout.push_back(std::move(block));
      return false;
    }
    if (found.channel->unit != "N*m")
      return Fail("channel '{}' has the unit {}, expected N*m", block.channel, found.channel->unit);
    block.role = trial.role == Role::kTrain ? BlockRole::kTrain : BlockRole::kValidate;
    block.sigma = found.channel->sigma;
    std::size_t at = 0;
    for (std::size_t i = 0; i < found.grid->time.size(); ++i) {
      const double t = found.grid->time[i];
      while (at < made.time.size() && made.time[at] < t - kSameTime) ++at;
      if (at == made.time.size()) break;
      if (made.time[at] > t + kSameTime || !std::isfinite(found.channel->values[i])) continue;
      block.sample.push_back(static_cast<int>(at));
      block.measured.push_back(found.channel->values[i]);
    }
    if (block.measured.size() < 2)
      return Fail("channel '{}' has {} samples at the times of grid 'lengths', expected 2", block.channel,
                  block.measured.size());
    SINEW_TRY(Weigh(block));
    out_.layout.push_back(std::move(block));
    return true;
  }

  // The thesis's objective (eq 4.6) divides by the variance of the moment and by the samples, so that every
  // trial counts alike; else the weight is that of the noise, see WeighAlike.
  Status Weigh(Block& block) const {
    const auto count = static_cast<double>(block.measured.size());
    const Eigen::Map<const Vector> measured(block.measured.data(), block.samples());
    const double variance = (measured.array() - measured.mean()).square().sum() / (count - 1);
    if (!(variance > 0)) return Fail("channel '{}' does not change: it has no information", block.channel);
    if (settings_.objective == NmsObjective::kThesis) {
      block.weight = 1 / std::sqrt(variance * count);
    } else if (block.sigma) {
      block.weight = 1 / *block.sigma;
    }
    return {};
  }

  // Noise that is not stated is taken as equal in all trials: the same sensor measured them. Divided by the
  // spread of the moment in the training trials.
  void WeighAlike() {
    if (settings_.objective == NmsObjective::kThesis) return;
    for (const std::string& joint : settings_.joints) {
      const std::string channel = joint + "_moment";
      double squares = 0;
      double count = 0;
      for (const Block& block : out_.layout) {
        if (block.channel != channel || block.role != BlockRole::kTrain) continue;
        const Eigen::Map<const Vector> measured(block.measured.data(), block.samples());
        squares += (measured.array() - measured.mean()).square().sum();
        count += static_cast<double>(block.samples());
      }
      for (Block& block : out_.layout) {
        if (block.channel == channel && !block.sigma && count > 0)
          block.weight = 1 / std::sqrt(squares / count);
      }
    }
  }

  const NmsSettings& settings_;
  const std::vector<std::string>& unmeasured_;
  NmsData out_;
  long cut_off_ = 0;
  long all_ = 0;
};

}  // namespace

std::string DescribeNmsChannels() {
  return "grid excitations, channels of the subject's channels, or of its muscles   1    0..1\n"
         "grid lengths, one per muscle                                              m    of muscle and "
         "tendon\n"
         "grid moment_arms.JOINT, one per muscle that moves it                      m    times as in "
         "lengths\n"
         "  (both from a model's geometry: `sinew data muscles`)\n"
         "JOINT_moment, on any grid                                                 N*m  measured\n"
         "  (an excitation may be missing where `sinew simulate nms --mode` finds it: docs/nms_modes.md)\n"
         "JOINT, on any grid (optional: for causes that depend on the motion)       rad  its angle\n"
         "files:\n"
         "  nms.yaml                   settings with key `nms` (or give --config)\n"
         "  subject.xml                the muscles, as CEINMS or CEINMS-RT has them\n";
}

Result<NmsData> PrepareNmsData(const Dataset& data, const NmsSettings& settings,
                               const std::vector<std::string>& unmeasured) {
  return Preparation(settings, unmeasured).Run(data);
}

}  // namespace sinew
