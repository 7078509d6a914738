#include "cli/data/data_warnings.h"

#include <algorithm>
#include <set>

#include "cli/data/check_text.h"
#include "datasets/check/check.h"
#include "datasets/check/mask.h"

namespace sinew {
namespace {

constexpr std::size_t kShownDataFindings = 5;

}  // namespace

std::vector<Finding> FindingsOf(const Dataset& data, const Layout& layout,
                                const std::vector<Finding>& findings) {
  std::set<std::string> trials;
  std::set<std::pair<std::string, std::string>> compared;
  for (const Block& block : layout) {
    trials.insert(block.trial);
    if (block.role != BlockRole::kPredicted) compared.insert({block.trial, block.channel});
  }
  std::vector<Finding> relevant;
  for (const Finding& finding : findings) {
    if (trials.count(finding.trial) == 0) continue;
    const auto& channels = data.trials.at(finding.trial).grids.at(finding.grid).channels;
    const auto channel = channels.find(finding.channel);
    const bool input = channel == channels.end() || channel->second.kind == ChannelKind::kInput;
    if (input || compared.count({finding.trial, finding.channel}) != 0) relevant.push_back(finding);
  }
  return relevant;
}

std::vector<std::string> ComparedChannels(const Layout& layout) {
  std::set<std::string> channels;
  for (const Block& block : layout) {
    if (block.role != BlockRole::kPredicted) channels.insert(block.channel);
  }
  return {channels.begin(), channels.end()};
}

std::vector<Warning> DataWarnings(const Dataset& data, const Layout& layout, const std::string& path) {
  std::vector<Warning> warnings;
  const std::vector<Finding> findings = FindingsOf(data, layout, CheckData(data).findings);
  for (std::size_t i = 0; i < std::min(findings.size(), kShownDataFindings); ++i) {
    const Finding& f = findings[i];
    warnings.push_back({WarningKind::kDataCheck,
                        {ToString(f.kind), f.channel, f.trial},
                        {f.spans.front().from, f.spans.back().to},
                        text::FindingPhrase(f)});
  }
  if (findings.size() > kShownDataFindings) {
    warnings.push_back({WarningKind::kOther,
                        {},
                        {},
                        fmt::format("the data have {} more remarks: sinew data check {}",
                                    findings.size() - kShownDataFindings, path)});
  }
  const auto masked = RecordedMask(data);
  if (masked && !masked->empty()) {
    warnings.push_back({WarningKind::kOther,
                        {},
                        {},
                        fmt::format("the data were masked before: {} (files/{} in the data set)",
                                    text::MaskText(*masked), kMaskFile)});
  }
  return warnings;
}

}  // namespace sinew
