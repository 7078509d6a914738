#include "models/mechanisms/mechanism_error.h"

#include <algorithm>
#include <cmath>

#include "base/assert.h"

namespace sinew {

MechanismError ErrorOf(const Mechanism& mechanism, const MechanismRun& run, const std::vector<double>& times,
                       const MechanismReference& reference) {
  MechanismError error;
  double total = 0;
  for (std::size_t j = 0; j < reference.curves.size(); ++j) {
    const ReferenceCurve& curve = reference.curves[j];
    double relative = 0;
    double squares = 0;
    double peak = 0;
    for (std::size_t i = 0; i < curve.time.size(); ++i) {
      const auto at = std::lower_bound(times.begin(), times.end(), std::max(0.0, curve.time[i]));
      SINEW_ASSERT(at != times.end(), "the run has the reference's times");
      const double off =
          std::abs(run.values(at - times.begin(), static_cast<Eigen::Index>(j)) - curve.values[i]);
      relative += std::pow(off / std::max(std::abs(curve.values[i]), mechanism.threshold), 2);
      squares += off * off;
      peak = std::max(peak, off);
    }
    const auto samples = static_cast<double>(curve.time.size());
    total += relative / samples;
    error.rmse.push_back(std::sqrt(squares / samples));
    error.peak.push_back(peak);
  }
  error.total = std::sqrt(total / static_cast<double>(reference.curves.size()));
  return error;
}

}  // namespace sinew
