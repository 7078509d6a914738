#include "datasets/check/check.h"

#include <algorithm>
#include <iterator>

#include "datasets/check/clipping.h"
#include "datasets/check/excursions.h"
#include "datasets/check/signals.h"
#include "datasets/check/stuck.h"
#include "datasets/check/time_stamps.h"

namespace sinew {
namespace {

void Append(std::vector<Finding> more, std::vector<Finding>& all) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

}  // namespace

CheckReport CheckData(const Dataset& dataset) {
  CheckReport report;
  report.trials = static_cast<int>(dataset.trials.size());
  Append(FindTimeJumps(dataset), report.findings);
  for (const ChannelGroup& group : GroupSignals(dataset)) {
    report.channels += static_cast<int>(group.signals.size());
    Append(FindExcursions(group), report.findings);
    Append(FindStuck(group), report.findings);
    Append(FindClipping(group), report.findings);
  }
  return report;
}

}  // namespace sinew
