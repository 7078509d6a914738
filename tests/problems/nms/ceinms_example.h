// The CEINMS project of the shared data as a data set: three trials, eleven muscles, knee and ankle.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "datasets/dataset.h"
#include "datasets/io/storage_file.h"

namespace sinew {

inline std::string ExamplePath(const std::string& name) {
  return SINEW_SHARED_DATA "/ceinms_example/" + name;
}

inline std::string ExampleText(const std::string& name) {
  std::ifstream file(ExamplePath(name));
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline void AddExampleTable(const std::string& file, const std::string& unit, const std::string& grid,
                            Trial& trial) {
  const auto table = ReadStorage(ExamplePath(file));
  ASSERT_TRUE(table) << table.error().message;
  trial.grids[grid].time = table->time;
  for (std::size_t c = 0; c < table->names.size(); ++c)
    trial.grids[grid].channels[table->names[c]] = {unit, ChannelKind::kInput, {}, table->columns[c]};
}

/// @param subject true.xml or start.xml
inline Dataset CeinmsExample(const std::string& subject) {
  Dataset data;
  for (int i = 1; i <= 3; ++i) {
    const std::string folder = "trial" + std::to_string(i);
    Trial trial;
    trial.role = i < 3 ? Role::kTrain : Role::kValidate;
    AddExampleTable(folder + "/emg.mot", "1", "excitations", trial);
    AddExampleTable(folder + "/Length.sto", "m", "lengths", trial);
    for (const std::string joint : {"knee_angle_r", "ankle_angle_r"})
      AddExampleTable(folder + "/MomentArm_" + joint + ".sto", "m", "moment_arms." + joint, trial);
    AddExampleTable(folder + "/id.sto", "N*m", "moments", trial);
    data.trials[folder] = std::move(trial);
  }
  data.files["subject.xml"] = ExampleText(subject);
  return data;
}

}  // namespace sinew
