// The import map: the YAML file of `sinew data import --map` with the meaning of columns.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "datasets/dataset.h"
#include "datasets/units.h"

namespace sinew {

/// The times of the samples: a column, or the rate where no column holds them: the first sample is then at 0
/// s.
struct MappedTime {
  std::string column;          ///< empty if there is a rate
  double factor = 1;           ///< to seconds
  std::optional<double> rate;  ///< [1/s, > 0]
  std::string rate_column;     ///< the variable of a .mat with the rate [1/s]
  long line = 0;
};

/// The source of one channel.
struct MappedChannel {
  std::string column;                  ///< its name in the file; a path within a .mat (ParseMatPath)
  std::optional<UnitConversion> unit;  ///< that the file's numbers have; .csv needs it
  std::optional<MappedTime> time;      ///< of a column of a .mat that is sampled unlike the others
  std::optional<ChannelKind> kind;     ///< measured, if nothing else is known
  double scale = 1;                    ///< the file's numbers are multiplied by it first; not 0
  std::optional<double> sigma;         ///< > 0, in the file's unit after `scale`
  long line = 0;                       ///< in the map
};

struct MappedMarker {
  std::string name;  ///< the new one
  long line = 0;
};

/// Time and channels of .csv and .mat; new names for markers of .trc and columns of .sto and .mot; and what
/// no file says.
struct ImportMap {
  std::string file;  ///< the map's own, for messages
  std::optional<MappedTime> time;
  std::map<std::string, MappedChannel> channels;  ///< by the name they get
  std::map<std::string, MappedMarker> markers;    ///< by the name they have
  std::map<std::string, Constant> constants;      ///< SI
  std::map<std::string, double> conditions;       ///< their unit is part of their name
  std::map<std::string, std::string> texts;  ///< title, subject, source, licence, task: those that are given
};

/// Reads a map:
///
///     time: {column: t, unit: s}     # or {rate: 148}, samples per second, where no column says it
///     channels: {position: {column: qm, unit: deg, kind: measured, scale: 1.0, sigma: 0.1}}
///                                    # and time: {...} in a channel of a .mat
///     markers: {R.ASIS: RASI}
///     constants: {gear_ratio: {value: 120, unit: "1"}}
///     conditions: {speed_rad_per_s: 0.52}
///
/// and the texts title, subject, source, licence and task. Without `column` a channel has its column's name.
/// Errors, with the line: not YAML, an unknown key (with a suggestion) or one that appears twice, an unknown
/// unit, a kind that is neither measured nor input, a value of the wrong type or range.
Result<ImportMap> ReadImportMap(const std::string& path);

/// ReadImportMap for a text in memory. @param file the name that errors show.
Result<ImportMap> ParseImportMap(std::string_view text, const std::string& file);

}  // namespace sinew
