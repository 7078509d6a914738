#include "datasets/io/external_loads.h"

#include <algorithm>
#include <pugixml.hpp>

#include "base/text.h"
#include "base/value_limits.h"
#include "datasets/io/cells.h"
#include "datasets/io/text_file.h"

namespace sinew {
namespace {

class LoadsParser {
 public:
  LoadsParser(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  Result<std::vector<ExternalForce>> Parse() {
    pugi::xml_document document;
    if (text_.size() > kMostXml)
      return Fail("{}: has {} bytes, expected at most {}", file_, text_.size(), kMostXml);
    const pugi::xml_parse_result parsed = document.load_buffer(text_.data(), text_.size());
    if (!parsed) return FailAt(file_, LineAt(parsed.offset), "not valid XML: {}", parsed.description());

    auto is_loads = [](const pugi::xml_node& node) {
      return std::string_view(node.name()) == "ExternalLoads";
    };
    const pugi::xml_node loads = document.find_node(is_loads);
    if (!loads) return Fail("{}: has no element ExternalLoads", file_);
    for (const char* list : {"objects", "."}) {
      const pugi::xml_node parent = std::string_view(list) == "." ? loads : loads.child(list);
      for (const pugi::xml_node& node : parent.children("ExternalForce")) SINEW_TRY(ParseForce(node));
    }
    if (forces_.empty()) {
      return FailAt(file_, LineAt(loads.offset_debug()),
                    "ExternalLoads holds no ExternalForce that is switched on");
    }
    return std::move(forces_);
  }

 private:
  [[nodiscard]] long LineAt(std::ptrdiff_t offset) const {
    const auto end = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    return 1 + std::count(text_.begin(), text_.begin() + end, '\n');
  }

  // OpenSim writes unknown names as "Unassigned".
  static std::string Value(const pugi::xml_node& node, const char* element) {
    std::string value(Trim(node.child_value(element)));
    return value == "Unassigned" ? std::string() : value;
  }

  static bool IsOff(const pugi::xml_node& node) {
    return Lowercase(Value(node, "isDisabled")) == "true" ||
           Lowercase(Value(node, "appliesForce")) == "false";
  }

  Status ParseForce(const pugi::xml_node& node) {
    if (IsOff(node)) return {};
    const long line = LineAt(node.offset_debug());
    ExternalForce force;
    force.name = Trim(node.attribute("name").value());
    force.applied_to_body = Value(node, "applied_to_body");
    force.force_identifier = Value(node, "force_identifier");
    force.point_identifier = Value(node, "point_identifier");
    force.torque_identifier = Value(node, "torque_identifier");
    if (force.name.empty()) return FailAt(file_, line, "an ExternalForce has no name");
    if (force.applied_to_body.empty())
      return FailAt(file_, line, "{} has no applied_to_body", Quoted(force.name));
    if (force.force_identifier.empty())
      return FailAt(file_, line, "{} has no force_identifier", Quoted(force.name));
    for (const char* element : {"force_expressed_in_body", "point_expressed_in_body"}) {
      const std::string body = Value(node, element);
      if (!body.empty() && body != "ground" && body != "/ground") {
        return FailAt(file_, line, "{}: {} is {}, expected ground", Quoted(force.name), element,
                      Quoted(body));
      }
    }
    for (const ExternalForce& other : forces_) {
      if (other.name == force.name)
        return FailAt(file_, line, "the name {} appears twice", Quoted(force.name));
    }
    forces_.push_back(std::move(force));
    return {};
  }

  std::string_view text_;
  const std::string& file_;
  std::vector<ExternalForce> forces_;
};

}  // namespace

Result<std::vector<ExternalForce>> ParseExternalLoads(std::string_view text, const std::string& file) {
  return LoadsParser(text, file).Parse();
}

Result<std::vector<ExternalForce>> ReadExternalLoads(const std::string& path) {
  SINEW_ASSIGN(const std::string text, ReadTextFile(path));
  return ParseExternalLoads(text, path);
}

}  // namespace sinew
