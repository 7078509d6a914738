// Commands of a cohort as processes of their own.
#pragma once

#include <sys/types.h>

#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew::cohort {

/// Runs this program with other words. A signal is passed on to all that run; if this process dies, they get
/// SIGTERM.
class Children {
 public:
  /// Waits for its end. Safe in several threads.
  /// @param folder where it works @param log absolute: what it prints is appended there
  /// @return its exit status, 128 + signal if one ended it. Errors: it cannot be started.
  Result<int> Run(const std::vector<std::string>& words, const std::string& folder, const std::string& log);

  /// To all that run, and to all that are started from now on.
  void Stop(int signal);
  [[nodiscard]] bool stopped() const;

 private:
  mutable std::mutex mutex_;
  std::set<pid_t> running_;
  int stopped_by_ = 0;
};

}  // namespace sinew::cohort
