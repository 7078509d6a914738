#include "cli/work_options.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>

#include "cli/mpi_ranks.h"

namespace sinew {
namespace {

// Every seed is a whole number in the run file, in JSON and in HDF5's readers.
constexpr std::uint64_t kMaxSeed = std::uint64_t{1} << 53;
constexpr int kMaxThreads = 1024;

}  // namespace

int WorkOptions::MachineCores() {
  int cores = tbb::info::default_concurrency();
  // mpirun gives each rank cores of its own, or leaves all of them to all ranks.
  const bool all_of_them = cores >= static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  if (const Ranks* ranks = TheRanks(); ranks != nullptr && all_of_them)
    cores /= ranks->size_on_this_machine();
  return std::clamp(cores, 1, kMaxThreads);
}

void WorkOptions::AddSeedTo(Command command) {
  command.Add("--seed", seed, "Seed of the random numbers")
      .Between(std::uint64_t{0}, kMaxSeed, "SEED")
      .ShowsDefault();
}

void WorkOptions::AddThreadsTo(Command command) {
  command
      .Add("--threads", threads,
           "Threads; the answer does not depend on it; default: the cores of the machine")
      .Between(1, kMaxThreads);
}

void WorkOptions::AddQuietTo(Command command) {
  command.AddFlag("--quiet", quiet, "Print no progress");
}

std::shared_ptr<void> WorkOptions::LimitThreads() const {
  return std::make_shared<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(threads));
}

void AddJsonTo(Command command, std::string& json) {
  command.Add("--json", json, "Result as JSON; - for standard output").NotEmpty().Shows("FILE|-");
}

}  // namespace sinew
