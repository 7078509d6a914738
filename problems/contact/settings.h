// Settings of a contact problem: where the soles are, which force plate measures them, which
// channels are fitted, and how residuals are weighed.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "models/contact/elastic_foundation.h"
#include "problems/contact/motion/motion_errors.h"

namespace sinew {

/// How the residuals of a channel are weighed.
enum class ContactObjective {
  kThesis,      ///< newtons as they are; the square root of twice the cost is eq 5.4 of the thesis
  kNormalised,  ///< divided by the standard deviation of the measured channel and the root of its sample
                ///< count
  kLikelihood   ///< divided by the channel's noise level (attribute sigma), which must be known
};

[[nodiscard]] const char* ToString(ContactObjective objective);

struct ContactRegionSettings {
  ContactRegion region;
  std::string body;   ///< that it belongs to, as named in the .osim
  std::string plate;  ///< prefix of the force channels that it adds to: "right" for right_force_y
  std::string group;  ///< regions of one group share their parameters
};

/// Range and start of one parameter.
struct ParameterRange {
  double lower = 0;
  double upper = 1;
  double start = 0;
};

/// To what each kind of channel is weighed by the objective kLikelihood where its noise level is not stated,
/// and instead of it where this is: errors of the model count too.
struct ContactAccuracy {
  std::optional<double> force;   ///< [N]
  std::optional<double> cop;     ///< centre of pressure [m]
  std::optional<double> moment;  ///< free moment [N m]
};

/// Directions in which a sole can lie elsewhere on the foot than its regions are drawn, along the axes of the
/// regions; outward is to the right of a right foot.
enum SolePlace { kSoleForward, kSoleHeight, kSoleOutward, kSolePlaces };
extern const std::array<const char*, kSolePlaces> kSolePlaceNames;

/// How fast the markers of a foot that stands on the floor move: it rolls, and its skin slides by a few
/// millimetres in the tenth of a second that it is flat [m/s].
inline constexpr double kStandingFoot = 0.03;

struct ContactSettings {
  std::string model = "model.osim";  ///< name of the .osim among the files of the data set
  Floor floor;                       ///< height [m], and velocity of a treadmill's belt [m/s]
  /// Standard deviation of that velocity, along x and z [m/s]; nothing: that of the markers of a standing
  /// foot.
  std::optional<std::array<double, 2>> floor_velocity_error;
  double transition_velocity = 0.01;  ///< of the friction law [m/s]
  ContactObjective objective = ContactObjective::kNormalised;
  std::vector<std::string> fit{"force_y"};  ///< of kContactChannels
  /// The centre of pressure means nothing under a light foot: it is compared where the vertical force exceeds
  /// this share of its maximum.
  double cop_force_share = 0.1;
  /// The pose of every foot may deviate from the recorded one; nothing: the motion is exact.
  std::optional<MotionErrorSettings> motion_errors;
  ContactAccuracy accuracy;
  std::vector<ContactRegionSettings> regions;
  /// That is set or, of what moves, kStandingFoot; 0: known exactly. [m/s]
  [[nodiscard]] std::array<double, 2> FloorVelocityError() const;
  /// Which of SolePlace are parameters of each group: its sole lies elsewhere on the foot than drawn.
  [[nodiscard]] std::vector<int> SolePlaces() const;
  /// Springs do not stay where the recorded motion has them.
  [[nodiscard]] bool moves_springs() const { return motion_errors || !SolePlaces().empty(); }
  /// By name within a group: stiffness, dissipation, static_friction, dynamic_friction, viscous_friction and,
  /// if they are to be fitted, sole_forward, sole_height and sole_outward.
  std::map<std::string, ParameterRange> parameters;

  [[nodiscard]] std::vector<std::string> Groups() const;
  [[nodiscard]] std::vector<std::string> Plates() const;
};

/// Of a group, see ContactSettings::parameters.
constexpr int kContactParametersPerGroup = 5;

/// The channels of a plate that this problem predicts, without the plate's prefix.
extern const std::vector<std::string> kContactChannels;

/// @param channel one of kContactChannels
[[nodiscard]] std::string PlateChannelUnit(const std::string& channel);

[[nodiscard]] const std::map<std::string, ParameterRange>& DefaultContactRanges();

/// @param yaml the map under the key `contact` of a settings file; @param files texts by name (for .obj
/// soles). Errors: unknown keys, wrong values, each with file and line.
Result<ContactSettings> ReadContactSettings(const YamlReader& yaml,
                                            const std::map<std::string, std::string>& files);

}  // namespace sinew
