// Counts what malloc and calloc are asked for: operator new ends there, and so does Eigen, which calls it
// itself.
#pragma once

#include <cstddef>  // tells the C library

// Sanitizers bring an allocator of their own, which cannot be counted this way.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SINEW_COUNTS_ALLOCATIONS

namespace sinew {

/// Allocations of this program so far.
long Allocations();

}  // namespace sinew
#endif
