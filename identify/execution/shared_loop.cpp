#include "identify/execution/shared_loop.h"

#include <atomic>
#include <mutex>
#include <utility>
#include <vector>

#include "identify/execution/fit_record.h"
#include "identify/execution/ranks.h"
#include "identify/execution/work_times.h"

namespace sinew {
namespace {

using Make = std::function<Answer(std::size_t, std::size_t)>;
using Take = std::function<bool(std::size_t, const Answer&)>;

class Loop {
 public:
  Loop(const SharedWork& work, std::size_t count, const Make& make)
      : work_(work),
        count_(count),
        make_(make),
        number_(work.times == nullptr ? 0 : work.times->Begin(count)) {}

  void Alone(const Executor& executor) {
    std::atomic<std::size_t> next = 0;
    DrawFrom(
        executor, [&] { return next++; }, [](std::size_t, Answer) {});
    if (work_.times != nullptr) work_.times->End(number_, 0);
  }

  void Together(const Executor& executor, const Digest& question, const Take& take) {
    Ranks& ranks = *work_.ranks;
    const Digest::Value name = ranks.Begin(question, count_);
    std::vector<char> done(count_, 0);
    std::mutex taking;
    const auto take_what_arrived = [&](bool wait) {
      const auto arrived = ranks.Arrived(name, wait);
      for (const auto& [piece, answer] : arrived) {
        if (piece < count_ && take(piece, answer)) done[piece] = 1;
      }
      return !arrived.empty();
    };
    const auto draw = [&] { return ranks.Draw(name, count_).value_or(count_); };
    DrawFrom(executor, draw, [&](std::size_t piece, Answer answer) {
      done[piece] = 1;
      ranks.Finish(name, count_, piece, std::move(answer));
      const std::unique_lock lock(taking, std::try_to_lock);
      if (lock.owns_lock()) take_what_arrived(false);
    });
    while (take_what_arrived(true)) {
    }
    ranks.End(name);
    std::vector<std::size_t> rest;
    for (std::size_t i = 0; i < count_; ++i) {
      if (done[i] == 0) rest.push_back(i);
    }
    const double before = WorkTimes::OfProcess();
    executor.ForEach(rest.size(), [&](std::size_t k, std::size_t worker) {
      const Ranks::Piece piece;
      make_(rest[k], worker);
    });
    if (work_.times != nullptr) work_.times->End(number_, WorkTimes::OfProcess() - before);
  }

 private:
  // In the order of the pieces, whichever worker does them: results that are combined in that order then
  // need not wait for long.
  void DrawFrom(const Executor& executor, const std::function<std::size_t()>& draw,
                const std::function<void(std::size_t, Answer)>& finish) {
    std::atomic<bool> failed = false;
    executor.ForEach(executor.workers(), [&](std::size_t, std::size_t worker) {
      try {
        for (std::size_t i = draw(); i < count_ && !failed; i = draw()) finish(i, Do(i, worker));
      } catch (...) {
        failed = true;
        throw;
      }
    });
  }

  Answer Do(std::size_t i, std::size_t worker) {
    const Ranks::Piece piece;
    const double before = WorkTimes::OfThread();
    Answer answer = make_(i, worker);
    if (work_.times != nullptr) work_.times->SetPiece(number_, i, WorkTimes::OfThread() - before);
    return answer;
  }

  SharedWork work_;
  std::size_t count_;
  const Make& make_;
  std::size_t number_;
};

}  // namespace

void ForEachShared(const SharedWork& work, const Digest& question, int threads, std::size_t count,
                   const Make& make, const Take& take) {
  const auto executor = MakeExecutor(threads);
  Loop loop(Ranks::InsidePiece() ? SharedWork() : work, count, make);
  if (work.ranks == nullptr || work.ranks->size() == 1 || count < 2 || Ranks::InsidePiece()) {
    loop.Alone(*executor);
  } else {
    loop.Together(*executor, question, take);
  }
}

void ForEachShared(const FitRecord* record, int threads, std::size_t count, const Executor::Work& work) {
  if (record == nullptr) return MakeExecutor(threads)->ForEach(count, work);
  const auto make = [&](std::size_t i, std::size_t worker) {
    work(i, worker);
    return Answer();
  };
  ForEachShared(record->shared, Digest().Add("record"), threads, count, make,
                [&](std::size_t, const Answer&) {
                  record->TellOfArrivals();
                  return false;
                });
}

}  // namespace sinew
