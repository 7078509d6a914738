#include "datasets/io/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(TextFilesRead, HoldsTheNamesOfAllThatIsReadWhileItLives) {
  const TextFilesRead outer;
  static_cast<void>(ReadTextFile("/no/a"));
  {
    const TextFilesRead inner;
    static_cast<void>(ReadTextFile("/no/b"));
    EXPECT_THAT(inner.paths(), ElementsAre("/no/b"));
  }
  static_cast<void>(ReadTextFile("/no/c"));
  EXPECT_THAT(outer.paths(), ElementsAre("/no/a", "/no/b", "/no/c"));
  EXPECT_THAT(TextFilesRead().paths(), IsEmpty());
}

}  // namespace
}  // namespace sinew
