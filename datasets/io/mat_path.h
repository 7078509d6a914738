// Where a column is within a MAT file, written as in MATLAB: Fdat.Region(2).FL, data(:,3), trials{4}.torque.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sinew {

struct MatStep {
  enum class Kind {
    kField,    ///< .name
    kElement,  ///< (i) of a struct array, {i} of cells
    kColumn,   ///< (:,j) of a matrix
    kRow       ///< (i,:)
  };
  Kind kind = Kind::kField;
  std::string name;       ///< of the field
  std::size_t index = 0;  ///< counted from 0
  std::string written;    ///< with all steps before it, for messages: "Fdat.Region(2)"
};

struct MatPath {
  std::string variable;
  std::vector<MatStep> steps;
};

/// Nothing if the text is no such path: it may be a title of a channel then. Indices are 1 to 10^9; a column
/// or a row is the last step.
[[nodiscard]] std::optional<MatPath> ParseMatPath(std::string_view text);

}  // namespace sinew
