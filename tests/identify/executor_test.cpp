#include "identify/execution/executor.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace sinew {
namespace {

constexpr std::size_t kPieces = 1000;

TEST(Executor, EveryPieceRunsOnce) {
  for (const int threads : {0, 1, 2, 64}) {
    std::vector<std::atomic<int>> runs(kPieces);
    MakeExecutor(threads)->ForEach(kPieces, [&](std::size_t i, std::size_t) { ++runs[i]; });
    for (std::size_t i = 0; i < kPieces; ++i) ASSERT_EQ(runs[i], 1) << threads << " " << i;
  }
}

TEST(Executor, OneThreadRunsThePiecesInOrder) {
  std::vector<std::size_t> order;
  const auto executor = MakeExecutor(1);
  EXPECT_EQ(executor->workers(), 1u);
  executor->ForEach(5, [&](std::size_t i, std::size_t worker) {
    order.push_back(i);
    EXPECT_EQ(worker, 0u);
  });
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

TEST(Executor, PiecesOfOneWorkerDoNotOverlapEvenIfTheyWaitForWorkOfTheirOwn) {
  const auto executor = MakeExecutor(2);
  std::vector<std::atomic<int>> busy(executor->workers());
  std::atomic<int> overlaps = 0;
  executor->ForEach(200, [&](std::size_t, std::size_t worker) {
    ASSERT_LT(worker, busy.size());
    if (busy[worker]++ != 0) ++overlaps;
    std::atomic<int> inner = 0;
    CurrentExecutor().ForEach(20, [&](std::size_t, std::size_t) { ++inner; });
    EXPECT_EQ(inner, 20);
    --busy[worker];
  });
  EXPECT_EQ(overlaps, 0);
}

TEST(Executor, AnExceptionOfAPieceReachesTheCaller) {
  for (const int threads : {1, 2}) {
    EXPECT_THROW(MakeExecutor(threads)->ForEach(10,
                                                [](std::size_t i, std::size_t) {
                                                  if (i == 3) throw std::runtime_error("a piece failed");
                                                }),
                 std::runtime_error);
  }
}

}  // namespace
}  // namespace sinew
