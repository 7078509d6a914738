#include "problems/ankle_study/emg_subject.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr std::uint64_t kPeople = 20201112;  // whoever they are, they stay the same
constexpr std::array<int, kEmgStudyMuscles> kWithElectrode{0, 1, 4, 2, 3};  // of StudyMuscles()
constexpr std::array<double, 5> kLeads{0.18, 0.0, 0.165, 0.0, 0.20};        // [s], of the study's people
// Times the scatter where a subject does not follow.
constexpr double kFailingGain = 1.5;
constexpr double kFailingTiming = 4;

}  // namespace

std::vector<std::string> EmgStudyMuscleNames() {
  std::vector<std::string> names;
  for (const int m : kWithElectrode) names.emplace_back(StudyMuscles()[static_cast<std::size_t>(m)].name);
  return names;
}

EmgSubject DrawEmgSubject(int number) {
  Random random(Random::StreamSeed(kPeople, static_cast<std::uint64_t>(number)));
  EmgSubject subject;
  const bool shifts = random.Uniform() < 0.5;
  const double lead = random.Uniform(0.15, 0.2);
  subject.lead = number < 5 ? kLeads[static_cast<std::size_t>(number)] : shifts ? lead : 0;
  subject.fails_slow = number < 2;
  // Some are clumsier than others, and their electrodes lay less well.
  const double clumsy = number < 2 ? 1.25 : 1;
  subject.gain_scatter = clumsy * random.Uniform(0.15, 0.22);
  subject.timing_scatter = clumsy * random.Uniform(0.012, 0.02);
  subject.cross_talk = clumsy * random.Uniform(0.0, 0.06);
  subject.strength = random.Uniform(0.8, 1.15);
  subject.push = random.Uniform(30, 60);
  for (std::size_t m = 0; m < subject.muscles.size(); ++m) {
    EmgSubjectMuscle& muscle = subject.muscles[m];
    muscle.study = kWithElectrode[m];
    const StudyMuscle& generic = StudyMuscles()[static_cast<std::size_t>(muscle.study)];
    muscle.size = generic.amplitude * random.Uniform(0.8, 1.2);
    muscle.centre = generic.centre + 0.02 * random.Normal();
    muscle.width = generic.width * random.Uniform(0.85, 1.2);
    muscle.other_size = random.Uniform(0.1, 0.35);
    muscle.other_centre = muscle.centre + 0.5 + 0.05 * random.Normal();
    muscle.floor = random.Uniform(0.005, 0.03);
    muscle.exponent = 0.25 + 0.15 * random.Normal();
    muscle.lead = subject.lead > 0 ? 0.02 * random.Normal() : 0;
  }
  for (EmgHabit& habit : subject.habits) {
    habit.timing = 0.02 * random.Normal();
    for (double& timing : habit.muscle_timing) timing = 0.01 * random.Normal();
    for (double& gain : habit.gain) gain = 0.1 * random.Normal();
  }
  return subject;
}

std::vector<std::vector<double>> DrawActivity(const EmgSubject& subject, const EmgActivity& what,
                                              double first, std::size_t count, double rate, Random& random) {
  const double gain_scatter = subject.gain_scatter * (what.failing ? kFailingGain : 1);
  const double timing_scatter = subject.timing_scatter * (what.failing ? kFailingTiming : 1);
  const int begin = static_cast<int>(std::floor(first / what.cycle)) - 1;
  const int end = static_cast<int>(std::ceil((first + static_cast<double>(count) / rate) / what.cycle)) + 1;
  const EmgHabit& habit = subject.habits[static_cast<std::size_t>(what.speed)];
  std::vector<double> together;  // of all muscles, per cycle
  for (int k = begin; k <= end; ++k) together.push_back(timing_scatter * random.Normal());
  std::vector<std::vector<double>> activities;
  for (std::size_t m = 0; m < subject.muscles.size(); ++m) {
    const EmgSubjectMuscle& muscle = subject.muscles[m];
    std::vector<double> e(count, muscle.floor);
    const double early = (subject.lead + muscle.lead) * what.rhythm + habit.timing + habit.muscle_timing[m];
    const double size = muscle.size * std::exp(muscle.exponent * what.log_speed + habit.gain[m]);
    for (int k = begin; k <= end; ++k) {
      const double own = 0.5 * timing_scatter * random.Normal();
      const double gain = std::exp(gain_scatter * random.Normal());
      const double shift = early + together[static_cast<std::size_t>(k - begin)] + own;
      for (const bool other : {false, true}) {
        const double centre = other ? muscle.other_centre : muscle.centre;
        const double height = size * gain * (other ? muscle.other_size : 1);
        for (std::size_t i = 0; i < count; ++i) {
          const double phase = (first + static_cast<double>(i) / rate) / what.cycle - k;
          if (std::abs(phase - centre) > 1) continue;
          const double warped = phase + shift + what.warp_sine * std::sin(2 * kPi * phase) +
                                what.warp_cosine * (std::cos(2 * kPi * phase) - 1);
          const double away = (warped - centre) / muscle.width;
          if (std::abs(away) < 6) e[i] += height * std::exp(-0.5 * away * away);
        }
      }
    }
    activities.push_back(std::move(e));
  }
  return activities;
}

}  // namespace sinew
