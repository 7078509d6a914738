#include "base/mat_transfer.h"

#include <cstdint>
#include <cstring>

#include "base/value_limits.h"

namespace sinew {
namespace {

class Packer {
 public:
  void Size(std::size_t number) { Append(&number, sizeof(number)); }
  void Text(const std::string& text) {
    Size(text.size());
    bytes_ += text;
  }
  void Value(const MatValue& value) {
    Size(static_cast<std::size_t>(value.kind));
    Size(value.integers ? 1 : 0);
    Size(value.shape.size());
    Append(value.shape.data(), value.shape.size() * sizeof(std::size_t));
    Size(value.numbers.size());
    Append(value.numbers.data(), value.numbers.size() * sizeof(double));
    Text(value.text);
    Text(value.other);
    Size(value.fields.size());
    for (const std::string& field : value.fields) Text(field);
    Size(value.elements.size());
    for (const MatValue& element : value.elements) Value(element);
  }
  std::string Take() { return std::move(bytes_); }

 private:
  void Append(const void* from, std::size_t size) { bytes_.append(static_cast<const char*>(from), size); }

  std::string bytes_;
};

// Every function returns whether it succeeded.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}

  bool Size(std::size_t& number) { return Copy(&number, sizeof(number)); }

  // A number of things of which each takes so many bytes at least.
  bool Count(std::size_t bytes_each, std::size_t& count) {
    return Size(count) && count <= bytes_.size() / bytes_each;
  }

  bool Text(std::string& text) {
    std::size_t size = 0;
    if (!Count(1, size)) return false;
    text.assign(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return true;
  }

  bool Value(MatValue& value, int depth = 0) {
    std::size_t kind = 0;
    std::size_t integers = 0;
    std::size_t count = 0;
    if (depth > 2 * kDeepestNesting || !Size(kind) || kind > static_cast<std::size_t>(MatKind::kOther))
      return false;
    value.kind = static_cast<MatKind>(kind);
    if (!Size(integers) || !Count(sizeof(std::size_t), count)) return false;
    value.integers = integers != 0;
    value.shape.resize(count);
    if (!Copy(value.shape.data(), count * sizeof(std::size_t)) || !Count(sizeof(double), count)) return false;
    value.numbers.resize(count);
    if (!Copy(value.numbers.data(), count * sizeof(double)) || !Text(value.text) || !Text(value.other))
      return false;
    if (!Count(sizeof(std::size_t), count)) return false;
    value.fields.resize(count);
    for (std::string& field : value.fields) {
      if (!Text(field)) return false;
    }
    if (!Count(kSmallestValue, count)) return false;
    value.elements.resize(count);
    for (MatValue& element : value.elements) {
      if (!Value(element, depth + 1)) return false;
    }
    return IsConsistent(value);
  }

  [[nodiscard]] bool empty() const { return bytes_.empty(); }

 private:
  static constexpr std::size_t kSmallestValue = 8 * sizeof(std::size_t);

  bool Copy(void* to, std::size_t size) {
    if (size > bytes_.size()) return false;
    if (size != 0) std::memcpy(to, bytes_.data(), size);
    bytes_.remove_prefix(size);
    return true;
  }

  // What users of a MatValue rely on: sizes that do not overflow, as many elements as they say.
  static bool IsConsistent(const MatValue& value) {
    std::size_t product = 1;
    for (const std::size_t size : value.shape) {
      if (size != 0 && product > kMaxValues / size) return false;
      product *= size;
    }
    if (value.kind != MatKind::kOther && value.shape.size() < 2) return false;
    const std::size_t elements = value.elements.size();
    if (value.kind == MatKind::kStruct) return elements == product * value.fields.size();
    if (value.kind == MatKind::kCell) return elements == product;
    return elements == 0 && (value.numbers.empty() || value.numbers.size() == product);
  }

  std::string_view bytes_;
};

}  // namespace

std::string PackMat(const MatFile& file) {
  Packer packer;
  packer.Size(file.variables.size());
  for (const auto& [name, value] : file.variables) {
    packer.Text(name);
    packer.Value(value);
  }
  packer.Size(file.twice.size());
  for (const std::string& name : file.twice) packer.Text(name);
  return packer.Take();
}

std::optional<MatFile> UnpackMat(std::string_view bytes) {
  Unpacker unpacker(bytes);
  MatFile file;
  std::size_t count = 0;
  if (!unpacker.Count(1, count)) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) {
    std::string name;
    MatValue value;
    if (!unpacker.Text(name) || !unpacker.Value(value)) return std::nullopt;
    file.variables.emplace(std::move(name), std::move(value));
  }
  if (!unpacker.Count(1, count)) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) {
    std::string name;
    if (!unpacker.Text(name)) return std::nullopt;
    file.twice.insert(std::move(name));
  }
  if (!unpacker.empty()) return std::nullopt;
  return file;
}

}  // namespace sinew
