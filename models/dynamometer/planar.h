// Vectors of the plane.
#pragma once

namespace sinew {

template <class T>
struct PlanarVector {
  T x{0.0};
  T y{0.0};
};

/// Moment of a force about the origin, counterclockwise.
template <class A, class B>
[[nodiscard]] auto Cross(const PlanarVector<A>& at, const PlanarVector<B>& force) {
  return at.x * force.y - at.y * force.x;
}

/// Cosine and sine of an angle.
template <class T>
struct Turn {
  T cosine{1.0};
  T sine{0.0};

  template <class U>
  [[nodiscard]] PlanarVector<T> operator()(const PlanarVector<U>& v) const {
    return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y};
  }
};

}  // namespace sinew
