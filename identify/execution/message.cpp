#include "identify/execution/message.h"

#include <cstring>

namespace sinew {
namespace {

struct Head {
  Digest::Value about;
  std::uint64_t index;
  std::uint64_t numbers;
  std::uint64_t kind;
};

}  // namespace

std::string ToBytes(const Message& message) {
  const Head head{message.about, message.index, message.answer.numbers.size(),
                  static_cast<std::uint64_t>(message.kind)};
  const std::size_t numbers = message.answer.numbers.size() * sizeof(double);
  std::string bytes(sizeof head + numbers + message.answer.text.size(), '\0');
  std::memcpy(bytes.data(), &head, sizeof head);
  if (numbers > 0) std::memcpy(bytes.data() + sizeof head, message.answer.numbers.data(), numbers);
  message.answer.text.copy(bytes.data() + sizeof head + numbers, message.answer.text.size());
  return bytes;
}

std::optional<Message> FromBytes(const std::string& bytes) {
  Head head{};
  if (bytes.size() < sizeof head) return {};
  std::memcpy(&head, bytes.data(), sizeof head);
  const std::size_t left = bytes.size() - sizeof head;
  if (head.numbers > left / sizeof(double) || head.kind > static_cast<std::uint64_t>(Message::Kind::kBye))
    return {};
  Message message;
  message.kind = static_cast<Message::Kind>(head.kind);
  message.about = head.about;
  message.index = head.index;
  message.answer.numbers.resize(head.numbers);
  const std::size_t numbers = head.numbers * sizeof(double);
  if (numbers > 0) std::memcpy(message.answer.numbers.data(), bytes.data() + sizeof head, numbers);
  message.answer.text = bytes.substr(sizeof head + numbers);
  return message;
}

}  // namespace sinew
