// MAT files, and their import with a map.
#include "base/mat_file.h"
#include "datasets/io/import.h"
#include "tests/fuzz/targets.h"

namespace sinew::fuzz {
namespace {

constexpr const char* kMap = R"(time: {column: t, unit: s}
channels:
  one: {column: y, unit: V}
  two: {column: "S.values", unit: V, time: {rate: 100}}
  three: {column: Torque, unit: N*m}
)";

}  // namespace

void MatFile(std::string_view bytes) {
  const std::string path = Scratch("x.mat", bytes);
  const auto file = ReadMat(path, {"y", "t", "S"});
  if (!Holds(file, path)) return;
  ImportOptions options;
  options.map = *ParseImportMap(kMap, "map.yaml");
  for (const char* channel : {"", "one", "two", "three"}) {
    ImportOptions one = options;
    if (*channel != '\0') one.map->channels = {{channel, options.map->channels.at(channel)}};
    Dataset data;
    std::vector<std::string> notes;
    const Status imported = ImportFile(path, one, data, notes);
    if (imported) {
      Demand(data.Check().has_value(), "an imported data set is none");
    } else {
      Demand(!imported.error().message.empty() && data.trials.empty(), "a refused file changed the data set");
    }
  }
}

}  // namespace sinew::fuzz
