// What became of a piece of work, in a form that can be kept in a file or sent to another process.
#pragma once

#include <string>
#include <vector>

namespace sinew {

struct Answer {
  std::vector<double> numbers;
  std::string text;
};

}  // namespace sinew
