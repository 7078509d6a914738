#include "models/contact/contact_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/text.h"

namespace sinew {
namespace {

constexpr int kMaxStrips = 1000;
constexpr long kMaxCells = kMostMeshFaces / 4;  // a plate has two faces below and two above each cell

// A plate whose bottom and top are grids of (along_x + 1) x (along_z + 1) points, joined at the rim.
// `corner(i, j)` gives x and z of grid point i along x, j along z.
template <class Corner>
ContactMesh GridPlate(double thickness, int along_x, int along_z, Corner corner) {
  ContactMesh mesh;
  const int row = along_z + 1;
  const int layer = (along_x + 1) * row;
  for (const double y : {0.0, thickness}) {
    for (int i = 0; i <= along_x; ++i) {
      for (int j = 0; j <= along_z; ++j) {
        const std::array<double, 2> xz = corner(i, j);
        mesh.vertices.emplace_back(xz[0], y, xz[1]);
      }
    }
  }
  const auto quad = [&mesh](int a, int b, int c, int d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  };
  for (int i = 0; i < along_x; ++i) {
    for (int j = 0; j < along_z; ++j) {
      const int a = i * row + j;
      quad(a, a + row, a + row + 1, a + 1);                                  // bottom, seen from below
      quad(a + layer, a + layer + 1, a + layer + row + 1, a + layer + row);  // top
    }
  }
  for (int i = 0; i < along_x; ++i) {
    const int low = i * row;
    const int high = low + along_z;
    quad(low, low + layer, low + row + layer, low + row);
    quad(high, high + row, high + row + layer, high + layer);
  }
  for (int j = 0; j < along_z; ++j) {
    const int back = j;
    const int front = along_x * row + j;
    quad(back, back + 1, back + 1 + layer, back + layer);
    quad(front, front + layer, front + 1 + layer, front + 1);
  }
  return mesh;
}

Status CheckStrips(int along_x, int along_z) {
  if (along_x < 1 || along_z < 1 || along_x > kMaxStrips || along_z > kMaxStrips) {
    return Fail("sole mesh: {} x {} strips, expected 1 to {} each way", along_x, along_z, kMaxStrips);
  }
  if (long{along_x} * along_z > kMaxCells) {
    return Fail("sole mesh: {} x {} strips make {} cells, expected at most {}", along_x, along_z,
                long{along_x} * along_z, kMaxCells);
  }
  return {};
}

// Lowest and highest z of the outline on the line x = constant.
Result<std::pair<double, double>> Chord(const std::vector<std::array<double, 2>>& outline, double x) {
  std::vector<double> crossings;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto& a = outline[i];
    const auto& b = outline[(i + 1) % outline.size()];
    if ((a[0] <= x) == (b[0] <= x)) continue;
    crossings.push_back(a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]));
  }
  if (crossings.size() != 2) {
    return Fail("sole outline: the line x = {:.4g} m crosses it {} times, expected twice", x,
                crossings.size());
  }
  return std::minmax(crossings[0], crossings[1]);
}

}  // namespace

Vec3 ContactMesh::Centre(int face) const {
  const auto& f = faces[static_cast<std::size_t>(face)];
  return (vertices[static_cast<std::size_t>(f[0])] + vertices[static_cast<std::size_t>(f[1])] +
          vertices[static_cast<std::size_t>(f[2])]) /
         3;
}

double ContactMesh::Area(int face) const {
  const auto& f = faces[static_cast<std::size_t>(face)];
  const Vec3& a = vertices[static_cast<std::size_t>(f[0])];
  return 0.5 * (vertices[static_cast<std::size_t>(f[1])] - a)
                   .cross(vertices[static_cast<std::size_t>(f[2])] - a)
                   .norm();
}

Vec3 ContactMesh::Normal(int face) const {
  const auto& f = faces[static_cast<std::size_t>(face)];
  const Vec3& a = vertices[static_cast<std::size_t>(f[0])];
  return (vertices[static_cast<std::size_t>(f[1])] - a)
      .cross(vertices[static_cast<std::size_t>(f[2])] - a)
      .normalized();
}

Result<ContactMesh> BoxMesh(const Vec3& size, int along_x, int along_z) {
  if (!size.allFinite() || !(size.minCoeff() > 0)) {
    return Fail("sole box: size {} x {} x {} m, expected three lengths above 0", size.x(), size.y(),
                size.z());
  }
  SINEW_TRY(CheckStrips(along_x, along_z));
  return GridPlate(size.y(), along_x, along_z, [&](int i, int j) {
    return std::array<double, 2>{size.x() * (static_cast<double>(i) / along_x - 0.5),
                                 size.z() * (static_cast<double>(j) / along_z - 0.5)};
  });
}

Result<ContactMesh> OutlineMesh(const std::vector<std::array<double, 2>>& outline, double thickness,
                                int along_x, int along_z) {
  if (outline.size() < 3) return Fail("sole outline: {} corners, expected at least 3", outline.size());
  for (const auto& corner : outline) {
    if (!std::isfinite(corner[0]) || !std::isfinite(corner[1]))
      return Fail("sole outline: a corner is not finite");
  }
  if (!(thickness > 0)) return Fail("sole outline: thickness {} m, expected above 0", thickness);
  SINEW_TRY(CheckStrips(along_x, along_z));
  const auto [back, front] = std::minmax_element(outline.begin(), outline.end(),
                                                 [](const auto& a, const auto& b) { return a[0] < b[0]; });
  const double length = (*front)[0] - (*back)[0];
  if (!(length > 0)) return Fail("sole outline: all corners lie at x = {} m", (*back)[0]);

  // The tips are cut by a hundredth of a strip, so that a pointed outline has no face without area.
  const double tip = 0.01 * length / along_x;
  std::vector<std::pair<double, double>> chords;
  std::vector<double> stations;
  for (int i = 0; i <= along_x; ++i) {
    const double x = std::clamp((*back)[0] + length * i / along_x, (*back)[0] + tip, (*front)[0] - tip);
    SINEW_ASSIGN(const auto chord, Chord(outline, x));
    stations.push_back(x);
    chords.push_back(chord);
  }
  const ContactMesh mesh = GridPlate(thickness, along_x, along_z, [&](int i, int j) {
    const auto& [low, high] = chords[static_cast<std::size_t>(i)];
    return std::array<double, 2>{stations[static_cast<std::size_t>(i)], low + (high - low) * j / along_z};
  });
  SINEW_TRY(CheckClosed(mesh));
  return mesh;
}

Result<ContactMesh> ReadObj(const std::string& text, const std::string& file, double scale) {
  ContactMesh mesh;
  long line_number = 0;
  for (const std::string_view line : Split(text, '\n')) {
    ++line_number;
    const auto words = SplitBlanks(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    if (words[0] == "v") {
      if (words.size() < 4)
        return FailAt(file, line_number, "vertex has {} coordinates, expected 3", words.size() - 1);
      Vec3 vertex;
      for (int axis = 0; axis < 3; ++axis) {
        const auto number = ParseNumber(words[static_cast<std::size_t>(axis) + 1]);
        if (!number || !std::isfinite(*number)) {
          return FailAt(file, line_number, "'{}' is not a coordinate",
                        words[static_cast<std::size_t>(axis) + 1]);
        }
        vertex[axis] = scale * *number;
      }
      mesh.vertices.push_back(vertex);
    } else if (words[0] == "f") {
      std::vector<int> corners;
      for (std::size_t i = 1; i < words.size(); ++i) {
        auto index = ParseInteger(words[i].substr(0, words[i].find('/')));
        const auto count = static_cast<long>(mesh.vertices.size());
        if (index && *index < 0) index = count + *index + 1;  // counted from the last vertex
        if (!index || *index < 1 || *index > count) {
          return FailAt(file, line_number, "'{}' is not one of the {} vertices so far", words[i], count);
        }
        corners.push_back(static_cast<int>(*index - 1));
      }
      if (corners.size() < 3)
        return FailAt(file, line_number, "face has {} corners, expected 3", corners.size());
      for (std::size_t i = 2; i < corners.size(); ++i)
        mesh.faces.push_back({corners[0], corners[i - 1], corners[i]});
      if (mesh.face_count() > kMostMeshFaces)
        return FailAt(file, line_number, "the mesh has more than {} triangles", kMostMeshFaces);
    }
  }
  if (mesh.faces.empty()) return Fail("{}: holds no face", file);
  const Status closed = CheckClosed(mesh);
  if (!closed) return Fail("{}: {}", file, closed.error().message);
  return mesh;
}

Status CheckClosed(const ContactMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (int face = 0; face < mesh.face_count(); ++face) {
    const auto& f = mesh.faces[static_cast<std::size_t>(face)];
    if (!(mesh.Area(face) > 0)) return Fail("contact mesh: face {} has no area", face);
    for (int k = 0; k < 3; ++k) {
      const std::pair<int, int> edge{f[static_cast<std::size_t>(k)],
                                     f[static_cast<std::size_t>((k + 1) % 3)]};
      if (++edges[edge] > 1)
        return Fail("contact mesh: edge {}-{} is used twice in one direction", edge.first, edge.second);
    }
  }
  for (const auto& [edge, count] : edges) {
    if (edges.count({edge.second, edge.first}) == 0) {
      return Fail("contact mesh: edge {}-{} has a face on one side only; the mesh must be closed", edge.first,
                  edge.second);
    }
  }
  return {};
}

}  // namespace sinew
