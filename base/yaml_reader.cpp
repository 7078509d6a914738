#include "base/yaml_reader.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "base/printable.h"
#include "base/text.h"
#include "base/yaml_limits.h"

namespace sinew {

// yaml-cpp looks at one key after the other.
struct YamlReader::Index {
  std::unordered_map<std::string, YAML::Node> values;
};

const YAML::Node* YamlReader::Find(const std::string& key) const {
  if (index_ == nullptr) {
    auto index = std::make_shared<Index>();
    for (const auto& entry : *node_) {
      if (entry.first.IsScalar()) index->values.emplace(entry.first.Scalar(), entry.second);
    }
    index_ = std::move(index);
  }
  const auto found = index_->values.find(key);
  return found == index_->values.end() ? nullptr : &found->second;
}

YamlReader::YamlReader(std::shared_ptr<const YAML::Node> node, std::string file, std::string path, long line)
    : node_(std::move(node)), file_(std::move(file)), path_(std::move(path)), line_(line) {}

Result<YamlReader> YamlReader::Parse(const std::string& text, const std::string& file) {
  try {
    SINEW_TRY(CheckYamlLimits(text, file));
    YAML::Node node = YAML::Load(text);
    if (node.IsNull()) node = YAML::Node(YAML::NodeType::Map);
    return YamlReader(std::make_shared<const YAML::Node>(node), file, "", 1);
  } catch (const YAML::Exception& exception) {
    return FailAt(file, exception.mark.line + 1, "is not YAML: {}", PrintableLine(exception.msg));
  } catch (const std::exception& exception) {
    return FailAt(file, 1, "is not YAML: {}", OneLine(exception.what()));
  }
}

tl::unexpected<Error> YamlReader::Expected(const std::string& what) const {
  return FailAt(file_, line_, "{}: expected {}", path_.empty() ? "the document" : path_, what);
}

bool YamlReader::is_map() const {
  return node_->IsMap();
}

bool YamlReader::Has(const std::string& key) const {
  return node_->IsMap() && Find(key) != nullptr;
}

Result<YamlReader> YamlReader::At(const std::string& key) const {
  if (!node_->IsMap()) return Expected("a map with key '" + key + "'");
  const YAML::Node* child = Find(key);
  if (child == nullptr) return Expected("key '" + key + "'");
  return YamlReader(std::make_shared<const YAML::Node>(*child), file_,
                    path_.empty() ? key : path_ + "." + key, std::max(0, child->Mark().line) + 1);
}

Status YamlReader::OnlyKeys(const std::vector<std::string>& known) const {
  if (!node_->IsMap()) return Expected("a map");
  for (const auto& entry : *node_) {
    if (!entry.first.IsScalar()) return Expected("plain words as keys");
    const std::string& key = entry.first.Scalar();
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      return FailAt(file_, std::max(0, entry.first.Mark().line) + 1, "unknown key '{}'{}", key,
                    Suggestion(key, known));
    }
  }
  return {};
}

Result<std::vector<std::string>> YamlReader::Keys() const {
  if (!node_->IsMap()) return Expected("a map");
  std::vector<std::string> keys;
  for (const auto& entry : *node_) {
    if (!entry.first.IsScalar()) return Expected("plain words as keys");
    keys.push_back(entry.first.Scalar());
  }
  return keys;
}

Result<std::vector<YamlReader>> YamlReader::Items() const {
  if (!node_->IsSequence()) return Expected("a list");
  std::vector<YamlReader> items;
  for (const auto& item : *node_) {
    items.push_back(YamlReader(std::make_shared<const YAML::Node>(item), file_,
                               fmt::format("{}[{}]", path_, items.size()),
                               std::max(0, item.Mark().line) + 1));
  }
  return items;
}

Result<double> YamlReader::Number() const {
  if (!node_->IsScalar()) return Expected("a number");
  const auto number = ParseNumber(node_->Scalar());
  if (!number || !std::isfinite(*number)) return Expected("a number instead of '" + node_->Scalar() + "'");
  return *number;
}

Result<long> YamlReader::Integer() const {
  if (!node_->IsScalar()) return Expected("a whole number");
  const auto number = ParseInteger(node_->Scalar());
  if (!number) return Expected("a whole number instead of '" + node_->Scalar() + "'");
  return *number;
}

Result<std::string> YamlReader::Text() const {
  if (!node_->IsScalar()) return Expected("a text");
  return node_->Scalar();
}

Result<std::vector<double>> YamlReader::Numbers(std::size_t count) const {
  if (!node_->IsSequence() || (count > 0 && node_->size() != count)) {
    return Expected(count > 0 ? fmt::format("a list of {} numbers", count) : "a list of numbers");
  }
  SINEW_ASSIGN(const auto items, Items());
  std::vector<double> numbers;
  for (const YamlReader& item : items) {
    SINEW_ASSIGN(const double number, item.Number());
    numbers.push_back(number);
  }
  return numbers;
}

Result<std::vector<std::string>> YamlReader::Texts() const {
  SINEW_ASSIGN(const auto items, Items());
  std::vector<std::string> texts;
  for (const YamlReader& item : items) {
    SINEW_ASSIGN(auto text, item.Text());
    texts.push_back(std::move(text));
  }
  return texts;
}

Result<double> YamlReader::NumberOr(const std::string& key, double fallback) const {
  if (!Has(key)) return fallback;
  SINEW_ASSIGN(const YamlReader value, At(key));
  return value.Number();
}

Result<double> YamlReader::NumberOr(const std::string& key, double fallback, double lower,
                                    double upper) const {
  SINEW_ASSIGN(const double read, NumberOr(key, fallback));
  if (read >= lower && read <= upper) return read;
  SINEW_ASSIGN(const YamlReader value, At(key));
  return FailAt(value.file(), value.line(), "{}: {}, expected {} to {}", key, read, lower, upper);
}

Result<std::string> YamlReader::TextOr(const std::string& key, const std::string& fallback) const {
  if (!Has(key)) return fallback;
  SINEW_ASSIGN(const YamlReader value, At(key));
  return value.Text();
}

}  // namespace sinew
