#include "cli/data/model_file.h"

#include "base/read_file.h"

namespace sinew {

Result<ModelFile> OpenModel(const std::string& model, const std::string& path, Dataset& data) {
  constexpr const char* kModel = "model.osim";
  if (!model.empty()) {
    SINEW_ASSIGN(data.files[kModel], ReadFile(model));
  }
  const auto file = data.files.find(kModel);
  if (file == data.files.end()) return Fail("{}: holds no {}: expected --model M.osim", path, kModel);
  return ModelFile{file->second, model.empty() ? path + "/files/" + kModel : model};
}

}  // namespace sinew
