// Columns of tables in files of ours, of a length that is known.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/hdf5_tree.h"

namespace sinew::files {

/// The numbers of a member; nullptr if it is absent, of another kind, or not of so many values.
inline const std::vector<double>* NumberColumn(const Hdf5Node& node, const std::string& name,
                                               std::size_t count) {
  const Hdf5Node* found = node.Find(name);
  const bool fits = found != nullptr && found->array() != nullptr && found->array()->values.size() == count;
  return fits ? &found->array()->values : nullptr;
}

/// The same, of texts.
inline const std::vector<std::string>* TextColumn(const Hdf5Node& node, const std::string& name,
                                                  std::size_t count) {
  const Hdf5Node* found = node.Find(name);
  const bool fits = found != nullptr && found->texts() != nullptr && found->texts()->size() == count;
  return fits ? found->texts() : nullptr;
}

}  // namespace sinew::files
