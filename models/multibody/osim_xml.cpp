#include "models/multibody/osim_xml.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sinew {

Result<OsimXml> OsimXml::Parse(std::string_view text, std::string file_name) {
  OsimXml xml;
  xml.file_name_ = std::move(file_name);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') xml.line_ends_.push_back(static_cast<std::ptrdiff_t>(i));
  }
  // Said to be UTF-8 so that offsets stay those of the text.
  xml.document_ = std::make_unique<pugi::xml_document>();
  const pugi::xml_parse_result parsed =
      xml.document_->load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) {
    return sinew::FailAt(xml.file_name_, xml.LineOfOffset(parsed.offset), "not well-formed XML: {}",
                         Lowercase(parsed.description()));
  }
  const pugi::xml_node root = xml.root();
  if (std::string_view(root.name()) != "OpenSimDocument")
    return xml.FailAt(root, "the outermost element is <{}>, expected <OpenSimDocument>", root.name());
  const auto version = ParseInteger(root.attribute("Version").value());
  if (!version) {
    return xml.FailAt(root, "OpenSimDocument has Version '{}', expected a number such as 40000",
                      root.attribute("Version").value());
  }
  xml.version_ = *version;
  return xml;
}

long OsimXml::LineOfOffset(std::ptrdiff_t offset) const {
  return std::lower_bound(line_ends_.begin(), line_ends_.end(), offset) - line_ends_.begin() + 1;
}

long OsimXml::Line(const pugi::xml_node& element) const {
  return LineOfOffset(element.offset_debug());
}

Result<std::vector<double>> OsimXml::Numbers(const pugi::xml_node& parent, const char* child) const {
  std::vector<double> numbers;
  const pugi::xml_node element = parent.child(child);
  std::string text = element.text().get();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  for (const std::string_view word : SplitBlanks(text)) {
    const auto number = ParseNumber(word);
    if (!number) return FailAt(element, "{} has '{}', expected a number", child, word);
    numbers.push_back(*number);
  }
  return numbers;
}

Result<double> OsimXml::Number(const pugi::xml_node& parent, const char* child, double fallback) const {
  const pugi::xml_node element = parent.child(child);
  if (!element) return fallback;
  const std::string text = ChildText(parent, child);
  const auto number = ParseNumber(text);
  if (!number || std::isnan(*number)) return FailAt(element, "{} is '{}', expected a number", child, text);
  return *number;
}

Result<bool> OsimXml::Flag(const pugi::xml_node& parent, const char* child, bool fallback) const {
  const pugi::xml_node element = parent.child(child);
  if (!element) return fallback;
  const std::string text = Lowercase(ChildText(parent, child));
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  return FailAt(element, "{} is '{}', expected true or false", child, text);
}

Result<Vec3> OsimXml::Vector3(const pugi::xml_node& parent, const char* child, const Vec3& fallback) const {
  const pugi::xml_node element = parent.child(child);
  if (!element) return fallback;
  SINEW_ASSIGN(const std::vector<double> numbers, Numbers(parent, child));
  if (numbers.size() != 3)
    return FailAt(element, "{} has {} value(s), expected three numbers", child, numbers.size());
  const Vec3 vector(numbers[0], numbers[1], numbers[2]);
  if (!vector.allFinite()) return FailAt(element, "{} is not finite", child);
  return vector;
}

std::string ChildText(const pugi::xml_node& parent, const char* child) {
  return std::string(Trim(parent.child(child).text().get()));
}

std::string NameOf(const pugi::xml_node& element) {
  return element.attribute("name").value();
}

std::vector<pugi::xml_node> Elements(const pugi::xml_node& parent) {
  std::vector<pugi::xml_node> elements;
  for (const pugi::xml_node& node : parent.children()) {
    if (node.type() == pugi::node_element) elements.push_back(node);
  }
  return elements;
}

std::vector<pugi::xml_node> Members(const pugi::xml_node& set) {
  return Elements(set.child("objects"));
}

}  // namespace sinew
