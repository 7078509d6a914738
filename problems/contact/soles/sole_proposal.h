// Settings of a contact problem that nobody tunes by hand: which foot stands on which plate, and regions of
// its sole, from the motion, the markers and the centre of pressure.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/contact/soles/belt_velocity.h"
#include "problems/contact/soles/foot_estimate.h"
#include "problems/contact/soles/plate_foot.h"

namespace sinew {

/// A plate in a trial that cannot be used.
struct PlateFinding {
  std::string trial;
  std::string plate;
  PlateFoot found;   ///< with its fault
  std::string body;  ///< names of its bodies; empty: none
  std::string other_body;
};

enum class SoleSource {
  kOwn,     ///< from stances of this foot; of two with stances if they differ (kFeetDiffer...)
  kBoth,    ///< mean of this foot and the mirrored other one
  kOther,   ///< the other foot, mirrored
  kNoPlate  ///< the same of a foot that no plate of the data measures
};

/// Two feet of a model whose planes differ by more than twice what the motion of both leaves open (2 degrees
/// and 6 mm each: Jackson et al. 2016) keep their own: their bodies were placed on them differently.
constexpr double kFeetDifferAngle = 0.1;     // [rad]
constexpr double kFeetDifferHeight = 0.017;  // [m]

struct ProposedFoot {
  std::vector<std::string> bodies;  ///< names, from the heel outwards
  std::vector<std::string> plates;  ///< that it stands on; of kNoPlate the name of its first body
  SoleSource source = SoleSource::kOwn;
  std::string other;          ///< first body of the other foot; empty: none
  double differs_angle = 0;   ///< of its plane from the mirrored other one, where both have stances [rad]
  double differs_height = 0;  ///< under the middle of the rearfoot [m]
  /// Patches in the frames of its own bodies; the rest tells what the stances said (of kOther: those of the
  /// other foot, of kBoth: its own).
  FootEstimate estimate;
};

struct ProposedRegion {
  std::string name;
  std::string body;
  std::string plate;
  std::size_t foot = 0;             ///< index into SoleProposal::feet
  std::size_t patch = 0;            ///< 0 rearfoot, 1 forefoot, 2 toes
  Vec3 position = Vec3::Zero();     ///< as in the settings [m]
  Vec3 orientation = Vec3::Zero();  ///< body-fixed x-y-z angles [rad]
  Vec3 size = Vec3::Zero();         ///< of its box [m]
  std::array<int, 2> strips{1, 1};
};

struct SoleProposal {
  double floor_height = 0;  ///< [m]
  std::vector<ProposedFoot> feet;
  std::vector<ProposedRegion> regions;  ///< none: nothing can be proposed; `findings` say why
  BeltVelocity belt;
  /// The largest load presses one foot's patches in by a hundredth of its length [N/m3]: where a search
  /// starts.
  double stiffness_start = 0;
  std::vector<std::string> fit;      ///< of kContactChannels, those that all plates measure
  std::vector<std::string> not_fit;  ///< the others
  std::vector<PlateFinding> findings;
  std::vector<std::string> skipped;  ///< sentences on trials, and channels of trials, that cannot be used
};

/// Geometry is estimated from training trials; held-out ones only tell which foot stands on which plate. A
/// foot without a training stance gets the other one's sole, mirrored, also one that no plate measures: its
/// steps can be predicted, and it tells when a measured foot carries all. Two feet that have stances get the
/// mean of both. Sizes are rounded to 0.1 mm, angles to 1e-4 rad.
/// @param model_file name of the .osim among the files of the data set; @param floor_height [m]
/// Errors: no .osim, one that is not understood; no trial with a plate and coordinates; two feet that share
/// the name of a plate.
Result<SoleProposal> ProposeSoles(const Dataset& data, const std::string& model_file, double floor_height);

}  // namespace sinew
