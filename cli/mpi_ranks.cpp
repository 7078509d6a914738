#include "cli/mpi_ranks.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/text.h"
#include "cli/stop_signals.h"

namespace sinew {
namespace {

Ranks* the_ranks = nullptr;

long NumberIn(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? 0 : ParseInteger(value).value_or(0);
}

// In the build tree, beside an installed program, or where this was installed.
std::vector<std::string> PlacesOfModule() {
  std::vector<std::string> places;
  std::error_code code;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", code);
  if (!code) {
    places.push_back((program.parent_path() / "sinew_mpi.so").string());
    places.push_back((program.parent_path().parent_path() / SINEW_MODULE_FOLDER / "sinew_mpi.so").string());
  }
  places.emplace_back(SINEW_INSTALLED_MODULE);
  return places;
}

using MakeTransport = Transport* (*)();

Result<MakeTransport> LoadModule() {
  std::string why = "it was built without MPI (packages.txt: libopenmpi-dev, then build again)";
  for (const std::string& place : PlacesOfModule()) {
    std::error_code code;
    if (!std::filesystem::exists(place, code)) continue;
    // Global: Open MPI's own modules look for its symbols.
    void* const module = dlopen(place.c_str(), RTLD_NOW | RTLD_GLOBAL);
    if (module == nullptr) {
      why = dlerror();
      continue;
    }
    if (void* const make = dlsym(module, "SinewMakeTransport")) return reinterpret_cast<MakeTransport>(make);
  }
  return Fail("started as one of several processes, but {}", why);
}

void PrintNothing() {
  std::fflush(stdout);
  std::fflush(stderr);
  const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nothing < 0) return;
  dup2(nothing, STDOUT_FILENO);
  dup2(nothing, STDERR_FILENO);
  close(nothing);
}

}  // namespace

bool StartedWithOthers() {
  return NumberIn("OMPI_COMM_WORLD_SIZE") > 1 || NumberIn("PMI_SIZE") > 1 ||
         (std::getenv("PMIX_RANK") != nullptr && NumberIn("SLURM_NTASKS") > 1);
}

Result<std::unique_ptr<Ranks>> JoinRanks() {
  SINEW_ASSIGN(const MakeTransport make, LoadModule());
  // A helper has nothing to save: it ends at once, whatever it is doing.
  auto ranks = std::make_unique<Ranks>([make] { return std::unique_ptr<Transport>(make()); },
                                       &InterruptFlag(), [] { _exit(0); });
  the_ranks = ranks.get();
  if (IsHelper()) {
    PrintNothing();
    LeaveEndToOthers();
  }
  return ranks;
}

Ranks* TheRanks() {
  return the_ranks;
}
bool IsHelper() {
  return the_ranks != nullptr && the_ranks->rank() != 0;
}

std::vector<std::string> EnvironmentOfOneProcess() {
  constexpr std::array kOfLaunchers{"OMPI_", "PMIX_", "PMI_", "ORTE_", "OPAL_"};
  std::vector<std::string> kept;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    const bool of_launcher = std::any_of(kOfLaunchers.begin(), kOfLaunchers.end(),
                                         [&](const char* start) { return text.rfind(start, 0) == 0; });
    if (!of_launcher) kept.push_back(text);
  }
  return kept;
}

}  // namespace sinew
