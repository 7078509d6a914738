#include "models/contact/contact_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

using ::testing::HasSubstr;

double BottomArea(const ContactMesh& mesh) {
  double area = 0;
  for (int face = 0; face < mesh.face_count(); ++face) {
    if (mesh.Normal(face).y() < -0.5) area += mesh.Area(face);
  }
  return area;
}

// Divergence theorem: the sum of area vectors of a closed mesh is zero, and a third of sum (centre . area)
// its volume.
double Volume(const ContactMesh& mesh) {
  double volume = 0;
  for (int face = 0; face < mesh.face_count(); ++face) {
    volume += mesh.Centre(face).dot(mesh.Normal(face)) * mesh.Area(face) / 3;
  }
  return volume;
}

TEST(ContactMesh, BoxIsClosedAndHasItsVolume) {
  const auto mesh = *BoxMesh({0.2, 0.03, 0.1}, 7, 3);
  EXPECT_TRUE(CheckClosed(mesh));
  EXPECT_NEAR(BottomArea(mesh), 0.02, 1e-15);
  EXPECT_NEAR(Volume(mesh), 0.2 * 0.03 * 0.1, 1e-15);
}

TEST(ContactMesh, OutlineOfAnEllipseHasItsArea) {
  std::vector<std::array<double, 2>> outline;
  for (int i = 0; i < 200; ++i) {
    outline.push_back({0.12 * std::cos(2 * M_PI * i / 200), 0.05 * std::sin(2 * M_PI * i / 200)});
  }
  const auto mesh = *OutlineMesh(outline, 0.02, 60, 6);
  EXPECT_TRUE(CheckClosed(mesh));
  EXPECT_NEAR(BottomArea(mesh), M_PI * 0.12 * 0.05,
              1e-2 * M_PI * 0.12 * 0.05);  // 60 straight strips: about 0.5 %
  EXPECT_NEAR(Volume(mesh), 0.02 * BottomArea(mesh), 1e-12);
}

TEST(ContactMesh, ReadsAnObjFile) {
  const std::string tetrahedron =
      "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1/1 2/2 4/3\nf 1 4 3\nf 2 -2 4\n";
  const auto mesh = ReadObj(tetrahedron, "t.obj", 0.1);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->face_count(), 4);
  EXPECT_NEAR(Volume(*mesh), 1e-3 / 6, 1e-15);
}

TEST(ContactMesh, ErrorsNameTheCause) {
  EXPECT_THAT(BoxMesh({0.2, 0, 0.1}, 2, 2).error().message, HasSubstr("three lengths above 0"));
  EXPECT_THAT(BoxMesh({0.2, 0.1, 0.1}, 0, 2).error().message, HasSubstr("0 x 2 strips"));
  EXPECT_THAT(OutlineMesh({{0, 0}, {1, 0}}, 0.1, 2, 2).error().message, HasSubstr("at least 3"));
  EXPECT_THAT(OutlineMesh({{0, 0}, {1, 0}, {0.1, 0.5}, {1, 1}, {0, 1}}, 0.1, 4, 2).error().message,
              HasSubstr("expected twice"));
  EXPECT_EQ(ReadObj("v 0 0 0\nv 1 x 0\n", "a.obj").error().message, "a.obj:2: 'x' is not a coordinate");
  EXPECT_EQ(ReadObj("v 0 0 0\nf 1 2 3\n", "a.obj").error().message,
            "a.obj:2: '2' is not one of the 1 vertices so far");
  EXPECT_THAT(ReadObj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj").error().message,
              HasSubstr("must be closed"));
  EXPECT_EQ(ReadObj("", "a.obj").error().message, "a.obj: holds no face");
}

// 1000 x 1000 strips took 1.3 GB.
TEST(ContactMesh, IsNoLargerThanASoleNeeds) {
  EXPECT_EQ(BoxMesh({0.2, 0.02, 0.1}, 1000, 1000).error().message,
            "sole mesh: 1000 x 1000 strips make 1000000 cells, expected at most 50000");
  EXPECT_THAT(OutlineMesh({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0.1, 501, 100).error().message,
              HasSubstr("expected at most 50000"));
  EXPECT_TRUE(BoxMesh({0.2, 0.02, 0.1}, 500, 100));
  std::string fan = "v 0 0 0\nv 1 0 0\nv 0 0 1\n";
  std::string corners = "f";
  for (int i = 0; i < kMostMeshFaces / 2; ++i) corners += " 1";
  fan += corners + "\n" + corners + "\n" + corners + "\n";
  EXPECT_EQ(ReadObj(fan, "a.obj").error().message, "a.obj:6: the mesh has more than 200000 triangles");
}

TEST(ContactMesh, DamagedObjFilesAreErrors) {
  const std::string valid = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  Random random(1);
  int accepted = 0;
  for (int round = 0; round < 5000; ++round) {
    std::string mutated = valid.substr(0, random.Index(valid.size()) + 1);
    for (std::uint64_t i = random.Index(4); i-- > 0;)
      mutated[random.Index(mutated.size())] = static_cast<char>(random.Index(256));
    if (ReadObj(mutated, "m.obj")) ++accepted;
  }
  EXPECT_LT(accepted, 5000);
}

}  // namespace
}  // namespace sinew
