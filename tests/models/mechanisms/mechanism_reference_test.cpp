#include "models/mechanisms/mechanism_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace sinew {
namespace {

namespace fs = std::filesystem;

class ReferenceFolder : public testing::Test {
 protected:
  ReferenceFolder() : folder_(fs::temp_directory_path() / ("sinew_mbs_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~ReferenceFolder() override { fs::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  [[nodiscard]] std::string ErrorOfReading() const {
    const auto reference = ReadReference(*FindMechanism("A01"), folder_.string());
    return reference ? "" : reference.error().message;
  }
  const fs::path folder_;
};

TEST_F(ReferenceFolder, IsReadByCoordinate) {
  Write("A01_reference_x.csv", "t_s,value_m\n-1e-9,-1\n0.5,-0.4\n");
  Write("A01_any_reference_y.csv", "0,0\n0.25,-0.9\n0.5,-0.8\n\n");
  Write("A02_reference_x.csv", "not ours");
  const auto reference = ReadReference(*FindMechanism("A01"), folder_.string());
  ASSERT_TRUE(reference) << reference.error().message;
  EXPECT_EQ(reference->curves[0].values, (std::vector<double>{-1, -0.4}));
  EXPECT_EQ(reference->curves[1].time, (std::vector<double>{0, 0.25, 0.5}));
  EXPECT_EQ(TimesOf(*reference), (std::vector<double>{0, 0.25, 0.5}));
}

TEST_F(ReferenceFolder, BadFilesAreNamed) {
  EXPECT_NE(ErrorOfReading().find("no file A01_..reference_x.csv"), std::string::npos) << ErrorOfReading();
  Write("A01_reference_y.csv", "0,0\n");
  Write("A01_reference_x.csv", "t_s,value_m\n0,1\n0.1,one\n");
  EXPECT_NE(ErrorOfReading().find("A01_reference_x.csv:3: expected"), std::string::npos) << ErrorOfReading();
  Write("A01_reference_x.csv", "0,1\n0,2\n");
  EXPECT_NE(ErrorOfReading().find(":2: time does not increase"), std::string::npos) << ErrorOfReading();
  Write("A01_reference_x.csv", "0,1,2\n");
  EXPECT_NE(ErrorOfReading().find(":1: expected"), std::string::npos) << ErrorOfReading();
  Write("A01_reference_x.csv", "0,nan\n");
  EXPECT_NE(ErrorOfReading().find(":1: expected"), std::string::npos) << ErrorOfReading();
  Write("A01_reference_x.csv", "t_s,value_m\n");
  EXPECT_NE(ErrorOfReading().find("no samples"), std::string::npos) << ErrorOfReading();
  Write("A01_reference_x.csv", "0,1\n");
  Write("A01_b_reference_x.csv", "0,1\n");
  EXPECT_NE(ErrorOfReading().find("more than one file"), std::string::npos) << ErrorOfReading();
  EXPECT_FALSE(ReadReference(*FindMechanism("A01"), (folder_ / "absent").string()));
}

TEST(BuiltInReference, ThePendulumConservesEnergyAndIsPeriodic) {
  const MechanismReference reference = BuiltInReference(*FindMechanism("A01"));
  const auto& x = reference.curves[0].values;
  const auto& y = reference.curves[1].values;
  EXPECT_EQ(x[0], -1);
  double lowest = 0;
  double farthest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(x[i] * x[i] + y[i] * y[i], 1, 1e-14);
    EXPECT_LE(y[i], 1e-14);
    lowest = std::min(lowest, y[i]);
    farthest = std::max(farthest, x[i]);
  }
  EXPECT_LT(lowest, -0.999);
  EXPECT_GT(farthest, 0.99);
}

// The curves that came with the benchmark have six digits or so.
TEST(BuiltInReference, AgreesWithTheLibraryOfBenchmarkProblems) {
  const std::string folder = SINEW_SHARED_DATA "/mbs_benchmark";
  if (!fs::exists(folder)) GTEST_SKIP() << "needs the shared data";
  for (const char* name : {"A01", "A02", "A03", "A04", "A05"}) {
    const Mechanism mechanism = *FindMechanism(name);
    const auto theirs = ReadReference(mechanism, folder);
    ASSERT_TRUE(theirs) << theirs.error().message;
    const MechanismReference ours = BuiltInReference(mechanism);
    int common = 0;
    for (std::size_t j = 0; j < ours.curves.size(); ++j) {
      const ReferenceCurve& curve = theirs->curves[j];
      for (std::size_t i = 0; i < curve.time.size(); ++i) {
        for (std::size_t k = 0; k < ours.curves[j].time.size(); ++k) {
          if (std::abs(ours.curves[j].time[k] - curve.time[i]) > 1e-8 * mechanism.duration) continue;
          ++common;
          EXPECT_NEAR(ours.curves[j].values[k], curve.values[i], name[2] == '3' ? 6e-9 : 4e-6)
              << name << ' ' << mechanism.coordinates[j] << " at " << curve.time[i];
        }
      }
    }
    EXPECT_GT(common, 20) << name;
  }
}

}  // namespace
}  // namespace sinew
