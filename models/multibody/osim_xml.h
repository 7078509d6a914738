// An OpenSim XML document. Internal to models/: it shows pugixml.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/linear_algebra.h"
#include "base/xml_document.h"

namespace sinew {

class OsimXml : public XmlDocument {
 public:
  /// Errors: not XML (with the line), or not an <OpenSimDocument Version="...">.
  static Result<OsimXml> Parse(std::string_view text, std::string file_name);

  [[nodiscard]] long version() const { return version_; }

  /// Three finite numbers.
  [[nodiscard]] Result<Vec3> Vector3(const pugi::xml_node& parent, const char* child,
                                     const Vec3& fallback) const;

 private:
  explicit OsimXml(XmlDocument document) : XmlDocument(std::move(document)) {}

  long version_ = 0;
};

/// The members of an OpenSim set: `<BodySet><objects> ... </objects></BodySet>`.
std::vector<pugi::xml_node> Members(const pugi::xml_node& set);

}  // namespace sinew
