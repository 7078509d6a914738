#include "models/multibody/muscle_geometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/models/multibody/muscle_reference.h"

namespace sinew {
namespace {

void Compare(const MuscleReference& reference) {
  const auto paths = reference.Paths();
  auto geometry = MuscleGeometry::Build(reference.model, paths);
  ASSERT_TRUE(geometry) << geometry.error().message;
  const auto series = geometry->Along(reference.times, reference.Trajectory(), {});
  ASSERT_TRUE(series) << series.error().message;
  std::printf("%zu %zu\n", reference.times.size(), reference.length_times.size());
  for (std::size_t m = 0; m < paths.size(); ++m) {
    const auto c = static_cast<Eigen::Index>(m);
    const auto rows = std::min(reference.lengths.rows(), series->lengths.rows());
    Eigen::Index where;
    const double worst =
        (series->lengths.col(c).head(rows) - reference.lengths.col(c).head(rows)).cwiseAbs().maxCoeff(&where);
    std::printf("%-16s wraps %zu  worst %.3e m at %td\n", paths[m].name.c_str(), paths[m].wraps.size(), worst,
                where);
    if (worst > 1e-4) {
      int n = 0;
      for (Eigen::Index i = 0; i < rows; ++i) {
        const double d = series->lengths(i, c) - reference.lengths(i, c);
        if (std::abs(d) > 1e-4 && n++ < 12)
          std::printf("   %td %.5f %.5f\n", i, series->lengths(i, c), reference.lengths(i, c));
      }
      std::printf("   %d frames\n", n);
    }
  }
}

TEST(MuscleGeometry, OpenSimWithoutWrapping) {
  const MuscleReference reference("walk_gait1018_subject01.osim", "walk_gait1018_state_reference.mot",
                                  "std_testGeometryPathWrapping_walk_gait1018_muscle_lengths.sto");
  Compare(reference);
}
TEST(MuscleGeometry, OpenSimWithCylinders) {
  const MuscleReference reference("subject_walk_armless_18musc.osim", "subject_walk_armless_coordinates.mot",
                                  "std_testGeometryPathWrapping_subject_walk_armless_muscle_lengths.sto");
  Compare(reference);
}

}  // namespace
}  // namespace sinew
