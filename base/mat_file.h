// A MAT file of MATLAB, version 5 (also compressed: 6 and 7) or 7.3, as a value. Read by libmatio.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

enum class MatKind {
  kNumbers,  ///< real and full; logical and integer ones too
  kText,     ///< a char array
  kStruct,
  kCell,
  kOther  ///< something whose content is not read: see MatValue::other
};

/// One variable, or one field of a struct, or one cell.
struct MatValue {
  MatKind kind = MatKind::kNumbers;
  std::vector<std::size_t> shape;  ///< at least two sizes; numbers and elements are column-major
  std::vector<double> numbers;     ///< empty as long as the variable is not read
  bool integers = false;           ///< the file stores them as integers
  std::string text;                ///< UTF-8, column-major
  std::vector<std::string> fields;
  std::vector<MatValue>
      elements;       ///< cells; of a struct array all fields of the first element, then the next
  std::string other;  ///< "is sparse, expected a full array (in MATLAB: full(x))"

  [[nodiscard]] std::size_t count() const;  ///< product of the sizes
  /// "34000 x 1 numbers", "1 x 1 struct", for messages.
  [[nodiscard]] std::string Describe() const;
  /// A field of the element of a struct array; nullptr if there is no such field or element.
  [[nodiscard]] const MatValue* Field(const std::string& name, std::size_t element = 0) const;
};

struct MatFile {
  std::map<std::string, MatValue> variables;
  std::set<std::string> twice;  ///< names that two variables have; the second is not read
};

/// Reads the numbers of the variables that are `wanted`. If one of these names is none of a variable, it may
/// be a title within one (a channel of Spike2): then structs with a field `title` are read as well. The
/// others are there without numbers, elements and text.
///
/// libmatio works in a process of its own (TryInOwnProcess). Errors: no such file; not a MAT file; version 4;
/// HDF5 without MATLAB's header; truncated or damaged, also where only the checksum of compressed numbers
/// says so; more numbers than the file can hold, or than 2^28; links to other files.
Result<MatFile> ReadMat(const std::string& path, const std::set<std::string>& wanted);

}  // namespace sinew
