// Data sets and other HDF5 files of ours. What libhdf5 makes of damaged bytes is hdf5_file's matter; the
// other targets write a whole file with any content, and read that.
#include <functional>

#include "base/hdf5_tree.h"
#include "datasets/dataset_hash.h"
#include "datasets/io/dataset_file.h"
#include "identify/files/run_file.h"
#include "identify/files/study_resume.h"
#include "tests/fuzz/targets.h"
#include "tests/fuzz/tree_text.h"

namespace sinew::fuzz {
namespace {

constexpr const char* kAnyFile = "file.h5";

// Writing and reading a file takes a hundred times as long as looking at its content.
bool GoesThroughAFile(std::string_view bytes) {
  return std::hash<std::string_view>()(bytes) % 32 == 0;
}

// Whatever can be written is read as it was.
void DemandSameTree(const Hdf5Node& tree) {
  const std::string path = ScratchFolder() + "/file.h5";
  if (!Holds(WriteHdf5(path, tree), path)) return;
  const auto read = ReadHdf5(path);
  Demand(read.has_value(), "a file that was written cannot be read");
  Demand(ToText(*read) == ToText(tree), "a file has another content than what was written");
}

}  // namespace

void Hdf5File(std::string_view bytes) {
  const std::string path = Scratch("bytes.h5", bytes);
  Holds(ReadHdf5(path), path);
}

void DatasetFile(std::string_view bytes) {
  const Hdf5Node tree = ToTree(bytes);
  if (GoesThroughAFile(bytes)) DemandSameTree(tree);
  const auto data = DatasetOf(tree);
  if (!Holds(data, "/")) return;
  Demand(data->Check().has_value(), "a data set that was read is none");
  if (!GoesThroughAFile(bytes)) return;
  const std::string copy = ScratchFolder() + "/copy.h5";
  Demand(WriteDataset(copy, *data).has_value(), "a data set that was read cannot be written");
  const auto again = ReadDataset(copy);
  Demand(again && DatasetHash(*again) == DatasetHash(*data), "a data set changed when it was written");
}

void RunFile(std::string_view bytes) {
  const Hdf5Node tree = ToTree(bytes);
  if (GoesThroughAFile(bytes)) DemandSameTree(tree);
  const auto run = RecordedRunOf(kAnyFile, tree);
  if (!Holds(run, kAnyFile)) return;
  for (const TraceEntry& entry : run->record.trace())
    Demand(static_cast<std::size_t>(entry.x.size()) == run->variables.size(), "a point of the trace");
}

void StudyFile(std::string_view bytes) {
  const Hdf5Node tree = ToTree(bytes);
  if (GoesThroughAFile(bytes)) DemandSameTree(tree);
  // What it says that it was made from is what is asked for.
  const Hdf5Node* origin = tree.Find("study/origin");
  FitSetup setup;
  setup.parameters.resize(3);
  setup.free = {0, 2};
  setup.rest = Vector::Zero(3);
  const auto runs = files::StudyRunsOf(kAnyFile, tree, setup, origin == nullptr ? Hdf5Node() : *origin);
  if (!Holds(runs, "")) return;
  for (const StudyRun& run : *runs)
    Demand(!run.stop.usable() || run.parameters.size() == 3, "a run's parameters");
}

}  // namespace sinew::fuzz
