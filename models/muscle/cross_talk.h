// Electrodes that record the other muscles too.
#pragma once

namespace sinew {

/// The excitation of a muscle. Every electrode records its muscle's excitation and a share of the mean of
/// those of the n others: s = (I + share (J - I) / n) e with J all ones, solved for e (Sherman, Morrison
/// 1950).
/// @param measured by its electrode, s [any unit] @param others mean of what the others record [same unit]
/// @param count of the others, n >= 1 @param share [1, -1 < share < n]
template <class T>
[[nodiscard]] T WithoutCrossTalk(double measured, double others, int count, const T& share) {
  const double n = count;
  return (measured - (measured / n + others) * (share / (1.0 + share))) / (1.0 - share * (1 / n));
}

}  // namespace sinew
