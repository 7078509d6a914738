#include "problems/nms/ceinms/rt_calibration.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "base/xml_document.h"
#include "problems/nms/settings.h"

namespace sinew {
namespace {

// Every objective function frees the shape factor; the names do not show that optimal fibre lengths are free,
// too.
struct Objective {
  const char* name;
  const char* shape;      // how it is shared
  double slack_length;    // share of the subject's value, both ways; 0: not free, nor is the strength
  double optimal_length;  // share of the subject's value, both ways
};
constexpr Objective kObjectives[] = {
    {"ShapeFactor", "single", 0, 0},
    {"StrengthCoefficients_ShapeFactor_TendonSlackLength_single", "single", 0.05, 0.025},
    {"StrengthCoefficients_ShapeFactor_TendonSlackLength_single_widerRange", "single", 0.15, 0.25},
    {"GroupedStrengthCoefficients_IndividualLstLom", "global", 0.05, 0.025},
};
constexpr const char* kShapeRange = "lower: -2.999, upper: -0.001";
constexpr const char* kStrengthRange = "lower: 0.5, upper: 1.5";

std::string Around(double share) {
  return fmt::format("{{share: single, lower: {}, upper: {}, relative: true}}", 1 - share, 1 + share);
}

class RtReader {
 public:
  RtReader(const XmlDocument& xml, CeinmsRtCalibration& out) : xml_(xml), out_(out) {}

  Status Read() {
    const pugi::xml_node root = xml_.root();
    SINEW_ASSIGN(out_.osim, Text(root, "osimFile"));
    out_.emg_processing = TextOrNone(root, "EMGProccesing");  // CEINMS-RT's spelling
    SINEW_ASSIGN(out_.prescaled, xml_.Flag(root.child("preScaling"), "use", false));
    const pugi::xml_node calibration = root.child("calibration");
    if (!calibration) return xml_.FailAt(root, "<simulatedAnnealing> has no <calibration>");
    SINEW_ASSIGN(const bool used, xml_.Flag(calibration, "use", true));
    if (!used) Note(calibration.child("use"), "CEINMS-RT would not calibrate; here everything is imported");
    SINEW_ASSIGN(out_.objective, Text(calibration, "objectiveFunction"));
    const auto known = CeinmsRtObjectives();
    if (std::find(known.begin(), known.end(), out_.objective.text) == known.end())
      return xml_.FailAt(calibration.child("objectiveFunction"), "CEINMS-RT has no objective function '{}'{}",
                         out_.objective.text, Suggestion(out_.objective.text, known));
    SINEW_ASSIGN(out_.raw_emg, xml_.Flag(calibration, "filterEMG", false));
    SINEW_ASSIGN(out_.emg_delay_s, xml_.Number(calibration, "EMD", 0));
    if (!(out_.emg_delay_s >= 0 && out_.emg_delay_s <= 1))
      return xml_.FailAt(calibration.child("EMD"), "EMD is {} s, expected 0 to 1", out_.emg_delay_s);
    SINEW_ASSIGN(out_.subject, Text(calibration, "inputSubjectXMLName"));
    SINEW_TRY(ReadJoints(calibration));
    SINEW_TRY(ReadTrials(calibration));
    NoteOthers(calibration);
    return {};
  }

 private:
  CeinmsRtText TextOrNone(const pugi::xml_node& parent, const char* child) const {
    const pugi::xml_node element = parent.child(child);
    return {ChildText(parent, child), element ? xml_.Line(element) : 0};
  }

  Result<CeinmsRtText> Text(const pugi::xml_node& parent, const char* child) const {
    CeinmsRtText text = TextOrNone(parent, child);
    if (text.text.empty()) return xml_.FailAt(parent, "<{}> has no <{}>", parent.name(), child);
    return text;
  }

  // Every <dofs> is a step: its muscles are calibrated to its joints' moments, then the next one's.
  Status ReadJoints(const pugi::xml_node& calibration) {
    const pugi::xml_node list = calibration.child("dofToCalibrate");
    for (const pugi::xml_node& step : list.children("dofs")) {
      out_.steps.emplace_back();
      std::string words = step.text().get();
      std::replace_if(
          words.begin(), words.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
      for (const std::string_view word : SplitBlanks(words)) {
        out_.steps.back().emplace_back(word);
        if (std::find(out_.joints.begin(), out_.joints.end(), word) == out_.joints.end())
          out_.joints.emplace_back(word);
      }
    }
    if (out_.joints.empty())
      return xml_.FailAt(list ? list : calibration, "<dofToCalibrate><dofs> names no joint coordinate");
    out_.joints_line = xml_.Line(list);
    if (out_.steps.size() > 1)
      Note(list, fmt::format("{} steps of joints: `sinew identify nms` fits all at once, `sinew identify nms "
                             "--stepwise` one after the other as CEINMS-RT does",
                             out_.steps.size()));
    return {};
  }

  Status ReadTrials(const pugi::xml_node& calibration) {
    const pugi::xml_node list = calibration.child("trials");
    if (!list) return xml_.FailAt(calibration, "<calibration> has no <trials>");
    SINEW_ASSIGN(out_.directory, Text(list, "directory"));
    for (const pugi::xml_node& element : list.children("trial")) {
      CeinmsRtTrial trial;
      trial.line = xml_.Line(element);
      trial.name = ChildText(element, "trialName");
      if (trial.name.empty()) return xml_.FailAt(element, "<trial> has no <trialName>");
      bool given_are_finite = true;
      for (const auto& [name, value] :
           {std::pair{"cropMinTimeFromZero", &trial.from_s}, std::pair{"cropMaxTimeFromZero", &trial.to_s}}) {
        if (!element.child(name)) continue;  // all that there is
        SINEW_ASSIGN(*value, xml_.Number(element, name, *value));
        given_are_finite = given_are_finite && std::isfinite(*value);
      }
      const bool from_begin = std::isinf(trial.from_s);
      if (!(given_are_finite && (from_begin || trial.from_s >= 0) &&
            std::max(trial.from_s, 0.0) < trial.to_s))
        return xml_.FailAt(
            element,
            "trial '{}': the window {} to {} s is none, expected cropMinTimeFromZero of at least "
            "0 and below cropMaxTimeFromZero",
            trial.name, trial.from_s, trial.to_s);
      NoteUnknown(element, {"trialName", "cropMinTimeFromZero", "cropMaxTimeFromZero"});
      out_.trials.push_back(std::move(trial));
    }
    if (out_.trials.empty()) return xml_.FailAt(list, "<trials> names no trial");
    return {};
  }

  void NoteOthers(const pugi::xml_node& calibration) {
    NoteUnknown(xml_.root(), {"EMGProccesing", "osimFile", "subjectXML", "nameOfSubject", "dofsSpline",
                              "computeSpline", "preScaling", "calibration"});
    NoteUnknown(calibration, {"use", "objectiveFunction", "filterEMG", "EMD", "dofToCalibrate", "trials",
                              "option", "inputSubjectXMLName", "outputSubjectXMLName"});
    if (calibration.child("option"))
      Note(calibration.child("option"),
           "settings of its annealing are not read: `identify --solver` chooses");
  }

  void NoteUnknown(const pugi::xml_node& parent, const std::set<std::string>& known) {
    for (const pugi::xml_node& element : Elements(parent)) {
      if (known.count(element.name()) == 0) Note(element, fmt::format("<{}> is not read", element.name()));
    }
  }

  void Note(const pugi::xml_node& element, const std::string& words) {
    out_.notes.push_back(fmt::format("{}:{}: {}", xml_.file_name(), xml_.Line(element), words));
  }

  const XmlDocument& xml_;
  CeinmsRtCalibration& out_;
};

}  // namespace

Result<CeinmsRtCalibration> ReadCeinmsRtCalibration(const std::string& text, const std::string& file) {
  SINEW_ASSIGN(const XmlDocument xml, XmlDocument::Parse(text, file));
  if (std::string_view(xml.root().name()) != "simulatedAnnealing")
    return xml.FailAt(xml.root(), "the outermost element is <{}>, expected <simulatedAnnealing>",
                      xml.root().name());
  CeinmsRtCalibration out;
  SINEW_TRY(RtReader(xml, out).Read());
  return out;
}

std::vector<std::string> CeinmsRtObjectives() {
  std::vector<std::string> names;
  for (const Objective& objective : kObjectives) names.emplace_back(objective.name);
  return names;
}

std::vector<CeinmsParameter> CeinmsRtParameters(const std::string& objective, const Subject& subject,
                                                const std::vector<std::string>& joints) {
  const auto* found = std::find_if(std::begin(kObjectives), std::end(kObjectives),
                                   [&](const Objective& o) { return objective == o.name; });
  if (found == std::end(kObjectives)) return {};
  std::vector<CeinmsParameter> parameters;
  parameters.push_back({"shape", fmt::format("{{share: {}, {}}}", found->shape, kShapeRange)});
  if (found->slack_length == 0) return parameters;

  std::vector<std::pair<double, std::vector<std::string>>> groups;
  for (const std::string& muscle : MusclesOf(subject, joints)) {
    const double strength = subject.Find(muscle)->strength_coefficient;
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == strength; });
    if (group == groups.end()) group = groups.insert(groups.end(), {strength, {}});
    group->second.push_back(muscle);
  }
  std::string members;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto& muscles = groups[i].second;
    members += fmt::format("{}{}: [{}]", i > 0 ? ", " : "",
                           muscles.size() == 1 ? muscles.front() : fmt::format("group_{}", i + 1),
                           Join(muscles, ", "));
  }
  parameters.push_back({"strength", fmt::format("{{groups: {{{}}}, {}}}", members, kStrengthRange)});
  parameters.push_back({"tendon_slack_length", Around(found->slack_length)});
  parameters.push_back({"optimal_length", Around(found->optimal_length)});
  return parameters;
}

}  // namespace sinew
