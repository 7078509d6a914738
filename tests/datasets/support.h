// What the tests of datasets share.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.h"
#include "datasets/dataset.h"

namespace sinew {

/// The message of a failure; empty for a success, so that a comparison with a message fails.
template <class T>
std::string ErrorOf(const Result<T>& result) {
  return result ? std::string() : result.error().message;
}

/// A folder of its own for each test, removed with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() / ("sinew_" + std::string(test->test_suite_name()) + "_" +
                                                      test->name() + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::string Path(const std::string& name) const { return (path_ / name).string(); }

  /// Writes a file and returns its path.
  [[nodiscard]] std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(Path(name), std::ios::binary) << text;
    return Path(name);
  }

 private:
  std::filesystem::path path_;
};

/// A dataset that uses everything a file can hold.
inline Dataset SmallDataset() {
  Dataset dataset;
  dataset.title = "walking";
  dataset.subject = "S1";
  dataset.source = "a laboratory";
  dataset.licence = "CC BY 4.0";
  dataset.synthetic = true;
  dataset.constants["body_mass"] = {72.6, "kg"};
  dataset.files["model.osim"] = "<OpenSimDocument/>\n";
  Trial& trial = dataset.trials["walk"];
  trial.role = Role::kValidate;
  trial.task = "level walking";
  trial.cut_from = "recording";
  trial.conditions["speed_m_per_s"] = 1.25;
  trial.grids["forces"].time = {0, 0.25, 0.5, 0.75, 1};
  trial.grids["forces"].channels["right_force_y"] = {
      "N", ChannelKind::kMeasured, 2.5, {0, 10, std::nan(""), 30, 40}};
  trial.grids["coordinates"].time = {-0.5, 0, 0.5, 1, 1.5};
  trial.grids["coordinates"].channels["knee_angle_r"] = {
      "rad", ChannelKind::kInput, {}, {0.1, 0.2, 0.3, 0.4, 0.5}};
  return dataset;
}

}  // namespace sinew
