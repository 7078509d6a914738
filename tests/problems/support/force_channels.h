// Order of the channels of a plate.
#pragma once

namespace sinew {

enum ForceChannel { kFx, kFy, kFz, kCopX, kCopZ, kPlateMomentY };

}  // namespace sinew
