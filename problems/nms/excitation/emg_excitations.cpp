#include "problems/nms/excitation/emg_excitations.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/numbers.h"
#include "base/text.h"
#include "models/emg/sampling.h"

namespace sinew {
namespace {

constexpr const char* kGridName = "excitations";
constexpr double kMaxFoldedBack = 0.01;
// Surface EMG has nearly all of its power below 400..500 Hz (De Luca 1997, J. Appl. Biomech. 13, 135).
constexpr double kUsualRate_Hz = 800;

template <class Map>
std::vector<std::string> Names(const Map& map) {
  std::vector<std::string> names;
  for (const auto& [name, unused] : map) names.push_back(name);
  return names;
}

bool HasVolts(const Grid& grid) {
  return std::any_of(grid.channels.begin(), grid.channels.end(),
                     [](const auto& channel) { return channel.second.unit == "V"; });
}

struct Muscle {
  std::string channel;
  std::string name;
  std::string unit;
  double maximum = 0;  // over the trials that count
  std::string maximum_trial;
  double maximum_time_s = 0;
  double divisor = 1;
  double largest = 0;  // over all trials
  std::string largest_trial;
  std::size_t samples = 0;
  std::size_t undershoot = 0;
  double deepest = 0;
};

class Excitations {
 public:
  explicit Excitations(const ExcitationSettings& settings) : settings_(settings) {}

  Result<ExcitationReport> Add(Dataset& data) {
    SINEW_TRY(CheckRate());
    SINEW_TRY(FindRecordings(data));
    SINEW_TRY(FindMuscles(data));
    SINEW_TRY(CheckNamedTrials(data));
    report_.lines.emplace_back();  // filled in last
    for (auto& [name, grid] : recordings_) {
      const Status filtered = Filter(name, data.trials[name]);
      if (!filtered) return Fail("trial '{}': {}", name, filtered.error().message);
    }
    for (Muscle& muscle : muscles_) {
      SINEW_TRY(Normalise(muscle, data));
      report_.lines.push_back(Line(muscle));
    }
    report_.lines.front() = Summary();
    return std::move(report_);
  }

 private:
  Status CheckRate() const {
    if (settings_.rate_Hz == 0) return {};
    if (!(settings_.rate_Hz > 0) || !std::isfinite(settings_.rate_Hz))
      return Fail("rate {} Hz: expected 0 or more", settings_.rate_Hz);
    const double left = LowPassAmplitude(settings_.envelope, settings_.rate_Hz / 2);
    if (left <= kMaxFoldedBack) return {};
    const double enough =
        2 * settings_.envelope.low_pass_Hz * std::pow(1 / kMaxFoldedBack - 1, 1.0 / settings_.envelope.order);
    return Fail("a rate of {} Hz is too low for an envelope low-passed at {} Hz, expected at least {:.4g} Hz",
                settings_.rate_Hz, settings_.envelope.low_pass_Hz, std::ceil(enough));
  }

  Status FindRecordings(const Dataset& data) {
    std::vector<std::string> without;
    for (const auto& [name, trial] : data.trials) {
      const auto grid = FindGrid(trial);
      if (!grid) return Fail("trial '{}': {}", name, grid.error().message);
      if (grid->empty()) {
        without.push_back(name);
      } else {
        recordings_[name] = *grid;
      }
    }
    if (recordings_.empty()) {
      std::map<std::string, bool> grids;
      for (const auto& [name, trial] : data.trials)
        for (const auto& [grid, content] : trial.grids) grids[grid] = true;
      const std::string wanted = settings_.grids.empty()
                                     ? "no trial has a grid of raw EMG (named emg, or with channels in V)"
                                     : "no trial has a grid '" + Join(settings_.grids, "' or '") + "'";
      return Fail("{}; its grids are {}", wanted, Join(Names(grids), ", "));
    }
    if (!without.empty())
      report_.notes.push_back(fmt::format("no raw EMG in {}: left as they are", Join(without, ", ")));
    return {};
  }

  // Empty: the trial has none.
  Result<std::string> FindGrid(const Trial& trial) const {
    std::vector<std::string> named;
    std::vector<std::string> in_volts;
    for (const auto& [name, grid] : trial.grids) {
      if (!settings_.grids.empty()) {
        const auto& wanted = settings_.grids;
        if (std::find(wanted.begin(), wanted.end(), name) != wanted.end()) named.push_back(name);
      } else if (name != kGridName) {
        if (Lowercase(name).find("emg") != std::string::npos) named.push_back(name);
        if (HasVolts(grid)) in_volts.push_back(name);
      }
    }
    const auto& found = named.empty() ? in_volts : named;
    if (found.size() > 1)
      return Fail("{} could all be raw EMG; choose one with --grid", Join(found, " and "));
    return found.empty() ? std::string() : found.front();
  }

  Status FindMuscles(const Dataset& data) {
    std::map<std::string, bool> present;
    std::vector<std::string> left_out;
    for (const auto& [trial, grid_name] : recordings_) {
      const Grid& grid = data.trials.at(trial).grids.at(grid_name);
      const bool volts = HasVolts(grid);
      for (const auto& [channel, content] : grid.channels) {
        const bool counts = !volts || content.unit == "V" || !settings_.channels.empty();
        if (counts) present[channel] = true;
        if (!counts && std::find(left_out.begin(), left_out.end(), channel) == left_out.end())
          left_out.push_back(channel);
      }
    }
    if (!left_out.empty())
      report_.notes.push_back(fmt::format("not in V, so no raw EMG: {}", Join(left_out, ", ")));
    std::map<std::string, std::string> taken;
    for (const auto& [channel, muscle] : Wanted(present)) {
      if (present.count(channel) == 0)
        return Fail("channel '{}' does not exist{}", channel, Suggestion(channel, Names(present)));
      const auto [other, is_new] = taken.emplace(muscle, channel);
      if (!is_new)
        return Fail("channels '{}' and '{}' would both become '{}'", other->second, channel, muscle);
      Muscle made;
      made.channel = channel;
      made.name = muscle;
      muscles_.push_back(std::move(made));
    }
    return {};
  }

  [[nodiscard]] std::vector<std::pair<std::string, std::string>> Wanted(
      const std::map<std::string, bool>& present) const {
    if (!settings_.channels.empty()) return settings_.channels;
    std::vector<std::pair<std::string, std::string>> all;
    for (const auto& [name, unused] : present) all.emplace_back(name, name);
    return all;
  }

  Status CheckNamedTrials(const Dataset& data) const {
    if (settings_.normalisation != Normalisation::kNamedTrials) return {};
    for (const std::string& trial : settings_.trials) {
      if (data.trials.count(trial) == 0) {
        return Fail("no trial '{}' to normalise by; the trials are {}", trial,
                    Join(Names(data.trials), ", "));
      }
      if (recordings_.count(trial) == 0) {
        return Fail("trial '{}', to normalise by, has no raw EMG; trials with raw EMG are {}", trial,
                    Join(Names(recordings_), ", "));
      }
    }
    return {};
  }

  [[nodiscard]] bool Counts(const std::string& trial) const {
    const auto& named = settings_.trials;
    return settings_.normalisation != Normalisation::kNamedTrials ||
           std::find(named.begin(), named.end(), trial) != named.end();
  }

  Status Filter(const std::string& name, Trial& trial) {
    const Grid& grid = trial.grids.at(recordings_.at(name));
    SINEW_ASSIGN(const double rate_Hz, UniformRate(grid.time));
    NoteRate(name, rate_Hz);
    Grid made;
    for (Muscle& muscle : muscles_) {
      const auto found = grid.channels.find(muscle.channel);
      if (found == grid.channels.end()) {
        return Fail("grid '{}' has no channel '{}'; choose channels that all trials have with --channels",
                    recordings_.at(name), muscle.channel);
      }
      const Channel& raw = found->second;
      if (muscle.unit.empty()) muscle.unit = raw.unit;
      if (muscle.unit != raw.unit) {
        return Fail("channel '{}' has the unit {}, but {} in another trial", muscle.channel, raw.unit,
                    muscle.unit);
      }
      auto envelope = ComputeEnvelope(raw.values, rate_Hz, settings_.envelope);
      if (!envelope) return Fail("channel '{}': {}", muscle.channel, envelope.error().message);
      NoteFaults(name, muscle, envelope->faults, grid.time, rate_Hz);
      Remember(name, *envelope, grid.time, muscle);
      Channel channel{muscle.unit, ChannelKind::kInput, std::nullopt, std::move(envelope->values)};
      // Straight lines between the samples of an envelope; a rate that is no lower changes nothing.
      if (settings_.rate_Hz > 0 && settings_.rate_Hz < rate_Hz) {
        SampledSignal sampled = SampleAtRate(grid.time, channel.values, settings_.rate_Hz);
        made.time = std::move(sampled.time);
        channel.values = std::move(sampled.values);
      } else {
        made.time = grid.time;
      }
      made.channels.emplace(muscle.name, std::move(channel));
    }
    if (trial.grids.count(kGridName) != 0)
      report_.notes.push_back(fmt::format("trial '{}': its grid '{}' was replaced", name, kGridName));
    trial.grids[kGridName] = std::move(made);
    return {};
  }

  void NoteRate(const std::string& trial, double rate_Hz) {
    if (rate_Hz < kUsualRate_Hz) {
      report_.notes.push_back(fmt::format(
          "trial '{}': sampled at {:.4g} Hz; surface EMG has components up to 400 Hz, and what is above "
          "{:.4g} Hz is lost "
          "or folded back. Is this raw EMG?",
          trial, rate_Hz, rate_Hz / 2));
    }
    if (settings_.rate_Hz >= rate_Hz) {
      report_.notes.push_back(
          fmt::format("trial '{}': stays at its {:.4g} Hz, which is no more than the {} Hz asked for", trial,
                      rate_Hz, settings_.rate_Hz));
    }
  }

  void NoteFaults(const std::string& trial, const Muscle& muscle, const RawEmgFaults& faults,
                  const std::vector<double>& time, double rate_Hz) {
    const auto note = [&](const std::string& what) {
      report_.notes.push_back(fmt::format("trial '{}', {}: {}", trial, muscle.name, what));
    };
    if (faults.silent) note("no signal: the raw values never change");
    const auto describe = [&](const std::vector<SampleRun>& runs) {
      const SampleRun& longest = LongestRun(runs);
      return fmt::format("{} samples in {} places, the longest {} ms at t = {:.4g} s", TotalSamples(runs),
                         runs.size(), Readable(1e3 * static_cast<double>(longest.count) / rate_Hz),
                         time[longest.first]);
    };
    if (!faults.gaps.empty()) note("gaps were bridged: " + describe(faults.gaps));
    if (!faults.clipped.empty()) {
      note("clipped: the raw signal stays at its extreme value for " + describe(faults.clipped) +
           "; the envelope is too low there");
    }
    if (!faults.frozen.empty()) {
      note("dropouts: the raw signal is constant for " + describe(faults.frozen) +
           "; they were taken as measured, and the envelope falls there");
    }
  }

  void Remember(const std::string& trial, const Envelope& envelope, const std::vector<double>& time,
                Muscle& muscle) {
    muscle.samples += envelope.values.size();
    muscle.undershoot += envelope.undershoot;
    muscle.deepest = std::min(muscle.deepest, envelope.deepest);
    if (envelope.maximum > muscle.largest) {
      muscle.largest = envelope.maximum;
      muscle.largest_trial = trial;
    }
    if (!Counts(trial) || envelope.maximum <= muscle.maximum) return;
    muscle.maximum = envelope.maximum;
    muscle.maximum_trial = trial;
    muscle.maximum_time_s = time[envelope.maximum_at];
    const double unsettled = UnsettledSeconds(settings_.envelope);
    muscle_at_end_[muscle.name] =
        muscle.maximum_time_s < time.front() + unsettled || muscle.maximum_time_s > time.back() - unsettled;
  }

  Status Normalise(Muscle& muscle, Dataset& data) {
    if (settings_.normalisation == Normalisation::kNone) return {};
    if (settings_.normalisation == Normalisation::kGiven) {
      const auto given = settings_.maxima.find(muscle.name);
      if (given == settings_.maxima.end())
        return Fail("no maximum is given for the muscle '{}'", muscle.name);
      muscle.divisor = given->second;
    } else {
      muscle.divisor = muscle.maximum;
    }
    if (!(muscle.divisor > 0)) {
      return Fail(
          "muscle '{}' has no signal in {}: nothing to divide by; leave it out with --channels", muscle.name,
          settings_.normalisation == Normalisation::kNamedTrials ? "trial " + Join(settings_.trials, ", ")
                                                                 : std::string("any trial"));
    }
    std::size_t above = 0;
    for (const auto& [trial, grid] : recordings_) {
      Channel& channel = data.trials[trial].grids[kGridName].channels[muscle.name];
      channel.unit = "1";
      for (double& value : channel.values) {
        value /= muscle.divisor;
        above += value > 1 ? 1 : 0;
      }
    }
    if (above > 0) {
      report_.notes.push_back(fmt::format(
          "{}: {} samples lie above 1, at most {} in trial '{}': the maximum that it was divided by "
          "was not its largest effort",
          muscle.name, above, Readable(muscle.largest / muscle.divisor), muscle.largest_trial));
    }
    if (settings_.normalisation != Normalisation::kGiven && muscle_at_end_[muscle.name]) {
      report_.notes.push_back(
          fmt::format("{}: its maximum lies at an end of trial '{}', where the filter depends on a single "
                      "sample; cut that "
                      "end off, or normalise by other trials",
                      muscle.name, muscle.maximum_trial));
    }
    return {};
  }

  [[nodiscard]] std::string Line(const Muscle& muscle) const {
    std::string text = muscle.name;
    if (muscle.name != muscle.channel) text += " (" + muscle.channel + ")";
    const std::string maximum =
        muscle.maximum > 0
            ? fmt::format("maximum {} {} in trial '{}' at t = {:.4g} s", Readable(muscle.maximum, 4),
                          muscle.unit, muscle.maximum_trial, muscle.maximum_time_s)
            : std::string("no signal");
    text += ": " + maximum;
    switch (settings_.normalisation) {
      case Normalisation::kAllTrials:
        text += ", divided by it";
        break;
      case Normalisation::kNamedTrials:
        text += fmt::format(", divided by it; over all trials at most {}",
                            Readable(muscle.largest / muscle.divisor));
        break;
      case Normalisation::kGiven:
        text += fmt::format(", divided by {} {}: at most {}", Readable(muscle.divisor, 4), muscle.unit,
                            Readable(muscle.largest / muscle.divisor));
        break;
      case Normalisation::kNone:
        text += ", not divided";
        break;
    }
    if (muscle.undershoot > 0) {
      text += fmt::format(
          "; {} % of samples were below 0 (down to {} % of the largest) and are 0 now",
          Readable(100.0 * static_cast<double>(muscle.undershoot) / static_cast<double>(muscle.samples), 2),
          Readable(100 * muscle.deepest / muscle.largest, 2));
    }
    return text;
  }

  [[nodiscard]] std::string Summary() const {
    const EnvelopeSettings& e = settings_.envelope;
    return fmt::format(
        "{} muscles in {} trials: high-pass {} Hz, rectified, low-pass {} Hz, both of order {} without lag "
        "(order {} forward and backward), {}",
        muscles_.size(), recordings_.size(), e.high_pass_Hz, e.low_pass_Hz, e.order, e.order / 2,
        settings_.rate_Hz > 0 ? fmt::format("{} Hz", settings_.rate_Hz) : "at the recording's rate");
  }

  const ExcitationSettings& settings_;
  std::map<std::string, std::string> recordings_;  // trial -> its grid of raw EMG
  std::vector<Muscle> muscles_;
  std::map<std::string, bool> muscle_at_end_;
  ExcitationReport report_;
};

}  // namespace

Result<ExcitationReport> AddExcitations(Dataset& data, const ExcitationSettings& settings) {
  return Excitations(settings).Add(data);
}

}  // namespace sinew
