// One person of the made-up EMG study on the dynamometer. Synthetic.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "datasets/dataset.h"
#include "problems/ankle_study/emg_subject.h"

namespace sinew {

/// What is true of a study: the values of --set, and what is hidden, by parameter.
struct EmgStudyTruth {
  std::map<std::string, double> settings;
  std::map<std::string, double> effects;
  EmgSubject subject;

  [[nodiscard]] double Set(const char* name) const { return settings.at(name); }
  [[nodiscard]] double Effect(const std::string& parameter) const {
    const auto found = effects.find(parameter);
    return found == effects.end() ? 0 : found->second;
  }
};

/// The speeds of the study [deg/s], in the order in which they are recorded.
constexpr std::array<int, kEmgStudySpeeds> kEmgStudyDegrees{75, 120, 45, 90, 30, 60};

/// All trials. Errors: no equilibrium of a tendon.
Result<std::map<std::string, Trial>> RecordEmgStudy(const EmgStudyTruth& truth, std::uint64_t seed);

}  // namespace sinew
