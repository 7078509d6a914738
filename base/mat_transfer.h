// The content of a MAT file on its way from the process that reads it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/mat_file.h"

namespace sinew {

/// Bytes that UnpackMat understands, in this machine's order.
[[nodiscard]] std::string PackMat(const MatFile& file);

/// Nothing if the bytes are not whole or contradict themselves; never takes more memory than a few times
/// their number.
[[nodiscard]] std::optional<MatFile> UnpackMat(std::string_view bytes);

}  // namespace sinew
