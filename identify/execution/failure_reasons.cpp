#include "identify/execution/failure_reasons.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <numeric>
#include <utility>

namespace sinew {
namespace {

const std::string kOtherReasons = "other reasons";

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

FailureCounts::FailureCounts(std::vector<std::string> messages) {
  for (std::string& message : messages) {
    known_.emplace(WithoutNumbers(message), reasons_.size());
    reasons_.push_back({std::move(message), 0, 0});
  }
  if (reasons_.size() >= kMostReasons) known_.emplace(kOtherReasons, kMostReasons - 1);
}

std::size_t FailureCounts::IndexOf(const std::string& message) {
  const std::string kind = WithoutNumbers(message);
  if (const auto found = known_.find(kind); found != known_.end()) return found->second;
  if (reasons_.size() >= kMostReasons) return IndexOf(kOtherReasons);
  known_.emplace(kind, reasons_.size());
  if (reasons_.size() + 1 == kMostReasons) known_.emplace(kOtherReasons, reasons_.size());
  reasons_.push_back({reasons_.size() + 1 == kMostReasons ? kOtherReasons : message, 0, 0});
  return reasons_.size() - 1;
}

void FailureCounts::Count(std::size_t reason, std::size_t first, long count) {
  FailureReason& counted = reasons_[reason];
  if (counted.count == 0) counted.first = first;
  counted.count += count;
}

std::int32_t FailureCounts::Add(const std::string& message, std::size_t evaluation) {
  const std::size_t reason = IndexOf(message);
  Count(reason, evaluation, 1);
  return static_cast<std::int32_t>(reason);
}

std::vector<std::int32_t> FailureCounts::Append(const FailureCounts& other, std::size_t offset) {
  std::vector<std::int32_t> indices(other.reasons_.size(), -1);
  std::vector<std::size_t> order(other.reasons_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return other.reasons_[a].first < other.reasons_[b].first;
  });
  for (const std::size_t i : order) {
    const FailureReason& reason = other.reasons_[i];
    if (reason.count == 0) continue;
    const std::size_t at = IndexOf(reason.message);
    Count(at, offset + reason.first, reason.count);
    indices[i] = static_cast<std::int32_t>(at);
  }
  return indices;
}

std::vector<FailureReason> FailureCounts::MostFrequentFirst() const {
  std::vector<FailureReason> reasons;
  std::copy_if(reasons_.begin(), reasons_.end(), std::back_inserter(reasons),
               [](const FailureReason& reason) { return reason.count > 0; });
  std::sort(reasons.begin(), reasons.end(), [](const FailureReason& a, const FailureReason& b) {
    return std::pair(-a.count, a.first) < std::pair(-b.count, b.first);
  });
  return reasons;
}

}  // namespace sinew
