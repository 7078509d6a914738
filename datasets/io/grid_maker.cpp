#include "datasets/io/grid_maker.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/text.h"
#include "base/value_limits.h"
#include "datasets/io/cells.h"
#include "datasets/io/sample_times.h"

namespace sinew {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

std::string Stem(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

Channel MakeChannel(const ColumnMeaning& meaning, std::vector<double> values) {
  Channel channel;
  channel.unit = meaning.unit;
  channel.kind = meaning.kind;
  channel.values = std::move(values);
  for (double& value : channel.values) {
    value *= meaning.factor;
    if (meaning.offset != 0) value += meaning.offset;
  }
  return channel;
}

// The map's entry for a channel, in addition to what its column states.
ColumnMeaning Refine(ColumnMeaning meaning, const MappedChannel& mapped) {
  if (mapped.unit) {
    meaning.unit = mapped.unit->si_unit;
    meaning.factor = mapped.unit->factor;
    meaning.offset = mapped.unit->offset;
    meaning.unit_is_known = true;
  }
  if (mapped.kind) meaning.kind = *mapped.kind;
  return meaning;
}

Channel MakeMappedChannel(const ColumnMeaning& refined, const MappedChannel& mapped,
                          std::vector<double> values) {
  ColumnMeaning scaled = refined;
  scaled.factor *= mapped.scale;
  Channel channel = MakeChannel(scaled, std::move(values));
  if (mapped.sigma) channel.sigma = *mapped.sigma * refined.factor;
  return channel;
}

Status AddChannel(const std::string& path, const std::string& name, Channel channel, Grid& grid) {
  if (grid.channels.count(name) != 0)
    return Fail("{}: two columns would become the channel '{}'", path, name);
  // One column may become many channels.
  if ((grid.channels.size() + 1) * channel.values.size() > kMaxValues)
    return Fail("{}: its channels would have more than {} values", path, kMaxValues);
  grid.channels.emplace(name, std::move(channel));
  return {};
}

std::string Listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMaximum = 6;
  const std::vector<std::string> first(names.begin(), names.begin() + std::min(names.size(), kMaximum));
  return Join(first, ", ") + (names.size() > kMaximum ? fmt::format(", ... ({})", names.size()) : "");
}

std::string GridName(StorageContent content, const std::string& path) {
  if (content == StorageContent::kForces) return "forces";
  if (content == StorageContent::kCoordinates) return "coordinates";
  return Stem(path);
}

}  // namespace

Result<NamedGrid> GridMaker::FromTrc(const std::string& path) {
  SINEW_ASSIGN(const TrcFile trc, ReadTrc(path));
  notes_.insert(notes_.end(), trc.notes.begin(), trc.notes.end());
  NamedGrid made{"markers", {trc.time, {}}};
  for (const TrcMarker& marker : trc.markers) {
    std::string name = marker.name;
    seen_markers_.push_back(name);
    if (options_.map) {
      const auto renamed = options_.map->markers.find(name);
      if (renamed != options_.map->markers.end()) {
        used_markers_.insert(name);
        name = renamed->second.name;
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto column = marker.position.col(axis);
      std::vector<double> values(column.data(), column.data() + column.size());
      SINEW_TRY(
          AddChannel(path, name + "_" + kAxes[axis], MakeChannel({name, "m"}, std::move(values)), made.grid));
    }
  }
  return made;
}

Result<NamedGrid> GridMaker::FromStorage(const std::string& path) {
  SINEW_ASSIGN(const Storage storage, ReadStorage(path));
  notes_.insert(notes_.end(), storage.notes.begin(), storage.notes.end());
  SINEW_ASSIGN(const PlateChannels plates, FindPlates(path, storage.names));
  StorageContent content = ClassifyStorage(storage, Stem(path), options_.coordinate_kind);
  if (!plates.empty()) content = StorageContent::kForces;
  if (content == StorageContent::kForces) NoteUnnamedPlates(path, plates, storage.names);
  if (content == StorageContent::kOther && storage.in_degrees.value_or(false)) {
    notes_.push_back(fmt::format(
        "{}: has inDegrees=yes, but its columns are no coordinates; they were not converted", path));
  }

  if (content == StorageContent::kOther && !storage.in_degrees) NoteUndeclaredAngles(path, storage);
  if (content == StorageContent::kCoordinates && !storage.in_degrees) {
    notes_.push_back(
        fmt::format("{}: has no inDegrees: its angles are taken as radians, as OpenSim does", path));
  }

  NamedGrid made{GridName(content, path), {storage.time, {}}};
  without_unit_.clear();
  for (std::size_t i = 0; i < storage.names.size(); ++i) {
    const std::string& column = storage.names[i];
    const auto plate = plates.find(column);
    const ColumnMeaning meaning =
        plate != plates.end()
            ? plate->second
            : MeaningOf(column, content, storage.in_degrees.value_or(false), options_.coordinate_kind);
    SINEW_TRY(AddColumn(path, column, meaning, storage.columns[i], made.grid));
  }
  if (!without_unit_.empty()) {
    notes_.push_back(fmt::format("{}: has no unit for {}; stored as they are with unit 1 (a map can give it)",
                                 path, Listed(without_unit_)));
  }
  return made;
}

Status GridMaker::AddColumn(const std::string& path, const std::string& column, const ColumnMeaning& meaning,
                            const std::vector<double>& values, Grid& grid) {
  seen_columns_.push_back(column);
  bool named = false;
  if (options_.map) {
    for (const auto& [name, mapped] : options_.map->channels) {
      if (mapped.column != column && mapped.column != meaning.channel) continue;
      if (mapped.time)
        return FailAt(options_.map->file, mapped.line,
                      "channel '{}' has a time of its own, which only a .mat can", name);
      const ColumnMeaning refined = Refine(meaning, mapped);
      if (!refined.unit_is_known) without_unit_.push_back(name);
      SINEW_TRY(AddChannel(path, name, MakeMappedChannel(refined, mapped, values), grid));
      used_channels_.insert(name);
      named = true;
    }
  }
  if (named) return {};
  if (!meaning.unit_is_known) without_unit_.push_back(meaning.channel);
  return AddChannel(path, meaning.channel, MakeChannel(meaning, values), grid);
}

Result<GridMaker::PlateChannels> GridMaker::FindPlates(const std::string& path,
                                                       const std::vector<std::string>& names) {
  std::vector<PlateColumns> plates;
  for (const PlatePrefix& prefix : options_.plates) {
    SINEW_ASSIGN(const auto columns, FindPlateColumns(prefix, names));
    if (columns) plates.push_back(*columns);
  }
  for (const ExternalForce& load : options_.external_loads) {
    if (!HasAxes(load.force_identifier, names)) continue;
    plates.push_back({load.name, load.force_identifier, load.point_identifier, load.torque_identifier});
  }

  PlateChannels channels;
  for (const PlateColumns& plate : plates) {
    const std::tuple<const std::string&, const char*, const char*> quantities[] = {
        {plate.force, "_force_", "N"}, {plate.point, "_cop_", "m"}, {plate.torque, "_moment_", "N*m"}};
    for (const auto& [identifier, word, unit] : quantities) {
      if (identifier.empty() || !HasAxes(identifier, names)) continue;
      for (const char* axis : kAxes) {
        const ColumnMeaning meaning{plate.plate + word + axis, unit};
        const auto [taken, is_new] = channels.emplace(identifier + axis, meaning);
        if (!is_new) {
          return Fail("{}: the column '{}' would belong to two plates ({} and {})", path, taken->first,
                      taken->second.channel, meaning.channel);
        }
      }
    }
    used_plates_.insert(plate.plate);
    NotePlate(path, plate, names);
  }
  return channels;
}

// A file that would hold coordinates if it said whether they are in degrees.
void GridMaker::NoteUndeclaredAngles(const std::string& path, const Storage& storage) {
  Storage declared;
  declared.title = storage.title;
  declared.names = storage.names;
  declared.in_degrees = false;
  if (ClassifyStorage(declared, Stem(path), options_.coordinate_kind) != StorageContent::kCoordinates) return;
  notes_.push_back(fmt::format(
      "{}: its columns are named like coordinates, but it has no inDegrees, and its name or values are "
      "not those of angles in radians; if they are angles, add inDegrees=yes or inDegrees=no to its header",
      path));
}

void GridMaker::NotePlate(const std::string& path, const PlateColumns& plate,
                          const std::vector<std::string>& names) {
  for (const auto& [identifier, what] :
       {std::pair<const std::string&, const char*>{plate.point, "centre of pressure"},
        std::pair<const std::string&, const char*>{plate.torque, "moment"}}) {
    if (identifier.empty() || !HasAxes(identifier, names)) {
      notes_.push_back(fmt::format("{}: plate '{}' has no columns for its {}", path, plate.plate, what));
    }
  }
}

void GridMaker::NoteUnnamedPlates(const std::string& path, const PlateChannels& plates,
                                  const std::vector<std::string>& names) {
  std::vector<std::string> unnamed;
  for (const std::string& name : names) {
    const std::string stem = name.substr(0, name.size() - 1);
    if (plates.count(name) == 0 && name.size() > 1 && name.back() == 'x' && stem.back() == 'v' &&
        HasAxes(stem, names)) {
      unnamed.push_back(stem);
    }
  }
  if (!unnamed.empty()) {
    notes_.push_back(fmt::format("{}: forces that no plate was named for keep their names: {}*", path,
                                 Join(unnamed, "*, ")));
  }
}

Result<const CsvColumn*> GridMaker::FindColumn(const std::string& path, const CsvTable& table,
                                               const std::string& name, long line) {
  const CsvColumn* found = nullptr;
  std::vector<std::string> names;
  for (const CsvColumn& column : table.columns) {
    names.push_back(column.name);
    if (column.name != name) continue;
    if (found != nullptr) return FailAt(path, table.header_line, "two columns are named '{}'", name);
    found = &column;
  }
  if (found == nullptr) {
    return FailAt(options_.map->file, line, "{} has no column '{}'{}", path, name, Suggestion(name, names));
  }
  if (found->text) {
    return FailAt(path, found->text->line, "column '{}': {} is not a number", name,
                  Quoted(found->text->cell));
  }
  return found;
}

Result<std::vector<double>> GridMaker::TimesOf(const std::string& path, const CsvTable& table,
                                               const MappedTime& mapped) {
  if (!mapped.rate_column.empty())
    return FailAt(options_.map->file, mapped.line,
                  "time: rate is {}, expected a number (only a .mat can hold the rate)",
                  Quoted(mapped.rate_column));
  if (mapped.rate) {
    std::vector<double> times(table.lines.size());
    for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<double>(i) / *mapped.rate;
    return times;
  }
  SINEW_ASSIGN(const CsvColumn* time, FindColumn(path, table, mapped.column, mapped.line));
  PrintedTimes printed;
  printed.lines = table.lines;
  for (const double value : time->values) printed.time_s.push_back(value * mapped.factor);
  constexpr int kMaxDecimals = 12;  // more digits than that: computed times, not rounded ones
  if (time->decimals <= kMaxDecimals) printed.last_digit_s = std::pow(10.0, -time->decimals) * mapped.factor;
  return UsableTimes(path, printed, notes_);
}

Result<NamedGrid> GridMaker::FromCsv(const std::string& path) {
  SINEW_ASSIGN(const CsvTable table, ReadCsv(path));
  std::vector<std::string> left_out;
  for (const CsvColumn& column : table.columns) left_out.push_back(column.name);
  if (!options_.map) {
    return Fail("{}: needs a map that assigns its columns to channels (they are {})", path, Listed(left_out));
  }
  const ImportMap& map = *options_.map;
  if (!map.time) return Fail("{}: has no time, expected for example time: {{column: t, unit: s}}", map.file);
  if (map.channels.empty()) return Fail("{}: names no channels for {}", map.file, path);

  NamedGrid made;
  made.name = Stem(path);
  SINEW_ASSIGN(made.grid.time, TimesOf(path, table, *map.time));
  auto use = [&](const std::string& column) {
    left_out.erase(std::remove(left_out.begin(), left_out.end(), column), left_out.end());
  };
  use(map.time->column);
  for (const auto& [name, mapped] : map.channels) {
    if (!mapped.unit) {
      return FailAt(map.file, mapped.line,
                    "channel '{}' has no unit; a .csv does not contain it (1 if there is none)", name);
    }
    if (mapped.time) {
      return FailAt(map.file, mapped.line,
                    "channel '{}' has a time of its own, which only a .mat can; a .csv has one time for all",
                    name);
    }
    SINEW_ASSIGN(const CsvColumn* column, FindColumn(path, table, mapped.column, mapped.line));
    SINEW_TRY(AddChannel(path, name, MakeMappedChannel(Refine({name, "1"}, mapped), mapped, column->values),
                         made.grid));
    used_channels_.insert(name);
    use(mapped.column);
  }
  if (!left_out.empty()) {
    notes_.push_back(
        fmt::format("{}: columns that the map does not name were left out: {}", path, Listed(left_out)));
  }
  return made;
}

Result<UnitConversion> GridMaker::UnitOf(const std::string& name, const MappedChannel& mapped,
                                         const MatColumn& column) {
  const std::string& file = options_.map->file;
  // Spike2's users write Deg and NM; where the case of letters makes a difference (mV, MV), it is kept.
  auto stated = ToSi(column.unit);
  if (!stated) stated = ToSi(Lowercase(column.unit));
  if (!mapped.unit) {
    if (column.unit.empty())
      return FailAt(file, mapped.line,
                    "channel '{}' has no unit; {} does not contain it (1 if there is none)", name,
                    column.where);
    if (!stated)
      return FailAt(file, mapped.line, "channel '{}' has no unit, and that of {} is not known: {}", name,
                    column.where, ToSi(column.unit).error().message);
    return *stated;
  }
  const bool differs =
      stated && (stated->si_unit != mapped.unit->si_unit || stated->factor != mapped.unit->factor);
  if (differs || (!stated && !column.unit.empty())) {
    notes_.push_back(fmt::format("{}: states the unit {}; that of the map was taken for channel '{}'",
                                 column.where, Quoted(column.unit), name));
  }
  return *mapped.unit;
}

Result<std::vector<NamedGrid>> GridMaker::FromMat(const std::vector<std::string>& paths) {
  const std::string& first = paths.front();
  if (!options_.map) {
    SINEW_ASSIGN(const MatFile file, ReadMat(first, {}));
    std::vector<std::string> there;
    for (const auto& [name, value] : file.variables) there.push_back(name + " (" + value.Describe() + ")");
    return Fail("{}: needs a map that assigns its variables to channels (they are {})", first, Listed(there));
  }
  const ImportMap& map = *options_.map;
  if (map.channels.empty()) return Fail("{}: names no channels for {}", map.file, first);
  SINEW_ASSIGN(MatRecording recording, MatRecording::Read(paths, map, notes_));
  std::vector<NamedGrid> grids;
  for (const auto& [name, mapped] : map.channels) {
    SINEW_ASSIGN(MatColumn column, recording.Channel(name, mapped, map.time));
    SINEW_ASSIGN(const UnitConversion unit, UnitOf(name, mapped, column));
    MappedChannel entry = mapped;
    entry.unit = unit;
    auto made = std::find_if(grids.begin(), grids.end(),
                             [&](const NamedGrid& other) { return other.grid.time == *column.time; });
    if (made == grids.end()) made = grids.insert(grids.end(), {name, {std::move(*column.time), {}}});
    SINEW_TRY(AddChannel(first, name,
                         MakeMappedChannel(Refine({name, "1"}, entry), entry, std::move(column.values)),
                         made->grid));
    used_channels_.insert(name);
  }
  if (grids.size() == 1) grids.front().name = Stem(first);
  const std::vector<std::string> left_out = recording.Unused();
  if (!left_out.empty()) {
    notes_.push_back(
        fmt::format("{}: variables that the map does not name were left out: {}", first, Listed(left_out)));
  }
  return grids;
}

Status GridMaker::CheckAllUsed() const {
  if (options_.map) {
    for (const auto& [name, marker] : options_.map->markers) {
      if (used_markers_.count(name) == 0) {
        return FailAt(options_.map->file, marker.line, "no file has a marker '{}'{}", name,
                      seen_markers_.empty() ? "" : Suggestion(name, seen_markers_));
      }
    }
    for (const auto& [name, mapped] : options_.map->channels) {
      if (used_channels_.count(name) == 0) {
        return FailAt(options_.map->file, mapped.line, "no file has a column '{}'{}", mapped.column,
                      seen_columns_.empty() ? "" : Suggestion(mapped.column, seen_columns_));
      }
    }
  }
  const auto missing = [&](const std::string& plate, const std::string& column) {
    return Fail("plate '{}': no file has columns {}{}", plate, column,
                seen_columns_.empty() ? "" : Suggestion(column, seen_columns_));
  };
  for (const PlatePrefix& prefix : options_.plates) {
    if (used_plates_.count(prefix.plate) == 0) return missing(prefix.plate, prefix.prefix + "force_vx");
  }
  for (const ExternalForce& load : options_.external_loads) {
    if (used_plates_.count(load.name) == 0) return missing(load.name, load.force_identifier + "x");
  }
  return {};
}

}  // namespace sinew
