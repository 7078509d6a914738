// Jacobi's elliptic functions.
#pragma once

namespace sinew {

/// Complete integral of the first kind K(m). @param m parameter (the square of the modulus), 0 <= m < 1
[[nodiscard]] double CompleteElliptic(double m);

struct JacobiElliptic {
  double sn = 0, cn = 1, dn = 1;
};
/// sn(u | m), cn(u | m), dn(u | m) by descending Landen transformation of the arithmetic-geometric mean;
/// Abramowitz & Stegun 1964, 16.4. @param m 0 <= m < 1
[[nodiscard]] JacobiElliptic JacobiEllipticAt(double u, double m);

}  // namespace sinew
