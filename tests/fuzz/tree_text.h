// An HDF5 file as lines of text, so that what is fuzzed is what the file says, not how libhdf5 stores it.
//
//   trials/walk @role "train        an attribute: a text, or a number (an integer has no point)
//   trials/walk/g/time 4 = 0 1 2 3  numbers of this shape; of none: a scalar
//   run/config "a: 1\nb: 2          a text; \n and \\ stand for a newline and a backslash
//   parameters/name ["a","b         texts
//   trials/walk                     a group
#pragma once

#include <string>
#include <string_view>

#include "base/hdf5_tree.h"

namespace sinew::fuzz {

/// Lines that mean nothing are passed over. Numbers that are missing are 0.
[[nodiscard]] Hdf5Node ToTree(std::string_view text);

/// The same tree as text.
[[nodiscard]] std::string ToText(const Hdf5Node& root);

}  // namespace sinew::fuzz
