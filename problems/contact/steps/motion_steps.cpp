#include "problems/contact/steps/motion_steps.h"

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
#include "problems/contact/contact_model.h"
#include "problems/contact/motion/loaded_span.h"
#include "problems/contact/soles/body_tree.h"
#include "problems/contact/steps/gait_events.h"

namespace sinew {
namespace {

// When plates of the settings carried a foot: plate, from, to.
std::vector<MotionStep> MeasuredSteps(const Trial& trial, const ContactSettings& settings) {
  std::vector<MotionStep> steps;
  const bool is_step = WindowOf(trial).has_value();
  for (const std::string& plate : settings.Plates()) {
    const auto vertical = trial.Find(plate + "_force_y");
    if (!vertical || !is_step) continue;
    const auto span = LoadedSpan(vertical.grid->time, vertical.channel->values, vertical.grid->time.front(),
                                 vertical.grid->time.back(), vertical.channel->sigma.value_or(0));
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

MotionSteps::OfTrial StepsOf(const std::string& name, const FootTracks& tracks, const MotionSteps& delays,
                             const std::vector<Contact>& contacts) {
  MotionSteps::OfTrial found;
  found.trial = name;
  found.frames = tracks.time;
  for (const auto& [plate, track] : tracks.feet) {
    const GaitEvents events = EventsOf(tracks, plate);
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
      const GaitEvents events = EventsOf(*tracks, step.plate);
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
      channel.unit = PlateChannelUnit(kind);
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
