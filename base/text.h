// Reading numbers and words from text, and the closest match of a misspelt name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sinew {

/// Without blanks, tabs, carriage returns and newlines at both ends.
[[nodiscard]] std::string_view Trim(std::string_view text);

/// The words with single spaces between them: a message of a library on several lines as one sentence.
[[nodiscard]] std::string OneLine(std::string_view text);

/// Pieces between single separators; empty pieces are kept. "a,,b" -> {"a", "", "b"}; "" -> {""}.
[[nodiscard]] std::vector<std::string_view> Split(std::string_view text, char separator);

/// Words between runs of blanks, tabs, carriage returns and newlines; no empty pieces.
[[nodiscard]] std::vector<std::string_view> SplitBlanks(std::string_view text);

// The pieces are views into the text: a temporary string would be gone before they are read.
template <class Text, class = std::enable_if_t<std::is_same_v<Text, std::string>>>
std::vector<std::string_view> Split(Text&& text, char separator) = delete;
template <class Text, class = std::enable_if_t<std::is_same_v<Text, std::string>>>
std::vector<std::string_view> SplitBlanks(Text&& text) = delete;

/// The whole text as a number ("nan" and "inf" in any case included); nothing if it is not one, in any
/// locale.
[[nodiscard]] std::optional<double> ParseNumber(std::string_view text);
[[nodiscard]] std::optional<long> ParseInteger(std::string_view text);

[[nodiscard]] std::string Join(const std::vector<std::string>& parts, std::string_view separator);
[[nodiscard]] std::string Lowercase(std::string_view text);

/// The closest candidate (fewest edits, at most a third of the letters), or nothing. Texts of more than 400
/// bytes are like nothing but themselves.
[[nodiscard]] std::optional<std::string> ClosestName(std::string_view name,
                                                     const std::vector<std::string>& candidates);

/// The candidates, those that need the fewest edits first; up to 20 of them, then "...".
[[nodiscard]] std::string ByLikeness(std::string_view name, const std::vector<std::string>& candidates);

/// "; did you mean 'stiffness'?" or, when nothing is close, "; expected one of a, b, c".
[[nodiscard]] std::string Suggestion(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace sinew
