#include "datasets/io/import.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/text.h"
#include "datasets/io/grid_maker.h"
#include "datasets/io/text_file.h"

namespace sinew {
namespace {

enum class FileType { kTrc, kStorage, kCsv, kMat, kModel, kText, kUnknown };

FileType TypeOf(const std::string& path) {
  const std::string extension = Lowercase(std::filesystem::path(path).extension().string());
  if (extension == ".trc") return FileType::kTrc;
  if (extension == ".mot" || extension == ".sto") return FileType::kStorage;
  if (extension == ".csv" || extension == ".txt") return FileType::kCsv;
  if (extension == ".mat") return FileType::kMat;
  if (extension == ".osim") return FileType::kModel;
  if (extension == ".xml" || extension == ".yaml" || extension == ".yml" || extension == ".obj")
    return FileType::kText;
  return FileType::kUnknown;
}

bool HoldsData(const std::string& path) {
  const FileType type = TypeOf(path);
  return type == FileType::kTrc || type == FileType::kStorage || type == FileType::kCsv ||
         type == FileType::kMat;
}

bool HasNumber(const Grid& grid) {
  return std::any_of(grid.channels.begin(), grid.channels.end(), [](const auto& channel) {
    const auto& values = channel.second.values;
    return std::any_of(values.begin(), values.end(), [](double value) { return !std::isnan(value); });
  });
}

// Imports into a copy of the dataset, so that an error leaves the original as it was.
class Importer {
 public:
  Importer(const ImportOptions& options, Dataset dataset, std::vector<std::string>& notes)
      : options_(options), dataset_(std::move(dataset)), notes_(notes), maker_(options, notes) {}

  Result<Dataset> Import(const std::vector<std::string>& paths) {
    SINEW_TRY(OpenTrial(paths));
    for (const std::string& path : paths) SINEW_TRY(ImportOne(path));
    SINEW_TRY(ImportMat(paths));
    SINEW_TRY(maker_.CheckAllUsed());
    SINEW_TRY(ApplyMap());
    SINEW_TRY(dataset_.Check());
    NoteAmbiguousChannels();
    return std::move(dataset_);
  }

 private:
  Status OpenTrial(const std::vector<std::string>& paths) {
    trial_name_ = options_.trial;
    const auto first = std::find_if(paths.begin(), paths.end(), HoldsData);
    if (first == paths.end()) return {};  // texts only: they belong to all trials
    if (trial_name_.empty()) trial_name_ = std::filesystem::path(*first).stem().string();
    const bool exists = dataset_.trials.count(trial_name_) != 0;
    if (exists && !options_.append) return Fail("{}: there is a trial '{}' already", *first, trial_name_);
    trial_ = &dataset_.trials[trial_name_];
    if (options_.role) trial_->role = *options_.role;
    return {};
  }

  Status ImportOne(const std::string& path) {
    switch (TypeOf(path)) {
      case FileType::kTrc:
        return AddGrid(path, maker_.FromTrc(path));
      case FileType::kStorage:
        return AddGrid(path, maker_.FromStorage(path));
      case FileType::kCsv:
        return AddGrid(path, maker_.FromCsv(path));
      case FileType::kMat:
        return {};  // together, see ImportMat
      case FileType::kModel:
        return AddText(path, "model.osim");
      case FileType::kText:
        return AddText(path, std::filesystem::path(path).filename().string());
      case FileType::kUnknown:
        break;
    }
    return Fail(
        "{}: cannot be imported, expected .trc, .mot, .sto, .csv, .txt, .mat, .osim, .xml, .yaml or .obj",
        path);
  }

  Status ImportMat(const std::vector<std::string>& paths) {
    std::vector<std::string> files;
    for (const std::string& path : paths) {
      if (TypeOf(path) == FileType::kMat) files.push_back(path);
    }
    if (files.empty()) return {};
    SINEW_ASSIGN(std::vector<NamedGrid> grids, maker_.FromMat(files));
    for (NamedGrid& grid : grids) SINEW_TRY(AddGrid(files.front(), std::move(grid)));
    return {};
  }

  Status AddGrid(const std::string& path, Result<NamedGrid> made) {
    if (!made) return tl::unexpected(made.error());
    if (!HasNumber(made->grid)) return Fail("{}: holds no numbers, only gaps", path);
    const auto [existing, is_new] = trial_->grids.try_emplace(made->name, made->grid);
    if (is_new) return {};
    if (existing->second.time != made->grid.time) {
      return Fail("{}: trial '{}' has a grid '{}' with other times already; give this file another trial",
                  path, trial_name_, made->name);
    }
    for (auto& [name, channel] : made->grid.channels) {
      if (!existing->second.channels.emplace(name, std::move(channel)).second) {
        return Fail("{}: trial '{}' has a channel '{}' on grid '{}' already", path, trial_name_, name,
                    made->name);
      }
    }
    return {};
  }

  Status AddText(const std::string& path, const std::string& name) {
    SINEW_ASSIGN(std::string text, ReadTextFile(path));
    if (text.find('\0') != std::string::npos) return Fail("{}: holds bytes that are not text", path);
    const auto [existing, is_new] = dataset_.files.emplace(name, text);
    if (!is_new && existing->second != text)
      return Fail("{}: the dataset has another text '{}' already", path, name);
    return {};
  }

  Status ApplyMap() {
    if (!options_.map) return {};
    const ImportMap& map = *options_.map;
    for (const auto& [name, constant] : map.constants) {
      const auto [existing, is_new] = dataset_.constants.emplace(name, constant);
      if (!is_new && (existing->second.value != constant.value || existing->second.unit != constant.unit)) {
        return Fail("{}: constant '{}' is {} {}, the dataset has {} {} already", map.file, name,
                    constant.value, constant.unit, existing->second.value, existing->second.unit);
      }
    }
    for (auto [key, text] :
         {std::pair("title", &dataset_.title), std::pair("subject", &dataset_.subject),
          std::pair("source", &dataset_.source), std::pair("licence", &dataset_.licence)}) {
      const auto given = map.texts.find(key);
      if (given != map.texts.end()) *text = given->second;
    }
    const auto task = map.texts.find("task");
    if (trial_ == nullptr) {
      if (map.conditions.empty() && task == map.texts.end()) return {};
      return Fail("{}: has a task or conditions, but no file with data was given that they belong to",
                  map.file);
    }
    if (task != map.texts.end()) trial_->task = task->second;
    for (const auto& [name, value] : map.conditions) trial_->conditions[name] = value;
    return {};
  }

  void NoteAmbiguousChannels() {
    if (trial_ == nullptr) return;
    std::set<std::string> seen;
    std::set<std::string> twice;
    for (const std::string& name : trial_->ChannelNames()) {
      if (!seen.insert(name).second) twice.insert(name);
    }
    if (twice.empty()) return;
    notes_.push_back(fmt::format("trial '{}': {} channel names are on several grids, such as '{}'",
                                 trial_name_, twice.size(), *twice.begin()));
  }

  const ImportOptions& options_;
  Dataset dataset_;
  std::vector<std::string>& notes_;
  GridMaker maker_;
  std::string trial_name_;
  Trial* trial_ = nullptr;  // in dataset_
};

}  // namespace

Status ImportFiles(const std::vector<std::string>& paths, const ImportOptions& options, Dataset& dataset,
                   std::vector<std::string>& notes) {
  SINEW_ASSIGN(dataset, Importer(options, dataset, notes).Import(paths));
  return {};
}

Status ImportFile(const std::string& path, const ImportOptions& options, Dataset& dataset,
                  std::vector<std::string>& notes) {
  return ImportFiles({path}, options, dataset, notes);
}

}  // namespace sinew
