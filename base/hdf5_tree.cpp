#include "base/hdf5_tree.h"

#define H5_USE_110_API  // H5Oget_info has other arguments since 1.12
#include <hdf5.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>

#include "base/forked_trial.h"
#include "base/hdf5_other_files.h"
#include "base/printable.h"
#include "base/replace_file.h"
#include "base/text.h"
#include "base/value_limits.h"

namespace sinew {
namespace {

constexpr std::size_t kValuesPerNode = 64;  // values that a group or dataset itself counts as, for its memory
// What the trial of a file may take: libhdf5's buffers, and some copies of all values that the file can hold.
// A text of a megabyte to which a million texts refer would take all memory.
constexpr std::size_t kTrialMemory = std::size_t{1} << 28;  // [bytes]
constexpr std::size_t kTrialMemoryPerValue = 3 * sizeof(double);
constexpr std::size_t kImageGrowth = std::size_t{1} << 20;  // [bytes] by which a file grows while it is made

// Closes an HDF5 identifier at the end of its scope.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Handle() {
    if (id_ >= 0) closer_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  Closer closer_;
};

hid_t NewTextType() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

// ---- reading
// -------------------------------------------------------------------------------------------------------

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
    const Handle type(H5Tcopy(stored_type), H5Tclose);
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
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
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
    const Handle attribute(
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
  const Handle file(H5Iget_file_id(dataset), H5Fclose);
  if (!file || H5Fget_filesize(file.get(), &bytes) < 0 ||
      H5Dvlen_get_buf_size(dataset, type, space, &needed) < 0)
    return Fail("{}: its text cannot be read", where);
  if (needed > bytes + extent.count) return Fail("{}: announces more text than the file can hold", where);
  return {};
}

Status ReadDataset(hid_t dataset, const std::string& where, std::size_t& room, Hdf5Node& node) {
  SINEW_TRY(RefuseStorageInOtherFile(dataset, where));
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const Handle space(H5Dget_space(dataset), H5Sclose);
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

  const Handle inside(AccessWithinThisFile(), H5Pclose);
  H5G_info_t info;
  if (!inside || H5Gget_info(object, &info) < 0) return Fail("{}: cannot be read", where);
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto length =
        H5Lget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (length < 0) return Fail("{}: a member cannot be read", where);
    std::string name(static_cast<std::size_t>(length), '\0');
    H5Lget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size() + 1, H5P_DEFAULT);
    SINEW_TRY(RefuseLinkToOtherFile(object, name, where));
    const Handle member(H5Oopen(object, name.c_str(), inside.get()), H5Oclose);
    if (!member) return Fail("{}: member '{}' cannot be read (truncated file?)", where, name);
    SINEW_TRY(ReadNode(member.get(), where + (where.back() == '/' ? "" : "/") + name, depth + 1, room,
                       node.children[name]));
  }
  return {};
}

Result<Hdf5Node> ReadTree(const std::string& path) {
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file) return Fail("{}: cannot be opened as HDF5 (truncated or damaged)", path);
  const Handle group(H5Gopen2(file.get(), "/", H5P_DEFAULT), H5Gclose);
  if (!group) return Fail("{}: has no root group (damaged file)", path);
  hsize_t bytes = 0;
  if (H5Fget_filesize(file.get(), &bytes) < 0) return Fail("{}: its size cannot be read", path);
  std::size_t room = MostValues(bytes);
  Hdf5Node root;
  const Status status = ReadNode(group.get(), "/", 0, room, root);
  if (!status) return Fail("{}: {}", path, status.error().message);
  return root;
}

// ---- writing
// -------------------------------------------------------------------------------------------------------

bool WriteAttribute(hid_t object, const std::string& name, const Hdf5Attribute& value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  auto write = [&](hid_t type, const void* buffer) {
    const Handle attribute(H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    return attribute && H5Awrite(attribute.get(), type, buffer) >= 0;
  };
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return write(H5T_NATIVE_INT64, integer);
  if (const auto* number = std::get_if<double>(&value)) return write(H5T_NATIVE_DOUBLE, number);
  const Handle type(NewTextType(), H5Tclose);
  const char* pointer = std::get<std::string>(value).c_str();
  return write(type.get(), &pointer);
}

bool WriteNumbers(hid_t dataset, const std::vector<double>& values) {
  return values.empty() ||
         H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0;
}

bool WriteNode(hid_t parent, const std::string& name, const Hdf5Node& node);

bool WriteAttributes(hid_t object, const Hdf5Node& node) {
  for (const auto& [name, value] : node.attributes) {
    if (!WriteAttribute(object, name, value)) return false;
  }
  return true;
}

bool WriteGroup(hid_t group, const Hdf5Node& node) {
  if (!WriteAttributes(group, node)) return false;
  for (const auto& [name, child] : node.children) {
    if (!WriteNode(group, name, child)) return false;
  }
  return true;
}

bool WriteNode(hid_t parent, const std::string& name, const Hdf5Node& node) {
  const auto* array = node.array();
  const auto* view = std::get_if<Hdf5View>(&node.data);
  const auto* numbers = view != nullptr ? view->values : array != nullptr ? &array->values : nullptr;
  const auto* text = node.text();
  const auto* texts = node.texts();
  if (numbers == nullptr && text == nullptr && texts == nullptr) {
    const Handle group(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    return group && WriteGroup(group.get(), node);
  }

  std::vector<hsize_t> shape;
  if (array != nullptr) shape.assign(array->shape.begin(), array->shape.end());
  if (view != nullptr) shape.push_back(numbers->size());
  if (texts != nullptr) shape.push_back(texts->size());
  const Handle space(shape.empty() ? H5Screate(H5S_SCALAR)
                                   : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose);
  const Handle text_type(NewTextType(), H5Tclose);
  const hid_t type = numbers != nullptr ? H5T_NATIVE_DOUBLE : text_type.get();

  // Long arrays are compressed in one chunk per MiB.
  const Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(options.get(), false);  // so that equal content gives equal bytes
  if (numbers != nullptr && numbers->size() > 512) {
    std::vector<hsize_t> chunk = shape;
    const hsize_t row = static_cast<hsize_t>(numbers->size()) / shape[0];
    chunk[0] =
        std::max<hsize_t>(1, std::min<hsize_t>(shape[0], (hsize_t{1} << 17) / std::max<hsize_t>(1, row)));
    H5Pset_chunk(options.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_shuffle(options.get());
    H5Pset_deflate(options.get(), 4);
  }
  const Handle dataset(
      H5Dcreate2(parent, name.c_str(), type, space.get(), H5P_DEFAULT, options.get(), H5P_DEFAULT), H5Dclose);
  if (!dataset || !WriteAttributes(dataset.get(), node)) return false;
  if (numbers != nullptr) return WriteNumbers(dataset.get(), *numbers);
  std::vector<const char*> pointers;
  if (text != nullptr) pointers.push_back(text->c_str());
  if (texts != nullptr) {
    for (const std::string& piece : *texts) pointers.push_back(piece.c_str());
  }
  return pointers.empty() ||
         H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()) >= 0;
}

// The memory in which libhdf5 makes a file, which it hands over when the file is closed instead of freeing
// it: a second copy of a data set would be a gigabyte.
class Image {
 public:
  Image() = default;
  ~Image() { std::free(bytes_); }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  bool TakeFrom(hid_t file_access) {
    H5FD_file_image_callbacks_t callbacks{Allocate, Copy, Resize, Release, Same, Leave, this};
    return H5Pset_file_image_callbacks(file_access, &callbacks) >= 0;
  }
  void set_size(std::size_t size) { size_ = size; }
  [[nodiscard]] bool complete() const { return bytes_ != nullptr && size_ > 0; }
  [[nodiscard]] std::string_view bytes() const { return {static_cast<const char*>(bytes_), size_}; }

 private:
  static void* Allocate(std::size_t size, H5FD_file_image_op_t /*when*/, void* /*image*/) {
    return std::malloc(size);
  }
  static void* Copy(void* to, const void* from, std::size_t size, H5FD_file_image_op_t /*when*/,
                    void* /*image*/) {
    return std::memcpy(to, from, size);
  }
  static void* Resize(void* bytes, std::size_t size, H5FD_file_image_op_t /*when*/, void* /*image*/) {
    return std::realloc(bytes, size);
  }
  static herr_t Release(void* bytes, H5FD_file_image_op_t when, void* image) {
    if (when != H5FD_FILE_IMAGE_OP_FILE_CLOSE) std::free(bytes);
    if (when == H5FD_FILE_IMAGE_OP_FILE_CLOSE) static_cast<Image*>(image)->bytes_ = bytes;
    return 0;
  }
  static void* Same(void* image) { return image; }
  static herr_t Leave(void* /*image*/) { return 0; }

  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

// The bytes of the file. They are made in memory and written by ourselves: where the disk is full, libhdf5
// cannot close a file of its own, keeps it, and crashes on it when the process ends.
bool MakeImage(const Hdf5Node& root, Image& image) {
  const Handle in_memory(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (!in_memory || H5Pset_fapl_core(in_memory.get(), kImageGrowth, false) < 0 ||
      !image.TakeFrom(in_memory.get()))
    return false;
  // Nothing is made under this name, but libhdf5 first looks whether it can be opened.
  const Handle file(H5Fcreate("/dev/null/image.h5", H5F_ACC_TRUNC, H5P_DEFAULT, in_memory.get()), H5Fclose);
  if (!file) return false;
  {
    const Handle group(H5Gopen2(file.get(), "/", H5P_DEFAULT), H5Gclose);
    if (!group || !WriteGroup(group.get(), root)) return false;
  }
  if (H5Fflush(file.get(), H5F_SCOPE_GLOBAL) < 0) return false;
  const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
  if (size <= 0) return false;
  image.set_size(static_cast<std::size_t>(size));
  return true;
}

// HDF5 stores names and texts up to their first null byte. @return what is longer than that, or null
const std::string* FindCutOff(const Hdf5Node& node) {
  const auto cut = [](const std::string& text) { return text.find('\0') != std::string::npos; };
  for (const auto& [name, value] : node.attributes) {
    if (cut(name)) return &name;
    const auto* text = std::get_if<std::string>(&value);
    if (text != nullptr && cut(*text)) return text;
  }
  if (node.text() != nullptr && cut(*node.text())) return node.text();
  if (node.texts() != nullptr) {
    const auto found = std::find_if(node.texts()->begin(), node.texts()->end(), cut);
    if (found != node.texts()->end()) return &*found;
  }
  for (const auto& [name, child] : node.children) {
    if (cut(name)) return &name;
    if (const std::string* found = FindCutOff(child)) return found;
  }
  return nullptr;
}

}  // namespace

Hdf5Node& Hdf5Node::At(std::string_view path) {
  Hdf5Node* node = this;
  for (const std::string_view part : Split(path, '/')) {
    if (!part.empty()) node = &node->children[std::string(part)];
  }
  return *node;
}

const Hdf5Node* Hdf5Node::Find(std::string_view path) const {
  const Hdf5Node* node = this;
  for (const std::string_view part : Split(path, '/')) {
    if (part.empty()) continue;
    const auto child = node->children.find(std::string(part));
    if (child == node->children.end()) return nullptr;
    node = &child->second;
  }
  return node;
}

void Hdf5Node::SetVector(std::vector<double> values) {
  const std::size_t size = values.size();
  data = Hdf5Array{{size}, std::move(values)};
}

void Hdf5Node::SetScalar(double value) {
  data = Hdf5Array{{}, {value}};
}

void Hdf5Node::SetMatrix(std::size_t rows, std::size_t columns, std::vector<double> values) {
  data = Hdf5Array{{rows, columns}, std::move(values)};
}

double Hdf5Node::Number(const std::string& attribute, double fallback) const {
  const auto found = attributes.find(attribute);
  if (found == attributes.end()) return fallback;
  if (const auto* integer = std::get_if<std::int64_t>(&found->second)) return static_cast<double>(*integer);
  if (const auto* number = std::get_if<double>(&found->second)) return *number;
  return fallback;
}

std::string Hdf5Node::Text(const std::string& attribute, const std::string& fallback) const {
  const auto found = attributes.find(attribute);
  if (found == attributes.end()) return fallback;
  const auto* text = std::get_if<std::string>(&found->second);
  return text != nullptr ? *text : fallback;
}

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

Status WriteHdf5(const std::string& path, const Hdf5Node& root) {
  if (const std::string* cut = FindCutOff(root))
    return Fail("{}: cannot be made: '{}' contains a null byte, after which HDF5 stores nothing", path,
                PrintableLine(*cut));
  Image image;
  {
    const std::lock_guard lock(Hdf5Mutex());
    SilenceHdf5();
    if (!MakeImage(root, image) || !image.complete())
      return Fail("{}: cannot be made (too little memory?)", path);
  }
  return ReplaceFile(path, image.bytes());
}

}  // namespace sinew
