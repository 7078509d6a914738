// The channels of a force plate from the load on it.
#pragma once

#include <array>

#include "models/contact/contact_sums.h"

namespace sinew {

/// Order of kContactChannels.
enum PlateChannel { kFx, kFy, kFz, kCopX, kCopZ, kFreeMoment, kPlateChannels };

/// Channels of a plate, and the derivative of each for one parameter from that of the load.
struct PlateChannels {
  std::array<double, kPlateChannels> value{};

  PlateChannels(const ContactLoad& load, const std::array<double, 2>& resting_cop) : load_(load) {
    presses_ = load[kForceY] > 0;
    value[kFx] = load[kForceX];
    value[kFy] = load[kForceY];
    value[kFz] = load[kForceZ];
    value[kCopX] = presses_ ? load[kFirstMomentX] / load[kForceY] : resting_cop[0];
    value[kCopZ] = presses_ ? load[kFirstMomentZ] / load[kForceY] : resting_cop[1];
    // The moment about the vertical through the centre of pressure.
    value[kFreeMoment] = load[kMomentY] - (value[kCopZ] * load[kForceX] - value[kCopX] * load[kForceZ]);
  }

  [[nodiscard]] std::array<double, kPlateChannels> Derivative(const ContactLoad& d) const {
    std::array<double, kPlateChannels> slope{};
    slope[kFx] = d[kForceX];
    slope[kFy] = d[kForceY];
    slope[kFz] = d[kForceZ];
    if (presses_) {
      slope[kCopX] = (d[kFirstMomentX] - value[kCopX] * d[kForceY]) / load_[kForceY];
      slope[kCopZ] = (d[kFirstMomentZ] - value[kCopZ] * d[kForceY]) / load_[kForceY];
    }
    slope[kFreeMoment] = d[kMomentY] - (slope[kCopZ] * load_[kForceX] + value[kCopZ] * d[kForceX] -
                                        slope[kCopX] * load_[kForceZ] - value[kCopX] * d[kForceZ]);
    return slope;
  }

 private:
  const ContactLoad& load_;
  bool presses_ = false;
};

}  // namespace sinew
