// Which candidates are refitted, for scores that are written by hand.
#include "identify/diagnosis/score/shortlist.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace sinew::diagnosis {
namespace {

using Pair = std::pair<int, int>;

/// Candidates and their scores. Directions are orthogonal unless Correlate is called.
class Scores {
 public:
  /// One candidate with one parameter, whose score has the statistic t^2. @return its index
  int Add(const std::string& effect, double t, const std::string& trial = "") {
    return AddMany(effect, {t}, trial);
  }
  int AddUnknown(const std::string& effect, double t) {
    const int c = Add(effect, t);
    candidates[static_cast<std::size_t>(c)].known = false;
    return c;
  }
  /// One candidate with a parameter for each of these t; its statistic is the sum of their squares.
  int AddMany(const std::string& effect, const std::vector<double>& t, const std::string& trial = "") {
    const int c = AddCandidate(effect, static_cast<int>(t.size()), trial);
    AddScore(c, t, scored.whitened);
    return c;
  }
  int AddCandidate(const std::string& effect, int parameters, const std::string& trial = "") {
    Candidate candidate;
    candidate.effect = effect;
    candidate.trial = trial;
    for (int i = 0; i < parameters; ++i) candidate.parameters.push_back(parameter_++);
    candidate.probes.emplace_back();
    candidates.push_back(candidate);
    return static_cast<int>(candidates.size()) - 1;
  }
  static void AddScore(int candidate, const std::vector<double>& t, ScoreTable& table) {
    Score score;
    score.candidate = candidate;
    for (const double value : t) {
      const auto at = table.t.size();
      table.t.conservativeResize(at + 1);
      table.t[at] = value;
      Matrix correlation = Matrix::Identity(at + 1, at + 1);
      correlation.topLeftCorner(at, at) = table.correlation;
      table.correlation = correlation;
      table.positive.push_back(false);
      score.directions.push_back(static_cast<int>(at));
      score.statistic += value * value;
    }
    table.scores.push_back(score);
  }
  void Correlate(int a, int b, double correlation) {
    scored.whitened.correlation(a, b) = correlation;
    scored.whitened.correlation(b, a) = correlation;
  }
  /// One of the statistics with these values per candidate.
  void AddAll(const std::vector<double>& statistics) {
    for (const double statistic : statistics)
      Add("effect_" + std::to_string(candidates.size()), std::sqrt(statistic));
  }

  [[nodiscard]] std::vector<int> Singles() const { return Shortlist(candidates, scored).Singles(scored); }
  [[nodiscard]] std::vector<int> All() const { return Shortlist(candidates, scored).All(); }
  [[nodiscard]] std::vector<Pair> Pairs() const { return Shortlist(candidates, scored).Pairs(); }

  std::vector<Candidate> candidates;
  ScoredModel scored;

 private:
  int parameter_ = 0;
};

bool Contains(const std::vector<int>& set, int c) {
  return std::count(set.begin(), set.end(), c) > 0;
}

// 40 % of 100: 61 is 39 behind, 59 is 41 behind.
TEST(Shortlist, KeepsScoresWithinFortyPercentOfALargeOne) {
  Scores scores;
  scores.AddAll({59, 100, 61, 80, 90, 70});
  EXPECT_EQ(scores.Singles(), (std::vector<int>{1, 2, 3, 4, 5}));
}

// 40 % of 20 is only 8; twice the set width of 6 is 12: 9 is 11 behind, 7 is 13 behind.
TEST(Shortlist, KeepsScoresWithinTwoSetWidthsOfASmallOne) {
  Scores scores;
  scores.AddAll({20, 18, 16, 14, 9, 7});
  EXPECT_EQ(scores.Singles(), (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(Shortlist, KeepsTheFirstFourHoweverFarTheyAreBehind) {
  Scores scores;
  scores.AddAll({0.5, 1, 100, 3, 2});
  EXPECT_EQ(scores.Singles(), (std::vector<int>{1, 2, 3, 4}));
}

TEST(Shortlist, KeepsNoCandidateWithoutAScoreAboveZero) {
  Scores scores;
  scores.AddAll({0, 100, 0});
  scores.AddCandidate("not_judged", 1);
  EXPECT_EQ(scores.Singles(), std::vector<int>{1});
}

TEST(Shortlist, KeepsFourteenAtMost) {
  Scores scores;
  scores.AddAll(std::vector<double>(16, 50));
  const std::vector<int> singles = scores.Singles();
  ASSERT_EQ(singles.size(), 14U);
  EXPECT_EQ(singles.front(), 0);
  EXPECT_EQ(singles.back(), 13) << "of equal scores those of the first candidates";
}

// Two further parameters cost 8: a statistic of 70 counts as 62, 38 behind 100, and one of 66 as 58.
TEST(Shortlist, FurtherParametersAreCharged) {
  Scores scores;
  scores.AddAll({100, 90, 80, 70});
  const int kept = scores.AddMany("three", {std::sqrt(30.0), std::sqrt(30.0), std::sqrt(10.0)});
  const int dropped = scores.AddMany("three_too", {std::sqrt(30.0), std::sqrt(30.0), std::sqrt(6.0)});
  EXPECT_TRUE(Contains(scores.Singles(), kept));
  EXPECT_FALSE(Contains(scores.Singles(), dropped));
}

TEST(Shortlist, UnknownTermsAreNotRefittedAsCauses) {
  Scores scores;
  const int known = scores.Add("known", 3);
  scores.AddUnknown("y(u)", 10);
  EXPECT_EQ(scores.Singles(), std::vector<int>{known});
}

TEST(Shortlist, AllHasKnownEffectsWithoutAScoreToo) {
  Scores scores;
  const int scored = scores.Add("scored", 5);
  scores.AddUnknown("term", 6);
  const int unscored = scores.AddCandidate("unscored", 1);
  EXPECT_EQ(scores.Singles(), std::vector<int>{scored});
  EXPECT_EQ(scores.All(), (std::vector<int>{scored, unscored}));
}

TEST(Shortlist, BestProbeOfACandidateDecides) {
  Scores scores;
  scores.AddAll({100, 90, 80, 70});
  const int probed = scores.Add("probed", 1);
  Scores::AddScore(probed, {8}, scores.scored.whitened);  // 64: 36 behind
  Scores::AddScore(probed, {2}, scores.scored.whitened);
  EXPECT_TRUE(Contains(scores.Singles(), probed));
}

// Coloured noise absorbs large effects: what is large without whitening is refitted too.
TEST(Shortlist, UnwhitenedScoresCountUnderColouredNoiseAlone) {
  Scores scores;
  scores.AddAll({100, 90, 80, 70, 10});
  for (int c = 0; c < 4; ++c) Scores::AddScore(c, {1}, scores.scored.plain);
  Scores::AddScore(4, {10}, scores.scored.plain);
  scores.scored.refit.noise.channels = {{"y", {}, 1}};
  EXPECT_EQ(scores.Singles(), (std::vector<int>{0, 1, 2, 3}));
  scores.scored.refit.noise.channels = {{"y", {0.8}, 1}};
  EXPECT_EQ(scores.Singles(), (std::vector<int>{0, 1, 2, 3, 4}));
}

/// An offset of each of four trials; the third has t = 6, the others `other`.
Scores OneTrialStandsOut(double other) {
  Scores scores;
  for (int t = 1; t <= 4; ++t) {
    const std::string trial = "trial_" + std::to_string(t);
    scores.Add("offset@" + trial, t == 3 ? 6 : other, trial);
  }
  return scores;
}

// 36 - 4 is at least 3 (9 - 4) + 6 = 21.
TEST(Shortlist, OnlyTheOutlyingTrialsEffectsAreKept) {
  Scores scores = OneTrialStandsOut(3);
  const int same_trial = scores.Add("scale@trial_3", 3.5, "trial_3");
  scores.Add("scale@trial_1", 3.5, "trial_1");
  const int shared = scores.Add("offset", 4);
  EXPECT_EQ(scores.Singles(), (std::vector<int>{2, same_trial, shared}));
}

// 36 - 4 is less than 3 (16 - 4) + 6 = 42.
TEST(Shortlist, NoTrialIsOutlyingIfOthersHaveLargeScoresToo) {
  Scores scores = OneTrialStandsOut(4);
  const int shared = scores.Add("offset", 3);
  EXPECT_EQ(scores.Singles(), std::vector<int>{shared});
}

// The least difference: 9.9 - 4 is less than 6, 10.1 - 4 is more.
TEST(Shortlist, NoTrialIsOutlyingByASmallScore) {
  for (const bool large : {false, true}) {
    Scores scores;
    // Twice the charge of a parameter is deducted from effects of one trial: 10.1 - 8 is above zero.
    scores.Add("offset@trial_1", std::sqrt(large ? 10.1 : 9.9), "trial_1");
    scores.Add("offset@trial_2", 0, "trial_2");
    EXPECT_EQ(scores.Singles().size(), large ? 1U : 0U);
  }
}

// Signatures with a correlation of -0.8: of t = (6, -4.8) the second is what the first leaves there, because
// the joint statistic (36 + 23.04 - 1.6 * 28.8) / 0.36 is 36, that of the first alone. Without the
// correlation 3 (23.04 - 4) + 6 = 63 exceeds 32.
TEST(Shortlist, ScoresThatTheOutlyingTrialExplainsDoNotCount) {
  for (const double correlation : {-0.8, 0.0}) {
    Scores scores;
    scores.Add("offset@trial_1", 6, "trial_1");
    scores.Add("offset@trial_2", -4.8, "trial_2");
    scores.Correlate(0, 1, correlation);
    EXPECT_EQ(scores.Singles(), correlation < 0 ? std::vector<int>{0} : std::vector<int>{});
  }
}

TEST(Shortlist, OfTwoOutlyingTrialsTheOneWithTheLargerScoreIsKept) {
  Scores scores = OneTrialStandsOut(0);
  const int larger = scores.Add("scale@trial_2", 7, "trial_2");
  scores.Add("scale@trial_1", 0, "trial_1");
  EXPECT_EQ(scores.Singles(), std::vector<int>{larger});
}

// 25 + 16, 25 + 9 and 16 + 9, less 8 each.
TEST(Shortlist, PairsAreOrderedByTheirJointStatistic) {
  Scores scores;
  const int c = scores.Add("c", 3);
  const int a = scores.Add("a", 5);
  const int b = scores.Add("b", -4);
  EXPECT_EQ(scores.Pairs(), (std::vector<Pair>{{a, b}, {c, a}, {c, b}}));
}

// b has three parameters: 41 - 16 = 25 with a, below 34 - 8 = 26 of a and c.
TEST(Shortlist, PairsAreChargedForTheirParameters) {
  Scores scores;
  const int a = scores.Add("a", 5);
  const int b = scores.AddMany("b", {4, 0, 0});
  const int c = scores.Add("c", 3);
  EXPECT_EQ(scores.Pairs(), (std::vector<Pair>{{a, c}, {a, b}, {b, c}}));
}

// (9 + 9 + 1.8 * 9) / (1 - 0.81) = 180 of the pair, although each alone has 9; the two largest alone have
// 49 + 36.
TEST(Shortlist, PairThatIsLargeOnlyTogetherComesFirst) {
  Scores scores;
  const int a = scores.Add("a", 3);
  const int b = scores.Add("b", -3);
  scores.Add("c", 7);
  scores.Add("d", 6);
  scores.Correlate(a, b, 0.9);
  EXPECT_EQ(scores.Pairs().front(), Pair(a, b));
}

TEST(Shortlist, PairsAreOfSharedKnownEffects) {
  Scores scores;
  const int a = scores.Add("a", 1);
  scores.AddUnknown("y(u)", 9);
  scores.Add("offset@trial_1", 9, "trial_1");
  const int b = scores.Add("b", 1);
  EXPECT_EQ(scores.Pairs(), (std::vector<Pair>{{a, b}}));
}

// The second probe of a has 36, the first 1: 36 + 25 with c, 36 + 4 with b, and 25 + 4 without a. With the
// first probe the order would be another.
TEST(Shortlist, PairOfProbedCandidatesIsListedOnceAtItsBestProbes) {
  Scores scores;
  const int a = scores.Add("a", 1);
  Scores::AddScore(a, {6}, scores.scored.whitened);
  const int b = scores.Add("b", 2);
  const int c = scores.Add("c", 5);
  EXPECT_EQ(scores.Pairs(), (std::vector<Pair>{{a, c}, {a, b}, {b, c}}));
}

TEST(Shortlist, EightPairsAtMost) {
  Scores scores;
  for (int c = 0; c < 5; ++c) scores.Add("effect_" + std::to_string(c), 10 - c);
  const std::vector<Pair> pairs = scores.Pairs();
  ASSERT_EQ(pairs.size(), 8U) << "of ten";
  EXPECT_EQ(std::count(pairs.begin(), pairs.end(), Pair(3, 4)), 0) << "the smallest";
  EXPECT_EQ(std::count(pairs.begin(), pairs.end(), Pair(2, 4)), 0) << "and the smallest but one";
}

}  // namespace
}  // namespace sinew::diagnosis
