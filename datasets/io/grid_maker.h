// Conversion of one file of measured data to one grid, by the import options.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "datasets/io/csv_file.h"
#include "datasets/io/import_options.h"
#include "datasets/io/mat_recording.h"
#include "datasets/io/storage_file.h"
#include "datasets/io/trc_file.h"

namespace sinew {

struct NamedGrid {
  std::string name;
  Grid grid;
};

/// Converts files to grids, and records which entries of the map and which plates were used. See ImportFiles.
class GridMaker {
 public:
  /// Both must outlive this object.
  GridMaker(const ImportOptions& options, std::vector<std::string>& notes)
      : options_(options), notes_(notes) {}

  Result<NamedGrid> FromTrc(const std::string& path);
  Result<NamedGrid> FromStorage(const std::string& path);
  Result<NamedGrid> FromCsv(const std::string& path);
  /// All MAT files of the trial at once, because one may hold the times of another's samples. Channels with
  /// the same times share a grid; if there are several, each has the name of its first channel.
  Result<std::vector<NamedGrid>> FromMat(const std::vector<std::string>& paths);

  /// Errors: a marker, channel or plate of the options that no file had: the first, with what the files do
  /// have.
  [[nodiscard]] Status CheckAllUsed() const;

 private:
  // A plate's columns by their name in the file.
  using PlateChannels = std::map<std::string, ColumnMeaning>;
  Result<PlateChannels> FindPlates(const std::string& path, const std::vector<std::string>& names);
  void NoteUndeclaredAngles(const std::string& path, const Storage& storage);
  void NotePlate(const std::string& path, const PlateColumns& plate, const std::vector<std::string>& names);
  void NoteUnnamedPlates(const std::string& path, const PlateChannels& plates,
                         const std::vector<std::string>& names);

  // Adds one column under the names that the map gives it, or under its own.
  Status AddColumn(const std::string& path, const std::string& column, const ColumnMeaning& meaning,
                   const std::vector<double>& values, Grid& grid);
  Result<std::vector<double>> TimesOf(const std::string& path, const CsvTable& table,
                                      const MappedTime& mapped);
  Result<UnitConversion> UnitOf(const std::string& name, const MappedChannel& mapped,
                                const MatColumn& column);
  Result<const CsvColumn*> FindColumn(const std::string& path, const CsvTable& table, const std::string& name,
                                      long line);

  const ImportOptions& options_;
  std::vector<std::string>& notes_;
  std::set<std::string> used_markers_;
  std::set<std::string> used_channels_;
  std::set<std::string> used_plates_;
  std::vector<std::string> seen_markers_;
  std::vector<std::string> seen_columns_;
  std::vector<std::string> without_unit_;  // channels of the present file
};

}  // namespace sinew
