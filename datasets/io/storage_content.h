// What the columns of a .sto or .mot mean: the files name neither units nor what they hold, so names must
// tell.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "datasets/dataset.h"
#include "datasets/io/storage_file.h"

namespace sinew {

/// What a coordinate is, by OpenSim's rules: inDegrees=yes concerns kAngle only.
enum class CoordinateKind {
  kAngle,
  kCoupledAngle,  ///< an angle that moves its joint through functions only (a patella's): always in rad
  kLength
};
/// The kind of a coordinate of the model; nothing if the model has no such coordinate.
using CoordinateKindOf = std::function<std::optional<CoordinateKind>(const std::string& coordinate)>;

enum class StorageContent {
  kCoordinates,    ///< joint angles and positions, and their speeds
  kForces,         ///< force plates
  kExcitations,    ///< EMG
  kMuscleLengths,  ///< of muscle-tendon units
  kMomentArms,
  kOther,  ///< joint moments, results of simulations, ...
};

/// What a column becomes.
struct ColumnMeaning {
  std::string channel;
  std::string unit;  ///< SI
  ChannelKind kind = ChannelKind::kMeasured;
  double factor = 1;          ///< file's number to SI
  bool unit_is_known = true;  ///< false: nothing in the file tells; `unit` is then 1
  double offset = 0;          ///< [SI] added after `factor`
};

/// A file without `inDegrees` holds coordinates if its columns are named like them, neither it nor its title
/// is named like moments, and no angle is beyond two turns in rad.
/// @param stem the file's name without folder and extension
[[nodiscard]] StorageContent ClassifyStorage(const Storage& storage, const std::string& stem,
                                             const CoordinateKindOf& kind_of);

/// @param column the name as it is in the file. inDegrees=yes is applied to rotational coordinates; which
/// they are is asked of the model, or, without one, all but *_tx, *_ty, *_tz, *_force* and *_fx, *_fy, *_fz,
/// and *_beta, which are coupled angles.
[[nodiscard]] ColumnMeaning MeaningOf(const std::string& column, StorageContent content, bool in_degrees,
                                      const CoordinateKindOf& kind_of);

/// OpenSim 4 writes paths; '/' cannot be part of a channel's name. "/jointset/hip_r/hip_flexion_r/value" ->
/// "hip_flexion_r", ".../speed" -> "hip_flexion_r_speed", "/forceset/soleus_r|length" -> "soleus_r_length".
[[nodiscard]] std::string ChannelName(const std::string& column);

}  // namespace sinew
