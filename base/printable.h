// Text of unknown origin, made safe to print: names and titles come from files of others, and a terminal
// obeys the control characters in them.
#pragma once

#include <string>
#include <string_view>

namespace sinew {

/// Without control characters (C0, DEL, C1), characters that change the direction of writing, and bytes that
/// are not UTF-8: each as "\x1b", or "\u202e" beyond a byte. Newlines stay.
[[nodiscard]] std::string Printable(std::string_view text);

/// The same, of what belongs into one line: newlines and tabs as well, as "\n" and "\t".
[[nodiscard]] std::string PrintableLine(std::string_view text);

/// JSON that means the same, with such characters as "\u009b". Bytes that are not UTF-8 are kept.
[[nodiscard]] std::string PrintableJson(std::string_view json);

}  // namespace sinew
