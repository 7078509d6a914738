// Identifiers of libhdf5, for the files that read and write trees.
#pragma once

#define H5_USE_110_API  // H5Oget_info has other arguments since 1.12
#include <hdf5.h>

namespace sinew {

/// Closes an HDF5 identifier at the end of its scope.
class Hdf5Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Hdf5Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Hdf5Handle() {
    if (id_ >= 0) closer_(id_);
  }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  Closer closer_;
};

/// Type of a text of any length, in UTF-8; to be closed by H5Tclose.
inline hid_t NewHdf5Text() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

}  // namespace sinew
