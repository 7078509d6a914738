#include "problems/nms/ceinms/rt_execution.h"

#include "base/text.h"
#include "base/xml_document.h"

namespace sinew {
namespace {

// The only element in another one; an empty node if there is none.
pugi::xml_node Chosen(const pugi::xml_node& parent) {
  const auto children = Elements(parent);
  return children.empty() ? pugi::xml_node() : children.front();
}

}  // namespace

Result<CeinmsRtExecution> ReadCeinmsRtExecution(const std::string& text, const std::string& file) {
  SINEW_ASSIGN(const XmlDocument xml, XmlDocument::Parse(text, file));
  const pugi::xml_node root = xml.root();
  if (std::string_view(root.name()) != "execution")
    return xml.FailAt(root, "the outermost element is <{}>, expected <execution>", root.name());
  const pugi::xml_node model = root.child("NMSmodel");
  if (!model) return xml.FailAt(root, "<execution> has no <NMSmodel>");

  CeinmsRtExecution out;
  const pugi::xml_node tendon = Chosen(model.child("tendon"));
  const std::string kind = tendon.name();
  if (kind == "stiff") {
    out.tendon = "rigid";
  } else if (kind == "elastic") {
    out.tendon = "equilibrium";
    out.notes.push_back(fmt::format(
        "{}:{}: tendon: CEINMS-RT looks for the equilibrium with next to no fibre velocity; here it "
        "is that of a spline through the fibre lengths",
        file, xml.Line(tendon)));
  } else if (kind == "elasticBiSec") {
    // Its velocity is (length - length before) / step inside the equilibrium: an implicit Euler step.
    out.tendon = "elastic";
    out.notes.push_back(fmt::format(
        "{}:{}: tendon: fibre lengths are integrated; where CEINMS-RT finds no equilibrium it takes "
        "the tendon as rigid, here that is a failure",
        file, xml.Line(tendon)));
  } else {
    return xml.FailAt(tendon ? tendon : model, "<tendon> has no kind <{}>{}", kind,
                      Suggestion(kind, {"stiff", "elastic", "elasticBiSec"}));
  }
  const pugi::xml_node activation = Chosen(model.child("activation"));
  if (activation && std::string_view(activation.name()) != "exponential")
    return xml.FailAt(activation, "activation <{}>: CEINMS-RT calibrates <exponential> only",
                      activation.name());
  pugi::xml_node type = Chosen(model.child("type"));
  if (std::string_view(type.name()) == "realTime") type = Chosen(type);
  if (type && std::string_view(type.name()) != "openLoop")
    out.notes.push_back(fmt::format("{}:{}: <{}> is not read: what is fitted is open loop", file,
                                    xml.Line(type), type.name()));
  return out;
}

}  // namespace sinew
