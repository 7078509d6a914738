#include "problems/nms/ceinms/rt_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "base/text.h"

namespace sinew {
namespace {

Result<CeinmsRtWanted> ParseValidate(const std::string& word) {
  const auto parts = Split(word, ':');
  CeinmsRtWanted wanted;
  wanted.folder = parts.front();
  wanted.to_s = std::numeric_limits<double>::infinity();
  wanted.role = Role::kValidate;
  if (parts.size() == 1 && !word.empty()) return wanted;
  const auto from = parts.size() == 3 ? ParseNumber(parts[1]) : std::nullopt;
  const auto to = parts.size() == 3 ? ParseNumber(parts[2]) : std::nullopt;
  if (!from || !to || parts.front().empty() || !(*from >= 0 && *from < *to && std::isfinite(*to)))
    return Fail(
        "--validate {}: expected TRIAL, or TRIAL:FROM:TO in seconds from its start, such as walk45:1:58",
        word);
  wanted.from_s = *from;
  wanted.to_s = *to;
  return wanted;
}

}  // namespace

Result<std::vector<CeinmsRtWanted>> ListCeinmsRtTrials(const CeinmsRtCalibration& calibration,
                                                       const std::string& file,
                                                       const std::vector<std::string>& validate) {
  std::vector<CeinmsRtWanted> all;
  for (const CeinmsRtTrial& trial : calibration.trials)
    all.push_back({"", trial.name, trial.from_s, trial.to_s, Role::kTrain, trial.line});
  for (const std::string& word : validate) {
    SINEW_ASSIGN(CeinmsRtWanted wanted, ParseValidate(word));
    wanted.line = calibration.directory.line;
    all.push_back(std::move(wanted));
  }
  std::set<std::string> taken;
  for (CeinmsRtWanted& wanted : all) {
    wanted.name = wanted.folder;
    std::replace_if(
        wanted.name.begin(), wanted.name.end(), [](char c) { return c == '/' || c == '\\'; }, '_');
    if (taken.count(wanted.name) > 0 && std::isfinite(wanted.from_s) && std::isfinite(wanted.to_s))
      wanted.name += fmt::format("_{}_{}", wanted.from_s, wanted.to_s);
    if (!taken.insert(wanted.name).second)
      return FailAt(file, wanted.line, "there is already a trial called '{}'", wanted.name);
  }
  return all;
}

}  // namespace sinew
