// An ankle that moves up and down on a dynamometer at constant speeds, driven by seven muscles: the
// experiment of the thesis's chapters 4 and 6, made up. SCIENCE sections 3 and 5.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "datasets/dataset.h"
#include "models/muscle/hill_muscle.h"
#include "problems/nms/muscle/muscle_force.h"

namespace sinew {

constexpr const char* kStudyJoint = "ankle_angle_r";
constexpr int kStudyMuscles = 7;

/// A muscle of a generic subject: its parameters, its path about the joint, and when it is active.
struct StudyMuscle {
  const char* name;
  double isometric_force;     ///< [N]
  double optimal_length;      ///< [m]
  double slack_length;        ///< [m]
  double pennation;           ///< [rad]
  double fibre;               ///< length of the fibre at the angle 0, of the optimal one, with a rigid tendon
  std::array<double, 3> arm;  ///< moment arm = arm[0] + arm[1] q + arm[2] q^2 [m; q in rad]
  double amplitude;           ///< of its bursts [0..1]
  double centre;              ///< of a burst, as a share of the cycle; the foot goes down until 0.5
  double width;               ///< standard deviation of a burst, as a share of the cycle
};
[[nodiscard]] const std::array<StudyMuscle, kStudyMuscles>& StudyMuscles();

/// Length of the unit [m], whose derivative is minus the moment arm.
[[nodiscard]] double UnitLength(const StudyMuscle& muscle, double angle);
[[nodiscard]] double MomentArm(const StudyMuscle& muscle, double angle);

/// The foot goes down from kStudyHighest to kStudyLowest at a constant speed, and up again. Turns take a
/// fixed time, with the velocity a raised cosine.
struct StudyMotion {
  double speed = 1;  ///< [rad/s]

  struct At {
    double angle = 0;
    double velocity = 0;
    double acceleration = 0;
  };
  [[nodiscard]] double cycle() const;  ///< [s]
  [[nodiscard]] At Get(double time) const;
};

/// Excitations [muscles] at a rate, from `first` on: bursts whose height and time scatter from cycle to
/// cycle.
[[nodiscard]] std::vector<std::vector<double>> DrawExcitations(const StudyMotion& motion, double first,
                                                               std::size_t count, double rate,
                                                               Random& random);

/// Raw surface EMG [V] of an excitation at kStudyEmgRate: noise between 20 and 400 Hz whose mean size is the
/// excitation times kStudyFullEmg, and the amplifier's own noise, in the steps of its converter.
[[nodiscard]] std::vector<double> DrawRawEmg(const std::vector<double>& excitation, Random& random);
constexpr double kStudyEmgRate = 2048;  // [Hz]
constexpr double kStudyFullEmg = 1e-3;  // [V]

constexpr double kStudyFineRate = 1000;  ///< [Hz] of the true muscles
constexpr double kStudyRate = 100;       ///< [Hz] of what is recorded of motion and moment

/// first, first + 1 / rate, ...
[[nodiscard]] std::vector<double> StudyTimes(double first, double rate, std::size_t count);
[[nodiscard]] Channel StudyInput(const char* unit, std::vector<double> values);

/// The generic subject as CEINMS writes it. @param muscles names, in the order of StudyMuscles; empty: all
[[nodiscard]] std::string StudySubjectXml(const std::vector<std::string>& muscles = {});

/// What differs between the settings of the nms problem in two data sets of the study.
struct StudyNmsChoice {
  const char* comment;       ///< the first line
  const char* peronei;       ///< muscles, separated by commas
  const char* dorsiflexors;  ///< the same
  const char* lower;         ///< bounds of the factors on strength
  const char* upper;
};
/// nms.yaml: strengths, shapes and tendon slack lengths of groups of muscles.
[[nodiscard]] std::string StudyNmsSettings(const StudyNmsChoice& choice);

}  // namespace sinew
