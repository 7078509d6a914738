// Reading of a tree: an untrusted file in a process of its own first.
#include <algorithm>
#include <filesystem>
#include <mutex>

#include "base/forked_trial.h"
#include "base/hdf5_handle.h"
#include "base/hdf5_other_files.h"
#include "base/hdf5_tree.h"
#include "base/printable.h"
#include "base/text.h"
#include "base/value_limits.h"

namespace sinew {
namespace {

constexpr std::size_t kValuesPerNode = 64;  // values that a group or dataset itself counts as, for its memory
// What the trial of a file may take: libhdf5's buffers, and some copies of all values that the file can hold.
// A text of a megabyte to which a million texts refer would take all memory.
constexpr std::size_t kTrialMemory = std::size_t{1} << 28;  // [bytes]
constexpr std::size_t kTrialMemoryPerValue = 3 * sizeof(double);

struct Extent {
  std::vector<std::size_t> shape;
  std::size_t count = 0;
};

Result<Extent> ReadExtent(hid_t space, const std::string& where) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || rank > 8) return Fail("{}: its shape cannot be read", where);
  std::vector<hsize_t> sizes(static_cast<std::size_t>(rank));
  if (rank > 0 && H5Sget_simple_extent_dims(space, sizes.data(), nullptr) < 0) {
    return Fail("{}: its shape cannot be read", where);
  }
  Extent extent;
  std::size_t count = 1;
  for (const hsize_t size : sizes) {
    if (size != 0 && count > kMaxValues / size) return Fail("{}: more than {} values", where, kMaxValues);
    count *= size;
    extent.shape.push_back(size);
  }
  extent.count = count;
  return extent;
}

// Reads text of fixed or variable length through `read`, which is H5Dread or H5Aread bound to its object.
template <class Read>
Result<std::vector<std::string>> ReadTexts(hid_t stored_type, hid_t space, std::size_t count, Read read,
                                           const std::string& where) {
  std::vector<std::string> texts;
  if (count == 0) return texts;
  const htri_t variable = H5Tis_variable_str(stored_type);
  if (variable > 0) {
    const Hdf5Handle type(H5Tcopy(stored_type), H5Tclose);
    std::vector<char*> pointers(count, nullptr);
    if (read(type.get(), pointers.data()) < 0) return Fail("{}: its text cannot be read", where);
    for (const char* pointer : pointers) texts.emplace_back(pointer != nullptr ? pointer : "");
    H5Dvlen_reclaim(type.get(), space, H5P_DEFAULT, pointers.data());
    return texts;
  }
  const std::size_t size = H5Tget_size(stored_type);
  if (size == 0 || size > kMaxValues / count) return Fail("{}: its text cannot be read", where);
  std::vector<char> bytes(size * count);
  if (read(stored_type, bytes.data()) < 0) return Fail("{}: its text cannot be read", where);
  for (std::size_t i = 0; i < count; ++i) {
    std::string_view piece(bytes.data() + i * size, size);
    piece = piece.substr(0, piece.find('\0'));
    texts.emplace_back(piece);
  }
  return texts;
}

Result<Hdf5Attribute> ReadAttribute(hid_t attribute, const std::string& where) {
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute), H5Sclose);
  if (!type || !space) return Fail("{}: cannot be read", where);
  SINEW_ASSIGN(const Extent extent, ReadExtent(space.get(), where));
  if (extent.count != 1) return Fail("{}: holds {} values, expected one", where, extent.count);
  switch (H5Tget_class(type.get())) {
    case H5T_INTEGER:
    case H5T_ENUM: {  // h5py writes a bool as an enum
      std::int64_t number = 0;
      if (H5Tget_class(type.get()) == H5T_ENUM) {
        signed char small = 0;
        if (H5Tget_size(type.get()) != 1 || H5Aread(attribute, type.get(), &small) < 0) {
          return Fail("{}: an enumeration that cannot be read", where);
        }
        return Hdf5Attribute(std::int64_t{small});
      }
      if (H5Aread(attribute, H5T_NATIVE_INT64, &number) < 0) return Fail("{}: cannot be read", where);
      return Hdf5Attribute(number);
    }
    case H5T_FLOAT: {
      double number = 0;
      if (H5Aread(attribute, H5T_NATIVE_DOUBLE, &number) < 0) return Fail("{}: cannot be read", where);
      return Hdf5Attribute(number);
    }
    case H5T_STRING: {
      auto read = [&](hid_t memory_type, void* buffer) { return H5Aread(attribute, memory_type, buffer); };
      SINEW_ASSIGN(const auto texts, ReadTexts(type.get(), space.get(), 1, read, where));
      return Hdf5Attribute(texts.front());
    }
    default:
      return Fail("{}: is neither a number nor text", where);
  }
}

Status ReadAttributes(hid_t object, const std::string& where, Hdf5Node& node) {
  H5O_info_t info;
  if (H5Oget_info(object, &info) < 0) return Fail("{}: cannot be read", where);
  for (hsize_t i = 0; i < info.num_attrs; ++i) {
    const Hdf5Handle attribute(
        H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!attribute) return Fail("{}: an attribute cannot be read", where);
    const ssize_t length = H5Aget_name(attribute.get(), 0, nullptr);
    if (length < 0) return Fail("{}: the name of an attribute cannot be read", where);
    std::string name(static_cast<std::size_t>(length), '\0');
    if (H5Aget_name(attribute.get(), name.size() + 1, name.data()) != length)
      return Fail("{}: the name of an attribute cannot be read", where);
    SINEW_ASSIGN(node.attributes[name], ReadAttribute(attribute.get(), where + " attribute '" + name + "'"));
  }
  return {};
}

// Subtracts the values from the number that the rest of the file can still hold: links back to their own
// group make an endless tree of a small file.
Status ReserveValues(std::size_t values, const std::string& where, std::size_t& room) {
  if (values > room) return Fail("{}: announces more values than the file can hold", where);
  room -= values;
  return {};
}

// Texts of variable length lie in the file once, uncompressed; many references to one would multiply it. (Of
// a scalar there is one, and libhdf5 1.10 writes beyond its memory when it is asked for the size of that.)
Status CheckTextSize(hid_t dataset, hid_t type, hid_t space, const Extent& extent, const std::string& where) {
  if (extent.shape.empty() || extent.count == 0 || H5Tis_variable_str(type) <= 0) return {};
  hsize_t needed = 0;
  hsize_t bytes = 0;
  const Hdf5Handle file(H5Iget_file_id(dataset), H5Fclose);
  if (!file || H5Fget_filesize(file.get(), &bytes) < 0 ||
      H5Dvlen_get_buf_size(dataset, type, space, &needed) < 0)
    return Fail("{}: its text cannot be read", where);
  if (needed > bytes + extent.count) return Fail("{}: announces more text than the file can hold", where);
  return {};
}

Status ReadDataset(hid_t dataset, const std::string& where, std::size_t& room, Hdf5Node& node) {
  SINEW_TRY(RefuseStorageInOtherFile(dataset, where));
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  if (!type || !space) return Fail("{}: cannot be read", where);
  SINEW_ASSIGN(const Extent extent, ReadExtent(space.get(), where));
  SINEW_TRY(ReserveValues(extent.count, where, room));
  switch (H5Tget_class(type.get())) {
    case H5T_INTEGER:
    case H5T_FLOAT: {
      Hdf5Array array{extent.shape, std::vector<double>(extent.count)};
      if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) < 0) {
        return Fail("{}: its numbers cannot be read (truncated file?)", where);
      }
      node.data = std::move(array);
      return {};
    }
    case H5T_STRING: {
      SINEW_TRY(CheckTextSize(dataset, type.get(), space.get(), extent, where));
      auto read = [&](hid_t memory_type, void* buffer) {
        return H5Dread(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
      };
      SINEW_ASSIGN(auto texts, ReadTexts(type.get(), space.get(), extent.count, read, where));
      if (extent.shape.empty() && texts.size() == 1) {
        node.data = std::move(texts.front());
      } else {
        node.data = std::move(texts);
      }
      return {};
    }
    default:
      return Fail("{}: holds neither numbers nor text", where);
  }
}

Status ReadNode(hid_t object, const std::string& where, int depth, std::size_t& room, Hdf5Node& node) {
  if (depth > kDeepestNesting) return Fail("{}: groups nested more than {} deep", where, kDeepestNesting);
  SINEW_TRY(ReserveValues(kValuesPerNode, where, room));
  SINEW_TRY(ReadAttributes(object, where, node));
  if (H5Iget_type(object) == H5I_DATASET) return ReadDataset(object, where, room, node);
  if (H5Iget_type(object) != H5I_GROUP) return {};  // a named type: no data

  const Hdf5Handle inside(AccessWithinThisFile(), H5Pclose);
  H5G_info_t info;
  if (!inside || H5Gget_info(object, &info) < 0) return Fail("{}: cannot be read", where);
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto length =
        H5Lget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (length < 0) return Fail("{}: a member cannot be read", where);
    std::string name(static_cast<std::size_t>(length), '\0');
    H5Lget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size() + 1, H5P_DEFAULT);
    SINEW_TRY(RefuseLinkToOtherFile(object, name, where));
    const Hdf5Handle member(H5Oopen(object, name.c_str(), inside.get()), H5Oclose);
    if (!member) return Fail("{}: member '{}' cannot be read (truncated file?)", where, name);
    SINEW_TRY(ReadNode(member.get(), where + (where.back() == '/' ? "" : "/") + name, depth + 1, room,
                       node.children[name]));
  }
  return {};
}

Result<Hdf5Node> ReadTree(const std::string& path) {
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file) return Fail("{}: cannot be opened as HDF5 (truncated or damaged)", path);
  const Hdf5Handle group(H5Gopen2(file.get(), "/", H5P_DEFAULT), H5Gclose);
  if (!group) return Fail("{}: has no root group (damaged file)", path);
  hsize_t bytes = 0;
  if (H5Fget_filesize(file.get(), &bytes) < 0) return Fail("{}: its size cannot be read", path);
  std::size_t room = MostValues(bytes);
  Hdf5Node root;
  const Status status = ReadNode(group.get(), "/", 0, room, root);
  if (!status) return Fail("{}: {}", path, status.error().message);
  return root;
}

}  // namespace

Result<Hdf5Node> ReadHdf5(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) return Fail("{}: no such file", path);
  if (std::filesystem::is_directory(path, code)) return Fail("{}: is a folder, expected an HDF5 file", path);
  if (!std::filesystem::is_regular_file(path, code))
    return Fail("{}: is a device, a pipe or a socket, expected an HDF5 file", path);
  const std::lock_guard lock(Hdf5Mutex());
  SilenceHdf5();
  if (H5Fis_hdf5(path.c_str()) <= 0) return Fail("{}: is not an HDF5 file", path);
  // libhdf5 1.10 does not check all sizes and offsets in a file. The tree is freed within the trial, so that
  // the allocator too finds what was overwritten.
  const auto read = [&]() -> Result<std::string> {
    SINEW_TRY(ReadTree(path));
    return std::string();
  };
  const std::size_t bytes = std::filesystem::file_size(path, code);
  if (code) return Fail("{}: cannot be read: {}", path, code.message());
  const std::size_t memory = kTrialMemory + kTrialMemoryPerValue * MostValues(bytes);
  SINEW_TRY(TryInOwnProcess(path, "HDF5", memory, read));
  return ReadTree(path);
}

}  // namespace sinew
