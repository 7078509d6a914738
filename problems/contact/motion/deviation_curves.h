// Smooth curves in time with a Gaussian prior: cubic splines whose weights are independent.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// Correlation of a curve over a lag, by which its prior is stated. With s = lag / correlation_time:
///   (1 - roughness) exp(-s^2 / 2) + roughness (1 + s) exp(-s)
/// The first part has no power at high frequencies (squared exponential), that of the second falls with the
/// fourth power of the frequency (Matern, order 3/2): a curve with a rate that may jump. Both have the same
/// rate. Source: Rasmussen, Williams, Gaussian Processes for Machine Learning (2006), eq. 4.9, 4.17.
/// To it, for a measured curve, comes what smoothing lets through of white noise:
///   noise exp(-(lag / noise_time)^2 / 2)
struct CurveSpectrum {
  double correlation_time = 0.1;  ///< standard deviation over that of the rate [s, > 0]
  double roughness = 1;           ///< share of the variance, 0 to 1
  double scale = 1;               ///< standard deviation of the curve [> 0]
  double noise = 0;               ///< variance of the noise over the square of `scale` [>= 0]
  double noise_time = 0.05;       ///< standard deviation of the noise over that of its rate [s, > 0]

  /// Of the curve, noise included, over the square of the scale: 1 + noise at lag 0.
  [[nodiscard]] double Correlation(double lag) const;
  [[nodiscard]] bool operator==(const CurveSpectrum& other) const;
};

/// Values and rates of a curve for each of its K weights.
struct CurveBasis {
  Matrix value;  ///< [T x K]
  Matrix rate;   ///< [T x K, 1/s]
};

/// Cubic B-splines with equidistant knots, half a period of the highest frequency apart.
/// Source: de Boor, A Practical Guide to Splines (1978), ch. IX.
class DeviationCurves {
 public:
  /// @param times [T, increasing, s] within `from` .. `to`; those outside have the value at that end, and no
  /// rate @param cutoff [Hz] @param stretch by which rates are multiplied, for times that are phases of a
  /// movement
  DeviationCurves(const std::vector<double>& times, double from, double to, double cutoff,
                  double stretch = 1);

  [[nodiscard]] int weights() const { return static_cast<int>(splines_.value.cols()); }
  /// The splines themselves.
  [[nodiscard]] const CurveBasis& splines() const { return splines_; }

  /// Weights [K] at one prior whose curve is that of `weights` at another: far from zero where the one does
  /// not allow what the other does.
  [[nodiscard]] Vector SameCurve(const Vector& weights, const CurveSpectrum& from,
                                 const CurveSpectrum& to) const;
  /// The same, about, as far as both allow it.
  [[nodiscard]] Vector Carried(const Vector& weights, const CurveSpectrum& from,
                               const CurveSpectrum& to) const;

  /// Weighted so that independent standard normal weights make a curve with the mean variance of the spectrum
  /// and its correlation. The last few are kept. May be called from several threads.
  [[nodiscard]] std::shared_ptr<const CurveBasis> With(const CurveSpectrum& spectrum) const;

 private:
  struct Kept {
    CurveSpectrum spectrum;
    std::shared_ptr<const CurveBasis> basis;
  };
  // Coefficients of the splines for each weight.
  [[nodiscard]] Matrix Root(const CurveSpectrum& spectrum) const;

  CurveBasis splines_;
  Matrix on_grid_;      // values of the splines over the whole range, where the mean variance is taken
  double spacing_ = 0;  // of the knots [s]
  mutable std::mutex mutex_;
  mutable std::vector<Kept> kept_;  // last used last
};

}  // namespace sinew
