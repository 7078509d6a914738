// What the motor of the laboratory's dynamometer is told to do.
#pragma once

namespace sinew {

enum class MachineMode {
  kRotation,    ///< the plate goes up and down at the set speed, whatever the person does
  kIsokinetic,  ///< the plate is free up to the set speed and between two stops
  kIsometric    ///< the plate is held at an angle
};

struct MachineProgram {
  MachineMode mode = MachineMode::kRotation;
  double speed = 1;       ///< [rad/s, > 0]
  double highest = 0.26;  ///< [rad]
  double lowest = -0.52;  ///< [rad]
  double hold = 0;        ///< angle of kIsometric [rad]

  /// How fast the servo's reference moves [rad/s]: against an isokinetic machine it follows the plate, up to
  /// the set speed and not beyond the range. @param since the trial began [s] @param reference where it is
  /// [rad]
  [[nodiscard]] double ReferenceRate(double since, double angle, double velocity, double reference) const;
  /// Torque of the motor [N m].
  [[nodiscard]] double Torque(double since, double angle, double velocity, double reference) const;
  /// Where the plate is at the begin [rad].
  [[nodiscard]] double BeginAngle() const;

 private:
  struct Reference {
    double angle = 0;
    double velocity = 0;
  };
  [[nodiscard]] Reference At(double since) const;
};

}  // namespace sinew
