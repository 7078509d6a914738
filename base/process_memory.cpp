#include "base/process_memory.h"

#include <unistd.h>

#include <cstdio>

namespace sinew {

std::size_t ResidentMemory() {
  std::FILE* sizes = std::fopen("/proc/self/statm", "r");
  if (sizes == nullptr) return 0;
  unsigned long pages = 0;
  const int count = std::fscanf(sizes, "%*u %lu", &pages);
  std::fclose(sizes);
  return count == 1 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace sinew
