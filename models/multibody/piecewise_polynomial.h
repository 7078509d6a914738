// A function of one argument that is a polynomial on each piece. Every function an .osim model moves its
// joints by is one of these.
#pragma once

#include <optional>
#include <vector>

#include "base/error.h"

namespace sinew {

class PiecewisePolynomial {
 public:
  struct Value {
    double value = 0;
    double first = 0;   ///< df/dx
    double second = 0;  ///< d2f/dx2
  };

  /// Zero everywhere.
  PiecewisePolynomial() : PiecewisePolynomial(Constant(0)) {}

  static PiecewisePolynomial Constant(double value);
  static PiecewisePolynomial Linear(double slope, double intercept);

  /// @param coefficients  lowest power first, at least one.
  static PiecewisePolynomial Polynomial(std::vector<double> coefficients);

  /// Straight lines through the points, the first and the last of which go on for ever.
  /// Errors: sizes differ, fewer than two points, x not increasing, a value that is not finite.
  static Result<PiecewisePolynomial> Lines(const std::vector<double>& x, const std::vector<double>& y);

  /// The cubic spline of SIMM and OpenSim (their SimmSpline, formerly NaturalCubicSpline): second derivatives
  /// are continuous, the third derivative at each end is that of the cubic through the four points there
  /// (zero when there are only three), and outside the points the end slope goes on as a straight line. It is
  /// *not* the natural spline of its old name. Errors as for Lines. Source: Forsythe, Malcolm, Moler,
  /// Computer Methods for Mathematical Computations (1977), ch. 4.4.
  static Result<PiecewisePolynomial> SimmSpline(const std::vector<double>& x, const std::vector<double>& y);

  [[nodiscard]] PiecewisePolynomial Scaled(double factor) const;

  /// At a break the piece on its right counts.
  [[nodiscard]] Value At(double x) const;

  /// The slope, if the whole function is one straight line.
  [[nodiscard]] std::optional<double> Slope() const;

 private:
  struct Piece {
    double origin = 0;
    std::vector<double> coefficients;  // of powers of (x - origin), lowest first
  };

  explicit PiecewisePolynomial(std::vector<Piece> pieces, std::vector<double> breaks = {})
      : pieces_(std::move(pieces)), breaks_(std::move(breaks)) {}

  std::vector<Piece> pieces_;   // one more than breaks
  std::vector<double> breaks_;  // increasing
};

}  // namespace sinew
