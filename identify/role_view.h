// A problem with other roles of its trials: a held-out trial is fitted, or a fitted one is held out.
#pragma once

#include <functional>

#include "identify/problem_view.h"

namespace sinew {

class RoleView final : public ProblemView {
 public:
  /// @param inner must outlive the view @param role the new role of each block
  RoleView(const Problem& inner, const std::function<BlockRole(const Block&)>& role) : ProblemView(inner) {
    for (Block& block : layout_) block.role = role(block);
  }
};

}  // namespace sinew
