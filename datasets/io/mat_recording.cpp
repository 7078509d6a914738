#include "datasets/io/mat_recording.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "datasets/io/cells.h"

namespace sinew {
namespace {

std::set<std::string> NamesIn(const ImportMap& map) {
  std::set<std::string> names;
  const auto add = [&](const std::string& column) {
    if (column.empty()) return;
    const auto path = ParseMatPath(column);
    names.insert(path ? path->variable : column);
  };
  const auto add_time = [&](const std::optional<MappedTime>& time) {
    if (!time) return;
    add(time->column);
    add(time->rate_column);
  };
  add_time(map.time);
  for (const auto& [name, channel] : map.channels) {
    add(channel.column);
    add_time(channel.time);
  }
  return names;
}

// The text in a field of a struct; empty if there is none.
std::string TextIn(const MatValue& value, const std::string& field, std::size_t element) {
  const MatValue* text = value.Field(field, element);
  return text != nullptr && text->kind == MatKind::kText ? std::string(Trim(text->text)) : "";
}

// The number in a field of a struct, if there is a single one.
std::optional<double> NumberIn(const MatValue& value, const std::string& field, std::size_t element) {
  const MatValue* number = value.Field(field, element);
  if (number == nullptr || number->numbers.size() != 1) return std::nullopt;
  return number->numbers.front();
}

// All numbers of a vector, or one column or row of a matrix.
Result<std::vector<double>> VectorOf(const MatValue& value, const std::string& where,
                                     const std::optional<MatStep>& part) {
  if (value.kind == MatKind::kOther) return Fail("{} {}", where, value.other);
  if (value.kind != MatKind::kNumbers)
    return Fail("{} is {}, expected a vector of numbers", where, value.Describe());
  if (value.count() == 0) return Fail("{} is empty, expected a vector of numbers", where);
  const std::size_t rows = value.shape[0];
  const std::size_t columns = value.count() / rows;
  if (value.shape.size() > 2 && columns != value.shape[1])
    return Fail("{} has {} dimensions ({}), expected a vector", where, value.shape.size(), value.Describe());
  if (!part) {
    if (rows == 1 || columns == 1) return value.numbers;
    const bool long_columns = rows >= columns;
    return Fail("{} has {}, expected a vector; name a {} of it: {} to {}", where, value.Describe(),
                long_columns ? "column" : "row", long_columns ? "(:,1)" : "(1,:)",
                long_columns ? fmt::format("(:,{})", columns) : fmt::format("({},:)", rows));
  }
  const bool column = part->kind == MatStep::Kind::kColumn;
  const std::size_t there = column ? columns : rows;
  if (part->index >= there)
    return Fail("{} has {}: there is no {} {}", where, value.Describe(), column ? "column" : "row",
                part->index + 1);
  std::vector<double> picked;
  for (std::size_t i = 0; i < (column ? rows : columns); ++i)
    picked.push_back(value.numbers[column ? i + part->index * rows : part->index + i * rows]);
  return picked;
}

Status CheckNotInfinite(const std::vector<double>& values, const std::string& where) {
  const auto infinite = std::find_if(values.begin(), values.end(), [](double x) { return std::isinf(x); });
  if (infinite == values.end()) return {};
  return Fail("{}: element {} is infinite; a gap is NaN", where, infinite - values.begin() + 1);
}

Status CheckIncreases(const std::vector<double>& time, const std::string& where) {
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i])) return Fail("{}: element {} is {}, expected a time", where, i + 1, time[i]);
    if (i > 0 && time[i] <= time[i - 1])
      return Fail("{}: element {} ({} s) does not increase, the one before is {} s", where, i + 1, time[i],
                  time[i - 1]);
  }
  return {};
}

}  // namespace

Result<MatRecording> MatRecording::Read(const std::vector<std::string>& paths, const ImportMap& map,
                                        std::vector<std::string>& notes) {
  MatRecording recording(map, notes);
  const std::set<std::string> names = NamesIn(map);
  for (const std::string& path : paths) {
    SINEW_ASSIGN(MatFile file, ReadMat(path, names));
    recording.files_.emplace_back(path, std::move(file));
  }
  return recording;
}

std::string MatRecording::Files() const {
  std::vector<std::string> paths;
  for (const auto& [path, file] : files_) paths.push_back(path);
  return Join(paths, " and ");
}

Result<MatRecording::Place> MatRecording::FindTitle(const std::string& column, long line) const {
  Place found;
  std::string variable;
  std::vector<std::string> there;
  for (const auto& [path, file] : files_) {
    for (const auto& [name, value] : file.variables) {
      there.push_back(name);
      if (value.kind != MatKind::kStruct || value.count() != 1) continue;
      const std::string title = TextIn(value, "title", 0);
      if (!title.empty() && title != name) there.push_back(title);
      if (title != column) continue;
      if (found.value != nullptr)
        return FailAt(map_->file, line, "two channels of {} have the title {}: {} and {}; name the variable",
                      path, Quoted(column), variable, name);
      found.value = &value;
      found.where = path + ": " + name;
      variable = name;
    }
  }
  if (found.value != nullptr) return found;
  return FailAt(map_->file, line, "{} {} no variable and no title {}{}", Files(),
                files_.size() > 1 ? "have" : "has", Quoted(column),
                there.empty() ? "; there are none" : "; there are " + ByLikeness(column, there));
}

Result<MatRecording::Place> MatRecording::FindVariable(const std::string& column,
                                                       const std::optional<MatPath>& path, long line) {
  Place found;
  std::string file_found;
  for (const auto& [name, file] : files_) {
    const auto variable = path ? file.variables.find(path->variable) : file.variables.end();
    if (variable == file.variables.end()) continue;
    if (file.twice.count(path->variable) != 0)
      return Fail("{}: two variables are named {}", name, Quoted(path->variable));
    if (found.value != nullptr)
      return FailAt(map_->file, line, "{} and {} have a variable {} both, expected it in one of them",
                    file_found, name, Quoted(path->variable));
    found.value = &variable->second;
    found.where = name + ": " + path->variable;
    file_found = name;
  }
  if (found.value == nullptr) {
    SINEW_ASSIGN(found, FindTitle(column, line));
    used_.insert(found.value);
    return found;
  }
  used_.insert(found.value);
  return Follow(std::move(found), *path, line);
}

Result<MatRecording::Place> MatRecording::Follow(Place place, const MatPath& path, long line) const {
  const std::string file = place.where.substr(0, place.where.size() - path.variable.size());
  bool indexed = false;
  for (const MatStep& step : path.steps) {
    const MatValue& value = *place.value;
    if (value.kind == MatKind::kOther) return Fail("{} {}", place.where, value.other);
    if (step.kind == MatStep::Kind::kField) {
      if (value.kind != MatKind::kStruct)
        return FailAt(map_->file, line, "{} is {}, it has no field '{}'", place.where, value.Describe(),
                      step.name);
      if (value.count() != 1 && !indexed)
        return FailAt(map_->file, line, "{} is {}, expected which of them: {}(1).{}", place.where,
                      value.Describe(), place.where.substr(file.size()), step.name);
      place.value = value.Field(step.name, place.element);
      if (place.value == nullptr)
        return FailAt(map_->file, line, "{} has no field {}; there are {}", place.where, Quoted(step.name),
                      ByLikeness(step.name, value.fields));
      place.element = 0;
      indexed = false;
    } else if (step.kind == MatStep::Kind::kElement) {
      const bool cell = value.kind == MatKind::kCell;
      if ((!cell && value.kind != MatKind::kStruct) || indexed)
        return FailAt(map_->file, line, "{} is {}; a column of a matrix is written as (:,{})", place.where,
                      value.Describe(), step.index + 1);
      if (step.index >= value.count())
        return FailAt(map_->file, line, "{} is {}, it has no element {}", place.where, value.Describe(),
                      step.index + 1);
      if (cell) place.value = &value.elements[step.index];
      if (!cell) place.element = step.index;
      indexed = !cell;
    } else {
      place.part = step;
    }
    if (!place.part) place.where = file + step.written;
  }
  return place;
}

Result<MatColumn> MatRecording::Sampled(const Place& place, long line) {
  const MatValue& value = *place.value;
  const auto field = [&](const char* name) { return value.Field(name, place.element); };
  const MatValue* values = field("values");
  const MatValue* times = field("times");
  const auto interval = NumberIn(value, "interval", place.element);
  if (value.count() == 0 || (times == nullptr && (values == nullptr || !interval)))
    return FailAt(map_->file, line,
                  "{} is {} without values and interval or times; name one of its fields: {}", place.where,
                  value.Describe(), ByLikeness("values", value.fields));
  MatColumn column;
  column.where = place.where;
  column.unit = TextIn(value, "units", place.element);
  if (times != nullptr) {
    SINEW_ASSIGN(column.time, VectorOf(*times, place.where + ".times", std::nullopt));
    SINEW_TRY(CheckIncreases(*column.time, place.where + ".times"));
  }
  if (values == nullptr) {  // events
    column.values.assign(column.time->size(), 1);
    column.unit = "1";
    return column;
  }
  SINEW_ASSIGN(column.values, VectorOf(*values, place.where + ".values", place.part));
  const auto scale = NumberIn(value, "scale", place.element);
  const auto offset = NumberIn(value, "offset", place.element);
  if (values->integers && scale && offset) {
    for (double& sample : column.values) sample = sample * *scale + *offset;
    notes_->push_back(
        fmt::format("{}: its integers were multiplied by its scale, {}, and its offset added, {}",
                    place.where, *scale, *offset));
  }
  if (const auto length = NumberIn(value, "length", place.element);
      length && *length != static_cast<double>(column.values.size())) {
    notes_->push_back(fmt::format("{}: has {} values, its length says {}; all of them were read", place.where,
                                  column.values.size(), *length));
  }
  if (column.time) {
    if (column.time->size() != column.values.size())
      return Fail("{} has {} values and {} times", place.where, column.values.size(), column.time->size());
    return column;
  }
  const double start = NumberIn(value, "start", place.element).value_or(0);
  if (!(*interval > 0) || !std::isfinite(*interval) || !std::isfinite(start))
    return Fail("{}: interval is {} s and start {} s, expected an interval above 0", place.where, *interval,
                start);
  column.time.emplace();
  for (std::size_t i = 0; i < column.values.size(); ++i)
    column.time->push_back(start + static_cast<double>(i) * *interval);
  SINEW_TRY(CheckIncreases(*column.time, place.where + ": start and interval"));
  return column;
}

Result<MatColumn> MatRecording::Column(const std::string& column, long line) {
  SINEW_ASSIGN(const Place place, FindVariable(column, ParseMatPath(column), line));
  if (place.value->kind == MatKind::kStruct) return Sampled(place, line);
  MatColumn found;
  found.where = place.where;
  SINEW_ASSIGN(found.values, VectorOf(*place.value, place.where, place.part));
  return found;
}

Result<std::vector<double>> MatRecording::Times(const MappedTime& time, std::size_t count) {
  double rate = time.rate.value_or(0);
  if (!time.rate_column.empty()) {
    SINEW_ASSIGN(const MatColumn found, Column(time.rate_column, time.line));
    rate = found.values.size() == 1 ? found.values.front() : 0;
    if (!(rate > 0) || !std::isfinite(rate))
      return Fail("{} is {}, expected samples per second above 0", found.where,
                  found.values.size() == 1 ? fmt::format("{}", rate)
                                           : fmt::format("{} numbers", found.values.size()));
  }
  std::vector<double> times(count);
  if (time.column.empty()) {
    for (std::size_t i = 0; i < count; ++i) times[i] = static_cast<double>(i) / rate;
    return times;
  }
  SINEW_ASSIGN(MatColumn found, Column(time.column, time.line));
  if (found.time) return std::move(*found.time);
  for (double& t : found.values) t *= time.factor;
  SINEW_TRY(CheckIncreases(found.values, found.where));
  return std::move(found.values);
}

Result<MatColumn> MatRecording::Channel(const std::string& name, const MappedChannel& entry,
                                        const std::optional<MappedTime>& time) {
  SINEW_ASSIGN(MatColumn column, Column(entry.column, entry.line));
  SINEW_TRY(CheckNotInfinite(column.values, column.where));
  const bool own = column.time.has_value();
  if (!own && !time && !entry.time)
    return FailAt(map_->file, entry.line,
                  "channel '{}': {} does not say when its samples were taken; expected for example time: "
                  "{{column: t, unit: s}} or time: {{rate: 2000}}",
                  name, column.where);
  if (!own || entry.time) {
    const MappedTime& mapped = entry.time ? *entry.time : *time;
    SINEW_ASSIGN(column.time, Times(mapped, column.values.size()));
    if (column.time->size() != column.values.size())
      return FailAt(map_->file, mapped.line, "channel '{}': {} has {} values, '{}' has {} times", name,
                    column.where, column.values.size(), mapped.column, column.time->size());
  }
  return column;
}

std::vector<std::string> MatRecording::Unused() const {
  std::vector<std::string> names;
  for (const auto& [path, file] : files_) {
    for (const auto& [name, value] : file.variables) {
      if (used_.count(&value) == 0) names.push_back(name);
    }
  }
  return names;
}

}  // namespace sinew
