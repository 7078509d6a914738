// Bytes between processes by MPI: a module that the program loads where it was started by mpirun or srun
// (mpi_ranks.cpp), so that a program that was not does not load MPI's libraries, which takes 3 ms. Functions
// have their second names (PMPI_, of the standard's profiling interface): Ipopt's sequential MUMPS brings
// functions of the first names that do nothing.
#include <mpi.h>

#include <cstdlib>
#include <iterator>
#include <list>
#include <utility>

#include "identify/execution/transport.h"

namespace sinew {
namespace {

class MpiTransport final : public Transport {
 public:
  MpiTransport() {
    // Messages are small, and in many containers one process may not read another one's memory: Open MPI
    // then prints a warning for every message.
    setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 0);
    int provided = 0;
    PMPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    PMPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    PMPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm machine = MPI_COMM_NULL;
    PMPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
    PMPI_Comm_size(machine, &size_on_this_machine_);
    PMPI_Comm_free(&machine);
  }
  ~MpiTransport() override { PMPI_Finalize(); }
  MpiTransport(const MpiTransport&) = delete;
  MpiTransport& operator=(const MpiTransport&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }
  [[nodiscard]] int size_on_this_machine() const override { return size_on_this_machine_; }

  void Send(int to, std::string bytes) override {
    Sending& one = sending_.emplace_back();
    one.bytes = std::move(bytes);
    PMPI_Isend(one.bytes.data(), static_cast<int>(one.bytes.size()), MPI_BYTE, to, 0, MPI_COMM_WORLD,
               &one.request);
  }

  std::optional<Arrival> Receive() override {
    Forget();
    int there = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    PMPI_Improbe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &there, &message, &status);
    if (there == 0) return {};
    int length = 0;
    PMPI_Get_count(&status, MPI_BYTE, &length);
    Arrival arrival{status.MPI_SOURCE, std::string(static_cast<std::size_t>(length), '\0')};
    PMPI_Mrecv(arrival.bytes.data(), length, MPI_BYTE, &message, MPI_STATUS_IGNORE);
    return arrival;
  }

  [[nodiscard]] bool AllSent() override {
    Forget();
    return sending_.empty();
  }

 private:
  struct Sending {
    std::string bytes;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  // Of messages that have left.
  void Forget() {
    for (auto one = sending_.begin(); one != sending_.end();) {
      int left = 0;
      PMPI_Test(&one->request, &left, MPI_STATUS_IGNORE);
      one = left != 0 ? sending_.erase(one) : std::next(one);
    }
  }

  int rank_ = 0;
  int size_ = 1;
  int size_on_this_machine_ = 1;
  std::list<Sending> sending_;  // a request's memory may not move
};

}  // namespace
}  // namespace sinew

extern "C" sinew::Transport* SinewMakeTransport() {
  return new sinew::MpiTransport;
}
