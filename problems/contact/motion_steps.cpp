#include "problems/contact/motion_steps.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "base/text.h"
#include "datasets/cut.h"
#include "datasets/stances/stances.h"
#include "models/dynamometer/smooth_angle.h"
#include "problems/contact/contact_model.h"
#include "problems/contact/loaded_span.h"
#include "problems/contact/soles/body_tree.h"
#include "problems/contact/trial_motion.h"
#include "problems/whole_body_dynamics.h"

namespace sinew {
namespace {

// How far the heel and the toe of one foot are ahead of the body [T, m].
struct FootTrack {
  std::vector<double> heel;
  std::vector<double> toe;
};

struct Tracks {
  std::vector<double> time;  // [T, s]
  std::map<std::string, FootTrack> feet;
};

// The first body between ground and a foot.
int RootOf(const BodyTree& tree, int body) {
  while (tree.depth(body) > 1) body = tree.parent(body);
  return body;
}

// The horizontal direction in which the feet point, in the mean over half a second before and after [T].
std::vector<Vec3> Ahead(const std::vector<double>& time, const std::vector<std::vector<BodyMotion>>& motions,
                        std::size_t feet) {
  constexpr double kAround = 0.5;  // [s]
  std::vector<Vec3> sums{Vec3::Zero()};
  for (const std::vector<BodyMotion>& at_instant : motions) {
    Vec3 sum = sums.back();
    for (std::size_t f = 0; f < feet; ++f) {
      Vec3 pointing = at_instant[f].rotation * Vec3::UnitX();
      pointing.y() = 0;
      sum += pointing;
    }
    sums.push_back(sum);
  }
  std::vector<Vec3> ahead;
  for (const double t : time) {
    const auto first = std::lower_bound(time.begin(), time.end(), t - kAround) - time.begin();
    const auto last = std::upper_bound(time.begin(), time.end(), t + kAround) - time.begin();
    const Vec3 mean = sums[static_cast<std::size_t>(last)] - sums[static_cast<std::size_t>(first)];
    ahead.push_back(mean.norm() > 0 ? Vec3(mean.normalized()) : Vec3::UnitX());
  }
  return ahead;
}

Result<Tracks> TracksOf(const Trial& trial, const ContactModel& model, const BodyTree& tree,
                        const ContactSettings& settings) {
  SINEW_ASSIGN(const TrialMotion recorded, FitTrialMotion(trial, model.multibody));
  SINEW_ASSIGN(const double rate, FrameRate(recorded));
  Tracks tracks;
  tracks.time = recorded.time;
  const std::size_t regions = settings.regions.size();
  std::vector<int> bodies = model.bodies;
  bodies.push_back(RootOf(tree, model.bodies.front()));
  SINEW_ASSIGN(const auto motions, model.multibody.BodyMotions(recorded.time, recorded.trajectory, bodies));
  const std::vector<Vec3> ahead = Ahead(recorded.time, motions, regions);
  for (const std::string& plate : settings.Plates()) {
    FootTrack& track = tracks.feet[plate];
    for (std::size_t t = 0; t < motions.size(); ++t) {
      double heel = std::numeric_limits<double>::infinity();
      double toe = -heel;
      for (std::size_t r = 0; r < regions; ++r) {
        const ContactRegionSettings& of = settings.regions[r];
        if (of.plate != plate) continue;
        const BodyMotion& body = motions[t][r];
        for (const int face : of.region.SpringFaceIndices()) {
          const Vec3 spring =
              body.position +
              body.rotation * (of.region.position + of.region.rotation * of.region.mesh.Centre(face));
          const double at = ahead[t].dot(spring - motions[t].back().position);
          heel = std::min(heel, at);
          toe = std::max(toe, at);
        }
      }
      track.heel.push_back(heel);
      track.toe.push_back(toe);
    }
    for (std::vector<double>* values : {&track.heel, &track.toe}) {
      SINEW_ASSIGN(SmoothAngle smooth, SmoothedAngle(*values, rate, kWalkingCutoff));
      *values = std::move(smooth.values);
    }
  }
  return tracks;
}

// Where the parabola through three samples is extreme.
double Refined(const std::vector<double>& time, const std::vector<double>& values, std::size_t i) {
  const double left = values[i] - values[i - 1];
  const double right = values[i] - values[i + 1];
  const double curvature = left + right;
  const double shift = curvature != 0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0;
  return time[i] + shift * (shift > 0 ? time[i + 1] - time[i] : time[i] - time[i - 1]);
}

// Times of the maxima of sign * values on whose both sides it falls by a third of its range.
std::vector<double> Extremes(const std::vector<double>& time, const std::vector<double>& values,
                             double sign) {
  constexpr double kFalls = 1.0 / 3;
  constexpr double kLeastRange = 0.03;  // [m]: smaller motion of a foot is no step, of a small robot either
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double range = *high - *low;
  std::vector<double> found;
  if (!(range > kLeastRange)) return found;
  std::size_t highest = 0;
  std::size_t lowest = 0;
  bool rises = false;  // the last extreme that is certain was a minimum
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double value = sign * values[i];
    if (value > sign * values[highest]) highest = i;
    if (value < sign * values[lowest]) lowest = i;
    if (rises && value < sign * values[highest] - kFalls * range) {
      found.push_back(Refined(time, values, highest));
      rises = false;
      lowest = i;
    } else if (!rises && value > sign * values[lowest] + kFalls * range) {
      rises = true;
      highest = i;
    }
  }
  return found;
}

struct Events {
  std::vector<double> lands;
  std::vector<double> leaves;
};

Events EventsOf(const Tracks& tracks, const std::string& plate) {
  const FootTrack& track = tracks.feet.at(plate);
  return {Extremes(tracks.time, track.heel, 1), Extremes(tracks.time, track.toe, -1)};
}

// When plates of the settings carried a foot: plate, from, to.
std::vector<MotionStep> MeasuredSteps(const Trial& trial, const ContactSettings& settings) {
  std::vector<MotionStep> steps;
  const bool is_step = WindowOf(trial).has_value();
  for (const std::string& plate : settings.Plates()) {
    const auto vertical = trial.Find(plate + "_force_y");
    if (!vertical || !is_step) continue;
    const auto span = LoadedSpan(vertical.grid->time, vertical.channel->values, vertical.grid->time.front(),
                                 vertical.grid->time.back());
    if (span) steps.push_back({plate, (*span)[0], (*span)[1], ""});
  }
  if (is_step) return steps;
  for (const Contact& contact : FindContacts(trial).contacts) {
    const auto plates = settings.Plates();
    if (contact.fault == ContactFault::kNone &&
        std::find(plates.begin(), plates.end(), contact.plate) != plates.end())
      steps.push_back({contact.plate, contact.from, contact.to, ""});
  }
  return steps;
}

// A step that was cut from a recording is there twice while the recording is.
std::vector<MotionStep> NotAmong(const std::vector<MotionStep>& known, std::vector<MotionStep> steps) {
  constexpr double kSame = 0.05;  // [s]
  steps.erase(std::remove_if(steps.begin(), steps.end(),
                             [&](const MotionStep& step) {
                               return std::any_of(known.begin(), known.end(), [&](const MotionStep& other) {
                                 return other.plate == step.plate &&
                                        std::abs(other.from - step.from) < kSame &&
                                        std::abs(other.to - step.to) < kSame;
                               });
                             }),
              steps.end());
  return steps;
}

// A plate of the foot carried something, a whole stance or not.
bool IsMeasured(const MotionStep& step, const std::vector<Contact>& contacts) {
  constexpr double kLeast = 0.05;  // [s] in common
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return contact.plate == step.plate &&
           std::min(contact.to, step.to) - std::max(contact.from, step.from) > kLeast;
  });
}

// What the event nearest to a measured time differs from it, if any is near.
std::optional<double> DelayTo(double measured, const std::vector<double>& events) {
  constexpr double kNear = 0.2;  // [s]
  std::optional<double> nearest;
  for (const double event : events) {
    const double delay = measured - event;
    if (std::abs(delay) < kNear && (!nearest || std::abs(delay) < std::abs(*nearest))) nearest = delay;
  }
  return nearest;
}

EventDelay Summary(const std::vector<double>& delays) {
  EventDelay summary;
  summary.scatter = std::numeric_limits<double>::quiet_NaN();
  const auto count = static_cast<double>(delays.size());
  if (delays.empty()) return summary;
  for (const double delay : delays) summary.mean += delay / count;
  if (delays.size() < 2) return summary;
  double squares = 0;
  for (const double delay : delays) squares += (delay - summary.mean) * (delay - summary.mean);
  summary.scatter = std::sqrt(squares / (count - 1));
  return summary;
}

MotionSteps::OfTrial StepsOf(const std::string& name, const Tracks& tracks, const MotionSteps& delays,
                             const std::vector<Contact>& contacts) {
  MotionSteps::OfTrial found;
  found.trial = name;
  found.frames = tracks.time;
  for (const auto& [plate, track] : tracks.feet) {
    const Events events = EventsOf(tracks, plate);
    for (std::size_t i = 0; i < events.lands.size(); ++i) {
      const double from = events.lands[i];
      const auto leaves = std::upper_bound(events.leaves.begin(), events.leaves.end(), from);
      const bool next = i + 1 < events.lands.size();
      if (leaves == events.leaves.end() || (next && *leaves > events.lands[i + 1])) {
        ++found.cut_off;
        continue;
      }
      MotionStep step{plate, from + delays.begin.mean, *leaves + delays.end.mean, ""};
      if (step.from < tracks.time.front() || step.to > tracks.time.back() || !(step.to > step.from))
        ++found.cut_off;
      else if (IsMeasured(step, contacts))
        ++found.measured;
      else
        found.steps.push_back(std::move(step));
    }
    // The foot is on the floor when the recording begins.
    if (!events.leaves.empty() && (events.lands.empty() || events.leaves.front() < events.lands.front()))
      ++found.cut_off;
  }
  std::stable_sort(found.steps.begin(), found.steps.end(),
                   [](const MotionStep& a, const MotionStep& b) { return a.from < b.from; });
  std::map<std::string, int> count;
  for (MotionStep& step : found.steps)
    step.trial = fmt::format("{}_{}_{}", name, step.plate, ++count[step.plate]);
  return found;
}

}  // namespace

Result<MotionSteps> FindMotionSteps(const Dataset& data, const ContactSettings& settings,
                                    const std::vector<std::string>& trials) {
  SINEW_ASSIGN(const ContactModel model, LoadContactModel(data, settings));
  SINEW_ASSIGN(const BodyTree tree, BodyTree::Of(model.osim, model.multibody));
  MotionSteps found;
  std::vector<double> begins;
  std::vector<double> ends;
  std::vector<MotionStep> all;
  for (const auto& [name, trial] : data.trials) {
    const std::vector<MotionStep> measured = NotAmong(all, MeasuredSteps(trial, settings));
    all.insert(all.end(), measured.begin(), measured.end());
    if (measured.empty()) continue;
    const auto tracks = TracksOf(trial, model, tree, settings);
    if (!tracks) continue;  // forces without a motion tell no delay
    for (const MotionStep& step : measured) {
      const Events events = EventsOf(*tracks, step.plate);
      const auto begin = DelayTo(step.from, events.lands);
      const auto end = DelayTo(step.to, events.leaves);
      if (begin) begins.push_back(*begin);
      if (end) ends.push_back(*end);
      found.measured += begin && end ? 1 : 0;
    }
  }
  found.begin = Summary(begins);
  found.end = Summary(ends);
  for (const std::string& name : trials) {
    const auto trial = data.trials.find(name);
    if (trial == data.trials.end()) {
      std::vector<std::string> names;
      for (const auto& [other, unused] : data.trials) names.push_back(other);
      return Fail("trial '{}' does not exist{}", name, Suggestion(name, names));
    }
    const auto tracks = TracksOf(trial->second, model, tree, settings);
    if (!tracks) return Fail("trial '{}': {}", name, tracks.error().message);
    found.trials.push_back(StepsOf(name, *tracks, found, FindContacts(trial->second).contacts));
  }
  return found;
}

Status CutMotionSteps(const MotionSteps::OfTrial& found, Dataset& data) {
  std::vector<std::string> made;
  const auto cut = [&](const MotionStep& step) -> Status {
    TrialWindow window;
    window.trial = found.trial;
    window.start_s = step.from;
    window.end_s = step.to;
    window.name = step.trial;
    window.role = Role::kValidate;
    SINEW_TRY(CutTrial(data, window));
    made.push_back(step.trial);
    Trial& trial = data.trials.at(step.trial);
    SINEW_TRY(KeepPlates(trial, {}));
    for (auto grid = trial.grids.begin(); grid != trial.grids.end();)
      grid = grid->second.channels.empty() ? trial.grids.erase(grid) : std::next(grid);
    Grid plate;
    for (const double t : found.frames) {
      if (t >= step.from && t <= step.to) plate.time.push_back(t);
    }
    const std::vector<double> unknown(plate.time.size(), std::numeric_limits<double>::quiet_NaN());
    for (const std::string& kind : kContactChannels) {
      Channel channel;
      channel.unit = kind == "moment_y" ? "N*m" : kind.rfind("cop", 0) == 0 ? "m" : "N";
      channel.values = unknown;
      plate.channels[step.plate + "_" + kind] = std::move(channel);
    }
    trial.grids["plates"] = std::move(plate);
    return {};
  };
  for (const MotionStep& step : found.steps) {
    const Status done = cut(step);
    if (done) continue;
    for (const std::string& name : made) data.trials.erase(name);
    return done;
  }
  return {};
}

}  // namespace sinew
