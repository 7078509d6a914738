// What processes that share one work tell each other, as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/digest.h"
#include "identify/execution/answer.h"

namespace sinew {

struct Message {
  enum class Kind : std::uint8_t {
    kDraw,    ///< to rank 0: which piece of the loop `about`, of `index` pieces, shall I do?
    kDrawn,   ///< from rank 0: piece `index` of that loop; as many as the loop has: none is left
    kAnswer,  ///< the answer to the question `about`
    kPiece,   ///< piece `index` of the loop `about` is done
    kTask,    ///< of a cohort: from rank 0: do task `index`; from the others: it is done
    kReady,   ///< of a cohort, to rank 0: `index` tasks can be done at once
    kEnd,     ///< from rank 0: all is done
    kBye      ///< to rank 0: nothing follows
  };
  Kind kind = Kind::kEnd;
  Digest::Value about{};
  std::uint64_t index = 0;
  Answer answer;
};

/// All processes run the same program on machines of one kind: numbers are copied as they are in memory.
[[nodiscard]] std::string ToBytes(const Message& message);
/// Nothing if these are not the bytes of a message.
[[nodiscard]] std::optional<Message> FromBytes(const std::string& bytes);

}  // namespace sinew
