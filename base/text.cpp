#include "base/text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <numeric>

namespace sinew {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::size_t kMaxShown = 20;  // names in a message

template <class Number>
std::optional<Number> ParseWhole(std::string_view text) {
  text = Trim(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  if (text.empty()) return std::nullopt;
  Number number{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

constexpr std::size_t kLongestName =
    400;  // [bytes] that is compared: two texts of a megabyte would take an hour

// Levenshtein 1966; of a name that is too long, its length, so that nothing is like it.
std::size_t EditDistance(std::string_view a, std::string_view b) {
  if (std::max(a.size(), b.size()) > kLongestName) return a == b ? 0 : std::max(a.size(), b.size());
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string OneLine(std::string_view text) {
  std::string line;
  for (const std::string_view word : SplitBlanks(text)) {
    if (!line.empty()) line += ' ';
    line += word;
  }
  return line;
}

std::string_view Trim(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> pieces;
  while (true) {
    const auto at = text.find(separator);
    pieces.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return pieces;
    text.remove_prefix(at + 1);
  }
}

std::vector<std::string_view> SplitBlanks(std::string_view text) {
  std::vector<std::string_view> words;
  while (true) {
    const auto first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return words;
    text.remove_prefix(first);
    const auto last = std::min(text.find_first_of(kBlanks), text.size());
    words.push_back(text.substr(0, last));
    text.remove_prefix(last);
  }
}

std::optional<double> ParseNumber(std::string_view text) {
  return ParseWhole<double>(text);
}
std::optional<long> ParseInteger(std::string_view text) {
  return ParseWhole<long>(text);
}

std::string Join(const std::vector<std::string>& parts, std::string_view separator) {
  std::string joined;
  for (const std::string& part : parts) {
    if (!joined.empty()) joined += separator;
    joined += part;
  }
  return joined;
}

std::string Lowercase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

std::optional<std::string> ClosestName(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string wanted = Lowercase(name);
  std::optional<std::string> closest;
  std::size_t fewest = std::max<std::size_t>(1, name.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = EditDistance(wanted, Lowercase(candidate));
    if (distance < fewest) {
      fewest = distance;
      closest = candidate;
    }
  }
  return closest;
}

std::string ByLikeness(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string wanted = Lowercase(name);
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const std::string& candidate : candidates)
    ranked.emplace_back(EditDistance(wanted, Lowercase(candidate)), candidate);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> shown;
  for (const auto& [distance, candidate] : ranked) {
    if (shown.size() < kMaxShown) shown.push_back(candidate);
  }
  return Join(shown, ", ") + (candidates.size() > kMaxShown ? ", ..." : "");
}

std::string Suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  if (const auto closest = ClosestName(name, candidates)) return "; did you mean '" + *closest + "'?";
  const std::vector<std::string> shown(candidates.begin(),
                                       candidates.begin() + std::min(candidates.size(), kMaxShown));
  return "; expected one of " + Join(shown, ", ") + (candidates.size() > kMaxShown ? ", ..." : "");
}

}  // namespace sinew
