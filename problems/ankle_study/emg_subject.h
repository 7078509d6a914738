// The people of the made-up EMG study: who they are, and what they do at a speed. Synthetic.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/random.h"
#include "problems/ankle_study/study.h"

namespace sinew {

constexpr int kEmgStudyMuscles = 5;  ///< with electrodes; two more are active
constexpr int kEmgStudySpeeds = 6;

/// One muscle of one person. Times are shares of a cycle, sizes of a maximal activation.
struct EmgSubjectMuscle {
  int study = 0;  ///< index into StudyMuscles()
  double size = 0;
  double centre = 0;
  double width = 0;
  double other_size = 0;  ///< of a second burst, against the first
  double other_centre = 0;
  double floor = 0;
  double exponent = 0;  ///< of the speed
  double lead = 0;      ///< beyond the person's [s]
};

/// A person's deviation at one speed from the laws of speed.
struct EmgHabit {
  double timing = 0;  ///< [cycle]
  std::array<double, kEmgStudyMuscles> muscle_timing{};
  std::array<double, kEmgStudyMuscles> gain{};  ///< of the logarithm
};

struct EmgSubject {
  std::array<EmgSubjectMuscle, kEmgStudyMuscles> muscles;
  std::array<EmgHabit, kEmgStudySpeeds> habits;
  double lead = 0;            ///< of all muscles [s]: phases shift with speed
  double gain_scatter = 0;    ///< of a cycle, of the logarithm
  double timing_scatter = 0;  ///< of a cycle [cycle]
  double cross_talk = 0;      ///< between neighbouring electrodes
  bool fails_slow = false;    ///< does not follow the machine at 30 deg/s
  double strength = 1;        ///< of all muscles, against the generic person
  /// Moment by which the machine turns the foot round before the person follows, at the highest angle [N m].
  double push = 0;
};

/// Names of the muscles with electrodes, in the order of EmgSubject.
[[nodiscard]] std::vector<std::string> EmgStudyMuscleNames();

/// Persons 0 to 4 are those of the study (0, 2 and 4 shift phase with speed, 0 and 1 fail at 30 deg/s); every
/// other number is a person drawn at random, who always follows.
[[nodiscard]] EmgSubject DrawEmgSubject(int number);

/// Activation [0..] of a muscle at times first, first + 1 / rate, ...: one burst, or two, per cycle.
struct EmgActivity {
  double cycle = 1;      ///< [s]
  double log_speed = 0;  ///< of the speed over 75 deg/s
  double rhythm = 0;     ///< 1 / cycle less that at 75 deg/s [1/s]
  int speed = 0;         ///< index of the habit
  bool failing = false;
  double warp_sine = 0;  ///< [cycle]
  double warp_cosine = 0;
};
[[nodiscard]] std::vector<std::vector<double>> DrawActivity(const EmgSubject& subject,
                                                            const EmgActivity& what, double first,
                                                            std::size_t count, double rate, Random& random);

}  // namespace sinew
