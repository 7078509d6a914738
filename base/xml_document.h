// An XML document whose elements carry their line numbers.
#pragma once

#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew {

/// Reads values out of elements. A value that is absent is the fallback; one that is there but cannot be read
/// is an error with its line.
class XmlDocument {
 public:
  /// Errors: not XML, with the line.
  static Result<XmlDocument> Parse(std::string_view text, std::string file_name);

  [[nodiscard]] pugi::xml_node root() const { return document_->document_element(); }
  [[nodiscard]] const std::string& file_name() const { return file_name_; }
  [[nodiscard]] long Line(const pugi::xml_node& element) const;

  /// An Error at the line of the element.
  template <class... Args>
  [[nodiscard]] tl::unexpected<Error> FailAt(const pugi::xml_node& element,
                                             fmt::format_string<Args...> format, Args&&... args) const {
    return sinew::FailAt(file_name_, Line(element), format, std::forward<Args>(args)...);
  }

  [[nodiscard]] Result<double> Number(const pugi::xml_node& parent, const char* child, double fallback) const;
  [[nodiscard]] Result<bool> Flag(const pugi::xml_node& parent, const char* child, bool fallback) const;
  /// Any count of numbers; none when the child is absent.
  [[nodiscard]] Result<std::vector<double>> Numbers(const pugi::xml_node& parent, const char* child) const;

 private:
  XmlDocument() = default;
  [[nodiscard]] long LineOfOffset(std::ptrdiff_t offset) const;

  std::string file_name_;
  std::unique_ptr<pugi::xml_document> document_;
  std::vector<std::ptrdiff_t> line_ends_;
};

/// The text of a child element without blanks around it; empty when the child is absent.
std::string ChildText(const pugi::xml_node& parent, const char* child);

/// The words of a child element; none when it is absent.
std::vector<std::string> ChildWords(const pugi::xml_node& parent, const char* child);

/// The name attribute.
std::string NameOf(const pugi::xml_node& element);

/// The elements directly below, without text and comments.
std::vector<pugi::xml_node> Elements(const pugi::xml_node& parent);

}  // namespace sinew
