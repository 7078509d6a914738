#include "models/multibody/osim_xml.h"

#include "base/text.h"

namespace sinew {

Result<OsimXml> OsimXml::Parse(std::string_view text, std::string file_name) {
  SINEW_ASSIGN(auto document, XmlDocument::Parse(text, std::move(file_name)));
  OsimXml xml(std::move(document));
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

std::vector<pugi::xml_node> Members(const pugi::xml_node& set) {
  return Elements(set.child("objects"));
}

}  // namespace sinew
