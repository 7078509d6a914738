// Raw EMG of a data set becomes the grid `excitations` of its trials.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "models/emg/envelope.h"

namespace sinew {

/// What a muscle's envelope is divided by.
enum class Normalisation {
  kAllTrials,    ///< its maximum over all trials
  kNamedTrials,  ///< its maximum over some trials: maximum voluntary contractions
  kGiven,        ///< a number per muscle
  kNone
};

struct ExcitationSettings {
  EnvelopeSettings envelope;
  double rate_Hz = 200;            ///< of the excitations; 0: that of the raw signal [Hz, >= 0]
  std::vector<std::string> grids;  ///< that hold raw EMG; empty: see AddExcitations
  /// Channels with the muscles that they become; empty: all of the grid, under their own names.
  std::vector<std::pair<std::string, std::string>> channels;
  Normalisation normalisation = Normalisation::kAllTrials;
  std::vector<std::string> trials;       ///< kNamedTrials
  std::map<std::string, double> maxima;  ///< kGiven: muscle -> [unit of the raw signal, > 0]
};

struct ExcitationReport {
  std::vector<std::string> lines;  ///< what was done: one line for all, then one per muscle
  std::vector<std::string> notes;  ///< what is wrong with the recordings, and what was decided about it
};

/// Adds (or replaces) the grid `excitations` of every trial with raw EMG: one channel per muscle, unit 1, on
/// the clock of the recording, as the problem nms reads it.
///
/// Without settings.grids, raw EMG is the grid whose name contains "emg"; without such a grid, the one that
/// has channels in V. Of its channels those in V count; if none is in V, all. Trials without raw EMG stay as
/// they are, with a note.
/// Errors, with trial and channel: no raw EMG, or several grids that could be it; a name that does not exist;
/// channels of one muscle with different units; those of ComputeEnvelope and UniformRate; a rate at
/// which the envelope would fold back (more than 1 % of it left at half of the rate); a muscle whose
/// maximum is 0 or not given. The data set is then unspecified.
Result<ExcitationReport> AddExcitations(Dataset& data, const ExcitationSettings& settings);

}  // namespace sinew
