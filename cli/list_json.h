// `sinew list` for machines.
#pragma once

#include <string>
#include <vector>

#include "identify/problem.h"
#include "problems/registry.h"

namespace sinew {

/// A kind of file: ending, whether it is read and written, what it holds.
struct FormatEntry {
  std::string name;
  bool read = false;
  bool written = false;
  std::string holds;
};

/// Each is an object with the list under its name: {"problems": [{"name": ..., ...}, ...]}.
[[nodiscard]] std::string ProblemsJson(const std::vector<ProblemEntry>& problems);
[[nodiscard]] std::string SolversJson();
[[nodiscard]] std::string IntegratorsJson();
[[nodiscard]] std::string FormatsJson(const std::vector<FormatEntry>& formats);
/// Parameters, and what `data synthesize --set` takes besides them.
[[nodiscard]] std::string ParametersJson(const ProblemEntry& entry);
/// Of a problem that has some with data alone.
[[nodiscard]] std::string ParametersJson(const ProblemEntry& entry, const std::vector<Parameter>& parameters);
[[nodiscard]] std::string EffectsJson(const ProblemEntry& entry, const Problem& problem);
/// The text of `sinew list channels`.
[[nodiscard]] std::string ChannelsJson(const ProblemEntry& entry);
/// What a problem compares: trial, channel, unit, role and samples of every block.
[[nodiscard]] std::string BlocksJson(const ProblemEntry& entry, const Problem& problem);

}  // namespace sinew
