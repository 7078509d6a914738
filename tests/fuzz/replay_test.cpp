// Every input of the corpora, and every one that once crashed a reader, in the ordinary tests: a reader
// returns, and what it returns holds together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/targets.h"

namespace sinew::fuzz {
namespace {

namespace fs = std::filesystem;

const std::string kFolder = SINEW_SOURCE_DIR "/tests/fuzz/";

std::vector<fs::path> InputsOf(const std::string& folder, const std::string& target) {
  std::vector<fs::path> inputs;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(kFolder + folder + "/" + target, code))
    inputs.push_back(entry.path());
  std::sort(inputs.begin(), inputs.end());
  return inputs;
}

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> Names() {
  std::vector<std::string> names;
  for (const Target& target : Targets()) names.emplace_back(target.name);
  return names;
}

class Replay : public testing::TestWithParam<std::size_t> {};

TEST_P(Replay, Inputs) {
  const Target& target = Targets()[GetParam()];
  const std::vector<fs::path> seeds = InputsOf("corpus", target.name);
  EXPECT_FALSE(seeds.empty()) << "no corpus of " << target.name;
  for (const fs::path& seed : seeds) target.run(BytesOf(seed));
  for (const fs::path& crash : InputsOf("crashes", target.name)) target.run(BytesOf(crash));
  target.run({});
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Replay, testing::Range(std::size_t{0}, Targets().size()),
                         [](const auto& one) { return std::string(Targets()[one.param].name); });

TEST(FuzzFolders, BelongToTargets) {
  for (const std::string folder : {"corpus", "crashes"}) {
    for (const auto& entry : fs::directory_iterator(kFolder + folder)) {
      if (!entry.is_directory()) continue;
      EXPECT_THAT(Names(), testing::Contains(entry.path().filename().string())) << folder;
    }
  }
}

TEST(FuzzDemand, EndsTheProcess) {
  EXPECT_DEATH(Demand(false, "a fault"), "fuzz: a fault");
  EXPECT_DEATH(DemandSentence({"x.csv"}, "x.csv"), "no sentence");
  EXPECT_DEATH(DemandSentence({"y.csv:1: wrong"}, "x.csv"), "no sentence");
  DemandSentence({"x.csv:1: wrong"}, "x.csv");
}

TEST(FuzzParts, AreSeparated) {
  EXPECT_THAT(Parts("a\n====\nb", 2), testing::ElementsAre("a", "b"));
  EXPECT_THAT(Parts("a", 3), testing::ElementsAre("a", "", ""));
  EXPECT_THAT(Parts("a\n====\nb\n====\nc", 2), testing::ElementsAre("a", "b\n====\nc"));
}

}  // namespace
}  // namespace sinew::fuzz
