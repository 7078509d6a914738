#include "identify/execution/failure_reasons.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "identify/execution/evaluator.h"

namespace sinew {
namespace {

bool IsDigit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

// The message with '#' for every number that stands alone: "e1x" is a name, "-1.5e-3" is a number.
std::string WithoutNumbers(const std::string& message) {
  std::string kind;
  for (std::size_t i = 0; i < message.size(); ++i) {
    const bool in_word =
        i > 0 && (std::isalnum(static_cast<unsigned char>(message[i - 1])) != 0 || message[i - 1] == '_');
    const bool sign = message[i] == '-' && i + 1 < message.size() && IsDigit(message[i + 1]);
    if (in_word || !(IsDigit(message[i]) || sign)) {
      kind += message[i];
      continue;
    }
    ++i;
    while (i < message.size() && (IsDigit(message[i]) || message[i] == '.' || message[i] == 'e' ||
                                  ((message[i] == '-' || message[i] == '+') && message[i - 1] == 'e')))
      ++i;
    --i;
    kind += '#';
  }
  return kind;
}

}  // namespace

std::vector<FailureReason> FailuresByReason(const std::vector<TraceEntry>& trace) {
  std::map<std::string, std::size_t> known;  // kind -> index in reasons
  std::vector<FailureReason> reasons;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    if (trace[i].failure.empty()) continue;
    const auto [at, is_new] = known.emplace(WithoutNumbers(trace[i].failure), reasons.size());
    if (is_new) reasons.push_back({trace[i].failure, i, 0});
    ++reasons[at->second].count;
  }
  std::stable_sort(reasons.begin(), reasons.end(),
                   [](const FailureReason& a, const FailureReason& b) { return a.count > b.count; });
  return reasons;
}

}  // namespace sinew
