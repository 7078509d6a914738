#include "problems/nms/ceinms/rt_emg.h"

#include <algorithm>
#include <cmath>

#include "base/xml_document.h"

namespace sinew {
namespace {

Result<FilterSections> ReadFilter(const XmlDocument& xml, const char* name) {
  const pugi::xml_node element = xml.root().child(name);
  if (!element) return xml.FailAt(xml.root(), "<executionEMG> has no <{}>", name);
  SINEW_ASSIGN(std::vector<double> a, xml.Numbers(element, "aCoeff"));
  SINEW_ASSIGN(std::vector<double> b, xml.Numbers(element, "bCoeff"));
  if (b.empty() || b.size() > 3 || a.size() > 2)
    return xml.FailAt(element, "<{}> has {} aCoeff and {} bCoeff, expected at most 2 and 1 to 3", name,
                      a.size(), b.size());
  a.resize(2);
  b.resize(3);
  const auto finite = [](double v) { return std::isfinite(v); };
  const bool settles = std::abs(a[1]) < 1 && std::abs(a[0]) < 1 + a[1];
  if (!settles || !std::all_of(b.begin(), b.end(), finite))
    return xml.FailAt(element, "<{}> with aCoeff {} {} never settles, or a bCoeff is not finite", name, a[0],
                      a[1]);
  return FilterSections{{b[0], b[1], b[2], a[0], a[1]}};
}

}  // namespace

Result<CeinmsRtEmg> ReadCeinmsRtEmg(const std::string& text, const std::string& file) {
  SINEW_ASSIGN(const XmlDocument xml, XmlDocument::Parse(text, file));
  if (std::string_view(xml.root().name()) != "executionEMG")
    return xml.FailAt(xml.root(), "the outermost element is <{}>, expected <executionEMG>",
                      xml.root().name());
  CeinmsRtEmg emg;
  SINEW_ASSIGN(emg.high_pass, ReadFilter(xml, "hpFilter"));
  SINEW_ASSIGN(emg.low_pass, ReadFilter(xml, "lpFilter"));
  SINEW_ASSIGN(emg.greatest, xml.Numbers(xml.root(), "maxEMG"));
  for (const double value : emg.greatest) {
    if (!(value >= 0 && std::isfinite(value)))
      return xml.FailAt(xml.root().child("maxEMG"), "maxEMG has {}, expected numbers of at least 0", value);
  }
  return emg;
}

std::vector<double> CeinmsRtEnvelope(const CeinmsRtEmg& emg, const std::vector<double>& raw) {
  CausalFilter high(emg.high_pass);
  CausalFilter low(emg.low_pass);
  std::vector<double> envelope;
  envelope.reserve(raw.size());
  for (const double value : raw) envelope.push_back(low.Next(std::abs(high.Next(value))));
  return envelope;
}

}  // namespace sinew
