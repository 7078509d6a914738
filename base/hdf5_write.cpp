// Writing of a tree: the file's bytes are made in memory, then put in the file's place at once.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "base/forked_trial.h"
#include "base/hdf5_handle.h"
#include "base/hdf5_other_files.h"
#include "base/hdf5_tree.h"
#include "base/printable.h"
#include "base/replace_file.h"

namespace sinew {
namespace {

constexpr std::size_t kImageGrowth = std::size_t{1} << 20;  // [bytes] by which a file grows while it is made

bool WriteAttribute(hid_t object, const std::string& name, const Hdf5Attribute& value) {
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  auto write = [&](hid_t type, const void* buffer) {
    const Hdf5Handle attribute(H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
    return attribute && H5Awrite(attribute.get(), type, buffer) >= 0;
  };
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return write(H5T_NATIVE_INT64, integer);
  if (const auto* number = std::get_if<double>(&value)) return write(H5T_NATIVE_DOUBLE, number);
  const Hdf5Handle type(NewHdf5Text(), H5Tclose);
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
    const Hdf5Handle group(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    return group && WriteGroup(group.get(), node);
  }

  std::vector<hsize_t> shape;
  if (array != nullptr) shape.assign(array->shape.begin(), array->shape.end());
  if (view != nullptr) shape.push_back(numbers->size());
  if (texts != nullptr) shape.push_back(texts->size());
  const Hdf5Handle space(shape.empty()
                             ? H5Screate(H5S_SCALAR)
                             : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                         H5Sclose);
  const Hdf5Handle text_type(NewHdf5Text(), H5Tclose);
  const hid_t type = numbers != nullptr ? H5T_NATIVE_DOUBLE : text_type.get();

  // Long arrays are compressed in one chunk per MiB.
  const Hdf5Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
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
  const Hdf5Handle dataset(
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
  const Hdf5Handle in_memory(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (!in_memory || H5Pset_fapl_core(in_memory.get(), kImageGrowth, false) < 0 ||
      !image.TakeFrom(in_memory.get()))
    return false;
  // Nothing is made under this name, but libhdf5 first looks whether it can be opened.
  const Hdf5Handle file(H5Fcreate("/dev/null/image.h5", H5F_ACC_TRUNC, H5P_DEFAULT, in_memory.get()),
                        H5Fclose);
  if (!file) return false;
  {
    const Hdf5Handle group(H5Gopen2(file.get(), "/", H5P_DEFAULT), H5Gclose);
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
