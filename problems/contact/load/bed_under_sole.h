// The bed of one spring of a sole with contact effects: what bends its law, and how stiff it is at its place.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "problems/contact/load/effect_load.h"
#include "problems/contact/load/pressure.h"

namespace sinew {

class BedUnderSole {
 public:
  BedUnderSole(const ElasticFoundation& bed, const EffectRegion& region, const ContactEffectValues& effects)
      : bed_(bed),
        modes_(region.stiffness_modes),
        bend_{effects[kStiffnessExponent], effects[kFloorCompliance], effects[kLinearDamping]} {
    std::copy_n(effects.begin() + kStiffnessMode, kStiffnessModes, values_.begin());
    uneven_ = !modes_.empty() &&
              std::any_of(values_.begin(), values_.end(), [](double value) { return value != 0; });
  }

  /// Pressure under a spring and its derivatives, by_stiffness for the stiffness of the whole bed.
  [[nodiscard]] Pressure At(std::size_t face, double depth, double rate, bool by_exponent) const {
    if (!uneven_) return PressureAt(bed_, bend_, depth, rate, by_exponent);
    double log_ratio = 0;
    for (std::size_t m = 0; m < kStiffnessModes; ++m) log_ratio += values_[m] * modes_[face][m];
    const double ratio = std::exp(log_ratio);
    ElasticFoundation bed = bed_;
    bed.stiffness *= ratio;
    Pressure p = PressureAt(bed, bend_, depth, rate, by_exponent);
    p.by_stiffness *= ratio;
    return p;
  }

  /// Derivative of something for each mode of the stiffness. @param by_stiffness of it
  template <class Sum, class Adder>
  void ForEachMode(std::size_t face, const Sum& by_stiffness, const Adder& add) const {
    if (modes_.empty()) return;
    for (std::size_t m = 0; m < kStiffnessModes; ++m)
      add(kStiffnessMode + m, Sum((bed_.stiffness * modes_[face][m]) * by_stiffness));
  }

 private:
  const ElasticFoundation& bed_;
  const std::vector<StiffnessModes>& modes_;
  BedEffects bend_;
  StiffnessModes values_{};
  bool uneven_ = false;
};

}  // namespace sinew
