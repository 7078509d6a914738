// Several processes (MPI: ranks) that do one work together. All run the same program with the same words and
// data, and so come to the same loops over independent pieces. Each piece is done by one of them, and the
// others take its answer.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "base/digest.h"
#include "identify/execution/answer.h"
#include "identify/execution/message.h"
#include "identify/execution/transport.h"

namespace sinew {

/// Rank 0 hands out the pieces, one at a time to whoever asks, so that fast ranks do more of them, and passes
/// answers on. It alone counts: nothing is taken from another rank but the answer to a question that rank 0
/// asks itself, to the last bit (a digest), and what does not come it computes. So a rank that has come to
/// another point, because its time was up or a signal stopped it, costs time and cannot change an answer. The
/// other ranks end when rank 0 does.
///
/// A thread of its own sends and receives. All members may be used from several threads.
class Ranks {
 public:
  using MakeTransport = std::function<std::unique_ptr<Transport>()>;
  using Keep = std::function<void(const Digest::Value& question, const Answer& answer)>;

  /// @param make called in the thread that then uses it
  /// @param interrupt ends the waiting of rank 0 for others; may be null
  /// @param at_end what ranks other than 0 do when rank 0 has ended, from the thread that receives
  Ranks(const MakeTransport& make, const std::atomic<bool>* interrupt, std::function<void()> at_end);
  /// Rank 0: tells the others that all is done. The others: wait for that.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int size_on_this_machine() const { return size_on_this_machine_; }

  /// From now on `keep` gets the answers of other ranks, those that came before first; empty: they wait.
  void Attach(Keep keep);
  /// An answer that was found while a piece was done, for all others.
  void Share(const Digest::Value& question, const Answer& answer);

  /// The next loop of this process over `count` pieces. @param question all that the pieces follow from and
  /// that may differ within one work @return what it is called by all ranks
  Digest::Value Begin(const Digest& question, std::size_t count);
  /// A piece for this process; nothing if none is left.
  std::optional<std::size_t> Draw(const Digest::Value& loop, std::size_t count);
  /// A piece that was drawn here is done.
  void Finish(const Digest::Value& loop, std::size_t count, std::size_t piece, Answer answer);
  /// What others have done of the loop since the last call. @param wait until there is something
  /// @return nothing: all pieces are done, or rank 0 was told to stop (or, without `wait`, nothing is new)
  std::vector<std::pair<std::size_t, Answer>> Arrived(const Digest::Value& loop, bool wait);
  void End(const Digest::Value& loop);

  /// Whether this thread is doing a piece: loops within it are for its own process.
  static bool InsidePiece();
  /// Makes it so.
  class Piece {
   public:
    Piece();
    ~Piece();
    Piece(const Piece&) = delete;
    Piece& operator=(const Piece&) = delete;

   private:
    bool before_;
  };

  /// Tasks of a cohort, and their results.
  void Send(int to, const Message& message);
  struct Received {
    int from = 0;
    Message message;
  };
  /// The next message about tasks; waits for a moment at most, and then returns nothing.
  std::optional<Received> Await();

 private:
  struct Loop {
    std::size_t count = 0;
    std::size_t next = 0;  // rank 0: the first that was not handed out
    std::size_t done = 0;
    std::vector<std::pair<std::size_t, Answer>> arrived;
    std::deque<std::size_t> drawn;  // other ranks: for threads that wait
  };

  void Communicate(const MakeTransport& make);
  void Handle(Transport::Arrival arrival, Transport& transport);
  void PassOn(const Transport::Arrival& arrival);
  std::size_t DrawFrom(Loop& loop) const;
  Loop& LoopOf(const Digest::Value& name, std::size_t count);
  void Post(int to, std::string bytes);
  void PostToOthers(const std::string& bytes, int except);
  [[nodiscard]] bool Stopped() const { return interrupt_ != nullptr && interrupt_->load(); }

  const std::atomic<bool>* interrupt_;
  std::function<void()> at_end_;
  int rank_ = 0;
  int size_ = 1;
  int size_on_this_machine_ = 1;

  std::mutex mutex_;                    // of all that follows
  std::condition_variable arrived_;     // for threads that wait for other ranks
  std::condition_variable to_be_sent_;  // for the thread that sends
  bool ready_ = false;
  bool ending_ = false;
  int said_bye_ = 0;
  std::uint64_t loops_begun_ = 0;
  std::map<Digest::Value, Loop> loops_;
  std::deque<std::pair<int, std::string>> outgoing_;
  std::deque<std::pair<Digest::Value, Answer>> waiting_answers_;
  std::deque<Received> received_;
  Keep keep_;
  std::thread thread_;
};

}  // namespace sinew
