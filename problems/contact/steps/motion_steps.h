// Steps where no plate was hit: when a foot is on the floor, as the motion tells it.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/contact/settings.h"

namespace sinew {

/// One step of one foot.
struct MotionStep {
  std::string plate;  ///< of the foot, in the settings: "right"
  double from = 0;    ///< [s]
  double to = 0;      ///< [s]
  std::string trial;  ///< the one that is made of it
};

/// How much later than the motion tells it the plates of other steps measured an event.
struct EventDelay {
  double mean = 0;     ///< [s]
  double scatter = 0;  ///< standard deviation of one step [s]; NaN of fewer than two
};

struct MotionSteps {
  int measured = 0;  ///< steps whose plates tell the delays; 0: the delays are taken for 0
  EventDelay begin;
  EventDelay end;
  struct OfTrial {
    std::string trial;
    std::vector<double> frames;     ///< [s] of its motion
    std::vector<MotionStep> steps;  ///< in the order of their beginning
    int measured = 0;               ///< steps during which a plate of the foot was loaded
    int cut_off = 0;                ///< steps that the recording does not hold from begin to end
  };
  std::vector<OfTrial> trials;
};

/// Finds the steps in recordings of walking that no plate measured, from the events of gait_events.h. How
/// much later plates measure both is known from the trials that are steps on the plates of the settings, and
/// is added.
/// @param trials to be searched
/// Errors, with the trial: no such trial, no motion, frames that are not equally spaced.
Result<MotionSteps> FindMotionSteps(const Dataset& data, const ContactSettings& settings,
                                    const std::vector<std::string>& trials);

/// Makes trials of the steps of one recording: held out, with the channels of the foot's plate, which have no
/// values. Errors: a name that is taken; the data set is then unchanged.
Status CutMotionSteps(const MotionSteps::OfTrial& found, Dataset& data);

}  // namespace sinew
