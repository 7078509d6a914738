#include "base/xml_document.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "base/value_limits.h"

namespace sinew {
namespace {

// The characters between words.
std::string WithBlanks(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

}  // namespace

Result<XmlDocument> XmlDocument::Parse(std::string_view text, std::string file_name) {
  if (text.size() > kMostXml)
    return Fail("{}: has {} bytes, expected at most {}", file_name, text.size(), kMostXml);
  XmlDocument xml;
  xml.file_name_ = std::move(file_name);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') xml.line_ends_.push_back(static_cast<std::ptrdiff_t>(i));
  }
  // Parsed as UTF-8 so that offsets are those of the text.
  xml.document_ = std::make_unique<pugi::xml_document>();
  const pugi::xml_parse_result parsed =
      xml.document_->load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) {
    return sinew::FailAt(xml.file_name_, xml.LineOfOffset(parsed.offset), "not well-formed XML: {}",
                         Lowercase(parsed.description()));
  }
  return xml;
}

long XmlDocument::LineOfOffset(std::ptrdiff_t offset) const {
  return std::lower_bound(line_ends_.begin(), line_ends_.end(), offset) - line_ends_.begin() + 1;
}

long XmlDocument::Line(const pugi::xml_node& element) const {
  return LineOfOffset(element.offset_debug());
}

Result<std::vector<double>> XmlDocument::Numbers(const pugi::xml_node& parent, const char* child) const {
  std::vector<double> numbers;
  const pugi::xml_node element = parent.child(child);
  const std::string text = WithBlanks(element.text().get());
  for (const std::string_view word : SplitBlanks(text)) {
    const auto number = ParseNumber(word);
    if (!number) return FailAt(element, "{} has '{}', expected a number", child, word);
    numbers.push_back(*number);
  }
  return numbers;
}

Result<double> XmlDocument::Number(const pugi::xml_node& parent, const char* child, double fallback) const {
  const pugi::xml_node element = parent.child(child);
  if (!element) return fallback;
  const std::string text = ChildText(parent, child);
  const auto number = ParseNumber(text);
  if (!number || std::isnan(*number)) return FailAt(element, "{} is '{}', expected a number", child, text);
  return *number;
}

Result<bool> XmlDocument::Flag(const pugi::xml_node& parent, const char* child, bool fallback) const {
  const pugi::xml_node element = parent.child(child);
  if (!element) return fallback;
  const std::string text = Lowercase(ChildText(parent, child));
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  return FailAt(element, "{} is '{}', expected true or false", child, text);
}

std::string ChildText(const pugi::xml_node& parent, const char* child) {
  return std::string(Trim(parent.child(child).text().get()));
}

std::vector<std::string> ChildWords(const pugi::xml_node& parent, const char* child) {
  const std::string text = WithBlanks(parent.child(child).text().get());
  const auto words = SplitBlanks(text);
  return {words.begin(), words.end()};
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

}  // namespace sinew
