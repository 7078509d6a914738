// The options that many commands share, declared once: --seed, --threads, --quiet, --json.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "cli/command.h"

namespace sinew {

/// How a command works: each declares those that mean something to it.
struct WorkOptions {
  std::uint64_t seed = 1;
  int threads = MachineCores();
  bool quiet = false;

  void AddSeedTo(Command command);
  void AddThreadsTo(Command command);
  void AddQuietTo(Command command);
  /// Until the result is destroyed, nothing in the program uses more threads.
  [[nodiscard]] std::shared_ptr<void> LimitThreads() const;

  /// The processor cores that this process may use; of several processes on one machine, its share.
  [[nodiscard]] static int MachineCores();
};

/// "--json FILE|-". @param json stays empty if it is not given
void AddJsonTo(Command command, std::string& json);

}  // namespace sinew
