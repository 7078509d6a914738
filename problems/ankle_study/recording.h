// One trial of the ankle study as a laboratory would record it. Synthetic.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "datasets/dataset.h"
#include "problems/ankle_study/study.h"

namespace sinew {

/// What is true of a study: the values of --set, and what is hidden, by parameter, from its null.
struct StudyTruth {
  std::map<std::string, double> settings;
  std::map<std::string, double> effects;

  [[nodiscard]] double Effect(const std::string& parameter) const {
    const auto found = effects.find(parameter);
    return found == effects.end() ? 0 : found->second;
  }
  [[nodiscard]] double OfJoint(const std::string& parameter) const {
    return Effect(parameter + "." + kStudyJoint);
  }
};

/// What is asked of the foot.
struct StudyTrial {
  const char* name;
  double degrees_per_second;
  Role role;
};

/// Simulated at 1000 frames a second with the excitations as they were; recorded as described at
/// SynthesizeNms.
/// @param seed of the trial's bursts and noise. Errors: no equilibrium of a tendon.
Result<Trial> RecordStudyTrial(const StudyTruth& truth, const StudyTrial& trial, std::uint64_t seed);

}  // namespace sinew
