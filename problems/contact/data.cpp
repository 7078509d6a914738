#include "problems/contact/data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/constants.h"
#include "base/text.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "problems/contact/contact_model.h"
#include "problems/contact/load/plate_samples.h"
#include "problems/contact/motion/level_feet.h"
#include "problems/contact/motion/loaded_span.h"
#include "problems/contact/motion/marker_pose.h"
#include "problems/contact/motion/motion_priors.h"
#include "problems/contact/motion/progression.h"
#include "problems/contact/motion/smooth_motion.h"
#include "problems/contact/motion/trial_motion.h"
#include "problems/contact/soles/body_tree.h"
#include "problems/contact/stance_notes.h"

namespace sinew {
namespace {

// Columns of kContactChannels that depend on stiffness and dissipation alone: the others feel friction too.
bool FeelsFriction(const std::string& channel) {
  return channel != "force_y" && channel != "cop_x" && channel != "cop_z";
}

std::string QuantityOf(const std::string& channel) {
  static const std::map<std::string, std::string> kQuantities{{"force_x", "forward force"},
                                                              {"force_y", "vertical force"},
                                                              {"force_z", "sideways force"},
                                                              {"cop_x", "centre of pressure, forward"},
                                                              {"cop_z", "centre of pressure, sideways"},
                                                              {"moment_y", "free moment"}};
  return kQuantities.at(channel);
}

// Frames of the motion while the plate records, continued by `margin` on both sides as far as there are any.
Result<std::vector<double>> Frames(const Grid& forces, const std::vector<double>& motion, double margin) {
  if (forces.time.empty() || motion.empty())
    return Fail("{} samples of the forces and {} frames of the motion: nothing to compare",
                forces.time.size(), motion.size());
  std::vector<double> time;
  for (const double t : motion) {
    if (t >= forces.time.front() - margin && t <= forces.time.back() + margin) time.push_back(t);
  }
  constexpr std::size_t kFewest = 8;
  const auto recorded = static_cast<std::size_t>(std::count_if(time.begin(), time.end(), [&](double t) {
    return t >= forces.time.front() && t <= forces.time.back();
  }));
  if (recorded < kFewest) {
    return Fail(
        "{} frames of the motion ({:.4g} .. {:.4g} s) while there are forces ({:.4g} .. {:.4g} s); expected "
        "at least {}",
        recorded, motion.front(), motion.back(), forces.time.front(), forces.time.back(), kFewest);
  }
  return time;
}

// Times of the force plate within the motion, continued by `margin` on both sides in steps of its median
// interval.
Result<std::vector<double>> PredictionTimes(const Grid& forces, const CoordinateTrajectory& motion,
                                            double margin) {
  constexpr double kRounding = 1e-9;  // [s] times that were rebuilt from a rate may miss the end by rounding
  std::vector<double> time;
  for (const double t : forces.time) {
    if (t >= motion.first_time() - kRounding && t <= motion.last_time() + kRounding) time.push_back(t);
  }
  if (time.size() < 2) {
    return Fail("forces ({:.4g} .. {:.4g} s) and motion ({:.4g} .. {:.4g} s) do not overlap in time",
                forces.time.empty() ? NAN : forces.time.front(),
                forces.time.empty() ? NAN : forces.time.back(), motion.first_time(), motion.last_time());
  }
  if (margin <= 0) return time;
  std::vector<double> steps(time.size());
  std::adjacent_difference(time.begin(), time.end(), steps.begin());
  std::nth_element(steps.begin() + 1, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  const double step = steps[steps.size() / 2];
  std::vector<double> before;
  for (double t = time.front() - step; t >= time.front() - margin && t >= motion.first_time(); t -= step) {
    before.push_back(t);
  }
  std::vector<double> all(before.rbegin(), before.rend());
  all.insert(all.end(), time.begin(), time.end());
  for (double t = time.back() + step; t <= time.back() + margin && t <= motion.last_time(); t += step)
    all.push_back(t);
  return all;
}

double StandardDeviation(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / n);
}

Result<double> WeightOf(const Block& block, ContactObjective objective) {
  switch (objective) {
    case ContactObjective::kThesis:
      return 1.0;
    case ContactObjective::kNormalised: {
      const double deviation = StandardDeviation(block.measured);
      if (!(deviation > 0)) return Fail("channel '{}' does not vary: nothing to fit", block.channel);
      return 1 / (deviation * std::sqrt(static_cast<double>(block.measured.size())));
    }
    case ContactObjective::kLikelihood:
      if (!block.sigma)
        return Fail("objective likelihood needs the noise level (attribute sigma) of '{}'", block.channel);
      return 1 / *block.sigma;
  }
  return 1.0;
}

const std::optional<double>& StatedAccuracy(const ContactSettings& settings, const Block& block) {
  const ContactAccuracy& accuracy = settings.accuracy;
  return block.unit == "N" ? accuracy.force : block.unit == "m" ? accuracy.cop : accuracy.moment;
}

// No law of a few parameters follows a foot closer than this, and no plate is so bad. Nothing: no load.
std::optional<double> UsualAccuracy(const Stance& stance, const Block& block) {
  constexpr double kForceShare = 0.005;  // of the greatest vertical force
  constexpr double kLengthShare = 0.01;  // of the sole's length
  const double force = kForceShare * stance.greatest_force;
  if (!(force > 0)) return std::nullopt;
  return block.unit == "N"   ? force
         : block.unit == "m" ? kLengthShare * stance.length
                             : 0.5 * force * stance.length;
}

// The level to which a block is weighed by its likelihood. @param noise of the channel, if known
std::optional<double> AccuracyOf(const ContactSettings& settings, const Stance& stance, const Block& block,
                                 const std::optional<double>& noise) {
  if (const auto& stated = StatedAccuracy(settings, block)) return stated;
  return noise || !settings.motion_errors ? noise : UsualAccuracy(stance, block);
}

void AddMeasured(const Grid& grid, const Channel& channel, const ContactSettings& settings,
                 const Stance& stance, bool is_cop, Block& block) {
  if (settings.motion_errors) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    const double level = AccuracyOf(settings, stance, block, channel.sigma).value_or(kAny);
    AddLocalFits(grid, channel, stance.plate, is_cop, settings.cop_force_share, level, block);
  } else {
    AddSamples(grid, channel, stance.plate, is_cop, settings.cop_force_share, block);
  }
  block.sigma = AccuracyOf(settings, stance, block, block.sigma);
  // A stated accuracy is that of the law, whatever the noise of what is read.
  if (StatedAccuracy(settings, block)) block.relative_weight.clear();
}

Status AddBlocks(const Trial& trial, const ContactSettings& settings, Stance& stance, ContactData& out,
                 StanceNotes& notes) {
  std::vector<int> all_columns;
  std::vector<int> normal_columns;
  for (const Stance::Part& part : stance.parts) {
    const int first = part.group * kContactParametersPerGroup;
    for (int k = 0; k < kContactParametersPerGroup; ++k) all_columns.push_back(first + k);
    for (int k = 0; k < 2; ++k) normal_columns.push_back(first + k);
  }
  std::vector<int> shared_columns;  // that every channel depends on
  const auto groups = static_cast<int>(settings.Groups().size());
  int place = groups * kContactParametersPerGroup;
  for (std::size_t p = 0; p < settings.SolePlaces().size(); ++p, place += groups) {
    for (const Stance::Part& part : stance.parts) shared_columns.push_back(place + part.group);
  }
  for (const int column : out.effects.ColumnsOf(stance.plate)) shared_columns.push_back(column);
  const std::vector<int> motion_columns = stance.motion_errors.Columns();
  shared_columns.insert(shared_columns.end(), motion_columns.begin(), motion_columns.end());
  for (std::size_t c = 0; c < kContactChannels.size(); ++c) {
    const std::string& kind = kContactChannels[c];
    const bool fitted = std::find(settings.fit.begin(), settings.fit.end(), kind) != settings.fit.end();
    Block block;
    block.trial = stance.trial;
    block.channel = stance.plate + "_" + kind;
    block.quantity = QuantityOf(kind);
    block.unit = PlateChannelUnit(kind);
    block.prediction_time = stance.time;
    block.columns = FeelsFriction(kind) ? all_columns : normal_columns;
    block.columns.insert(block.columns.end(), shared_columns.begin(), shared_columns.end());
    const bool compared = fitted && stance.measured;
    block.role = !compared                    ? BlockRole::kPredicted
                 : trial.role == Role::kTrain ? BlockRole::kTrain
                                              : BlockRole::kValidate;
    const auto found = trial.Find(block.channel);
    if (found) {
      AddMeasured(*found.grid, *found.channel, settings, stance, kind.rfind("cop", 0) == 0, block);
      // The deviations follow the plate: what they leave is smaller than the noise, and correlated.
      block.white = settings.motion_errors && block.sigma;
    } else if (!stance.measured) {
      block.sigma = AccuracyOf(settings, stance, block, {});
    }
    if (compared) {
      if (block.measured.empty()) {
        return Fail("channel '{}' is to be fitted but {}", block.channel,
                    found ? "has no usable sample" : "is not measured");
      }
      SINEW_ASSIGN(block.weight, WeightOf(block, settings.objective));
      if (!settings.motion_errors) {
        const std::size_t recorded = found.channel->values.size();
        notes.NotCompared(stance, block.channel, recorded - block.measured.size(), recorded);
      }
    }
    stance.blocks[c] = static_cast<int>(out.layout.size());
    out.layout.push_back(std::move(block));
  }
  return {};
}

// The greatest vertical force, and from when to when the plate is loaded.
Status FindLoad(const Trial& trial, const ContactSettings& settings, Stance& stance) {
  const auto [grid_of_plate, channel] = trial.Find(stance.plate + "_force_y");
  const Grid& grid = *grid_of_plate;
  const Channel& force = *channel;
  stance.measured = false;
  for (const double f : force.values) {
    if (!std::isfinite(f)) continue;
    stance.measured = true;
    stance.greatest_force = std::max(stance.greatest_force, f);
  }
  if (!stance.measured) {
    if (trial.role == Role::kTrain)
      return Fail("{}_force_y has no value: a step without a plate can only be predicted (role validate)",
                  stance.plate);
    stance.loaded = WindowOf(trial).value_or(std::array<double, 2>{stance.recorded[0], stance.recorded[1]});
    return {};
  }
  // The accuracy of every channel is a share of this force.
  if (settings.motion_errors && !(stance.greatest_force > 0))
    return Fail("plate '{}' never carries an upward force: is it upside down?", stance.plate);
  const auto loaded =
      LoadedSpan(grid.time, force.values, stance.recorded[0], stance.recorded[1], force.sigma.value_or(0));
  stance.loaded = loaded.value_or(std::array<double, 2>{stance.recorded[0], stance.recorded[1]});
  return {};
}

// Of the instants of a stance, those while the plate records: the first, and the one after the last.
std::array<std::size_t, 2> RecordedInstants(const std::vector<double>& time, const Grid& forces) {
  const auto first = std::lower_bound(time.begin(), time.end(), forces.time.front());
  const auto last = std::upper_bound(first, time.end(), forces.time.back());
  return {static_cast<std::size_t>(first - time.begin()), static_cast<std::size_t>(last - time.begin())};
}

// Moves the foot to its markers and takes noise out of its motion. By what was recorded alone: what is
// predicted beside it, for late sensors, must not change it.
MarkerPose ImproveMotion(double cutoff, const std::array<std::size_t, 2>& recorded, Stance& stance) {
  const auto [first, last] = recorded;
  const std::vector<double> time(stance.time.begin() + static_cast<std::ptrdiff_t>(first),
                                 stance.time.begin() + static_cast<std::ptrdiff_t>(last));
  stance.LookForward((first + last) / 2);
  stance.foot.SetCentre(first);
  FootMotion foot = stance.foot.Part(first, last);
  FootMarkers markers = stance.markers.Part(first, last);
  const MarkerPose by_markers = MoveToMarkers(time, foot, markers);
  stance.pose_noise = by_markers.noise;
  SmoothMotion(time, cutoff, foot);
  stance.foot.TakeOver(foot, first);
  for (std::size_t m = 0; m < markers.markers.size(); ++m) {
    FootMarkers::Marker& marker = stance.markers.markers[m];
    marker.location = markers.markers[m].location;
    for (std::size_t t = 0; t < stance.time.size(); ++t) {
      if (t < first || t >= last) marker.measured[t].setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return by_markers;
}

Status AddTrial(const std::string& name, const Trial& trial, const ContactModel& model,
                const ContactSettings& settings, double margin, ContactData& out, StanceNotes& notes) {
  std::vector<std::string> plates;
  for (const std::string& plate : settings.Plates()) {
    if (trial.Find(plate + "_force_y")) plates.push_back(plate);
  }
  if (plates.empty()) return {};
  SINEW_ASSIGN(const TrialMotion recorded, FitTrialMotion(trial, model.multibody));
  const CoordinateTrajectory& motion = recorded.trajectory;
  notes.Held(name, motion.held());
  for (const std::string& plate : plates) {
    const auto vertical = trial.Find(plate + "_force_y");
    SINEW_ASSIGN(auto time, settings.motion_errors ? Frames(*vertical.grid, recorded.time, margin)
                                                   : PredictionTimes(*vertical.grid, motion, margin));
    SINEW_ASSIGN(Stance stance,
                 MakeStance(name, plate, std::move(time), motion, model.multibody, model.bodies, settings));
    stance.fitted = trial.role == Role::kTrain;
    const auto while_recorded = RecordedInstants(stance.time, *vertical.grid);
    stance.recorded = {stance.time[while_recorded[0]], stance.time[while_recorded[1] - 1]};
    SINEW_TRY(FindLoad(trial, settings, stance));
    for (const double t : stance.time) stance.kinematics.phase.push_back(PhaseShareAt(t, stance.loaded));
    if (settings.motion_errors) {
      stance.markers = MeasuredMarkers(trial, model.osim, model.multibody, stance.foot, stance.time);
      notes.MovedToMarkers(stance, ImproveMotion(settings.motion_errors->cutoff, while_recorded, stance));
      SINEW_ASSIGN(const BodyTree tree, BodyTree::Of(model.osim, model.multibody));
      const int root = tree.Root(model.bodies.front());
      SINEW_TRY(FindProgression(motion, model.multibody, root, settings.floor, stance));
      SINEW_ASSIGN(stance.body,
                   MeasuredBodyLoad(trial, stance, motion, model.multibody, model.bodies, settings, notes));
    }
    out.stances.push_back(std::move(stance));
  }
  return {};
}

// Of the settings, those that measured a force in any trial.
std::vector<std::string> MeasuredPlates(const Dataset& data, const ContactSettings& settings) {
  std::vector<std::string> plates;
  for (const std::string& plate : settings.Plates()) {
    const bool measured = std::any_of(data.trials.begin(), data.trials.end(), [&](const auto& trial) {
      const auto vertical = trial.second.Find(plate + "_force_y");
      return vertical && std::any_of(vertical.channel->values.begin(), vertical.channel->values.end(),
                                     [](double value) { return std::isfinite(value); });
    });
    if (measured) plates.push_back(plate);
  }
  return plates;
}

// Where no plate measured it: the mean of the stances whose plates did.
void SetGreatestForceOfUnmeasured(std::vector<Stance>& stances) {
  double sum = 0;
  double count = 0;
  for (const Stance& stance : stances) {
    if (!stance.measured) continue;
    sum += stance.greatest_force;
    count += 1;
  }
  for (Stance& stance : stances) {
    if (!stance.measured && count > 0) stance.greatest_force = sum / count;
  }
}

}  // namespace

Result<ContactData> PrepareContactData(const Dataset& data, const ContactSettings& settings, double margin) {
  SINEW_ASSIGN(const ContactModel model, LoadContactModel(data, settings));
  ContactData out;
  const int per_group = kContactParametersPerGroup + static_cast<int>(settings.SolePlaces().size());
  out.effects = ContactEffectList(static_cast<int>(settings.Groups().size()) * per_group,
                                  MeasuredPlates(data, settings));
  out.next_parameter = out.effects.end();
  StanceNotes notes;
  for (const auto& [name, trial] : data.trials) {
    const Status status = AddTrial(name, trial, model, settings, margin, out, notes);
    if (!status) return Fail("trial '{}': {}", name, status.error().message);
  }
  const bool any_measured = std::any_of(out.stances.begin(), out.stances.end(),
                                        [](const Stance& stance) { return stance.measured; });
  if (!any_measured) {
    return Fail("no trial has a vertical force of the plates {}: expected a channel such as {}_force_y",
                Join(settings.Plates(), ", "), settings.Plates().front());
  }
  SetGreatestForceOfUnmeasured(out.stances);
  if (settings.motion_errors) {
    const std::vector<double> raised = LevelFeet(out.stances);
    for (std::size_t s = 0; s < raised.size(); ++s) notes.Raised(out.stances[s], raised[s]);
    AddMotionErrors(*settings.motion_errors, settings.FloorVelocityError(), out.stances, out.next_parameter,
                    out.notes);
  }
  for (Stance& stance : out.stances) {
    const Status status = AddBlocks(data.trials.at(stance.trial), settings, stance, out, notes);
    if (!status) return Fail("trial '{}': {}", stance.trial, status.error().message);
  }
  const std::vector<std::string> of_stances = notes.Sentences();
  out.notes.insert(out.notes.begin(), of_stances.begin(), of_stances.end());
  // One floor under all stances turns about one point, in their midst, so that a slope is no height.
  std::array<double, 2> middle{};
  for (const std::size_t axis : {0U, 1U}) {
    double low = kInfinity;
    double high = -kInfinity;
    for (const Stance& stance : out.stances) {
      if (!stance.measured) continue;
      low = std::min(low, stance.middle[axis]);
      high = std::max(high, stance.middle[axis]);
    }
    middle[axis] = 0.5 * (low + high);
  }
  for (Stance& stance : out.stances) stance.kinematics.tilt_reference = middle;
  return out;
}

std::string DescribeContactChannels() {
  return "measured, per plate PLATE (such as right, left), any sampling rate:\n"
         "  PLATE_force_y                   N    vertical ground reaction force; a trial takes part with "
         "every plate that has it\n"
         "                                       (a held-out trial in which it has no value is a step "
         "without a "
         "plate, which is predicted)\n"
         "  PLATE_force_x, PLATE_force_z    N    tangential force (optional; identifies friction)\n"
         "  PLATE_cop_x, PLATE_cop_z        m    centre of pressure in the world (optional)\n"
         "  PLATE_moment_y                  N*m  free moment about the centre of pressure (optional)\n"
         "  whole_body_load_*, whole_body_torque_*, mass_centre_*    N, N*m, m    what the whole body needs "
         "of the "
         "ground\n"
         "                                  (`sinew data dynamics`): predicts held-out steps without their "
         "plates\n"
         "input:\n"
         "  every coordinate of the model   rad, m    joint angles and root position around the stance "
         "(`sinew data kinematics`)\n"
         "files:\n"
         "  model.osim                      the model that the coordinates belong to\n"
         "  contact.yaml                    settings with key `contact` (or give --config)\n";
}

}  // namespace sinew
