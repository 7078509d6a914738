// Made-up people for the tests of the emg_shape problems.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "problems/ankle_study/emg_shape_synthesis.h"
#include "problems/emg_shape/settings.h"

namespace sinew {

/// Three speeds, two muscles, no raw EMG and no moments unless `set` says so.
inline Dataset EmgStudy(std::map<std::string, double> set = {}, std::uint64_t seed = 1) {
  SynthesisRequest request;
  request.seed = seed;
  request.set = {{"speeds", 3}, {"muscles", 2}, {"raw", 0}, {"moments", 0}, {"train", 5}, {"validate", 2}};
  for (const auto& [name, value] : set) request.set[name] = value;
  auto data = SynthesizeEmgShape(request);
  EXPECT_TRUE(data) << data.error().message;
  return data ? std::move(*data) : Dataset();
}

inline EmgShapeSettings EmgSettings(const std::string& more = "") {
  const auto yaml = YamlReader::Parse("emg_shape: {angle: ankle_angle_r" + more + "}", "emg_shape.yaml");
  EXPECT_TRUE(yaml);
  auto settings = ReadEmgShapeSettings(yaml->At("emg_shape").value());
  EXPECT_TRUE(settings) << settings.error().message;
  return settings ? std::move(*settings) : EmgShapeSettings();
}

}  // namespace sinew
