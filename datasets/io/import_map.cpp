#include "datasets/io/import_map.h"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "base/printable.h"
#include "base/text.h"
#include "base/value_limits.h"
#include "base/yaml_limits.h"
#include "datasets/io/cells.h"
#include "datasets/io/mat_path.h"
#include "datasets/io/text_file.h"

namespace sinew {
namespace {

constexpr std::array<const char*, 5> kTexts = {"title", "subject", "source", "licence", "task"};

long LineOf(const YAML::Node& node) {
  return node.Mark().line + 1;
}

class MapParser {
 public:
  explicit MapParser(const std::string& file) : file_(file) { map_.file = file; }

  Result<ImportMap> Parse(const YAML::Node& root) {
    if (!root.IsMap()) return Fail("{}: is not a map, expected keys such as time and channels", file_);
    std::vector<std::string> known = {"time", "channels", "markers", "constants", "conditions"};
    known.insert(known.end(), kTexts.begin(), kTexts.end());
    SINEW_TRY(
        ForEach(root, "the map", [&](const std::string& key, long line, const YAML::Node& value) -> Status {
          if (key == "time") {
            SINEW_ASSIGN(map_.time, ParseTime(value, line, key));
            return {};
          }
          if (key == "channels") return ForEach(value, key, Bind(&MapParser::ParseChannel));
          if (key == "markers") return ForEach(value, key, Bind(&MapParser::ParseMarker));
          if (key == "constants") return ForEach(value, key, Bind(&MapParser::ParseConstant));
          if (key == "conditions") return ForEach(value, key, Bind(&MapParser::ParseCondition));
          for (const std::string_view text : kTexts) {
            if (key != text) continue;
            SINEW_ASSIGN(map_.texts[key], Text(value, line, key));
            return {};
          }
          return UnknownKey(key, line, "the map", known);
        }));
    return std::move(map_);
  }

 private:
  using Entry = std::function<Status(const std::string& key, long line, const YAML::Node& value)>;

  Entry Bind(Status (MapParser::*parse)(const std::string&, long, const YAML::Node&)) {
    return [this, parse](const std::string& key, long line, const YAML::Node& value) {
      return (this->*parse)(key, line, value);
    };
  }

  [[nodiscard]] tl::unexpected<Error> UnknownKey(const std::string& key, long line, const std::string& where,
                                                 const std::vector<std::string>& known) const {
    return FailAt(file_, line, "unknown key {} in {}{}", Quoted(key), where, Suggestion(key, known));
  }

  // Calls entry(key, line of the key, value) for each pair; refuses keys that appear twice.
  Status ForEach(const YAML::Node& node, const std::string& where, const Entry& entry) const {
    if (!node.IsMap()) return FailAt(file_, LineOf(node), "{}: expected NAME: VALUE pairs", where);
    std::set<std::string> seen;
    for (const auto& pair : node) {
      const long line = LineOf(pair.first);
      if (!pair.first.IsScalar() || pair.first.Scalar().empty()) {
        return FailAt(file_, line, "{}: a key is not a name", where);
      }
      const std::string& key = pair.first.Scalar();
      if (!seen.insert(key).second)
        return FailAt(file_, line, "{}: the key {} appears twice", where, Quoted(key));
      SINEW_TRY(entry(key, line, pair.second));
    }
    return {};
  }

  Result<std::string> Text(const YAML::Node& node, long line, const std::string& what) const {
    if (!node.IsScalar()) return FailAt(file_, line, "{}: expected a text", what);
    return node.Scalar();
  }

  Result<double> Number(const YAML::Node& node, long line, const std::string& what) const {
    SINEW_ASSIGN(const std::string text, Text(node, line, what));
    const auto number = ParseNumber(text);
    if (!number || !std::isfinite(*number)) {
      return FailAt(file_, line, "{} is {}, expected a number", what, Quoted(text));
    }
    return *number;
  }

  Result<UnitConversion> Unit(const YAML::Node& node, long line) const {
    SINEW_ASSIGN(const std::string text, Text(node, line, "unit"));
    auto conversion = ToSi(text);
    if (!conversion) return FailAt(file_, line, "{}", conversion.error().message);
    return conversion;
  }

  Result<MappedTime> ParseTime(const YAML::Node& node, long line, const std::string& where) const {
    MappedTime time;
    time.line = line;
    SINEW_TRY(ForEach(node, where, [&](const std::string& key, long at, const YAML::Node& value) -> Status {
      if (key == "column") {
        SINEW_ASSIGN(time.column, Text(value, at, "column"));
        return {};
      }
      if (key == "rate") return ParseRate(value, at, where, time);
      if (key != "unit") return UnknownKey(key, at, where, {"column", "unit", "rate"});
      SINEW_ASSIGN(const auto unit, Unit(value, at));
      if (unit.si_unit != "s")
        return FailAt(file_, at, "the unit of time is {}, expected s or ms", unit.si_unit);
      time.factor = unit.factor;
      return {};
    }));
    const bool has_rate = time.rate || !time.rate_column.empty();
    if (time.column.empty() == !has_rate)
      return FailAt(file_, line, "{} has {}", where,
                    has_rate ? "a column and a rate, expected one of them" : "no column");
    return time;
  }

  // A number, or the variable of a .mat that holds it.
  Status ParseRate(const YAML::Node& node, long line, const std::string& where, MappedTime& time) const {
    SINEW_ASSIGN(const std::string text, Text(node, line, where + ": rate"));
    const auto rate = ParseNumber(text);
    if (!rate && ParseMatPath(text)) {
      time.rate_column = text;
      return {};
    }
    if (!rate || !std::isfinite(*rate))
      return FailAt(file_, line, "{}: rate is {}, expected a number", where, Quoted(text));
    if (!(*rate > 0))
      return FailAt(file_, line, "{}: rate is {}, expected samples per second above 0", where, *rate);
    time.rate = *rate;
    return {};
  }

  Status ParseChannel(const std::string& name, long line, const YAML::Node& node) {
    MappedChannel channel;
    channel.column = name;
    channel.line = line;
    const std::string where = "channel '" + name + "'";
    SINEW_TRY(ForEach(node, where, [&](const std::string& key, long at, const YAML::Node& value) {
      return ParseChannelKey(key, at, value, where, channel);
    }));
    if (channel.column.empty()) return FailAt(file_, line, "{}: its column has no name", where);
    map_.channels.emplace(name, std::move(channel));
    if (map_.channels.size() > kMostColumns)
      return FailAt(file_, line, "names more than {} channels", kMostColumns);
    return {};
  }

  Status ParseChannelKey(const std::string& key, long line, const YAML::Node& value, const std::string& where,
                         MappedChannel& channel) const {
    if (key == "column") {
      SINEW_ASSIGN(channel.column, Text(value, line, where + ": column"));
    } else if (key == "unit") {
      SINEW_ASSIGN(channel.unit, Unit(value, line));
    } else if (key == "time") {
      SINEW_ASSIGN(channel.time, ParseTime(value, line, where + ": time"));
    } else if (key == "kind") {
      SINEW_ASSIGN(const std::string kind, Text(value, line, where + ": kind"));
      if (kind != "measured" && kind != "input") {
        return FailAt(file_, line, "{}: kind is {}, expected measured or input", where, Quoted(kind));
      }
      channel.kind = kind == "input" ? ChannelKind::kInput : ChannelKind::kMeasured;
    } else if (key == "scale") {
      SINEW_ASSIGN(channel.scale, Number(value, line, where + ": scale"));
      if (channel.scale == 0) return FailAt(file_, line, "{}: scale is 0, expected another number", where);
    } else if (key == "sigma") {
      SINEW_ASSIGN(const double sigma, Number(value, line, where + ": sigma"));
      if (sigma <= 0) return FailAt(file_, line, "{}: sigma is {}, expected more than 0", where, sigma);
      channel.sigma = sigma;
    } else {
      return UnknownKey(key, line, where, {"column", "unit", "time", "kind", "scale", "sigma"});
    }
    return {};
  }

  Status ParseMarker(const std::string& old_name, long line, const YAML::Node& node) {
    SINEW_ASSIGN(std::string name, Text(node, line, "marker '" + old_name + "'"));
    if (name.empty()) return FailAt(file_, line, "marker '{}': its new name is empty", old_name);
    map_.markers[old_name] = MappedMarker{std::move(name), line};
    return {};
  }

  Status ParseConstant(const std::string& name, long line, const YAML::Node& node) {
    const std::string where = "constant '" + name + "'";
    std::optional<double> number;
    std::optional<UnitConversion> unit;
    SINEW_TRY(ForEach(node, where, [&](const std::string& key, long at, const YAML::Node& value) -> Status {
      if (key == "value") {
        SINEW_ASSIGN(number, Number(value, at, where));
        return {};
      }
      if (key != "unit") return UnknownKey(key, at, where, {"value", "unit"});
      SINEW_ASSIGN(unit, Unit(value, at));
      return {};
    }));
    if (!number || !unit) return FailAt(file_, line, "{}: expected {{value: NUMBER, unit: UNIT}}", where);
    map_.constants[name] = Constant{unit->ToSi(*number), unit->si_unit};
    return {};
  }

  Status ParseCondition(const std::string& name, long line, const YAML::Node& node) {
    SINEW_ASSIGN(map_.conditions[name], Number(node, line, "condition '" + name + "'"));
    return {};
  }

  const std::string& file_;
  ImportMap map_;
};

}  // namespace

Result<ImportMap> ParseImportMap(std::string_view text, const std::string& file) {
  try {
    const std::string all(text);
    SINEW_TRY(CheckYamlLimits(all, file));
    return MapParser(file).Parse(YAML::Load(all));
  } catch (const YAML::Exception& exception) {  // yaml-cpp reports everything so
    return FailAt(file, exception.mark.line + 1, "not valid YAML: {}", PrintableLine(exception.msg));
  } catch (const std::exception& exception) {
    return Fail("{}: not valid YAML: {}", file, OneLine(exception.what()));
  }
}

Result<ImportMap> ReadImportMap(const std::string& path) {
  SINEW_ASSIGN(const std::string text, ReadTextFile(path));
  return ParseImportMap(text, path);
}

}  // namespace sinew
