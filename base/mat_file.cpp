#include "base/mat_file.h"

#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "base/forked_trial.h"
#include "base/hdf5_other_files.h"
#include "base/mat_container.h"
#include "base/mat_transfer.h"
#include "base/read_file.h"
#include "base/value_limits.h"

namespace sinew {
namespace {

constexpr int kMaxRank = 8;
constexpr std::size_t kMemoryPerValue = 6 * sizeof(double);  // libmatio's copy, its buffers, ours, and packed
constexpr std::size_t kWorkingMemory = std::size_t{1} << 26U;  // [bytes]
constexpr const char* kExpectedArray =
    "expected an array or a struct of arrays (in MATLAB: s = table2struct(t, 'ToScalar', true), then save s)";
constexpr const char* kUnknownClass =
    "is a table, a string, an object or a function of MATLAB, or was written by another program, ";

struct CloseFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using OpenFile = std::unique_ptr<mat_t, CloseFile>;
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

bool IsNumeric(int type) {
  return type >= MAT_C_DOUBLE && type <= MAT_C_UINT64;
}

// Checks the shape and that all numbers together are no more than a file of this size can hold.
Status TakeShape(const matvar_t& from, const std::string& where, std::size_t& room, MatValue& value) {
  if (from.rank < 0 || from.rank > kMaxRank || (from.rank > 0 && from.dims == nullptr))
    return Fail("{} has {} dimensions, expected at most {}", where, from.rank, kMaxRank);
  std::size_t count = 1;
  for (int i = 0; i < from.rank; ++i) {
    const std::size_t size = from.dims[i];
    if (size != 0 && count > kMaxValues / size) return Fail("{} has more than {} values", where, kMaxValues);
    count *= size;
    value.shape.push_back(size);
  }
  if (value.shape.empty()) value.shape = {0, 0};
  if (value.shape.size() == 1) value.shape.push_back(1);  // never of MATLAB
  if (value.count() > room) return Fail("{} announces more values than the file can hold", where);
  room -= value.count();
  return {};
}

template <class Number>
void Copy(const matvar_t& from, std::size_t count, std::vector<double>& to) {
  const auto* numbers = static_cast<const Number*>(from.data);
  to.reserve(count);
  for (std::size_t i = 0; i < count; ++i) to.push_back(static_cast<double>(numbers[i]));
}

Status TakeNumbers(const matvar_t& from, const std::string& where, MatValue& value) {
  const std::size_t count = value.count();
  if (count == 0) return {};
  const std::size_t size = Mat_SizeOfClass(from.class_type);
  if (from.data == nullptr || size == 0 || from.data_size != static_cast<int>(size) ||
      from.nbytes / size < count)
    return Fail("{} cannot be read (truncated or damaged)", where);
  switch (from.class_type) {
    case MAT_C_DOUBLE:
      Copy<double>(from, count, value.numbers);
      break;
    case MAT_C_SINGLE:
      Copy<float>(from, count, value.numbers);
      break;
    case MAT_C_INT8:
      Copy<std::int8_t>(from, count, value.numbers);
      break;
    case MAT_C_UINT8:
      Copy<std::uint8_t>(from, count, value.numbers);
      break;
    case MAT_C_INT16:
      Copy<std::int16_t>(from, count, value.numbers);
      break;
    case MAT_C_UINT16:
      Copy<std::uint16_t>(from, count, value.numbers);
      break;
    case MAT_C_INT32:
      Copy<std::int32_t>(from, count, value.numbers);
      break;
    case MAT_C_UINT32:
      Copy<std::uint32_t>(from, count, value.numbers);
      break;
    case MAT_C_INT64:
      Copy<std::int64_t>(from, count, value.numbers);
      break;
    default:
      Copy<std::uint64_t>(from, count, value.numbers);
  }
  return {};
}

void AppendUtf8(unsigned code, std::string& text) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xc0 | code >> 6U);
    text += static_cast<char>(0x80 | (code & 0x3fU));
  } else {
    text += static_cast<char>(0xe0 | code >> 12U);
    text += static_cast<char>(0x80 | (code >> 6U & 0x3fU));
    text += static_cast<char>(0x80 | (code & 0x3fU));
  }
}

// Bytes are taken as UTF-8, 16-bit units as characters of their own.
void TakeText(const matvar_t& from, MatValue& value) {
  if (from.data == nullptr) return;
  if (from.data_size == 1) {
    value.text.assign(static_cast<const char*>(from.data), from.nbytes);
  } else if (from.data_size == 2) {
    const auto* units = static_cast<const std::uint16_t*>(from.data);
    for (std::size_t i = 0; i < from.nbytes / 2; ++i) AppendUtf8(units[i], value.text);
  }
}

// Takes the description of a variable, and its content where `with_data`.
class Taker {
 public:
  Taker(std::size_t& room, bool with_data) : room_(room), with_data_(with_data) {}

  Status Take(const matvar_t& from, const std::string& where, int depth, MatValue& value) {
    if (depth > kDeepestNesting) return Fail("{} is nested more than {} deep", where, kDeepestNesting);
    if (from.class_type == MAT_C_SPARSE)
      return Other("is sparse, expected a full array (in MATLAB: full(x))", value);
    if (IsNumeric(from.class_type) && from.isComplex != 0)
      return Other("is complex, expected real numbers", value);
    if (IsNumeric(from.class_type) || from.class_type == MAT_C_CHAR) return TakeArray(from, where, value);
    if (from.class_type == MAT_C_STRUCT) return TakeStruct(from, where, depth, value);
    if (from.class_type == MAT_C_CELL) return TakeCell(from, where, depth, value);
    return Other(std::string(kUnknownClass) + kExpectedArray, value);
  }

 private:
  static Status Other(std::string what, MatValue& value) {
    value.kind = MatKind::kOther;
    value.other = std::move(what);
    return {};
  }

  Status TakeArray(const matvar_t& from, const std::string& where, MatValue& value) {
    value.kind = from.class_type == MAT_C_CHAR ? MatKind::kText : MatKind::kNumbers;
    value.integers = from.class_type >= MAT_C_INT8 && from.isLogical == 0;
    if (!with_data_) return TakeUnreadShape(from, value);
    SINEW_TRY(TakeShape(from, where, room_, value));
    if (value.kind == MatKind::kNumbers) return TakeNumbers(from, where, value);
    TakeText(from, value);
    return {};
  }

  // An array that is too large matters only to who wants it.
  static Status TakeUnreadShape(const matvar_t& from, MatValue& value) {
    std::size_t room = kMaxValues;
    const Status taken = TakeShape(from, "", room, value);
    if (taken) return {};
    value.shape.clear();
    return Other(taken.error().message.substr(1), value);
  }

  Status TakeStruct(const matvar_t& from, const std::string& where, int depth, MatValue& value) {
    value.kind = MatKind::kStruct;
    SINEW_TRY(TakeShape(from, where, room_, value));
    // libmatio's functions take a matvar_t* that they do not change.
    auto* variable = const_cast<matvar_t*>(&from);
    const std::size_t fields = Mat_VarGetNumberOfFields(variable);
    char* const* names = Mat_VarGetStructFieldnames(variable);
    if (fields > room_ || (fields > 0 && names == nullptr)) return Fail("{} cannot be read (damaged)", where);
    for (std::size_t f = 0; f < fields; ++f) value.fields.emplace_back(names[f] != nullptr ? names[f] : "");
    if (fields != 0 && value.count() > room_ / fields)
      return Fail("{} announces more values than the file can hold", where);
    value.elements.resize(value.count() * fields);
    for (std::size_t i = 0; i < value.elements.size(); ++i) {
      const matvar_t* field = Mat_VarGetStructFieldByIndex(variable, i % fields, i / fields);
      SINEW_TRY(TakeMember(field, where + "." + value.fields[i % fields], depth, value.elements[i]));
    }
    return {};
  }

  Status TakeCell(const matvar_t& from, const std::string& where, int depth, MatValue& value) {
    value.kind = MatKind::kCell;
    SINEW_TRY(TakeShape(from, where, room_, value));
    if (value.count() != 0 && from.data == nullptr) return Fail("{} cannot be read (damaged)", where);
    const auto* cells = static_cast<matvar_t* const*>(from.data);
    value.elements.resize(value.count());
    for (std::size_t i = 0; i < value.elements.size(); ++i)
      SINEW_TRY(TakeMember(cells[i], where + "{}", depth, value.elements[i]));
    return {};
  }

  // A member that was never given a value is an empty array.
  Status TakeMember(const matvar_t* member, const std::string& where, int depth, MatValue& value) {
    if (member != nullptr && member->class_type != MAT_C_EMPTY) return Take(*member, where, depth + 1, value);
    if (member != nullptr && member->rank > 0)
      return Other(std::string(kUnknownClass) + kExpectedArray, value);
    value.shape = {0, 0};
    return {};
  }

  std::size_t& room_;
  bool with_data_;
};

// Whether all sizes within it are possible, before libmatio asks for memory.
Status CheckSizes(const matvar_t& variable, std::size_t bytes) {
  std::size_t room = MostValues(bytes);
  const std::function<Status(const matvar_t&, const std::string&, int)> check =
      [&](const matvar_t& part, const std::string& where, int depth) -> Status {
    if (depth > kDeepestNesting) return Fail("{} is nested more than {} deep", where, kDeepestNesting);
    if (part.rank == 0) return {};
    MatValue shape;
    SINEW_TRY(TakeShape(part, where, room, shape));
    const bool is_struct = part.class_type == MAT_C_STRUCT;
    if (part.data == nullptr || (!is_struct && part.class_type != MAT_C_CELL)) return {};
    const auto* members = static_cast<matvar_t* const*>(part.data);
    auto* whole = const_cast<matvar_t*>(&part);
    const std::size_t count = shape.count() * (is_struct ? Mat_VarGetNumberOfFields(whole) : 1);
    for (std::size_t i = 0; i < count; ++i) {
      if (members[i] != nullptr) SINEW_TRY(check(*members[i], where, depth + 1));
    }
    return {};
  };
  return check(variable, fmt::format("variable '{}'", variable.name), 0);
}

bool HasTitle(const MatValue& value) {
  return value.kind == MatKind::kStruct && value.Field("title") != nullptr;
}

class Reader {
 public:
  Reader(const std::string& path, std::size_t bytes) : path_(path), bytes_(bytes) {}

  Result<MatFile> Read(const std::set<std::string>& wanted, std::size_t elements) {
    MatFile found;
    std::size_t room = kMaxValues;
    const auto list = [&](mat_t* /*file*/, matvar_t& variable) -> Status {
      MatValue value;
      SINEW_TRY(Taker(room, false).Take(variable, Where(variable), 0, value));
      if (!found.variables.emplace(variable.name, std::move(value)).second) found.twice.insert(variable.name);
      return {};
    };
    SINEW_ASSIGN(const std::size_t count, ForEach(list));
    if (count < elements)
      return Fail("{}: is damaged: {} of {} variables can be read", path_, count, elements);
    const bool titles = std::any_of(wanted.begin(), wanted.end(), [&](const std::string& name) {
      return found.variables.count(name) == 0;
    });
    std::set<std::string> done;
    room = MostValues(bytes_);
    const auto read = [&](mat_t* file, matvar_t& variable) -> Status {
      MatValue& value = found.variables[variable.name];
      if (wanted.count(variable.name) == 0 && !(titles && HasTitle(value))) return {};
      if (value.kind == MatKind::kOther || !done.insert(variable.name).second) return {};
      SINEW_TRY(CheckSizes(variable, bytes_));
      if (Mat_VarReadDataAll(file, &variable) != 0)
        return Fail("{} cannot be read (truncated or damaged)", Where(variable));
      value = MatValue();
      return Taker(room, true).Take(variable, Where(variable), 0, value);
    };
    SINEW_TRY(ForEach(read));
    return found;
  }

 private:
  static std::string Where(const matvar_t& variable) { return fmt::format("variable '{}'", variable.name); }

  // Calls visit for each named variable; returns how many elements the file has. MATLAB's own ones have no
  // name, or one that begins with #.
  Result<std::size_t> ForEach(const std::function<Status(mat_t*, matvar_t&)>& visit) const {
    const OpenFile file(Mat_Open(path_.c_str(), MAT_ACC_RDONLY));
    if (file == nullptr) return Fail("{}: cannot be opened as a MAT file (truncated or damaged)", path_);
    std::size_t count = 0;
    while (true) {
      const Variable variable(Mat_VarReadNextInfo(file.get()));
      if (variable == nullptr) return count;
      ++count;
      const char* name = variable->name;
      if (name == nullptr || *name == '\0' || *name == '#') continue;
      const Status visited = visit(file.get(), *variable);
      if (!visited) return Fail("{}: {}", path_, visited.error().message);
    }
  }

  const std::string& path_;
  std::size_t bytes_;
};

}  // namespace

std::size_t MatValue::count() const {
  std::size_t product = 1;
  for (const std::size_t size : shape) product *= size;
  return product;
}

std::string MatValue::Describe() const {
  if (kind == MatKind::kOther) return "unreadable";
  std::string sizes;
  for (const std::size_t size : shape) sizes += (sizes.empty() ? "" : " x ") + std::to_string(size);
  const char* what = kind == MatKind::kNumbers  ? "numbers"
                     : kind == MatKind::kText   ? "text"
                     : kind == MatKind::kStruct ? "struct"
                                                : "cells";
  return sizes + " " + what;
}

const MatValue* MatValue::Field(const std::string& name, std::size_t element) const {
  const auto found = std::find(fields.begin(), fields.end(), name);
  if (found == fields.end() || element >= count()) return nullptr;
  return &elements[element * fields.size() + static_cast<std::size_t>(found - fields.begin())];
}

Result<MatFile> ReadMat(const std::string& path, const std::set<std::string>& wanted) {
  constexpr std::size_t kHeader = 512;  // [bytes] before the content of version 7.3, which may have many GB
  SINEW_ASSIGN(std::string bytes, ReadFileStart(path, kHeader));
  SINEW_ASSIGN(const MatVersion version, FindMatVersion(bytes, path));
  if (version == MatVersion::k5) {
    SINEW_ASSIGN(bytes, ReadFile(path));
  }
  std::error_code code;
  const std::size_t size = std::filesystem::file_size(path, code);
  if (code) return Fail("{}: cannot be read: {}", path, code.message());
  const auto read = [&]() -> Result<std::string> {
    std::size_t elements = 0;  // not known of version 7.3
    if (version == MatVersion::k73) {
      SINEW_TRY(RefuseOtherFiles(path));
    } else {
      SINEW_ASSIGN(elements, CountMat5Elements(bytes, path));
    }
    Reader reader(path, size);
    SINEW_ASSIGN(const MatFile file, reader.Read(wanted, elements));
    return PackMat(file);
  };
  const std::size_t memory = kWorkingMemory + kMemoryPerValue * MostValues(size);
  const std::lock_guard lock(Hdf5Mutex());
  SilenceHdf5();
  SINEW_ASSIGN(const std::string packed, TryInOwnProcess(path, "libmatio", memory, read));
  auto unpacked = UnpackMat(packed);
  if (!unpacked) return Fail("{}: is damaged (libmatio could not read it)", path);
  MatFile& found = *unpacked;
  if (version == MatVersion::k73) return std::move(found);
  for (const Mat5Object& object : FindMat5Objects(bytes)) {
    MatValue& value = found.variables[object.name];
    value.kind = MatKind::kOther;
    value.other =
        fmt::format("is a '{}', an object that MATLAB alone can read, {}", object.class_name, kExpectedArray);
  }
  return std::move(found);
}

}  // namespace sinew
