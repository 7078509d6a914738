#include "models/muscle/hill_muscle.h"

namespace sinew {

// Lloyd and Besier's curves (2003) as CEINMS ships them; points that only keep a natural spline flat are left
// out.
MuscleCurves MuscleCurves::Default() {
  const auto smooth = [](const std::vector<double>& x, const std::vector<double>& y) {
    return *MuscleCurve::Smooth(x, y);
  };
  return {smooth({0, 0.4035, 0.52725, 0.62875, 0.71875, 0.86125, 1.045, 1.2175, 1.43875, 1.61875, 2.2},
                 {0, 0, 0.226667, 0.636667, 0.856667, 0.95, 0.993333, 0.77, 0.246667, 0, 0}),
          smooth({0, 1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6}, {0, 0, 0.035, 0.12, 0.26, 0.55, 1.17, 2}),
          smooth({-10, -1, -0.6, -0.3, -0.1, 0, 0.1, 0.3, 0.6, 0.8, 10},
                 {0, 0, 0.08, 0.2, 0.55, 1, 1.4, 1.6, 1.7, 1.75, 1.75}),
          smooth({-1, 0, 0.00131, 0.00281, 0.00431, 0.00581, 0.00731, 0.00881, 0.0103, 0.0118, 0.0123, 9.2},
                 {0, 0, 0.0108, 0.0257, 0.0435, 0.0652, 0.0915, 0.123, 0.161, 0.208, 0.227, 345})};
}

}  // namespace sinew
