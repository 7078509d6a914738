#include "tests/fuzz/tree_text.h"

#include <algorithm>

#include "base/text.h"

namespace sinew::fuzz {
namespace {

constexpr std::size_t kMostValues = 4096;  // of one array

std::string Escape(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? "\\n" : c == '\\' ? "\\\\" : std::string(1, c);
  return out;
}

// HDF5's own texts end at a zero byte.
std::string Unescape(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size() && text[i] != '\0'; ++i) {
    const bool escaped = text[i] == '\\' && i + 1 < text.size();
    const char c = escaped ? text[++i] : text[i];
    out += escaped && c == 'n' ? '\n' : c;
  }
  return out;
}

Hdf5Attribute AttributeOf(std::string_view value) {
  if (!value.empty() && value.front() == '"') return Unescape(value.substr(1));
  if (const auto integer = ParseInteger(value)) return std::int64_t{*integer};
  return ParseNumber(value).value_or(0);
}

Hdf5Array ArrayOf(std::string_view shape, std::string_view values) {
  Hdf5Array array;
  std::size_t count = 1;
  for (const auto word : SplitBlanks(shape)) {
    const auto size =
        static_cast<std::size_t>(std::clamp(ParseInteger(word).value_or(0), 0L, long{kMostValues}));
    if (array.shape.size() == 4 || count * size > kMostValues) break;
    count *= size;
    array.shape.push_back(size);
  }
  for (const auto word : SplitBlanks(values)) array.values.push_back(ParseNumber(word).value_or(0));
  array.values.resize(count);
  return array;
}

void AddLine(std::string_view line, Hdf5Node& root) {
  const auto blank = line.find(' ');
  std::string path = Unescape(line.substr(0, blank));
  Hdf5Node& node = root.At(path);
  if (blank == std::string_view::npos) return;
  const std::string_view rest = line.substr(blank + 1);
  if (rest.empty()) return;
  if (rest.front() == '@') {
    const auto end = rest.find(' ');
    const std::string name = Unescape(rest.substr(1, end == rest.npos ? rest.npos : end - 1));
    if (!name.empty()) node.attributes[name] = AttributeOf(end == rest.npos ? "" : rest.substr(end + 1));
  } else if (rest.front() == '"') {
    node.data = Unescape(rest.substr(1));
  } else if (rest.front() == '[') {
    std::vector<std::string> texts;
    for (const auto piece : Split(rest.substr(1), ','))
      texts.push_back(Unescape(piece.substr(0, 1) == "\"" ? piece.substr(1) : piece));
    node.data = std::move(texts);
  } else if (const auto equals = rest.find('='); equals != rest.npos) {
    node.data = ArrayOf(rest.substr(0, equals), rest.substr(equals + 1));
  }
}

// A group has no data, and a dataset no members.
void Tidy(Hdf5Node& node) {
  if (!node.children.empty()) node.data = std::monostate();
  for (auto& [name, child] : node.children) Tidy(child);
}

void Append(const Hdf5Node& node, const std::string& path, std::string& out) {
  if (!path.empty()) out += path + "\n";
  for (const auto& [name, value] : node.attributes) {
    out += path + " @" + name + " ";
    if (const auto* text = std::get_if<std::string>(&value)) {
      out += "\"" + Escape(*text);
    } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
      out += std::to_string(*integer);
    } else {
      out += fmt::format("{:#}", std::get<double>(value));
    }
    out += "\n";
  }
  if (const Hdf5Array* array = node.array()) {
    out += path + " ";
    for (const std::size_t size : array->shape) out += std::to_string(size) + " ";
    out += "=";
    for (const double value : array->values) out += fmt::format(" {}", value);
    out += "\n";
  } else if (const std::string* text = node.text()) {
    out += path + " \"" + Escape(*text) + "\n";
  } else if (const auto* texts = node.texts()) {
    out += path + " [";
    for (std::size_t i = 0; i < texts->size(); ++i) out += (i == 0 ? "\"" : ",\"") + Escape((*texts)[i]);
    out += "\n";
  }
  for (const auto& [name, child] : node.children) Append(child, path.empty() ? name : path + "/" + name, out);
}

}  // namespace

Hdf5Node ToTree(std::string_view text) {
  Hdf5Node root;
  for (const auto line : Split(text, '\n')) AddLine(line, root);
  Tidy(root);
  root.data = std::monostate();  // a file is a group
  return root;
}

std::string ToText(const Hdf5Node& root) {
  std::string out;
  Append(root, "", out);
  return out;
}

}  // namespace sinew::fuzz
