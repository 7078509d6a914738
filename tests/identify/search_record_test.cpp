#include "identify/execution/search_record.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/constants.h"
#include "base/random.h"

namespace sinew {
namespace {

constexpr long kEntries = 64;

Vector At(double x) {
  return Vector::Constant(2, x);
}

// Costs with a decreasing trend and noise, with failures.
std::vector<TraceEntry> Search(std::uint64_t seed, long evaluations) {
  Random random(seed);
  std::vector<TraceEntry> entries;
  for (long i = 0; i < evaluations; ++i) {
    TraceEntry entry;
    entry.x = At(random.Uniform());
    entry.cost = 100 * std::exp(-5.0 * static_cast<double>(i) / static_cast<double>(evaluations)) *
                 (1 + random.Uniform());
    if (random.Uniform() < 0.2) {
      entry.cost = kInfinity;
      entry.failure = fmt::format("no balance at t = {}", i);
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

bool IsBest(const SearchRecord& record, const TraceEntry& entry) {
  return std::isfinite(entry.cost) && (!record.has_best() || entry.cost < record.best().cost);
}

SearchRecord RecordOf(const std::vector<TraceEntry>& entries, long most = kEntries) {
  SearchRecord record(most);
  for (const TraceEntry& entry : entries) record.Add(entry, IsBest(record, entry));
  return record;
}

void Append(const SearchRecord& part, SearchRecord& record) {
  std::vector<bool> is_best;
  double lowest = record.has_best() ? record.best().cost : kInfinity;
  for (const TraceEntry& entry : part.trace()) {
    is_best.push_back(entry.cost < lowest);
    lowest = std::min(lowest, entry.cost);
  }
  record.Append(part, is_best);
}

void ExpectSame(const SearchRecord& a, const SearchRecord& b) {
  ASSERT_EQ(a.evaluations(), b.evaluations());
  ASSERT_EQ(a.trace().size(), b.trace().size());
  for (std::size_t i = 0; i < a.trace().size(); ++i) {
    EXPECT_EQ(a.trace()[i].evaluation, b.trace()[i].evaluation) << i;
    EXPECT_EQ(a.trace()[i].level, b.trace()[i].level) << i;
    EXPECT_EQ(a.trace()[i].x, b.trace()[i].x) << i;
    EXPECT_EQ(a.trace()[i].cost, b.trace()[i].cost) << i;
    EXPECT_EQ(a.trace()[i].failure, b.trace()[i].failure) << i;
  }
  ASSERT_EQ(a.recorded(), b.recorded());
  for (std::size_t i = 0; i < a.outcomes().size(); ++i) {
    EXPECT_EQ(a.outcomes()[i].cost, b.outcomes()[i].cost) << i;
    EXPECT_EQ(a.outcomes()[i].mark, b.outcomes()[i].mark) << i;
    EXPECT_EQ(a.outcomes()[i].reason, b.outcomes()[i].reason) << i;
  }
  const auto reasons_a = a.reasons().MostFrequentFirst();
  const auto reasons_b = b.reasons().MostFrequentFirst();
  ASSERT_EQ(reasons_a.size(), reasons_b.size());
  for (std::size_t i = 0; i < reasons_a.size(); ++i) {
    EXPECT_EQ(reasons_a[i].message, reasons_b[i].message);
    EXPECT_EQ(reasons_a[i].first, reasons_b[i].first);
    EXPECT_EQ(reasons_a[i].count, reasons_b[i].count);
  }
}

TEST(SearchRecord, HoldsEverythingUpToItsLimit) {
  const SearchRecord record = RecordOf(Search(1, kEntries));
  EXPECT_EQ(record.trace().size(), static_cast<std::size_t>(kEntries));
  EXPECT_FALSE(record.thinned());
  EXPECT_TRUE(RecordOf(Search(1, kEntries + 1)).thinned());
}

TEST(SearchRecord, KeepsAnEvenShareAndEveryImprovement) {
  const std::vector<TraceEntry> search = Search(2, 5000);
  const SearchRecord record = RecordOf(search);
  EXPECT_EQ(record.evaluations(), 5000);
  double last = kInfinity;
  std::size_t improvements = 0;
  double lowest = kInfinity;
  for (long i = 0; i < 5000; ++i) {
    const double cost = search[static_cast<std::size_t>(i)].cost;
    lowest = std::min(lowest, cost);
    const bool improves = cost < (1 - 1e-3) * last;
    if (improves) last = cost;
    improvements += improves ? 1 : 0;
    const bool held = std::any_of(record.trace().begin(), record.trace().end(),
                                  [&](const TraceEntry& entry) { return entry.evaluation == i; });
    if (improves || i == 0) {
      EXPECT_TRUE(held) << i;
    }
    if (SearchRecord::LevelOf(i) >= 7) {  // 5000 / 128 is below 64, 5000 / 64 is not
      EXPECT_TRUE(held) << i;
    }
  }
  EXPECT_LE(record.trace().size(), kEntries + improvements + 3);
  EXPECT_EQ(record.best().cost, lowest);
  EXPECT_TRUE(
      std::is_sorted(record.trace().begin(), record.trace().end(),
                     [](const TraceEntry& a, const TraceEntry& b) { return a.evaluation < b.evaluation; }));
}

// Every evaluation is the lowest so far, by less than what is kept.
TEST(SearchRecord, ASlowDescentIsBoundedToo) {
  SearchRecord record(kEntries);
  for (int i = 0; i < 20000; ++i) record.Add({0, 1 + 1e-3 * std::exp(-1e-4 * i), At(i)}, true);
  EXPECT_LE(record.trace().size(), static_cast<std::size_t>(kEntries) + 4);
  EXPECT_EQ(record.best().evaluation, 19999);
  EXPECT_EQ(record.trace().back().evaluation, 19999);
}

TEST(SearchRecord, FindsTheOutcomeOfEveryEvaluationAtItsPoint) {
  const std::vector<TraceEntry> search = Search(3, 1000);
  const SearchRecord record = RecordOf(search);
  for (std::size_t i = 0; i < search.size(); ++i) {
    const EvaluationOutcome* found = record.Find(static_cast<long>(i), search[i].x);
    ASSERT_NE(found, nullptr) << i;
    EXPECT_EQ(found->cost, search[i].cost) << i;
    EXPECT_EQ(record.Find(static_cast<long>(i), At(2)), nullptr) << i;
  }
  EXPECT_EQ(record.Find(1000, search[0].x), nullptr);
}

// A search from many starts, one of whose searches is so long that it is thinned itself, is stopped after the
// third of its searches and resumed: those that had ended are taken from the record.
TEST(SearchRecord, PartsAppendedAgainGiveTheSameRecord) {
  const std::vector<std::vector<TraceEntry>> searches = {Search(4, 90), Search(5, 700), Search(6, 33),
                                                         Search(7, 250), Search(8, 4000)};
  SearchRecord whole(kEntries);
  for (const auto& search : searches) Append(RecordOf(search), whole);
  SearchRecord stopped(kEntries);
  for (std::size_t i = 0; i < 3; ++i) Append(RecordOf(searches[i]), stopped);
  SearchRecord resumed(kEntries);
  long first = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto count = static_cast<long>(searches[i].size());
    Append(stopped.Part(first, count), resumed);
    first += count;
  }
  ExpectSame(resumed, stopped);
  for (std::size_t i = 3; i < searches.size(); ++i) Append(RecordOf(searches[i]), resumed);
  ExpectSame(resumed, whole);
}

TEST(SearchRecord, WithoutAGivenLimitItGoesByTheNumberOfVariables) {
  SearchRecord few;
  SearchRecord many;
  for (int i = 0; i < 70000; ++i) {
    few.Add({0, 1, At(i)}, i == 0);
    many.Add({0, 1, Vector::Constant(300, i)}, i == 0);
  }
  EXPECT_LE(few.trace().size(), (1U << 16) + 1);
  EXPECT_GT(few.trace().size(), 30000U);
  EXPECT_LE(many.trace().size(), 4096U + 1);
  EXPECT_GT(many.trace().size(), 2000U);
}

TEST(FailureCounts, AreBounded) {
  FailureCounts counts;
  const std::string letters = "abcdefghijklmnopqrstuvwxyz";
  std::size_t evaluation = 0;
  for (const char a : letters) {
    for (const char b : letters) {
      for (const char c : {'x', 'y'}) counts.Add(std::string{a, b, c}, evaluation++);
    }
  }
  EXPECT_EQ(counts.all().size(), FailureCounts::kMostReasons);
  const auto reasons = counts.MostFrequentFirst();
  EXPECT_EQ(reasons[0].message, "other reasons");
  EXPECT_EQ(reasons[0].count, 26 * 26 * 2 - 999);
  EXPECT_EQ(reasons[0].first, 999U);
  long all = 0;
  for (const FailureReason& reason : reasons) all += reason.count;
  EXPECT_EQ(all, 26 * 26 * 2);
}

}  // namespace
}  // namespace sinew
