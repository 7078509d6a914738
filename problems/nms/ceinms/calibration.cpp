#include "problems/nms/ceinms/calibration.h"

#include <algorithm>
#include <optional>

#include "base/text.h"
#include "base/xml_document.h"

namespace sinew {
namespace {

// How a parameter is shared and bounded, in nms.yaml's words.
struct Range {
  std::string share;
  std::string numbers;
  double lower = 0;
  double upper = 0;
};

struct Name {
  const char* ceinms;
  const char* ours;
};
constexpr Name kNames[] = {
    {"shapeFactor", "shape"},
    {"emDelay", "delay"},
    {"optimalFibreLength", "optimal_length"},
    {"optimalFiberLength", "optimal_length"},
    {"pennationAngle", "pennation"},
    {"tendonSlackLength", "tendon_slack_length"},
    {"maxIsometricForce", "isometric_force"},
    {"strengthCoefficient", "strength"},
    {"percentageChange", "length_change"},
    {"damping", "damping"},
    {"maxContractionVelocity", "largest_velocity"},
};
// Half of the distance between C1 and C2 is (1 + mean) sqrt(spread).
constexpr double kWidestSpread = 0.81;

class Reader {
 public:
  Reader(const XmlDocument& xml, CeinmsCalibration& out) : xml_(xml), out_(out) {}

  Status ReadModel(const pugi::xml_node& model) {
    const auto choose = [&](const char* element, std::initializer_list<Name> choices,
                            std::string& chosen) -> Status {
      const auto children = Elements(model.child(element));
      if (children.empty()) return {};
      const std::string word = children.front().name();
      std::vector<std::string> known;
      for (const Name& choice : choices) {
        known.emplace_back(choice.ceinms);
        if (word != choice.ceinms) continue;
        chosen = choice.ours;
        return {};
      }
      return xml_.FailAt(children.front(), "<{}> has no kind <{}>{}", element, word, Suggestion(word, known));
    };
    SINEW_TRY(
        choose("tendon",
               {{"stiff", "rigid"}, {"equilibriumElastic", "equilibrium"}, {"integrationElastic", "elastic"}},
               out_.tendon));
    SINEW_TRY(
        choose("activation", {{"exponential", "exponential"}, {"piecewise", "piecewise"}}, out_.activation));
    std::string type = "openLoop";
    SINEW_TRY(choose("type", {{"openLoop", "openLoop"}, {"hybrid", "hybrid"}}, type));
    if (type == "hybrid") return ReadHybrid(model.child("type").child("hybrid"));
    return {};
  }

  Status ReadHybrid(const pugi::xml_node& element) {
    CeinmsHybrid hybrid;
    hybrid.line = xml_.Line(element);
    for (const auto& [name, value] :
         {std::pair{"alpha", &hybrid.alpha}, {"beta", &hybrid.beta}, {"gamma", &hybrid.gamma}}) {
      if (!element.child(name)) return xml_.FailAt(element, "<hybrid> has no <{}>", name);
      SINEW_ASSIGN(*value, xml_.Number(element, name, 0));
      const bool is_alpha = value == &hybrid.alpha;
      if (!(is_alpha ? *value > 0 : *value >= 0)) {
        return xml_.FailAt(element.child(name), "<{}> is {}, expected a number {} 0", name, *value,
                           is_alpha ? "above" : "of at least");
      }
    }
    // The second names are those of versions before 2015.
    const auto words = [&](const char* name, const char* old_name) {
      return ChildWords(element, element.child(name) ? name : old_name);
    };
    hybrid.synthesise = words("synthMTUs", "predictedMuscles");
    hybrid.adjust = words("adjustMTUs", "trackedMuscles");
    hybrid.joints = ChildWords(element, "dofSet");
    if (hybrid.synthesise.empty() && hybrid.adjust.empty())
      return xml_.FailAt(element, "<hybrid> names no muscle in <synthMTUs> or <adjustMTUs>");
    out_.notes.push_back(
        fmt::format("{}, line {}: hybrid: `sinew simulate nms` adjusts the excitations; fits are open loop. "
                    "beta weighs the "
                    "effort and gamma the distance to the measured excitations, as Pizzolato et al. 2015 and "
                    "CEINMS-RT have "
                    "it; there are versions of CEINMS that exchange the two",
                    xml_.file_name(), hybrid.line));
    out_.hybrid = std::move(hybrid);
    return {};
  }

  Status ReadStep(const pugi::xml_node& step) {
    for (const std::string& joint : ChildWords(step, "dofs")) {
      if (std::find(out_.joints.begin(), out_.joints.end(), joint) == out_.joints.end())
        out_.joints.push_back(joint);
    }
    const auto objective = Elements(step.child("objectiveFunction"));
    if (!objective.empty() && std::string_view(objective.front().name()) != "minimizeTorqueError") {
      out_.notes.push_back(
          fmt::format("{}, line {}: objective <{}> is not known: the error of the moments is",
                      xml_.file_name(), xml_.Line(objective.front()), objective.front().name()));
    }
    std::optional<Range> c1;
    std::optional<Range> c2;
    for (const pugi::xml_node& parameter : Elements(step.child("parameterSet"))) {
      const std::string name = ChildText(parameter, "name");
      SINEW_ASSIGN(const Range range, ReadRange(parameter, name));
      if (name == "c1" || name == "C1") {
        c1 = range;
      } else if (name == "c2" || name == "C2") {
        c2 = range;
      } else {
        const auto* known = std::find_if(std::begin(kNames), std::end(kNames),
                                         [&](const Name& n) { return name == n.ceinms; });
        if (known == std::end(kNames)) {
          std::vector<std::string> names{"c1", "c2"};
          for (const Name& n : kNames) names.emplace_back(n.ceinms);
          return xml_.FailAt(parameter, "parameter '{}' does not exist{}", name, Suggestion(name, names));
        }
        Add(known->ours, range);
      }
    }
    if (c1 || c2) AddFilter(c1 ? *c1 : *c2, c1 && c2);
    CeinmsStep made{ChildWords(step, "dofs"), {}};
    for (const pugi::xml_node& parameter : Elements(step.child("parameterSet"))) {
      const std::string name = ChildText(parameter, "name");
      const auto* known =
          std::find_if(std::begin(kNames), std::end(kNames), [&](const Name& n) { return name == n.ceinms; });
      if (known != std::end(kNames)) made.parameters.emplace_back(known->ours);
    }
    if (c1 || c2) made.parameters.insert(made.parameters.end(), {"filter_mean", "filter_spread"});
    out_.steps.push_back(std::move(made));
    return {};
  }

 private:
  Result<Range> ReadRange(const pugi::xml_node& parameter, const std::string& name) const {
    Range range;
    const bool relative = static_cast<bool>(parameter.child("relativeToSubjectValue"));
    const pugi::xml_node bounds = parameter.child(relative ? "relativeToSubjectValue" : "absolute");
    if (!bounds) {
      return xml_.FailAt(parameter, "parameter '{}' has neither <absolute> nor <relativeToSubjectValue>",
                         name);
    }
    SINEW_ASSIGN(const auto numbers, xml_.Numbers(bounds, "range"));
    if (numbers.size() != 2 || !(numbers[0] < numbers[1]))
      return xml_.FailAt(bounds, "the range of '{}' is not two increasing numbers", name);
    range.lower = numbers[0];
    range.upper = numbers[1];
    range.numbers =
        fmt::format("lower: {}, upper: {}{}", numbers[0], numbers[1], relative ? ", relative: true" : "");
    if (parameter.child("global")) {
      range.share = "share: global";
    } else if (parameter.child("muscleGroups")) {
      int count = 0;
      for (const pugi::xml_node& group : Elements(parameter.child("muscleGroups"))) {
        const auto words = Split(group.text().get(), ' ');
        std::string members;
        std::string first;
        int size = 0;
        for (const auto word : words) {
          if (word.empty()) continue;
          members += (members.empty() ? "" : ", ") + std::string(word);
          if (first.empty()) first = word;
          ++size;
        }
        if (members.empty()) return xml_.FailAt(group, "a muscle group of '{}' is empty", name);
        ++count;
        range.share += fmt::format("{}{}: [{}]", count > 1 ? ", " : "",
                                   size == 1 ? first : fmt::format("group_{}", count), members);
      }
      range.share = "groups: {" + range.share + "}";
    } else if (parameter.child("single")) {
      range.share = "share: single";
    } else {
      return xml_.FailAt(parameter, "parameter '{}' is neither <single>, <global> nor <muscleGroups>", name);
    }
    return range;
  }

  void Add(const std::string& name, const Range& range) {
    const bool again = std::any_of(out_.parameters.begin(), out_.parameters.end(),
                                   [&](const CeinmsParameter& p) { return p.name == name; });
    if (again) {
      out_.notes.push_back(fmt::format("{}: '{}' is in several steps: the range of the first one counts",
                                       xml_.file_name(), name));
      return;
    }
    out_.parameters.push_back({name, "{" + range.share + ", " + range.numbers + "}"});
  }

  void AddFilter(const Range& range, bool both) {
    Add("filter_mean", range);
    Range spread = range;
    spread.numbers = fmt::format("lower: 0, upper: {}", kWidestSpread);
    Add("filter_spread", spread);
    out_.notes.push_back(
        fmt::format("{}: c1 and c2 can be exchanged without any change: their mean and their distance are "
                    "fitted instead{}",
                    xml_.file_name(), both ? "" : ", both of them, though the file names one"));
  }

  const XmlDocument& xml_;
  CeinmsCalibration& out_;
};

// What CEINMS users let their calibrations move, SCIENCE section 3.
const CeinmsParameter kUsual[] = {
    {"filter_mean", "{share: single, lower: -0.95, upper: -0.05}"},
    {"filter_spread", "{share: single, lower: 0, upper: 0.81}"},
    {"shape", "{share: single, lower: -2.999, upper: -0.001}"},
    {"tendon_slack_length", "{share: single, lower: 0.85, upper: 1.15, relative: true}"},
    {"strength", "{share: single, lower: 0.5, upper: 2.5}"},
};

}  // namespace

Result<CeinmsCalibration> ReadCeinmsCalibration(const std::string& text, const std::string& file) {
  SINEW_ASSIGN(const XmlDocument xml, XmlDocument::Parse(text, file));
  CeinmsCalibration out;
  Reader reader(xml, out);
  const std::string_view root = xml.root().name();
  if (root == "execution") {
    SINEW_TRY(reader.ReadModel(xml.root().child("NMSmodel")));
    if (out.hybrid && xml.root().child("online")) {
      out.notes.push_back(
          fmt::format("{}, line {}: <online/>: fibre velocities are those of the whole trial, as "
                      "<offline/> has them",
                      file, xml.Line(xml.root().child("online"))));
    }
    out.parameters.assign(std::begin(kUsual), std::end(kUsual));
    if (out.activation == "piecewise") out.parameters[2].entry = "{share: single, lower: 0, upper: 0.12}";
    return out;
  }
  if (root != "calibration")
    return xml.FailAt(xml.root(), "the outermost element is <{}>, expected <calibration> or <execution>",
                      root);
  SINEW_TRY(reader.ReadModel(xml.root().child("NMSmodel")));
  const auto steps = Elements(xml.root().child("calibrationSteps"));
  for (const pugi::xml_node& step : steps) SINEW_TRY(reader.ReadStep(step));
  if (steps.size() > 1) {
    out.notes.push_back(
        fmt::format("{}: {} steps: `sinew identify nms` fits everything at once, `sinew identify nms "
                    "--stepwise` one step after the other as CEINMS does",
                    file, steps.size()));
  }
  if (out.parameters.empty()) return xml.FailAt(xml.root(), "no calibration step names a parameter");
  out.trials = ChildWords(xml.root(), "trialSet");
  if (out.trials.empty()) return xml.FailAt(xml.root(), "<trialSet> names no trial");
  return out;
}

namespace {

std::string List(const std::vector<std::string>& names) {
  return "[" + Join(names, ", ") + "]";
}

}  // namespace

std::string SettingsText(const CeinmsCalibration& calibration) {
  std::string text =
      "# How the nms problem sees this CEINMS project.\nnms:\n  subject: subject.xml\n"
      "  as_ceinms: true   # CEINMS's own numbers; false: smooth curves, delays between samples\n";
  text += "  tendon: " + calibration.tendon + "\n  activation: " + calibration.activation + "\n";
  text += "  objective: thesis\n";
  if (calibration.fibre_range) text += "  fibre_range: {lower: 0.5, upper: 1.5}\n";
  if (!calibration.joints.empty()) text += "  joints: " + List(calibration.joints) + "\n";
  if (calibration.hybrid) {
    const CeinmsHybrid& hybrid = *calibration.hybrid;
    text +=
        fmt::format("  mode: {{type: {}, alpha: {}, beta: {}, gamma: {}, synthesise: {}, adjust: {}{}}}\n",
                    hybrid.adjust.empty() ? "hybrid" : "assisted", hybrid.alpha, hybrid.beta, hybrid.gamma,
                    List(hybrid.synthesise), List(hybrid.adjust),
                    hybrid.joints.empty() ? "" : ", joints: " + List(hybrid.joints));
  }
  if (calibration.steps.size() > 1) {
    text += "  steps:   # of `sinew identify nms --stepwise`\n";
    for (const CeinmsStep& step : calibration.steps)
      text += "    - {" + (step.joints.empty() ? "" : "joints: " + List(step.joints) + ", ") +
              "parameters: " + List(step.parameters) + "}\n";
  }
  text += "  parameters:\n";
  for (const CeinmsParameter& parameter : calibration.parameters)
    text += "    " + parameter.name + ": " + parameter.entry + "\n";
  return text;
}

}  // namespace sinew
