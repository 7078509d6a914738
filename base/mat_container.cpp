#include "base/mat_container.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace sinew {
namespace {

constexpr std::size_t kHeader = 128;       // [bytes] "MAT-File Format", MathWorks: text, subsystem, version
constexpr std::size_t kVersionAt = 124;    // 16 bits, then the letters MI in the order of the writer
constexpr std::size_t kTag = 8;            // [bytes] of an element: type and size, 32 bits each
constexpr std::uint32_t kMatrix = 14;      // miMATRIX
constexpr std::uint32_t kCompressed = 15;  // miCOMPRESSED
constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";
constexpr const char* kExpected = "expected a MAT file of version 5 or 7.3";

std::uint32_t Unsigned(std::string_view bytes, std::size_t at, std::size_t size, bool big_endian) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t from = at + (big_endian ? i : size - 1 - i);
    number = number << 8U | static_cast<unsigned char>(bytes[from]);
  }
  return number;
}

// A header of version 4 is five numbers: MOPT (byte order, 0, precision, kind as decimal digits), rows,
// columns, whether complex, length of the name, which follows.
bool IsVersion4(std::string_view bytes, bool big_endian) {
  constexpr std::size_t kHeader4 = 20;
  if (bytes.size() <= kHeader4) return false;
  const auto number = [&](std::size_t i) { return Unsigned(bytes, 4 * i, 4, big_endian); };
  const std::uint32_t type = number(0);
  const std::uint32_t length = number(4);
  constexpr std::uint32_t kLongestName = 64;
  if (type > 4052 || type / 100 % 10 != 0 || type / 10 % 10 > 5 || type % 10 > 2 || number(3) > 1)
    return false;
  if (length < 2 || length > kLongestName || bytes.size() < kHeader4 + length) return false;
  const std::string_view name = bytes.substr(kHeader4, length - 1);
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

// Whether the whole of a zlib stream is there and its checksum is right.
bool Inflates(std::string_view compressed) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return false;
  // zlib reads through this pointer only; its type is not const unless ZLIB_CONST is defined.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  stream.avail_in = static_cast<uInt>(compressed.size());
  std::array<Bytef, 1U << 16U> piece;
  int code = Z_OK;
  while (code == Z_OK) {
    stream.next_out = piece.data();
    stream.avail_out = static_cast<uInt>(piece.size());
    code = inflate(&stream, Z_NO_FLUSH);
  }
  inflateEnd(&stream);
  return code == Z_STREAM_END;
}

// The first bytes of a zlib stream.
std::string InflatedStart(std::string_view compressed) {
  constexpr std::size_t kEnough = 512;  // names are shorter than 64
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  stream.avail_in = static_cast<uInt>(compressed.size());
  std::string start(kEnough, '\0');
  stream.next_out = reinterpret_cast<Bytef*>(start.data());
  stream.avail_out = static_cast<uInt>(start.size());
  inflate(&stream, Z_SYNC_FLUSH);
  start.resize(start.size() - stream.avail_out);
  inflateEnd(&stream);
  return start;
}

// Takes the first element off; up to 4 bytes may stand within the tag itself. Nothing if it is not whole.
std::optional<std::string_view> TakeElement(std::string_view& bytes, bool big_endian) {
  if (bytes.size() < kTag) return std::nullopt;
  const std::uint32_t type = Unsigned(bytes, 0, 4, big_endian);
  const std::uint32_t size = type >> 16U != 0 ? type >> 16U : Unsigned(bytes, 4, 4, big_endian);
  const std::size_t begin = type >> 16U != 0 ? 4 : kTag;
  if (size > bytes.size() - begin) return std::nullopt;
  const std::string_view content = bytes.substr(begin, size);
  const std::size_t padded = begin == 4 ? kTag : kTag + (std::size_t{size} + kTag - 1) / kTag * kTag;
  bytes.remove_prefix(std::min(padded, bytes.size()));
  return content;
}

// Flags, name, "MCOS", class, reference: in place of flags, sizes, name, numbers.
std::optional<Mat5Object> ObjectIn(std::string_view matrix, bool big_endian) {
  constexpr std::uint32_t kOpaque = 17;
  const auto flags = TakeElement(matrix, big_endian);
  if (!flags || flags->size() < 4 || (Unsigned(*flags, 0, 4, big_endian) & 0xffU) != kOpaque)
    return std::nullopt;
  const auto name = TakeElement(matrix, big_endian);
  const auto system = TakeElement(matrix, big_endian);
  const auto class_name = TakeElement(matrix, big_endian);
  if (!name || !system || !class_name) return std::nullopt;
  return Mat5Object{std::string(*name), std::string(*class_name)};
}

}  // namespace

Result<MatVersion> FindMatVersion(std::string_view bytes, const std::string& file) {
  if (bytes.empty()) return Fail("{}: is empty, {}", file, kExpected);
  if (bytes.substr(0, kHdf5.size()) == kHdf5)
    return Fail("{}: is an HDF5 file without the header of a MAT file, {}", file, kExpected);
  if (bytes.size() >= kHeader) {
    const std::string_view order = bytes.substr(kVersionAt + 2, 2);
    if (order == "IM" || order == "MI") {
      const std::uint32_t version = Unsigned(bytes, kVersionAt, 2, order == "MI");
      if (version == 0x0100) return MatVersion::k5;
      if (version == 0x0200) return MatVersion::k73;
      return Fail("{}: is a MAT file of the unknown version {:#06x}, {}", file, version, kExpected);
    }
  }
  if (IsVersion4(bytes, false) || IsVersion4(bytes, true))
    return Fail("{}: is a MAT file of version 4, {} (in MATLAB: load it, then save with -v7)", file,
                kExpected);
  return Fail("{}: is not a MAT file, {}", file, kExpected);
}

Result<std::size_t> CountMat5Elements(std::string_view bytes, const std::string& file) {
  const bool big_endian = bytes.substr(kVersionAt + 2, 2) == "MI";
  if (bytes.size() == kHeader) return Fail("{}: holds no variables", file);
  std::size_t count = 0;
  for (std::size_t at = kHeader; at < bytes.size(); ++count) {
    if (bytes.size() - at < kTag)
      return Fail("{}: is truncated: its last element begins at byte {} of {}", file, at, bytes.size());
    const std::uint32_t type = Unsigned(bytes, at, 4, big_endian);
    const std::uint32_t size = Unsigned(bytes, at + 4, 4, big_endian);
    if (type != kMatrix && type != kCompressed)
      return Fail("{}: is damaged: the element at byte {} has the type {}, expected {} or {}", file, at, type,
                  kMatrix, kCompressed);
    const std::size_t begin = at + kTag;
    if (size > bytes.size() - begin)
      return Fail("{}: is truncated: the element at byte {} announces {} bytes, {} are there", file, at, size,
                  bytes.size() - begin);
    if (type == kCompressed && !Inflates(bytes.substr(begin, size)))
      return Fail(
          "{}: is damaged: the compressed element at byte {} disagrees with its checksum or ends early", file,
          at);
    at = begin + size;
  }
  return count;
}

std::vector<Mat5Object> FindMat5Objects(std::string_view bytes) {
  const bool big_endian = bytes.substr(kVersionAt + 2, 2) == "MI";
  std::vector<Mat5Object> objects;
  for (std::size_t at = kHeader; at + kTag <= bytes.size();) {
    const std::uint32_t type = Unsigned(bytes, at, 4, big_endian);
    const std::uint32_t size = Unsigned(bytes, at + 4, 4, big_endian);
    const std::string_view content = bytes.substr(at + kTag, size);
    const std::string inflated = type == kCompressed ? InflatedStart(content) : std::string();
    std::string_view matrix = type == kCompressed ? std::string_view(inflated) : content;
    if (type == kCompressed) matrix.remove_prefix(std::min(kTag, matrix.size()));
    if (auto object = ObjectIn(matrix, big_endian)) objects.push_back(std::move(*object));
    at += kTag + size;
  }
  return objects;
}

}  // namespace sinew
