#include "problems/nms/ceinms/rt_recording.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "datasets/io/import.h"
#include "datasets/io/storage_file.h"
#include "problems/kit/coordinate_kinds.h"

namespace sinew {
namespace {

Result<Storage> ReadTable(const std::string& file, std::vector<std::string>& notes) {
  SINEW_ASSIGN(Storage table, ReadStorage(file));
  notes.insert(notes.end(), table.notes.begin(), table.notes.end());
  return table;
}

Status AddAngles(const std::string& file, const CeinmsRtReading& reading, Trial& trial,
                 std::vector<std::string>& notes) {
  ImportOptions options;
  options.trial = "trial";
  options.coordinate_kind = CoordinateKindsOf(reading.grids.model());
  Dataset data;
  SINEW_TRY(ImportFile(file, options, data, notes));
  const Grid* motion = reading.grids.FindMotion(data.trials["trial"]);
  for (const std::string& joint : reading.joints) {
    if (motion == nullptr || motion->channels.count(joint) == 0)
      return Fail("{}: there is no column '{}', expected the joint angles", file, joint);
  }
  trial.grids["coordinates"] = *motion;
  return {};
}

Status AddMoments(const std::string& file, const CeinmsRtReading& reading, Trial& trial,
                  std::vector<std::string>& notes) {
  SINEW_ASSIGN(const Storage table, ReadTable(file, notes));
  Grid& grid = trial.grids["moments"];
  grid.time = table.time;
  for (const std::string& joint : reading.joints) {
    const auto* column = table.Find(joint + "_moment");
    if (column == nullptr) column = table.Find(joint);
    if (column == nullptr)
      return Fail("{}: there is no column '{}_moment' or '{}'{}", file, joint, joint,
                  Suggestion(joint + "_moment", table.names));
    grid.channels[joint + "_moment"] = {"N*m", ChannelKind::kMeasured, {}, *column};
  }
  return {};
}

Status AddExcitations(const std::string& file, const CeinmsRtReading& reading, Trial& trial,
                      std::vector<std::string>& notes) {
  SINEW_ASSIGN(const Storage table, ReadTable(file, notes));
  Grid& grid = trial.grids["excitations"];
  for (const double time : table.time) grid.time.push_back(time + reading.emg_delay_s);
  for (const std::string& channel : reading.channels) {
    const auto* column = table.Find(channel);
    if (column == nullptr)
      return Fail("{}: there is no column '{}'{}", file, channel, Suggestion(channel, table.names));
    std::vector<double> values = *column;
    if (reading.filters != nullptr) {
      if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
        return Fail("{}: column '{}' has a gap: it cannot be filtered", file, channel);
      values = CeinmsRtEnvelope(*reading.filters, values);
    }
    grid.channels[channel] = {"1", ChannelKind::kInput, {}, std::move(values)};
  }
  return {};
}

}  // namespace

Result<Trial> ReadCeinmsRtRecording(const CeinmsRtFiles& files, const CeinmsRtReading& reading,
                                    std::vector<std::string>& notes) {
  Trial trial;
  SINEW_TRY(AddAngles(files.angles, reading, trial, notes));
  SINEW_TRY(AddMoments(files.moments, reading, trial, notes));
  SINEW_TRY(AddExcitations(files.emg, reading, trial, notes));
  return trial;
}

}  // namespace sinew
