// Why evaluations of a search failed, counted.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sinew {

struct TraceEntry;

/// Failures whose messages differ in their numbers at most: "no balance at t = 0.3" and "no balance at t =
/// 0.4".
struct FailureReason {
  std::string message;    ///< of the first of them
  std::size_t first = 0;  ///< its index in the record
  long count = 0;
};

/// Most frequent first; equally frequent ones in the order of the record.
[[nodiscard]] std::vector<FailureReason> FailuresByReason(const std::vector<TraceEntry>& trace);

}  // namespace sinew
