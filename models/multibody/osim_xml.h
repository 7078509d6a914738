// An OpenSim XML document whose elements know their lines. Internal to models/: it shows pugixml.
#pragma once

#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

/// Reads values out of elements. A value that is absent is the fallback; one that is there but cannot be read
/// is an error with its line.
class OsimXml {
 public:
  /// Errors: not XML (with the line), or not an <OpenSimDocument Version="...">.
  static Result<OsimXml> Parse(std::string_view text, std::string file_name);

  [[nodiscard]] pugi::xml_node root() const { return document_->document_element(); }
  [[nodiscard]] long version() const { return version_; }

  /// An Error at the line of the element.
  template <class... Args>
  [[nodiscard]] tl::unexpected<Error> FailAt(const pugi::xml_node& element,
                                             fmt::format_string<Args...> format, Args&&... args) const {
    return sinew::FailAt(file_name_, Line(element), format, std::forward<Args>(args)...);
  }

  [[nodiscard]] Result<double> Number(const pugi::xml_node& parent, const char* child, double fallback) const;
  [[nodiscard]] Result<bool> Flag(const pugi::xml_node& parent, const char* child, bool fallback) const;
  /// Three finite numbers.
  [[nodiscard]] Result<Vec3> Vector3(const pugi::xml_node& parent, const char* child,
                                     const Vec3& fallback) const;
  /// Any count of numbers; none when the child is absent.
  [[nodiscard]] Result<std::vector<double>> Numbers(const pugi::xml_node& parent, const char* child) const;

 private:
  OsimXml() = default;
  [[nodiscard]] long Line(const pugi::xml_node& element) const;
  [[nodiscard]] long LineOfOffset(std::ptrdiff_t offset) const;

  std::string file_name_;
  std::unique_ptr<pugi::xml_document> document_;
  std::vector<std::ptrdiff_t> line_ends_;
  long version_ = 0;
};

/// The text of a child element without blanks around it; empty when the child is absent.
std::string ChildText(const pugi::xml_node& parent, const char* child);

/// The name attribute.
std::string NameOf(const pugi::xml_node& element);

/// The elements directly below, without text and comments.
std::vector<pugi::xml_node> Elements(const pugi::xml_node& parent);

/// The members of an OpenSim set: `<BodySet><objects> ... </objects></BodySet>`.
std::vector<pugi::xml_node> Members(const pugi::xml_node& set);

}  // namespace sinew
