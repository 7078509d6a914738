#include "models/emg/butterworth.h"

#include <cmath>
#include <complex>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kLowestShare = 1e-5;  // of the rate: below, rounding leaves less than seven digits

// (square s^2 + linear s + constant) / (s^2 + damping s + stiffness)
struct AnaloguePair {
  double square = 0;
  double linear = 0;
  double constant = 0;
  double damping = 0;
  double stiffness = 0;
};

FilterSection Digital(const AnaloguePair& pair) {
  const double norm = 1 + pair.damping + pair.stiffness;
  return {(pair.square + pair.linear + pair.constant) / norm, 2 * (pair.constant - pair.square) / norm,
          (pair.square - pair.linear + pair.constant) / norm, 2 * (pair.stiffness - 1) / norm,
          (1 - pair.damping + pair.stiffness) / norm};
}

// (linear s + constant) / (s + stiffness)
FilterSection DigitalSingle(double linear, double constant, double stiffness) {
  const double norm = 1 + stiffness;
  return {(linear + constant) / norm, (constant - linear) / norm, 0, (stiffness - 1) / norm, 0};
}

double Angle(int order, int k) {
  return (2 * k + 1) * kPi / (2 * order);
}

Status CheckOrder(int order) {
  if (order >= 1 && order <= kHighestFilterOrder) return {};
  return Fail("filter of order {}: expected 1 to {}", order, kHighestFilterOrder);
}

// The cut-off in the plane of s. Written so that NaN fails.
Result<double> Warp(double cut_off_Hz, double rate_Hz) {
  if (!(rate_Hz > 0) || !std::isfinite(rate_Hz))
    return Fail("sampling rate {} Hz: expected more than 0", rate_Hz);
  if (!(cut_off_Hz >= kLowestShare * rate_Hz) || !(cut_off_Hz < rate_Hz / 2)) {
    return Fail(
        "cut-off {:.6g} Hz at a sampling rate of {:.6g} Hz: expected at least {:.6g} Hz and less than half "
        "of "
        "the rate, {:.6g} Hz",
        cut_off_Hz, rate_Hz, kLowestShare * rate_Hz, rate_Hz / 2);
  }
  return std::tan(kPi * cut_off_Hz / rate_Hz);
}

enum class Side { kLow, kHigh };

Result<FilterSections> OneSided(Side side, int order, double cut_off_Hz, double rate_Hz) {
  SINEW_TRY(CheckOrder(order));
  SINEW_ASSIGN(const double w, Warp(cut_off_Hz, rate_Hz));
  FilterSections sections;
  for (int k = 0; k < order / 2; ++k) {
    AnaloguePair pair;
    (side == Side::kLow ? pair.constant : pair.square) = side == Side::kLow ? w * w : 1;
    pair.damping = 2 * w * std::sin(Angle(order, k));
    pair.stiffness = w * w;
    sections.push_back(Digital(pair));
  }
  if (order % 2 == 1)
    sections.push_back(side == Side::kLow ? DigitalSingle(0, w, w) : DigitalSingle(1, 0, w));
  return sections;
}

}  // namespace

Result<FilterSections> ButterworthLowPass(int order, double cut_off_Hz, double rate_Hz) {
  return OneSided(Side::kLow, order, cut_off_Hz, rate_Hz);
}

Result<FilterSections> ButterworthHighPass(int order, double cut_off_Hz, double rate_Hz) {
  return OneSided(Side::kHigh, order, cut_off_Hz, rate_Hz);
}

Result<FilterSections> ButterworthBandPass(int order, double low_Hz, double high_Hz, double rate_Hz) {
  SINEW_TRY(CheckOrder(order));
  SINEW_ASSIGN(const double low, Warp(low_Hz, rate_Hz));
  SINEW_ASSIGN(const double high, Warp(high_Hz, rate_Hz));
  if (!(low < high))
    return Fail("pass band from {} to {} Hz: expected an end above its start", low_Hz, high_Hz);
  // The low-pass's pole p becomes the two roots of s^2 - p width s + low high.
  const double width = high - low;
  FilterSections sections;
  for (int k = 0; k < order / 2; ++k) {
    const std::complex<double> half =
        0.5 * width * std::complex<double>(-std::sin(Angle(order, k)), std::cos(Angle(order, k)));
    const std::complex<double> root = std::sqrt(half * half - low * high);
    for (const std::complex<double> pole : {half + root, half - root})
      sections.push_back(Digital({0, width, 0, -2 * pole.real(), std::norm(pole)}));
  }
  if (order % 2 == 1) sections.push_back(Digital({0, width, 0, width, low * high}));
  return sections;
}

}  // namespace sinew
