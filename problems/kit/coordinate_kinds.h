// What the coordinates of a model are, as the readers of motion files ask for it.
#pragma once

#include "datasets/io/storage_content.h"
#include "models/multibody/multibody_model.h"

namespace sinew {

/// @param model outlives what is returned
[[nodiscard]] inline CoordinateKindOf CoordinateKindsOf(const MultibodyModel& model) {
  return [&model](const std::string& name) -> std::optional<CoordinateKind> {
    if (!model.CoordinateIndex(name)) return std::nullopt;  // no coordinate: the reader goes by the name
    if (model.IsRotational(name)) return CoordinateKind::kAngle;
    return model.IsAngle(name) ? CoordinateKind::kCoupledAngle : CoordinateKind::kLength;
  };
}

}  // namespace sinew
