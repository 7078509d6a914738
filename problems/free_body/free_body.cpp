#include "problems/free_body/free_body.h"

namespace sinew {

std::vector<ContactPoint> PointsOfBox(const Vec3& edges, FreeBodyContact contact, int divisions) {
  std::vector<ContactPoint> points;
  const Vec3 half = edges / 2;
  if (contact == FreeBodyContact::kVertices) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
      points.push_back({sign.cwiseProduct(half), -sign, 1});
    }
    return points;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3;
    const int b = (axis + 2) % 3;
    const double area = edges[a] * edges[b] / (divisions * divisions);
    for (const double side : {-1.0, 1.0}) {
      for (int i = 0; i < divisions; ++i) {
        for (int j = 0; j < divisions; ++j) {
          Vec3 place;
          place[axis] = side * half[axis];
          place[a] = half[a] * ((2 * i + 1.0) / divisions - 1);
          place[b] = half[b] * ((2 * j + 1.0) / divisions - 1);
          points.push_back({place, Vec3::Zero(), area});
        }
      }
    }
  }
  return points;
}

}  // namespace sinew
