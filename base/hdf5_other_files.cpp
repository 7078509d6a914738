#include "base/hdf5_other_files.h"

#define H5_USE_110_API
#include <hdf5.h>

namespace sinew {
namespace {

herr_t RefuseLink(const char* /*file*/, const char* /*group*/, const char* /*other_file*/,
                  const char* /*object*/, unsigned* /*flags*/, hid_t /*access*/, void* /*data*/) {
  return -1;
}

herr_t CheckLink(hid_t group, const char* name, const H5L_info_t* /*link*/, void* status) {
  auto& result = *static_cast<Status*>(status);
  result = RefuseLinkToOtherFile(group, name, "/");
  return result ? 0 : 1;
}

herr_t CheckObject(hid_t root, const char* name, const H5O_info_t* object, void* status) {
  if (object->type != H5O_TYPE_DATASET) return 0;
  auto& result = *static_cast<Status*>(status);
  const hid_t dataset = H5Oopen(root, name, H5P_DEFAULT);
  if (dataset < 0) return -1;
  result = RefuseStorageInOtherFile(dataset, std::string("/") + name);
  H5Oclose(dataset);
  return result ? 0 : 1;
}

Status CheckEverything(hid_t file) {
  Status status;
  const bool visited = H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, CheckLink, &status) >= 0 &&
                       (!status || H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, CheckObject, &status) >= 0);
  if (!visited && status) return Fail("its groups cannot be read (truncated or damaged)");
  return status;
}

}  // namespace

std::int64_t AccessWithinThisFile() {
  const hid_t access = H5Pcreate(H5P_LINK_ACCESS);
  if (access < 0 || H5Pset_elink_cb(access, RefuseLink, nullptr) >= 0) return access;
  H5Pclose(access);
  return -1;
}

Status RefuseLinkToOtherFile(std::int64_t group, const std::string& name, const std::string& where) {
  H5L_info_t link;
  if (H5Lget_info(group, name.c_str(), &link, H5P_DEFAULT) < 0)
    return Fail("{}: member '{}' cannot be read (truncated file?)", where, name);
  if (link.type == H5L_TYPE_HARD || link.type == H5L_TYPE_SOFT) return {};
  return Fail("{}: member '{}' is a link to another file, expected the data themselves", where, name);
}

Status RefuseStorageInOtherFile(std::int64_t dataset, const std::string& where) {
  const hid_t made = H5Dget_create_plist(dataset);
  if (made < 0) return Fail("{}: cannot be read", where);
  const int files = H5Pget_external_count(made);
  const H5D_layout_t layout = H5Pget_layout(made);
  H5Pclose(made);
  if (files < 0 || layout == H5D_LAYOUT_ERROR) return Fail("{}: cannot be read", where);
  if (files == 0 && layout != H5D_VIRTUAL) return {};
  return Fail("{}: its numbers are in another file, expected them in this one", where);
}

void SilenceHdf5() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Status RefuseOtherFiles(const std::string& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) return Fail("{}: cannot be opened as HDF5 (truncated or damaged)", path);
  const Status status = CheckEverything(file);
  H5Fclose(file);
  if (!status) return Fail("{}: {}", path, status.error().message);
  return {};
}

}  // namespace sinew
