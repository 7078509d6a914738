// Why evaluations of a search failed, counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace sinew {

/// Failures whose messages differ in their numbers at most: "no balance at t = 0.3" and "no balance at t =
/// 0.4".
struct FailureReason {
  std::string message;    ///< of the first of them
  std::size_t first = 0;  ///< its evaluation, from 0
  long count = 0;
};

class FailureCounts {
 public:
  /// Beyond so many reasons all others are one.
  static constexpr std::size_t kMostReasons = 1000;

  FailureCounts() = default;
  /// Reasons that no evaluation has failed for yet, at these indices.
  explicit FailureCounts(std::vector<std::string> messages);

  /// @param evaluation comes after those before @return index of its reason in all()
  std::int32_t Add(const std::string& message, std::size_t evaluation);
  /// More failures of a reason. @param first evaluation of them @pre reason < all().size()
  void Count(std::size_t reason, std::size_t first, long count);
  /// The failures of another search. @param offset of its evaluations @return index in all() of each of its
  /// reasons; -1 of one that no evaluation has failed for
  std::vector<std::int32_t> Append(const FailureCounts& other, std::size_t offset);

  [[nodiscard]] const std::vector<FailureReason>& all() const { return reasons_; }
  /// Most frequent first; equally frequent ones in the order of the evaluations.
  [[nodiscard]] std::vector<FailureReason> MostFrequentFirst() const;

 private:
  std::size_t IndexOf(const std::string& message);

  std::vector<FailureReason> reasons_;
  std::map<std::string, std::size_t> known_;  // messages without their numbers
};

}  // namespace sinew
