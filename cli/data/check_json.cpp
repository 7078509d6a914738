#include "cli/data/check_json.h"

#include "cli/data/check_text.h"
#include "datasets/check/mask.h"
#include "datasets/dataset_hash.h"

namespace sinew {
namespace {

using Json = nlohmann::ordered_json;

Json SpanJson(const TimeSpan& span) {
  return {{"from_s", span.from}, {"to_s", span.to}};
}

Json FindingJson(const Dataset& data, const Finding& finding) {
  Json json{{"kind", ToString(finding.kind)}, {"trial", finding.trial},        {"grid", finding.grid},
            {"channel", finding.channel},     {"unit", finding.unit},          {"whole", finding.whole},
            {"size", finding.size},           {"usual", finding.usual},        {"among", finding.among},
            {"other", finding.other},         {"undecided", finding.undecided}};
  json["spans"] = Json::array();
  for (const TimeSpan& span : finding.spans) json["spans"].push_back(SpanJson(span));
  json["sentence"] = text::FindingText(finding);
  json["advice"] = text::AdviceText(finding);
  json["mask"] = Json::array();
  for (const MaskedSpan& span : SuggestMask(data, finding)) {
    Json mask{{"grid", span.grid}, {"channel", span.channel}};
    mask.update(SpanJson(span.span));
    json["mask"].push_back(mask);
  }
  return json;
}

}  // namespace

Json CheckJson(const Dataset& data, const CheckReport& report) {
  Json json{{"schema", "sinew.check/1"},
            {"hash", DatasetHash(data)},
            {"trials", report.trials},
            {"channels", report.channels}};
  json["findings"] = Json::array();
  for (const Finding& finding : report.findings) json["findings"].push_back(FindingJson(data, finding));
  return json;
}

}  // namespace sinew
