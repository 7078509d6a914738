// What the words of a command line mean, without doing it.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

struct Program;

struct ParsedWords {
  std::string command;               ///< "data import"
  std::set<std::string> options;     ///< all that it has: "--threads", ...
  std::set<std::string> given;       ///< those among the words
  std::vector<std::string> written;  ///< values of --out, then of --out-dir, then of --json but for "-"
};

/// @param words without the program's name. Errors: what RunCommandLine would say of them.
Result<ParsedWords> ParseWords(const Program& program, const std::vector<std::string>& words);

}  // namespace sinew
