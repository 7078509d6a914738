// Where refits of a model start that lack one of its causes.
#pragma once

#include <vector>

#include "base/error.h"
#include "identify/least_squares.h"

namespace sinew::diagnosis {

/// For each of some causes the point where its parameters are at their nulls and the others have moved,
/// within their bounds, so that the residuals change least, to first order: what the rest can take over is
/// taken over. From the null alone, a refit has to find that along the curved valleys of near substitutes.
/// @param fit of the whole model, its transform set as for the refits @param x [n] its minimum
/// @param causes parameters of each cause @param nulls [P] values at which they do nothing
/// @return [causes] points [P]. Errors: no prediction, or no finite derivatives, at x.
[[nodiscard]] Result<std::vector<Vector>> StartsWithout(const LeastSquares& fit, const Vector& x,
                                                        const std::vector<std::vector<int>>& causes,
                                                        const Vector& nulls);

}  // namespace sinew::diagnosis
