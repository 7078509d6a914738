// SINEW_ASSERT(condition, message): a bug of ours ends the process with the place and the reason. Always
// armed.
#pragma once

#include <cstdio>
#include <cstdlib>

#define SINEW_ASSERT(condition, message)                                                             \
  do {                                                                                               \
    if (!(condition)) {                                                                              \
      std::fprintf(stderr, "sinew: bug: %s:%d: %s (%s)\n", __FILE__, __LINE__, message, #condition); \
      std::abort();                                                                                  \
    }                                                                                                \
  } while (false)
