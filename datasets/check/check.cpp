#include "datasets/check/check.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include "datasets/check/clipping.h"
#include "datasets/check/cycle_timing.h"
#include "datasets/check/cycles.h"
#include "datasets/check/displaced_stretches.h"
#include "datasets/check/drift.h"
#include "datasets/check/excursions.h"
#include "datasets/check/foot_timing.h"
#include "datasets/check/odd_cycles.h"
#include "datasets/check/plausible.h"
#include "datasets/check/relations.h"
#include "datasets/check/repeats.h"
#include "datasets/check/rigid_markers.h"
#include "datasets/check/rotations.h"
#include "datasets/check/signals.h"
#include "datasets/check/stuck.h"
#include "datasets/check/time_stamps.h"
#include "datasets/check/two_feet.h"

namespace sinew {
namespace {

void Append(std::vector<Finding> more, std::vector<Finding>& all) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

void AppendNew(std::vector<Finding> more, std::vector<Finding>& all) {
  for (Finding& finding : more) {
    const bool known = std::any_of(all.begin(), all.end(),
                                   [&](const Finding& other) {
                                     return other.kind == finding.kind && other.trial == finding.trial &&
                                            other.grid == finding.grid && other.channel == finding.channel;
                                   }) ||
                       std::any_of(all.begin(), all.end(), [&](const Finding& other) {
                         // Of a pair of trials one is known to be wrong already, or its whole device to be
                         // late.
                         const bool device = other.channel.empty() && other.kind == FindingKind::kLag;
                         return finding.undecided && other.whole && other.kind == finding.kind &&
                                (device || other.channel == finding.channel);
                       });
    if (!known) all.push_back(std::move(finding));
  }
}

// What has a remark already does not get another one from the comparisons that follow.
void LeaveOut(const std::vector<Finding>& found, Signal& signal) {
  for (const Finding& finding : found) {
    if (finding.trial != signal.trial || finding.grid != signal.grid || finding.channel != signal.channel)
      continue;
    for (const TimeSpan& span : finding.spans) {
      const auto& time = *signal.time;
      const auto first = std::lower_bound(time.begin(), time.end(), span.from) - time.begin();
      const auto last = std::upper_bound(time.begin(), time.end(), span.to) - time.begin();
      signal.values.MakeGap(static_cast<std::size_t>(first), static_cast<std::size_t>(last));
    }
  }
}

}  // namespace

CheckReport CheckData(const Dataset& dataset) {
  CheckReport report;
  report.trials = static_cast<int>(dataset.trials.size());
  Append(FindTimeJumps(dataset), report.findings);
  std::vector<ChannelGroup> groups = GroupSignals(dataset);
  for (ChannelGroup& group : groups) {
    report.channels += static_cast<int>(group.signals.size());
    // What one of them found is left out for the next one.
    for (const auto& detector : {FindExcursions, FindStuck, FindClipping, FindDisplacedStretches}) {
      std::vector<Finding> found = detector(group);
      for (Signal& signal : group.signals) LeaveOut(found, signal);
      Append(std::move(found), report.findings);
    }
  }
  std::map<std::string, std::vector<const Signal*>> of_trial;
  for (const ChannelGroup& group : groups) {
    for (const Signal& signal : group.signals) of_trial[signal.trial].push_back(&signal);
  }
  std::map<std::string, Cycles> cycles_of_trial;
  for (const auto& [trial, signals] : of_trial) {
    const Cycles& cycles = cycles_of_trial[trial] = FindCycles(signals);
    for (const Signal* signal : signals) Append(FindDrift(*signal, cycles), report.findings);
    if (cycles.count() == 0) continue;
    report.cycles[trial] = cycles.count();
    for (const Signal* signal : signals) Append(FindOddCycles(*signal, cycles), report.findings);
  }
  Append(FindTwoFeet(dataset), report.findings);
  const std::vector<Finding> of_segments = FindBrokenSegments(groups);
  // One remark per channel that is wrong as a whole.
  AppendNew(of_segments, report.findings);
  AppendNew(FindLatePlates(dataset, groups), report.findings);
  AppendNew(FindBrokenRotations(dataset), report.findings);
  AppendNew(FindLateInCycles(cycles_of_trial, of_trial), report.findings);
  std::vector<Finding> whole = FindImplausible(dataset, groups);
  const std::vector<ChannelGroup> alike = ByTask(groups);
  for (const ChannelGroup& group : alike) Append(FindOddScales(group), whole);
  Append(FindBrokenRelations(groups), whole);
  AppendNew(std::move(whole), report.findings);
  for (const ChannelGroup& group : groups) AppendNew(FindOddRepeats(group), report.findings);
  for (const ChannelGroup& group : alike) Append(FindOddTrials(group), report.findings);
  // What spoils most comes first: whole channels, then by time.
  std::stable_sort(report.findings.begin(), report.findings.end(), [](const Finding& a, const Finding& b) {
    return std::pair(a.whole, Duration(a.spans)) > std::pair(b.whole, Duration(b.spans));
  });
  return report;
}

}  // namespace sinew
