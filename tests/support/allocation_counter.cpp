#include "tests/support/allocation_counter.h"

#include <atomic>
#include <cstddef>

#ifdef SINEW_COUNTS_ALLOCATIONS

namespace {
std::atomic<long> allocations{0};
}  // namespace

// Stand before the C library's. A compiler makes calloc out of malloc and a loop of zeros.
extern "C" void* __libc_malloc(std::size_t size);                     // NOLINT: the C library's name
extern "C" void* __libc_calloc(std::size_t count, std::size_t size);  // NOLINT: the same
extern "C" void* malloc(std::size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
extern "C" void* calloc(std::size_t count, std::size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}

namespace sinew {

long Allocations() {
  return allocations;
}

}  // namespace sinew
#endif
