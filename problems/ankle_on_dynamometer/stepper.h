// The calibrated ankle for a control program that calls it at a fixed rate: angle and EMG in, torque out.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "models/dynamometer/strapped_foot_run.h"
#include "models/muscle/activation.h"
#include "problems/ankle_on_dynamometer/settings.h"
#include "problems/ankle_on_dynamometer/trial_run.h"

namespace sinew {

/// After Begin, Step allocates no memory and takes the same few microseconds each time. The angle passes a
/// critically damped low-pass of second order, which also gives its velocity and acceleration: what it
/// delays, by 1 / (pi cutoff), is missing from the torque.
class AnkleStepper {
 public:
  /// @param values by name of base and effect parameters, as `identify` reports them; others keep their
  /// starts
  /// @param rate of the calls [Hz, 50..1e5] @param cutoff of the angle's low-pass [Hz, > 0, at most rate / 6]
  /// Errors: a parameter that does not exist, a rate or a cut-off out of its range.
  static Result<std::unique_ptr<AnkleStepper>> Make(AnkleSettings settings,
                                                    const std::map<std::string, double>& values, double rate,
                                                    double cutoff = 25);

  [[nodiscard]] std::size_t muscles() const { return settings_.muscles.size(); }

  /// At rest at an angle [rad]. @param excitations [muscles, 0..1] Errors: no equilibrium.
  Status Begin(double angle, const double* excitations);
  /// One period later. @return torque of foot and attachment on the motor [N m]. Errors: no equilibrium.
  Result<double> Step(double angle, const double* excitations);

  /// Of the last call: torque of the foot on the plate [N m], forces between them, the ankle's motion.
  [[nodiscard]] const FootInstant<double>& instant() const { return run_->instant(); }
  [[nodiscard]] const std::vector<double>& tendon_forces() const { return run_->tendon_forces(); }  ///< [N]
  [[nodiscard]] const std::vector<double>& fibre_lengths() const { return run_->fibre_lengths(); }  ///< [m]

 private:
  AnkleStepper(AnkleSettings settings, std::vector<double> values, double rate, double cutoff);
  /// The excitation of a muscle as it was [0..1], given the measured ones.
  [[nodiscard]] double Drive(std::size_t muscle, const double* excitations) const;
  /// Neural drive of a muscle `late_` before the newest sample.
  [[nodiscard]] double DelayedDrive(std::size_t muscle) const;
  void Activate(std::vector<double>& activation) const;

  AnkleSettings settings_;
  std::vector<double> values_;
  double period_ = 0;
  double pole_ = 0;  ///< of the angle's low-pass [1/s]
  double late_ = 0;  ///< of the drive, in samples
  MuscleCurves curves_;
  std::vector<MusclePath> paths_;
  StrappedFoot<double> foot_;
  FootSolutions solutions_;
  std::unique_ptr<StrappedFootRun<double>> run_;
  std::vector<ExcitationFilter<double>> filters_;
  std::vector<std::vector<double>> drive_;  ///< [muscles] ring of the last drives
  std::size_t newest_ = 0;
  std::vector<double> before_;                    ///< activations at the last call
  std::vector<double> now_;                       ///< and at this one
  std::vector<std::vector<double>> activations_;  ///< [stages]
  PlateMotion plate_;
  double angle_ = 0;  ///< as it was given last [rad]
};

}  // namespace sinew
