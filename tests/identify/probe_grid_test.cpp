#include "identify/probe_grid.h"

#include <gmock/gmock.h>

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(ProbeGrid, CombinesTheValuesOfTheParametersThatHaveAny) {
  std::vector<Parameter> parameters(4);
  parameters[0].probes = {9};
  parameters[1].probes = {1, 2};
  parameters[3].probes = {3, 4};
  EXPECT_THAT(ProbeGrid(parameters, {1, 2, 3}),
              ElementsAre(ElementsAre(Pair(1, 1), Pair(3, 3)), ElementsAre(Pair(1, 1), Pair(3, 4)),
                          ElementsAre(Pair(1, 2), Pair(3, 3)), ElementsAre(Pair(1, 2), Pair(3, 4))));
}

TEST(ProbeGrid, OfAGroupWithoutValuesIsOneEmptyEntry) {
  EXPECT_THAT(ProbeGrid(std::vector<Parameter>(2), {0, 1}), ElementsAre(ElementsAre()));
}

}  // namespace
}  // namespace sinew
