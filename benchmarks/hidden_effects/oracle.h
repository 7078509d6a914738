// An oracle test with known truth and noise: the detectable size of a hidden effect.
#pragma once

#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "benchmarks/hidden_effects/hidden_effect.h"
#include "problems/drive/laboratory/synthesis.h"

namespace sinew {

/// A test at 5 % (two-sided) detects an effect whose signature has this norm with a probability of 95 %: the
/// sum of the normal quantiles 1.960 and 1.645.
inline constexpr double kUnitNorm = 3.605;

/// Signatures of hidden effects in the training trials of a plan: the change of the readings without noise,
/// whitened by the noise's covariance, off the span of the base parameters and of each trial's initial state.
class Oracle {
 public:
  /// @param plan without effects. Errors: those of SimulateDrive.
  static Result<Oracle> Make(const DrivePlan& plan);

  /// [all training samples] signature of a truth, amplitudes as they are. Errors: those of SimulateDrive.
  Result<Vector> Signature(const DriveTruth& truth) const;

  /// The noise that the plan's position sensor adds, treated in the same way.
  [[nodiscard]] Vector Noise() const;

  struct Sized {
    double amplitude = 0;
    Vector signature;
    double factor = 1;  ///< by which both were multiplied
  };
  /// The amplitude whose signature has norm `norm` (to 1 %); nothing if no sensible amplitude has.
  ///
  /// Where small differences grow (a plan that turns the joint over), the bare change of the readings leaves
  /// the range in which it is linear long before its part off the base model does. There the signature is
  /// that of an amplitude so small that no reading changes by more than 1 mrad, times a factor. For effects
  /// with a threshold (saturation, backlash), which grow faster than their amplitude, it is a lower limit.
  Result<std::optional<Sized>> Amplitude(const HiddenEffect& effect, double norm) const;

  /// R| between a signature and an effect of the library at unit size, with its parameters restricted to the
  /// probe values: the largest multiple correlation over its groups of columns.
  Result<double> Correlation(const Vector& signature, const std::string& effect) const;

  [[nodiscard]] const Extents& extents() const { return extents_; }

 private:
  Oracle() = default;
  void Whiten(Matrix& stacked) const;
  /// The change of the readings by a truth [all training samples, rad].
  Result<Matrix> Change(const DriveTruth& truth) const;
  [[nodiscard]] Vector Project(Matrix change) const;
  Result<std::optional<Sized>> SmallAmplitude(const HiddenEffect& effect, double norm) const;
  Result<Vector> Positions(const DriveTruth& truth, const std::vector<DriveTrial>& trials) const;

  DrivePlan plan_;
  double step_ = kSignatureStep;
  bool grows_ = false;                ///< small differences grow
  std::vector<DriveTrial> replayed_;  ///< the training trials with their recorded torque as command
  Eigen::Index samples_ = 0;          ///< per trial
  Vector undisturbed_;                ///< position readings of the base model
  Matrix basis_;                      ///< orthonormal, of what the base model absorbs
  Extents extents_;
};

}  // namespace sinew
