// How processes that share one work send bytes to each other.
#pragma once

#include <optional>
#include <string>

namespace sinew {

/// Used by one thread from its making to its end. Between two ranks bytes arrive whole and in the order in
/// which they were sent.
class Transport {
 public:
  struct Arrival {
    int from = 0;
    std::string bytes;
  };

  Transport() = default;
  /// Every rank has to come here before any of them goes on.
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  [[nodiscard]] virtual int rank() const = 0;  ///< 0 .. size() - 1
  [[nodiscard]] virtual int size() const = 0;
  /// Ranks on this machine, this one among them.
  [[nodiscard]] virtual int size_on_this_machine() const = 0;

  /// Returns at once. @pre fewer than 2^31 bytes
  virtual void Send(int to, std::string bytes) = 0;
  /// What has arrived, or nothing. To be called again and again: sending goes on in here too.
  virtual std::optional<Arrival> Receive() = 0;
  /// Whether everything that was sent has left.
  [[nodiscard]] virtual bool AllSent() = 0;
};

}  // namespace sinew
