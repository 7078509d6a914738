// Foreseeable failures are values: a function that may fail returns Result<T>, which holds a T or one Error.
// Three kinds are never mixed: a bug of ours is SINEW_ASSERT (base/assert.h); misuse of a public function is
// std::invalid_argument; a bad file, a failed simulation, a singular fit is an Error.
#pragma once

#include <fmt/format.h>

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace sinew {

/// One sentence for a person: where it is, what is wrong, what was expected. Holds no newline at its end.
struct Error {
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

/// Success, or the reason why not.
using Status = Result<void>;

/// An Error ready to be returned: `return Fail("{}: no such trial", name);`
template <class... Args>
[[nodiscard]] tl::unexpected<Error> Fail(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected<Error>(Error{fmt::format(format, std::forward<Args>(args)...)});
}

/// An Error at a place in a text file, printed as `FILE:LINE: what is wrong, what was expected`.
template <class... Args>
[[nodiscard]] tl::unexpected<Error> FailAt(const std::string& file, long line,
                                           fmt::format_string<Args...> format, Args&&... args) {
  return Fail("{}:{}: {}", file, line, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace sinew

#define SINEW_CONCAT_INNER(a, b) a##b
#define SINEW_CONCAT(a, b) SINEW_CONCAT_INNER(a, b)

/// Returns the error of a Status or Result from the enclosing function, if there is one.
#define SINEW_TRY(expression)                                                  \
  do {                                                                         \
    auto&& sinew_status = (expression);                                        \
    if (!sinew_status) return tl::unexpected(std::move(sinew_status).error()); \
  } while (false)

/// `SINEW_ASSIGN(auto trial, ReadTrial(file));` declares trial, or returns the error.
#define SINEW_ASSIGN(target, expression) \
  SINEW_ASSIGN_INNER(SINEW_CONCAT(sinew_result_, __LINE__), target, expression)
// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names and declarations.
#define SINEW_ASSIGN_INNER(result, target, expression)           \
  auto result = (expression);                                    \
  if (!result) return tl::unexpected(std::move(result).error()); \
  target = std::move(*result)
// NOLINTEND(bugprone-macro-parentheses)
