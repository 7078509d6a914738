// Just enough of .trc and .mot to read the shared data.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "base/text.h"
#include "models/multibody/inverse_kinematics.h"
#include "tests/models/multibody/test_models.h"

namespace sinew {

/// The lines of a text as words.
inline std::vector<std::vector<std::string>> ReadWords(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    for (const std::string_view word : SplitBlanks(Trim(line))) rows.back().emplace_back(word);
  }
  return rows;
}

/// A .trc without gaps, in mm.
inline MarkerTrajectories ReadTrc(const std::string& path) {
  MarkerTrajectories markers;
  const auto rows = ReadWords(ReadText(path));
  markers.names.assign(rows[3].begin() + 2, rows[3].end());
  for (std::size_t row = 5; row < rows.size(); ++row) {
    if (rows[row].size() != 2 + 3 * markers.names.size()) continue;
    std::vector<double> numbers;
    for (const std::string& word : rows[row]) numbers.push_back(*ParseNumber(word));
    markers.times.push_back(numbers[1]);
    markers.positions.emplace_back();
    for (std::size_t i = 2; i < numbers.size(); i += 3)
      markers.positions.back().emplace_back(Vec3(numbers[i], numbers[i + 1], numbers[i + 2]) / 1000);
  }
  return markers;
}

/// A .mot or .sto: names after `endheader`, numbers as in the file.
struct Motion {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
};
inline Motion ReadMot(const std::string& path) {
  Motion motion;
  bool in_header = true;
  for (const auto& words : ReadWords(ReadText(path))) {
    if (in_header) {
      in_header = words.empty() || words[0] != "endheader";
    } else if (motion.names.empty()) {
      motion.names = words;
    } else if (words.size() == motion.names.size()) {
      motion.rows.emplace_back();
      for (const std::string& word : words) motion.rows.back().push_back(*ParseNumber(word));
    }
  }
  return motion;
}

}  // namespace sinew
