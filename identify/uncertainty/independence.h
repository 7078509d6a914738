// Whether the residuals are evidence against independent errors of one level.
#pragma once

#include "identify/least_squares.h"
#include "identify/uncertainty/linearization.h"

namespace sinew::uncertainty {

/// True unless a portmanteau test of some channel rejects, at 5 % for all tests together (Bonferroni): of the
/// autocorrelation of the residuals over 1 and over 10 lags (Ljung, Box 1978), and of the same of their
/// squares, which tells of a level that changes with time (McLeod, Li 1983). Trials of one channel are tested
/// together; neighbours in the list of samples count as neighbours in time. A channel with fewer than 30
/// samples is not tested, and counts as not independent.
[[nodiscard]] bool ResidualsLookIndependent(const LeastSquares& problem, const Linearization& at);

}  // namespace sinew::uncertainty
