#include "datasets/io/dataset_file.h"

#include <algorithm>
#include <cmath>

#include "base/hdf5_tree.h"
#include "base/text.h"
#include "datasets/io/cells.h"
#include "datasets/units.h"

namespace sinew {
namespace {

constexpr const char* kSchema = "dataset/1";

bool IsGroup(const Hdf5Node& node) {
  return std::holds_alternative<std::monostate>(node.data);
}

// ---- reading: every function takes the path of its node in the file, for the message
// ---------------------------------

Result<std::string> TextAttribute(const Hdf5Node& node, const std::string& where, const std::string& name) {
  const auto found = node.attributes.find(name);
  if (found == node.attributes.end()) return Fail("{}: has no attr '{}'", where, name);
  if (const auto* text = std::get_if<std::string>(&found->second)) return *text;
  return Fail("{}: attr '{}' is a number, expected a text", where, name);
}

Result<double> NumberAttribute(const Hdf5Node& node, const std::string& where, const std::string& name) {
  if (std::holds_alternative<std::string>(node.attributes.at(name))) {
    return Fail("{}: attr '{}' is a text, expected a number", where, name);
  }
  return node.Number(name, 0);
}

Status CheckAttributes(const Hdf5Node& node, const std::string& where,
                       const std::vector<std::string>& known) {
  for (const auto& [name, value] : node.attributes) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return Fail("{}: unknown attr {}{}", where, Quoted(name),
                  known.empty() ? ", expected none" : Suggestion(name, known));
    }
  }
  return {};
}

Status CheckChildren(const Hdf5Node& node, const std::string& where, const std::vector<std::string>& known) {
  for (const auto& [name, child] : node.children) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return Fail("{}: unknown member {}{}", where, Quoted(name), Suggestion(name, known));
    }
  }
  return {};
}

Status CheckGroup(const Hdf5Node& node, const std::string& where) {
  if (!IsGroup(node)) return Fail("{}: is a dataset, expected a group", where);
  return {};
}

// The numbers of a dataset of shape [N], [N, 1] or [1, N], which are taken out of it.
Result<std::vector<double>> ReadVector(Hdf5Node& node, const std::string& where) {
  auto* array = std::get_if<Hdf5Array>(&node.data);
  if (array == nullptr) return Fail("{}: holds no numbers, expected a vector", where);
  const auto long_axes =
      std::count_if(array->shape.begin(), array->shape.end(), [](auto size) { return size != 1; });
  if (array->shape.empty() || long_axes > 1) {
    return Fail("{}: has {} dimensions, expected a vector", where, array->shape.size());
  }
  return std::move(array->values);
}

Result<UnitConversion> ReadUnit(const Hdf5Node& node, const std::string& where) {
  SINEW_ASSIGN(const std::string unit, TextAttribute(node, where, "unit"));
  auto conversion = ToSi(unit);
  if (!conversion) return Fail("{}: {}", where, conversion.error().message);
  return conversion;
}

Result<ChannelKind> ReadKind(const Hdf5Node& node, const std::string& where) {
  SINEW_ASSIGN(const std::string kind, TextAttribute(node, where, "kind"));
  if (kind == "measured") return ChannelKind::kMeasured;
  if (kind == "input") return ChannelKind::kInput;
  return Fail("{}: kind is {}, expected measured or input", where, Quoted(kind));
}

Result<Channel> ReadChannel(Hdf5Node& node, const std::string& where) {
  SINEW_TRY(CheckAttributes(node, where, {"unit", "kind", "sigma"}));
  SINEW_ASSIGN(const UnitConversion unit, ReadUnit(node, where));
  Channel channel;
  channel.unit = unit.si_unit;
  SINEW_ASSIGN(channel.kind, ReadKind(node, where));
  SINEW_ASSIGN(channel.values, ReadVector(node, where));
  for (double& value : channel.values) value = unit.ToSi(value);
  if (node.attributes.count("sigma") != 0) {
    SINEW_ASSIGN(const double sigma, NumberAttribute(node, where, "sigma"));
    channel.sigma = sigma * unit.factor;
  }
  return channel;
}

Result<std::vector<double>> ReadTime(Hdf5Node& node, const std::string& where) {
  SINEW_TRY(CheckAttributes(node, where, {"unit"}));
  SINEW_ASSIGN(std::vector<double> time, ReadVector(node, where));
  if (node.attributes.count("unit") == 0) return time;
  SINEW_ASSIGN(const UnitConversion unit, ReadUnit(node, where));
  if (unit.si_unit != "s") return Fail("{}: unit is {}, expected s or ms", where, unit.si_unit);
  for (double& t : time) t *= unit.factor;
  return time;
}

Result<Grid> ReadGrid(Hdf5Node& node, const std::string& where) {
  SINEW_TRY(CheckGroup(node, where));
  SINEW_TRY(CheckAttributes(node, where, {}));
  SINEW_TRY(CheckChildren(node, where, {"time", "channels"}));
  if (node.Find("time") == nullptr) return Fail("{}: has no 'time'", where);
  if (node.Find("channels") == nullptr) return Fail("{}: has no 'channels'", where);
  Hdf5Node& channels = node.At("channels");
  SINEW_TRY(CheckGroup(channels, where + "/channels"));
  Grid grid;
  SINEW_ASSIGN(grid.time, ReadTime(node.At("time"), where + "/time"));
  for (auto& [name, child] : channels.children) {
    SINEW_ASSIGN(grid.channels[name], ReadChannel(child, where + "/channels/" + name));
  }
  return grid;
}

Result<Trial> ReadTrial(Hdf5Node& node, const std::string& where) {
  SINEW_TRY(CheckGroup(node, where));
  Trial trial;
  SINEW_ASSIGN(const std::string role, TextAttribute(node, where, "role"));
  if (role != "train" && role != "validate") {
    return Fail("{}: role is {}, expected train or validate", where, Quoted(role));
  }
  trial.role = role == "train" ? Role::kTrain : Role::kValidate;
  for (const auto& [name, value] : node.attributes) {
    if (name == "role") continue;
    if (name == "task") {
      SINEW_ASSIGN(trial.task, TextAttribute(node, where, name));
    } else if (name == "cut_from") {
      SINEW_ASSIGN(trial.cut_from, TextAttribute(node, where, name));
    } else {
      SINEW_ASSIGN(trial.conditions[name], NumberAttribute(node, where, name));
    }
  }
  for (auto& [name, child] : node.children) {
    SINEW_ASSIGN(trial.grids[name], ReadGrid(child, where + "/" + name));
  }
  return trial;
}

Result<Constant> ReadConstant(const Hdf5Node& node, const std::string& where) {
  SINEW_TRY(CheckAttributes(node, where, {"unit"}));
  const Hdf5Array* array = node.array();
  if (array == nullptr || array->values.size() != 1) return Fail("{}: expected a single number", where);
  SINEW_ASSIGN(const UnitConversion unit, ReadUnit(node, where));
  return Constant{unit.ToSi(array->values.front()), unit.si_unit};
}

Result<std::string> ReadText(const Hdf5Node& node, const std::string& where) {
  if (node.text() != nullptr) return *node.text();
  if (node.texts() != nullptr && node.texts()->size() == 1) return node.texts()->front();
  return Fail("{}: expected a text", where);
}

Status ReadRootAttributes(const Hdf5Node& root, Dataset& dataset) {
  if (root.attributes.count("sinew_schema") == 0) {
    return Fail("/: has no attr 'sinew_schema', expected \"{}\": is it a dataset?", kSchema);
  }
  SINEW_ASSIGN(const std::string schema, TextAttribute(root, "/", "sinew_schema"));
  if (schema != kSchema) return Fail("/: sinew_schema is {}, expected \"{}\"", Quoted(schema), kSchema);
  SINEW_TRY(
      CheckAttributes(root, "/", {"sinew_schema", "title", "subject", "source", "licence", "synthetic"}));
  for (auto [name, text] : {std::pair("title", &dataset.title), std::pair("subject", &dataset.subject),
                            std::pair("source", &dataset.source), std::pair("licence", &dataset.licence)}) {
    if (root.attributes.count(name) == 0) continue;
    SINEW_ASSIGN(*text, TextAttribute(root, "/", name));
  }
  if (root.attributes.count("synthetic") == 0) return {};
  SINEW_ASSIGN(const double synthetic, NumberAttribute(root, "/", "synthetic"));
  if (synthetic != 0 && synthetic != 1) return Fail("/: synthetic is {}, expected 0 or 1", synthetic);
  dataset.synthetic = synthetic == 1;
  return {};
}

// ---- writing
// -------------------------------------------------------------------------------------------------------

// One spelling per unit, so that files of other programs may use their own: "N m" is written as N*m.
Hdf5Attribute UnitAttribute(const std::string& unit) {
  return ToSi(unit)->si_unit;
}

// The channels are not copied: the trial must outlive the tree.
Hdf5Node ToTree(const Trial& trial) {
  Hdf5Node node;
  node.attributes["role"] = std::string(trial.role == Role::kTrain ? "train" : "validate");
  node.attributes["task"] = trial.task;
  if (!trial.cut_from.empty()) node.attributes["cut_from"] = trial.cut_from;
  for (const auto& [name, value] : trial.conditions) node.attributes[name] = value;
  for (const auto& [grid_name, grid] : trial.grids) {
    Hdf5Node& grid_node = node.children[grid_name];
    grid_node.children["time"].SetView(grid.time);
    Hdf5Node& channels = grid_node.children["channels"];
    for (const auto& [name, channel] : grid.channels) {
      Hdf5Node& channel_node = channels.children[name];
      channel_node.SetView(channel.values);
      channel_node.attributes["unit"] = UnitAttribute(channel.unit);
      channel_node.attributes["kind"] =
          std::string(channel.kind == ChannelKind::kMeasured ? "measured" : "input");
      if (channel.sigma) channel_node.attributes["sigma"] = *channel.sigma;
    }
  }
  return node;
}

Hdf5Node ToTree(const Dataset& dataset) {
  Hdf5Node root;
  root.attributes["sinew_schema"] = std::string(kSchema);
  root.attributes["title"] = dataset.title;
  root.attributes["subject"] = dataset.subject;
  root.attributes["source"] = dataset.source;
  root.attributes["licence"] = dataset.licence;
  root.attributes["synthetic"] = std::int64_t{dataset.synthetic};
  root.children["trials"];
  for (const auto& [name, trial] : dataset.trials) root.children["trials"].children[name] = ToTree(trial);
  for (const auto& [name, constant] : dataset.constants) {
    Hdf5Node& node = root.children["constants"].children[name];
    node.SetScalar(constant.value);
    node.attributes["unit"] = UnitAttribute(constant.unit);
  }
  for (const auto& [name, text] : dataset.files) root.children["files"].children[name].data = text;
  return root;
}

}  // namespace

Result<Dataset> DatasetOf(Hdf5Node root) {
  Dataset dataset;
  SINEW_TRY(ReadRootAttributes(root, dataset));
  SINEW_TRY(CheckChildren(root, "/", {"trials", "constants", "files"}));
  for (const char* name : {"trials", "constants", "files"}) {
    if (root.Find(name) == nullptr) continue;
    Hdf5Node& group = root.At(name);
    const std::string where = std::string("/") + name;
    SINEW_TRY(CheckGroup(group, where));
    for (auto& [child_name, child] : group.children) {
      const std::string child_where = where + "/" + child_name;
      if (where == "/trials") {
        SINEW_ASSIGN(dataset.trials[child_name], ReadTrial(child, child_where));
      } else if (where == "/constants") {
        SINEW_ASSIGN(dataset.constants[child_name], ReadConstant(child, child_where));
      } else {
        SINEW_ASSIGN(dataset.files[child_name], ReadText(child, child_where));
      }
    }
  }
  SINEW_TRY(dataset.Check());
  return dataset;
}

Result<Dataset> ReadDataset(const std::string& path) {
  SINEW_ASSIGN(Hdf5Node root, ReadHdf5(path));
  auto dataset = DatasetOf(std::move(root));
  if (!dataset) return Fail("{}: {}", path, dataset.error().message);
  return dataset;
}

Status WriteDataset(const std::string& path, const Dataset& dataset) {
  const Status checked = dataset.Check();
  if (!checked) return Fail("{}: {}", path, checked.error().message);
  return WriteHdf5(path, ToTree(dataset));
}

}  // namespace sinew
