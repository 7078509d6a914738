// What a YAML document may be: limits that are looked at before anything is made of it.
#pragma once

#include <cstddef>
#include <string>

#include "base/error.h"

namespace sinew {

constexpr std::size_t kMostYaml = std::size_t{1} << 26U;  ///< [bytes] more is no file of settings
constexpr std::size_t kDeepestYaml = 200;                 ///< yaml-cpp recurses once per bracket

/// Refuses what would take all stack or memory: text of more than kMostYaml bytes; collections nested deeper
/// than kDeepestYaml; aliases that stand for more than kMostYaml characters (nine lines of aliases of aliases
/// can stand for 10^9 values, and one alias of a long text for any amount of memory), or stand within what
/// they stand for. An alias is one sum, so this takes the time of one reading.
///
/// Throws what yaml-cpp throws where the text is no YAML. @param file name for messages
Status CheckYamlLimits(const std::string& text, const std::string& file);

}  // namespace sinew
