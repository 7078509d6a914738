// When a foot lands and leaves the floor, as its motion tells it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/contact/contact_model.h"
#include "problems/contact/settings.h"
#include "problems/contact/soles/body_tree.h"

namespace sinew {

/// How far the heel (the hindmost spring of a foot's regions) and the toe are ahead of the first body of the
/// model, mostly the pelvis [T, m]. Ahead is where the feet point within half a second. Low-passed at 6 Hz.
struct FootTrack {
  std::vector<double> heel;
  std::vector<double> toe;
};

struct FootTracks {
  std::vector<double> time;               // [T, s]
  std::map<std::string, FootTrack> feet;  // by the plate of the foot
};

/// Errors: no motion, frames that are not equally spaced.
Result<FootTracks> TracksOf(const Trial& trial, const ContactModel& model, const BodyTree& tree,
                            const ContactSettings& settings);

/// Times [s], between frames.
struct GaitEvents {
  std::vector<double> lands;
  std::vector<double> leaves;
};

/// A foot lands where its heel is farthest ahead, and leaves where its toe is farthest behind (Zeni,
/// Richards, Higginson 2008, Gait & Posture 27:710).
/// @param plate of the foot, one of `tracks.feet`
GaitEvents EventsOf(const FootTracks& tracks, const std::string& plate);

}  // namespace sinew
