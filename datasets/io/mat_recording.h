// The channels in the MAT files of one trial: arrays, fields of structs, and channels as Spike2 exports them.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/mat_file.h"
#include "datasets/io/import_map.h"
#include "datasets/io/mat_path.h"

namespace sinew {

/// One vector of numbers.
struct MatColumn {
  std::string where;  ///< "walk.mat: Torque.values", for messages
  std::vector<double> values;
  std::optional<std::vector<double>> time;  ///< [s] of the samples, if it brings them along
  std::string unit;                         ///< that the file states; empty if it states none
};

class MatRecording {
 public:
  /// Reads all files, and of their variables those that the map names. `notes` gets what was decided; both
  /// must outlive this object. Errors: those of ReadMat.
  static Result<MatRecording> Read(const std::vector<std::string>& paths, const ImportMap& map,
                                   std::vector<std::string>& notes);

  /// Samples and times of a channel; `entry` is that of the map, `time` what holds for it. Errors: no such
  /// variable, or in two files; a variable that is no vector of real numbers; infinite numbers; no times;
  /// times that are not as many as the samples, or do not increase.
  Result<MatColumn> Channel(const std::string& name, const MappedChannel& entry,
                            const std::optional<MappedTime>& time);

  /// Variables that no channel or time has used so far.
  [[nodiscard]] std::vector<std::string> Unused() const;

 private:
  struct Place {
    std::string where;  // with the file
    const MatValue* value = nullptr;
    std::size_t element = 0;      // of a struct array
    std::optional<MatStep> part;  // column or row of a matrix
  };

  MatRecording(const ImportMap& map, std::vector<std::string>& notes) : map_(&map), notes_(&notes) {}

  Result<Place> FindVariable(const std::string& column, const std::optional<MatPath>& path, long line);
  Result<Place> FindTitle(const std::string& column, long line) const;
  Result<Place> Follow(Place place, const MatPath& path, long line) const;
  Result<MatColumn> Column(const std::string& column, long line);
  Result<MatColumn> Sampled(const Place& place, long line);
  Result<std::vector<double>> Times(const MappedTime& time, std::size_t count);
  [[nodiscard]] std::string Files() const;

  const ImportMap* map_;
  std::vector<std::string>* notes_;
  std::vector<std::pair<std::string, MatFile>> files_;  // by path
  std::set<const MatValue*> used_;                      // variables
};

}  // namespace sinew
