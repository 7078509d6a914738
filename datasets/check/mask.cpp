#include "datasets/check/mask.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "base/yaml_reader.h"

namespace sinew {
namespace {

constexpr double kSameInstant_s = 1e-9;
constexpr int kFewestSamples = 10;

// Measured channels of a trial within a span; of one grid, if it is given.
void AddMeasured(const std::string& trial_name, const Trial& trial, const TimeSpan& span,
                 const std::string& reason, const std::string& grid_only, std::vector<MaskedSpan>& mask) {
  for (const auto& [grid_name, grid] : trial.grids) {
    if (!grid_only.empty() && grid_name != grid_only) continue;
    for (const auto& [name, channel] : grid.channels) {
      if (channel.kind == ChannelKind::kMeasured) mask.push_back({trial_name, grid_name, name, span, reason});
    }
  }
}

TimeSpan ShorterPart(const Grid& grid, const TimeSpan& jump) {
  const TimeSpan before{grid.time.front(), jump.from};
  const TimeSpan after{jump.to, grid.time.back()};
  return before.to - before.from < after.to - after.from ? before : after;
}

// What a mask has changed, so that it can be taken back without a copy of all data.
struct MaskedValues {
  Channel* channel = nullptr;
  std::size_t first = 0;
  std::vector<double> before;
};

MaskedValues Mask(Channel& channel, const std::vector<double>& time, const TimeSpan& span, long& masked) {
  const auto first = std::lower_bound(time.begin(), time.end(), span.from - kSameInstant_s) - time.begin();
  const auto last = std::upper_bound(time.begin(), time.end(), span.to + kSameInstant_s) - time.begin();
  MaskedValues changed{&channel, static_cast<std::size_t>(first), {}};
  for (auto i = first; i < last; ++i) {
    double& value = channel.values[static_cast<std::size_t>(i)];
    masked += std::isnan(value) ? 0 : 1;
    changed.before.push_back(value);
    value = std::numeric_limits<double>::quiet_NaN();
  }
  return changed;
}

bool HoldsData(const Trial& trial, const std::vector<std::string>& channels) {
  for (const auto& [grid_name, grid] : trial.grids) {
    for (const auto& [name, channel] : grid.channels) {
      if (channel.kind != ChannelKind::kMeasured) continue;
      if (!channels.empty() && std::find(channels.begin(), channels.end(), name) == channels.end()) continue;
      if (std::count_if(channel.values.begin(), channel.values.end(), [](double v) {
            return std::isfinite(v);
          }) >= std::min<long>(kFewestSamples, static_cast<long>(channel.values.size())))
        return true;
    }
  }
  return false;
}

bool HasMeasured(const Trial& trial) {
  for (const auto& [grid_name, grid] : trial.grids) {
    for (const auto& [name, channel] : grid.channels) {
      if (channel.kind == ChannelKind::kMeasured) return true;
    }
  }
  return false;
}

std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace

std::vector<MaskedSpan> SuggestMask(const Dataset& dataset, const Finding& finding) {
  std::vector<MaskedSpan> mask;
  const auto found = dataset.trials.find(finding.trial);
  if (finding.undecided || finding.kind == FindingKind::kDrift || found == dataset.trials.end()) return mask;
  const Trial& trial = found->second;
  const Grid& grid = trial.grids.at(finding.grid);
  const std::string reason = ToString(finding.kind);
  if (finding.kind == FindingKind::kTimeJump) {
    for (const TimeSpan& span : finding.spans) {
      if (finding.whole) {
        AddMeasured(finding.trial, trial, span, reason, finding.grid, mask);
      } else {
        AddMeasured(finding.trial, trial, ShorterPart(grid, span), reason, "", mask);
      }
    }
    return mask;
  }
  if (finding.channel.empty()) {  // a device
    const bool measures = std::any_of(grid.channels.begin(), grid.channels.end(), [](const auto& channel) {
      return channel.second.kind == ChannelKind::kMeasured;
    });
    for (const TimeSpan& span : finding.spans)
      AddMeasured(finding.trial, trial, span, reason, measures ? finding.grid : "", mask);
    return mask;
  }
  const Channel& channel = grid.channels.at(finding.channel);
  for (const TimeSpan& span : finding.spans) {
    if (channel.kind == ChannelKind::kMeasured) {
      mask.push_back({finding.trial, finding.grid, finding.channel, span, reason});
    } else {
      AddMeasured(finding.trial, trial, span, reason, "", mask);
    }
  }
  return mask;
}

std::vector<MaskedSpan> SuggestMask(const Dataset& dataset, const std::vector<Finding>& findings) {
  std::vector<MaskedSpan> all;
  std::set<std::tuple<std::string, std::string, std::string, double, double>> known;
  for (const Finding& finding : findings) {
    for (MaskedSpan& span : SuggestMask(dataset, finding)) {
      if (known.insert({span.trial, span.grid, span.channel, span.span.from, span.span.to}).second)
        all.push_back(std::move(span));
    }
  }
  return all;
}

Result<MaskOutcome> ApplyMask(Dataset& dataset, const std::vector<MaskedSpan>& mask) {
  MaskOutcome outcome;
  std::string record = dataset.files.count(kMaskFile) == 0 ? "" : dataset.files.at(kMaskFile);
  if (record.empty())
    record = "# Values that were replaced by gaps (sinew data check --mask auto), times in s.\nmasked:\n";
  std::vector<MaskedValues> changed;
  for (const MaskedSpan& span : mask) {
    Grid& grid = dataset.trials.at(span.trial).grids.at(span.grid);
    changed.push_back(Mask(grid.channels.at(span.channel), grid.time, span.span, outcome.values));
    record += fmt::format("  - {{trial: {}, grid: {}, channel: {}, from: {}, to: {}, reason: {}}}\n",
                          Quoted(span.trial), Quoted(span.grid), Quoted(span.channel), span.span.from,
                          span.span.to, span.reason);
  }
  for (const auto& [name, trial] : dataset.trials) {
    if (HasMeasured(trial) && !HoldsData(trial, {})) outcome.removed.push_back(name);
  }
  if (!HasTrainingData(dataset)) {
    for (auto one = changed.rbegin(); one != changed.rend(); ++one)  // spans may overlap
      std::copy(one->before.begin(), one->before.end(),
                one->channel->values.begin() + static_cast<std::ptrdiff_t>(one->first));
    return Fail("nothing measured would be left in any training trial");
  }
  if (mask.empty()) return outcome;
  for (const std::string& name : outcome.removed) dataset.trials.erase(name);
  dataset.files[kMaskFile] = std::move(record);
  return outcome;
}

Result<std::vector<MaskedSpan>> RecordedMask(const Dataset& dataset) {
  std::vector<MaskedSpan> mask;
  const auto record = dataset.files.find(kMaskFile);
  if (record == dataset.files.end()) return mask;
  SINEW_ASSIGN(const YamlReader document, YamlReader::Parse(record->second, kMaskFile));
  SINEW_ASSIGN(const YamlReader list, document.At("masked"));
  SINEW_ASSIGN(const std::vector<YamlReader> items, list.Items());
  for (const YamlReader& item : items) {
    MaskedSpan span;
    for (const auto& [key, text] : {std::pair{"trial", &span.trial}, std::pair{"grid", &span.grid},
                                    std::pair{"channel", &span.channel}, std::pair{"reason", &span.reason}}) {
      SINEW_ASSIGN(const YamlReader value, item.At(key));
      SINEW_ASSIGN(*text, value.Text());
    }
    for (const auto& [key, number] : {std::pair{"from", &span.span.from}, std::pair{"to", &span.span.to}}) {
      SINEW_ASSIGN(const YamlReader value, item.At(key));
      SINEW_ASSIGN(*number, value.Number());
    }
    if (dataset.trials.count(span.trial) != 0) mask.push_back(std::move(span));
  }
  return mask;
}

bool HasTrainingData(const Dataset& dataset, const std::vector<std::string>& channels) {
  return std::any_of(dataset.trials.begin(), dataset.trials.end(), [&](const auto& trial) {
    return trial.second.role == Role::kTrain && HoldsData(trial.second, channels);
  });
}

}  // namespace sinew
