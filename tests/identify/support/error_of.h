// Access to the message of a failure.
#pragma once

#include <string>

#include "base/error.h"

namespace sinew {

/// The message of a failure; empty for a success, so that a comparison with a message fails.
template <class T>
std::string ErrorOf(const Result<T>& result) {
  return result ? std::string() : result.error().message;
}

}  // namespace sinew
