// An HDF5 file as a value: a tree of groups, arrays, texts and attributes, read and written whole.
// Our files are small (a few MB; data sets up to a GB or two), so a tree in memory keeps HDF5's handles out
// of all other code, and lets a file be replaced in one step: whoever reads it, or kills the writer, finds
// the old file or the new one, never half of one.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/error.h"

namespace sinew {

/// Numbers in row-major order; shape {} is a scalar, {N} a vector, {N, M} a matrix.
struct Hdf5Array {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

/// A vector that lies elsewhere and is written without being copied. A file that is read has none.
struct Hdf5View {
  const std::vector<double>* values = nullptr;
};

using Hdf5Attribute = std::variant<std::int64_t, double, std::string>;

/// A group (has children, no data) or a dataset (has data, no children).
struct Hdf5Node {
  std::map<std::string, Hdf5Attribute> attributes;
  std::map<std::string, Hdf5Node> children;
  std::variant<std::monostate, Hdf5Array, std::string, std::vector<std::string>, Hdf5View> data;

  /// The node at a path such as "trials/walk/time"; missing groups are made.
  Hdf5Node& At(std::string_view path);
  /// The node at a path, or nullptr.
  [[nodiscard]] const Hdf5Node* Find(std::string_view path) const;

  void SetVector(std::vector<double> values);
  /// The same without a copy. @param values must stay as they are until the tree is written
  void SetView(const std::vector<double>& values) { data = Hdf5View{&values}; }
  void SetScalar(double value);
  /// @param values [rows * columns, row-major]
  void SetMatrix(std::size_t rows, std::size_t columns, std::vector<double> values);

  [[nodiscard]] const Hdf5Array* array() const { return std::get_if<Hdf5Array>(&data); }
  [[nodiscard]] const std::string* text() const { return std::get_if<std::string>(&data); }
  [[nodiscard]] const std::vector<std::string>* texts() const {
    return std::get_if<std::vector<std::string>>(&data);
  }
  /// An attribute as a number (integers too) or as text; fallback if it is absent or of another type.
  [[nodiscard]] double Number(const std::string& attribute, double fallback) const;
  [[nodiscard]] std::string Text(const std::string& attribute, const std::string& fallback = "") const;
};

/// Reads it in a process of its own first, because damaged bytes can crash libhdf5; that triples the time (7
/// ms become 25 for a run file of 0.5 MB). Errors: no such file, not HDF5, truncated or damaged, more values
/// than the file can hold or than 2^28, a dataset that is neither numbers nor text; links to other files, and
/// datasets whose numbers are in other files (external storage, virtual datasets), which are not opened.
Result<Hdf5Node> ReadHdf5(const std::string& path);

/// Made in memory, then written by ReplaceFile. Errors: a name or a text with a null byte, and those of
/// ReplaceFile; the old file is then unchanged.
Status WriteHdf5(const std::string& path, const Hdf5Node& root);

}  // namespace sinew
