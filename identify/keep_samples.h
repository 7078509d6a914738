// Part of the samples of a block.
#pragma once

#include <utility>

#include "identify/layout.h"

namespace sinew {

/// Removes the samples of a block that are not kept; its predictions stay. A block without any left is
/// predicted only. @param keep (index of the sample) true for those that stay
template <class Keep>
void KeepSamples(const Keep& keep, Block& block) {
  Block rest = block;
  rest.sample.clear();
  rest.measured.clear();
  rest.relative_weight.clear();
  rest.group.clear();
  for (std::size_t i = 0; i < block.measured.size(); ++i) {
    if (!keep(i)) continue;
    rest.sample.push_back(block.sample[i]);
    rest.measured.push_back(block.measured[i]);
    if (!block.relative_weight.empty()) rest.relative_weight.push_back(block.relative_weight[i]);
    if (!block.group.empty()) rest.group.push_back(block.group[i]);
  }
  if (rest.measured.empty()) rest.role = BlockRole::kPredicted;
  block = std::move(rest);
}

}  // namespace sinew
