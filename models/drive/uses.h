// Which effects of a joint must be evaluated, and how fast the joint can change with them.
#pragma once

#include <array>

#include "models/drive/dynamics.h"
#include "models/drive/run.h"

namespace sinew {

/// Numbers of the joint by slot.
using DriveNumbers = std::array<double, kDriveSlots>;

/// An effect is evaluated where one of its numbers is not at rest.
/// @param differentiated [slots] those that are differentiated are evaluated too
[[nodiscard]] DriveUses UsesOf(const DriveNumbers& numbers,
                               const std::array<bool, kDriveSlots>& differentiated, const DriveJoint& joint);

[[nodiscard]] bool AnyFrictionAboveZero(const DriveNumbers& numbers);

/// The fastest rate at which the joint can change at speeds as they were measured [1/s]: what bounds the
/// step.
[[nodiscard]] double FastestRate(const DriveNumbers& numbers, const DriveJoint& joint,
                                 const DriveCommand& command, const DriveRun& run);

}  // namespace sinew
