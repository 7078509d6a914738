// How much memory this process takes.
#pragma once

#include <cstddef>

namespace sinew {

/// [bytes] that are in the machine's memory now (the resident set); 0 where the system does not tell.
[[nodiscard]] std::size_t ResidentMemory();

}  // namespace sinew
