#include "identify/execution/ranks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "identify/execution/fit_record.h"
#include "identify/execution/message.h"
#include "identify/execution/shared_loop.h"

namespace sinew {
namespace {

constexpr std::size_t kPieces = 60;

// Ranks that are threads of one process.
struct Post {
  std::mutex mutex;
  std::vector<std::deque<Transport::Arrival>> inboxes;
};

class InMemory final : public Transport {
 public:
  InMemory(Post& post, int rank) : post_(post), rank_(rank) {}
  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return static_cast<int>(post_.inboxes.size()); }
  [[nodiscard]] int size_on_this_machine() const override { return size(); }
  void Send(int to, std::string bytes) override {
    const std::lock_guard lock(post_.mutex);
    post_.inboxes[static_cast<std::size_t>(to)].push_back({rank_, std::move(bytes)});
  }
  std::optional<Arrival> Receive() override {
    const std::lock_guard lock(post_.mutex);
    auto& inbox = post_.inboxes[static_cast<std::size_t>(rank_)];
    if (inbox.empty()) return {};
    Arrival first = std::move(inbox.front());
    inbox.pop_front();
    return first;
  }
  [[nodiscard]] bool AllSent() override { return true; }

 private:
  Post& post_;
  int rank_;
};

// The same work by so many ranks, rank 0 in this thread.
void RunTogether(int size, const std::function<void(Ranks&)>& work) {
  Post post;
  post.inboxes.resize(static_cast<std::size_t>(size));
  std::atomic<int> done = 0;
  const auto run = [&](int rank) {
    Ranks ranks([&, rank] { return std::make_unique<InMemory>(post, rank); }, nullptr, {});
    ASSERT_EQ(ranks.rank(), rank);
    work(ranks);
    ++done;
    while (done < size) std::this_thread::yield();  // a process would end when rank 0 does
  };
  std::vector<std::thread> others;
  for (int rank = 1; rank < size; ++rank) others.emplace_back(run, rank);
  run(0);
  for (std::thread& other : others) other.join();
}

double Square(std::size_t i) {
  return static_cast<double>(i * i);
}

TEST(Ranks, EachPieceIsDoneByOneRankAndAllHaveItsAnswer) {
  for (const int size : {1, 2, 5}) {
    std::vector<std::atomic<int>> made(kPieces);
    std::atomic<int> complete = 0;
    RunTogether(size, [&](Ranks& ranks) {
      std::vector<double> squares(kPieces, -1);
      for (int loop = 0; loop < 3; ++loop) {
        ForEachShared(
            {&ranks, nullptr}, Digest().Add("squares"), 1, kPieces,
            [&](std::size_t i, std::size_t) {
              ++made[i];
              squares[i] = Square(i);
              return Answer{{squares[i]}, "of " + std::to_string(i)};
            },
            [&](std::size_t i, const Answer& answer) {
              EXPECT_EQ(answer.text, "of " + std::to_string(i));
              squares[i] = answer.numbers.front();
              return true;
            });
      }
      bool right = true;
      for (std::size_t i = 0; i < kPieces; ++i) right = right && squares[i] == Square(i);
      complete += right ? 1 : 0;
    });
    EXPECT_EQ(complete, size);
    for (std::size_t i = 0; i < kPieces; ++i) EXPECT_EQ(made[i], 3) << size << " ranks, piece " << i;
  }
}

TEST(Ranks, AnAnswerThatIsNotSufficientIsMadeByEachRank) {
  std::vector<std::atomic<int>> made(kPieces);
  RunTogether(3, [&](Ranks& ranks) {
    std::vector<char> mine(kPieces, 0);
    ForEachShared(
        {&ranks, nullptr}, Digest().Add("empty"), 1, kPieces,
        [&](std::size_t i, std::size_t) {
          ++made[i];
          mine[i] = 1;
          return Answer();
        },
        [](std::size_t, const Answer& answer) { return !answer.numbers.empty(); });
    for (std::size_t i = 0; i < kPieces; ++i) EXPECT_EQ(mine[i], 1);
  });
  for (std::size_t i = 0; i < kPieces; ++i) EXPECT_EQ(made[i], 3);
}

// Fits of a record are computed once among all ranks, and found by the others.
TEST(Ranks, ARecordIsFilledTogether) {
  std::atomic<int> computed = 0;
  RunTogether(3, [&](Ranks& ranks) {
    FitRecord record;
    record.Share({&ranks, nullptr});
    std::vector<double> found(kPieces, -1);
    ForEachShared(&record, 1, kPieces, [&](std::size_t i, std::size_t) {
      const Digest question = Digest().Add(static_cast<std::uint64_t>(i));
      if (const auto known = record.Find(question)) {
        found[i] = known->numbers.front();
        return;
      }
      ++computed;
      found[i] = Square(i);
      record.Keep(question, {{found[i]}, ""});
    });
    for (std::size_t i = 0; i < kPieces; ++i) EXPECT_EQ(found[i], Square(i));
    EXPECT_EQ(record.size(), kPieces);
  });
  EXPECT_EQ(computed, static_cast<int>(kPieces));
}

// What is kept between loops every rank finds itself, and does not send.
TEST(Ranks, OutsideOfLoopsNothingIsShared) {
  RunTogether(2, [](Ranks& ranks) {
    FitRecord record;
    record.Share({&ranks, nullptr});
    record.Keep(Digest().Add(static_cast<double>(ranks.rank())), {});
    ForEachShared(&record, 1, 4, [](std::size_t, std::size_t) {});
    EXPECT_EQ(record.size(), 1u);
  });
}

// A rank that asks something else neither helps nor harms.
TEST(Ranks, ARankAtAnotherPointChangesNothing) {
  RunTogether(3, [](Ranks& ranks) {
    const double factor = ranks.rank() == 1 ? 2 : 1;
    if (ranks.rank() == 1) ranks.Begin(Digest().Add("one loop more"), 7);
    std::vector<double> values(kPieces, -1);
    ForEachShared(
        {&ranks, nullptr}, Digest().Add(factor), 1, kPieces,
        [&](std::size_t i, std::size_t) {
          values[i] = factor * Square(i);
          return Answer{{values[i]}, ""};
        },
        [&](std::size_t i, const Answer& answer) {
          values[i] = answer.numbers.front();
          return true;
        });
    for (std::size_t i = 0; i < kPieces; ++i) EXPECT_EQ(values[i], factor * Square(i));
  });
}

TEST(Ranks, RankZeroDoesNotWaitForOthersOnceItIsToldToStop) {
  Post post;
  post.inboxes.resize(2);
  std::atomic<bool> stop = false;
  std::atomic<bool> drawn = false;
  std::thread other([&] {
    Ranks ranks([&] { return std::make_unique<InMemory>(post, 1); }, nullptr, {});
    const auto loop = ranks.Begin(Digest().Add("long"), 2);
    ranks.Draw(loop, 2);  // and never finishes it
    drawn = true;
  });
  {
    Ranks ranks([&] { return std::make_unique<InMemory>(post, 0); }, &stop, {});
    while (!drawn) std::this_thread::yield();
    int done = 0;
    std::thread signal([&] { stop = true; });
    ForEachShared(
        {&ranks, nullptr}, Digest().Add("long"), 1, 2,
        [&](std::size_t, std::size_t) {
          ++done;
          return Answer();
        },
        [](std::size_t, const Answer&) { return true; });
    signal.join();
    EXPECT_EQ(done, 2);
  }
  other.join();
}

TEST(Ranks, ALoopWithinAPieceStaysInItsProcess) {
  std::atomic<int> inner = 0;
  RunTogether(2, [&](Ranks& ranks) {
    const SharedWork work{&ranks, nullptr};
    const auto take = [](std::size_t, const Answer&) { return true; };
    ForEachShared(
        work, Digest().Add("outer"), 1, 4,
        [&](std::size_t, std::size_t) {
          ForEachShared(
              work, Digest().Add("inner"), 1, 5,
              [&](std::size_t, std::size_t) {
                ++inner;
                return Answer();
              },
              take);
          return Answer();
        },
        take);
  });
  EXPECT_EQ(inner, 20);
}

TEST(Ranks, MessagesArriveAsTheyWereSent) {
  const Message sent{Message::Kind::kPiece, {1, 2}, 3, {{0.1, -0.0, 1e300}, std::string("a\0b", 3)}};
  const std::string bytes = ToBytes(sent);
  const auto arrived = FromBytes(bytes);
  ASSERT_TRUE(arrived);
  EXPECT_EQ(arrived->kind, sent.kind);
  EXPECT_EQ(arrived->about, sent.about);
  EXPECT_EQ(arrived->index, sent.index);
  EXPECT_EQ(arrived->answer.numbers, sent.answer.numbers);
  EXPECT_TRUE(std::signbit(arrived->answer.numbers[1]));
  EXPECT_EQ(arrived->answer.text, sent.answer.text);
  EXPECT_FALSE(FromBytes(bytes.substr(0, 20)));
  EXPECT_FALSE(FromBytes(bytes.substr(0, 45)));  // fewer numbers than it says
  EXPECT_FALSE(FromBytes(std::string(40, '\xff')));
}

}  // namespace
}  // namespace sinew
