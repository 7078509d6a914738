// The sole as a closed triangle mesh: a box, a flat outline with a thickness, or an .obj file.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

/// More triangles than any sole needs; they would take gigabytes (a sole of a few hundred springs is fine).
constexpr int kMostMeshFaces = 200000;

/// Closed, oriented triangle mesh (corners counter-clockwise seen from outside), in the frame of its region:
/// y up, the bottom of a sole at y = 0 [m].
struct ContactMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> faces;

  [[nodiscard]] int face_count() const { return static_cast<int>(faces.size()); }
  /// Where the spring of a face is attached: the mean of its corners.
  [[nodiscard]] Vec3 Centre(int face) const;
  [[nodiscard]] double Area(int face) const;
  /// Unit vector out of the mesh.
  [[nodiscard]] Vec3 Normal(int face) const;
};

/// Box with its bottom at y = 0, centred in x and z.
/// @param size [m, all > 0]; @param along_x, along_z squares of the bottom, 1 to 1000 (two faces
/// each), and at most kMostMeshFaces / 4 in all.
Result<ContactMesh> BoxMesh(const Vec3& size, int along_x, int along_z);

/// Plate with the given outline, from y = 0 up to the thickness.
/// @param outline [>= 3 corners, x and z, m], in either sense of rotation; every line x = constant must cross
/// it at most twice (true for a sole whose long axis is x). @param along_x, along_z strips of the bottom.
Result<ContactMesh> OutlineMesh(const std::vector<std::array<double, 2>>& outline, double thickness,
                                int along_x, int along_z);

/// Wavefront .obj: v and f lines (polygons are cut into fans; texture and normal indices are ignored).
/// @param scale to metres. Errors carry file and line; a mesh that is not closed, or has more than
/// kMostMeshFaces triangles, is an error too.
Result<ContactMesh> ReadObj(const std::string& text, const std::string& file, double scale = 1);

/// Closed: every edge belongs to two faces, in opposite directions; no face without area.
[[nodiscard]] Status CheckClosed(const ContactMesh& mesh);

}  // namespace sinew
