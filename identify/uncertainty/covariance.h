// Covariance of the estimates: the plain one, for independent residuals, and one that
// is valid for autocorrelated ones.
#pragma once

#include <vector>

#include "base/linear_algebra.h"
#include "identify/uncertainty/information.h"
#include "identify/uncertainty/linearization.h"

namespace sinew::uncertainty {

/// Covariance of the minimiser of the weighted cost for independent residuals with the given deviations:
/// G P' diag(d^2) P G, with P = columns and G = inverse of `info`. It is s^2 (J'J)^-1 for one channel, and
/// stays right when the weights of the channels are not one over their noise.
/// @param deviation [m] of the weighted residuals @return [k x k] unit box
[[nodiscard]] Matrix PlainCovariance(const Information& info, const Vector& deviation);

/// Consistent under heteroskedastic and autocorrelated residuals: G S G, where S is the long-run covariance
/// of the scores (rows of P times residual). Rows of different blocks count as independent; within a block,
/// neighbours in the list of samples count as neighbours in time, also across a gap.
///
/// S is the Bartlett-kernel estimate of Newey, West 1987 of scores that were made nearly white by a
/// first-order autoregression per parameter (Andrews, Monahan 1992, eq 2.1-2.4, diagonal), since the kernel
/// alone is far too small for residuals with a correlation of 0.8 in a few hundred samples. Its lag is the
/// larger of 4 (n/100)^(2/9) (Newey, West 1994) and the AR(1) plug-in of Andrews 1991, eq 6.4. Scaled by n /
/// (n - leverage). Rows of priors enter as in PlainCovariance.
///
/// Where the scores of a parameter are correlated by more than 0.97 from row to row, their memory is longer
/// than any such kernel: a force that is recorded with noise, in open loop, makes the position a random walk.
/// Each variance is then at least that of the cosines of the lowest frequencies (Mueller 2007, J.
/// Econometrics 141:1331; Lazarus, Lewis, Stock, Watson 2018, JBES 36:541): 12 or more over all blocks, with
/// the sums of the blocks, times the square of the ratio of Student's to the normal quantile.
[[nodiscard]] Matrix RobustCovariance(const Information& info, const Linearization& at,
                                      const Vector& deviation);

}  // namespace sinew::uncertainty
