// Forward-mode dual numbers: a value and its derivatives for N variables ("lanes"), carried through
// arithmetic exactly. The value is computed by the same operations, in the same order, as with double: to the
// last bit.
//
// Source: Griewank & Walther, Evaluating Derivatives (2nd ed., 2008), ch. 3.
#pragma once

#include <array>
#include <cmath>

namespace sinew {

/// A number with N derivatives. Comparisons are left out on purpose: write Value(a) < Value(b).
template <int N>
struct Dual {
  // In this order: copies then move the same pairs of numbers as the loops over d load, which a processor
  // takes from its store buffer only if they are the same.
  std::array<double, N> d;
  double value;

  // NOLINTNEXTLINE(google-explicit-constructor): a number is a dual number that depends on nothing
  Dual(double constant = 0) : value(constant) { d.fill(0); }

  /// A variable: its own derivative in `lane` is 1.
  static Dual Variable(double value, int lane) {
    Dual x(value);
    x.d[static_cast<std::size_t>(lane)] = 1;
    return x;
  }

  /// f(x) by the chain rule, from f's value and slope at x.
  static Dual Chain(double f, double slope, const Dual& x) {
    Dual r{Unset{}};
    r.value = f;
#pragma omp simd
    for (int i = 0; i < N; ++i) r.d[i] = slope * x.d[i];
    return r;
  }

  Dual operator-() const {
    return Chain(-value, -1, *this);
  }

  Dual& operator+=(const Dual& b) {
    value += b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) d[i] += b.d[i];
    return *this;
  }
  Dual& operator-=(const Dual& b) {
    value -= b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) d[i] -= b.d[i];
    return *this;
  }
  /// *this += a * b in one pass, with the same rounding.
  Dual& AddProduct(double a, const Dual& b) {
    value += a * b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) d[i] += a * b.d[i];
    return *this;
  }
  Dual& AddProduct(const Dual& a, const Dual& b) {
    value += a.value * b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) d[i] += a.value * b.d[i] + b.value * a.d[i];
    return *this;
  }
  Dual& SubtractProduct(const Dual& a, const Dual& b) {
    value -= a.value * b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) d[i] -= a.value * b.d[i] + b.value * a.d[i];
    return *this;
  }
  Dual& operator+=(double b) {
    value += b;
    return *this;
  }
  Dual& operator-=(double b) {
    value -= b;
    return *this;
  }

  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r{Unset{}};
    r.value = a.value + b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] + b.d[i];
    return r;
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r{Unset{}};
    r.value = a.value - b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] - b.d[i];
    return r;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r{Unset{}};
    r.value = a.value * b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) r.d[i] = a.value * b.d[i] + b.value * a.d[i];
    return r;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual r{Unset{}};
    r.value = a.value / b.value;
    const double scale = 1 / b.value;
#pragma omp simd
    for (int i = 0; i < N; ++i) r.d[i] = (a.d[i] - r.value * b.d[i]) * scale;
    return r;
  }

  friend Dual operator+(const Dual& a, double b) {
    Dual r = a;
    r.value += b;
    return r;
  }
  friend Dual operator+(double a, const Dual& b) {
    Dual r = b;
    r.value = a + b.value;
    return r;
  }
  friend Dual operator-(const Dual& a, double b) {
    Dual r = a;
    r.value -= b;
    return r;
  }
  friend Dual operator-(double a, const Dual& b) {
    return Chain(a - b.value, -1, b);
  }
  friend Dual operator*(const Dual& a, double b) {
    return Chain(a.value * b, b, a);
  }
  friend Dual operator*(double a, const Dual& b) {
    return Chain(a * b.value, a, b);
  }
  friend Dual operator/(const Dual& a, double b) {
    return Chain(a.value / b, 1 / b, a);
  }
  friend Dual operator/(double a, const Dual& b) {
    const double r = a / b.value;
    return Chain(r, -r / b.value, b);
  }

 private:
  struct Unset {};
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): every caller sets all of it
  explicit Dual(Unset /*unset*/) {}
};

/// sum += a * b and sum -= a * b, with the rounding of the two operations, in one pass over the derivatives.
template <class A, class B>
void AddProduct(double& sum, const A& a, const B& b) {
  sum += a * b;
}
template <int N, class A>
void AddProduct(Dual<N>& sum, const A& a, const Dual<N>& b) {
  sum.AddProduct(a, b);
}
inline void SubtractProduct(double& sum, double a, double b) {
  sum -= a * b;
}
template <int N>
void SubtractProduct(Dual<N>& sum, const Dual<N>& a, const Dual<N>& b) {
  sum.SubtractProduct(a, b);
}

/// The number without its derivatives.
[[nodiscard]] inline double Value(double x) {
  return x;
}
template <int N>
[[nodiscard]] double Value(const Dual<N>& x) {
  return x.value;
}

/// The derivatives without the number: 0 in value.
[[nodiscard]] inline double Tangent(double /*x*/) {
  return 0;
}
template <int N>
[[nodiscard]] Dual<N> Tangent(const Dual<N>& x) {
  return Dual<N>::Chain(0, 1, x);
}

// The functions of <cmath> that models need; for double they are the library's.
[[nodiscard]] inline double Sin(double x) {
  return std::sin(x);
}
[[nodiscard]] inline double Cos(double x) {
  return std::cos(x);
}
[[nodiscard]] inline double Exp(double x) {
  return std::exp(x);
}
[[nodiscard]] inline double Sqrt(double x) {
  return std::sqrt(x);
}
[[nodiscard]] inline double Log(double x) {
  return std::log(x);
}
[[nodiscard]] inline double Abs(double x) {
  return std::abs(x);
}

template <int N>
[[nodiscard]] Dual<N> Sin(const Dual<N>& x) {
  return Dual<N>::Chain(std::sin(x.value), std::cos(x.value), x);
}
template <int N>
[[nodiscard]] Dual<N> Cos(const Dual<N>& x) {
  return Dual<N>::Chain(std::cos(x.value), -std::sin(x.value), x);
}
template <int N>
[[nodiscard]] Dual<N> Exp(const Dual<N>& x) {
  const double e = std::exp(x.value);
  return Dual<N>::Chain(e, e, x);
}
/// @pre x > 0: the slope at 0 is infinite.
template <int N>
[[nodiscard]] Dual<N> Sqrt(const Dual<N>& x) {
  const double root = std::sqrt(x.value);
  return Dual<N>::Chain(root, 0.5 / root, x);
}
template <int N>
[[nodiscard]] Dual<N> Log(const Dual<N>& x) {
  return Dual<N>::Chain(std::log(x.value), 1 / x.value, x);
}
/// At 0 the slope is that to the right.
template <int N>
[[nodiscard]] Dual<N> Abs(const Dual<N>& x) {
  return Dual<N>::Chain(std::abs(x.value), x.value < 0 ? -1 : 1, x);
}

}  // namespace sinew
