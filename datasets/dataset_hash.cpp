#include "datasets/dataset_hash.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace sinew {
namespace {

class Fnv1a {
 public:
  // Byte by byte from the lowest, so that the machine's byte order does not matter.
  void Add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) AddByte(static_cast<unsigned char>(word >> shift));
  }
  void Add(double number) {
    constexpr std::uint64_t kAnyNan = 0x7ff8000000000000;
    std::uint64_t bits = 0;
    static_assert(sizeof bits == sizeof number);
    std::memcpy(&bits, &number, sizeof bits);
    Add(std::isnan(number) ? kAnyNan : bits);
  }
  void Add(const std::string& text) {
    Add(static_cast<std::uint64_t>(text.size()));
    for (const char c : text) AddByte(static_cast<unsigned char>(c));
  }
  void Add(const std::vector<double>& numbers) {
    Add(static_cast<std::uint64_t>(numbers.size()));
    for (const double number : numbers) Add(number);
  }
  // The size first, so that neighbouring containers cannot be confused.
  template <class Value, class AddValue>
  void Add(const std::map<std::string, Value>& entries, AddValue add_value) {
    Add(static_cast<std::uint64_t>(entries.size()));
    for (const auto& [name, value] : entries) {
      Add(name);
      add_value(value);
    }
  }
  [[nodiscard]] std::string Hex() const { return fmt::format("{:016x}", state_); }

 private:
  void AddByte(unsigned char byte) { state_ = (state_ ^ byte) * 0x100000001b3; }

  std::uint64_t state_ = 0xcbf29ce484222325;
};

}  // namespace

std::string DatasetHash(const Dataset& dataset) {
  Fnv1a hash;
  auto add_channel = [&](const Channel& channel) {
    hash.Add(channel.unit);
    hash.Add(static_cast<std::uint64_t>(channel.kind));
    hash.Add(channel.sigma.value_or(0));
    hash.Add(channel.values);
  };
  auto add_grid = [&](const Grid& grid) {
    hash.Add(grid.time);
    hash.Add(grid.channels, add_channel);
  };
  for (const std::string* text : {&dataset.title, &dataset.subject, &dataset.source, &dataset.licence})
    hash.Add(*text);
  hash.Add(static_cast<std::uint64_t>(dataset.synthetic));
  hash.Add(dataset.trials, [&](const Trial& trial) {
    hash.Add(static_cast<std::uint64_t>(trial.role));
    hash.Add(trial.task);
    if (!trial.cut_from.empty()) hash.Add("cut_from " + trial.cut_from);
    hash.Add(trial.conditions, [&](double value) { hash.Add(value); });
    hash.Add(trial.grids, add_grid);
  });
  hash.Add(dataset.constants, [&](const Constant& constant) {
    hash.Add(constant.value);
    hash.Add(constant.unit);
  });
  hash.Add(dataset.files, [&](const std::string& text) { hash.Add(text); });
  return hash.Hex();
}

}  // namespace sinew
