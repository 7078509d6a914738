#include "problems/nms/ceinms/subject.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/constants.h"
#include "base/text.h"
#include "base/xml_document.h"

namespace sinew {
namespace {

// A value of a muscle under its names in both dialects.
struct Entry {
  const char* ceinms;
  const char* realtime;
  double SubjectMuscle::*value;
  double lower;
  double upper;
  bool required;
};
constexpr double kHuge = 1e9;
constexpr double kTiny = 1e-9;
constexpr double kStable = 0.9999;  // a filter with a pole on the unit circle never settles
const Entry kEntries[] = {
    {"c1", "C1", &SubjectMuscle::c1, -kStable, kStable, false},
    {"c2", "C2", &SubjectMuscle::c2, -kStable, kStable, false},
    {"shapeFactor", "shapeFactor", &SubjectMuscle::shape_factor, -10, 1, false},
    {"emDelay", "emDelay", &SubjectMuscle::delay, 0, 1, false},
    {"optimalFibreLength", "optimalFiberLength", &SubjectMuscle::optimal_fibre_length, kTiny, 10, true},
    {"pennationAngle", "pennationAngle", &SubjectMuscle::pennation_angle, 0, kPi / 2, true},
    {"tendonSlackLength", "tendonSlackLength", &SubjectMuscle::tendon_slack_length, kTiny, 10, true},
    {"maxIsometricForce", "maxIsometricForce", &SubjectMuscle::maximal_isometric_force, kTiny, kHuge, true},
    {"strengthCoefficient", "strengthCoefficient", &SubjectMuscle::strength_coefficient, kTiny, 1000, false},
    {"percentageChange", "percentageChange", &SubjectMuscle::percentage_change, 0, 10, false},
    {"damping", "damping", &SubjectMuscle::damping, 0, 1000, false},
    {"maxContractionVelocity", "maxContractionVelocity", &SubjectMuscle::maximal_contraction_velocity, kTiny,
     kHuge, false},
};

constexpr const char* kCurveNames[kSubjectCurves] = {"activeForceLength", "passiveForceLength",
                                                     "forceVelocity", "tendonForceStrain"};
struct Dialect {
  bool realtime = false;
  const char* defaults = "mtuDefault";
  const char* muscles = "mtuSet";
  const char* muscle = "mtu";
  const char* curve = "curve";
  const char* dofs = "dofSet";
  const char* dof = "dof";
  const char* members = "mtuNameSet";

  [[nodiscard]] const char* NameOf(const Entry& entry) const {
    return realtime ? entry.realtime : entry.ceinms;
  }
  [[nodiscard]] double Factor(const Entry& entry) const {
    return realtime && entry.value == &SubjectMuscle::pennation_angle ? kPi / 180 : 1;
  }
};
constexpr Dialect kRealtime{true,    "muscleDefault", "muscles", "muscle",
                            "Curve", "DoFs",          "DoF",     "muscleSequence"};

Result<Dialect> DialectOf(const XmlDocument& xml) {
  const pugi::xml_node root = xml.root();
  if (std::string_view(root.name()) != "subject")
    return xml.FailAt(root, "the outermost element is <{}>, expected <subject>", root.name());
  if (root.child("mtuSet")) return Dialect{};
  if (root.child("muscles")) return kRealtime;
  return xml.FailAt(root, "<subject> has no <mtuSet> (CEINMS) and no <muscles> (CEINMS-RT)");
}

Status ReadValues(const XmlDocument& xml, const Dialect& dialect, const pugi::xml_node& element,
                  SubjectMuscle& muscle) {
  for (const Entry& entry : kEntries) {
    const char* name = dialect.NameOf(entry);
    const pugi::xml_node child = element.child(name);
    if (!child) continue;
    const double factor = dialect.Factor(entry);
    SINEW_ASSIGN(const double number, xml.Number(element, name, 0));
    if (!(number * factor >= entry.lower && number * factor <= entry.upper))
      return xml.FailAt(child, "{} is {}, expected {} to {}", name, number, entry.lower / factor,
                        entry.upper / factor);
    muscle.*entry.value = number * factor;
  }
  return {};
}

Status ReadCurves(const XmlDocument& xml, const Dialect& dialect, const pugi::xml_node& defaults,
                  Subject& subject) {
  std::array<bool, kSubjectCurves> found{};
  for (const pugi::xml_node& element : Elements(defaults)) {
    if (std::string_view(element.name()) != dialect.curve) continue;
    const std::string name = ChildText(element, "name");
    const auto* at = std::find(std::begin(kCurveNames), std::end(kCurveNames), name);
    if (at == std::end(kCurveNames)) {
      return xml.FailAt(element, "curve '{}' does not exist{}", name,
                        Suggestion(name, {std::begin(kCurveNames), std::end(kCurveNames)}));
    }
    const auto which = static_cast<std::size_t>(at - kCurveNames);
    CurvePoints& points = subject.curves[which];
    SINEW_ASSIGN(points.x, xml.Numbers(element, "xPoints"));
    SINEW_ASSIGN(points.y, xml.Numbers(element, "yPoints"));
    const auto finite = [](double v) { return std::isfinite(v); };
    if (points.x.size() < 2 || points.x.size() != points.y.size())
      return xml.FailAt(element, "curve '{}' has {} xPoints and {} yPoints, expected two or more of each",
                        name, points.x.size(), points.y.size());
    if (!std::all_of(points.x.begin(), points.x.end(), finite) ||
        !std::all_of(points.y.begin(), points.y.end(), finite) ||
        std::adjacent_find(points.x.begin(), points.x.end(), std::greater_equal<>()) != points.x.end())
      return xml.FailAt(element, "xPoints of curve '{}' do not increase, or a point is not finite", name);
    found[which] = true;
  }
  if (!found[kTendonForceStrain]) {
    // CEINMS-RT builds the tendon's curve in.
    subject.curves[kTendonForceStrain] = CeinmsCurvePoints()[kTendonForceStrain];
    found[kTendonForceStrain] = dialect.realtime;
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) return xml.FailAt(defaults, "there is no curve '{}'", kCurveNames[i]);
  }
  return {};
}

Result<std::vector<std::pair<std::string, std::vector<std::string>>>> ReadGroups(const XmlDocument& xml,
                                                                                 const pugi::xml_node& set,
                                                                                 const char* group,
                                                                                 const char* members,
                                                                                 const Subject& subject) {
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;
  std::set<std::string> seen;
  for (const pugi::xml_node& element : Elements(set)) {
    if (std::string_view(element.name()) != group) continue;
    std::string name = ChildText(element, "name");
    if (name.empty()) return xml.FailAt(element, "<{}> has no name", group);
    if (!seen.insert(name).second) return xml.FailAt(element, "'{}' is there twice", name);
    std::vector<std::string> muscles = ChildWords(element, members);
    for (const std::string& muscle : muscles) {
      if (subject.Find(muscle) != nullptr) continue;
      std::vector<std::string> names;
      for (const SubjectMuscle& m : subject.muscles) names.push_back(m.name);
      return xml.FailAt(element, "'{}' names the muscle '{}', which is not in the file{}", name, muscle,
                        Suggestion(muscle, names));
    }
    groups.emplace_back(std::move(name), std::move(muscles));
  }
  return groups;
}

void NoteUnknown(const XmlDocument& xml, const pugi::xml_node& parent, const std::set<std::string>& known,
                 std::set<std::string>& said, std::vector<std::string>& notes) {
  for (const pugi::xml_node& element : Elements(parent)) {
    if (known.count(element.name()) > 0 || !said.insert(element.name()).second) continue;
    notes.push_back(
        fmt::format("{}:{}: <{}> is not read", xml.file_name(), xml.Line(element), element.name()));
  }
}

}  // namespace

const std::array<CurvePoints, kSubjectCurves>& CeinmsCurvePoints() {
  static const std::array<CurvePoints, kSubjectCurves> kPoints{{
      {{-5, 0, 0.401, 0.402, 0.4035, 0.52725, 0.62875, 0.71875, 0.86125, 1.045, 1.2175, 1.43875, 1.61875,
        1.62, 1.621, 2.2, 5},
       {0, 0, 0, 0, 0, 0.226667, 0.636667, 0.856667, 0.95, 0.993333, 0.77, 0.246667, 0, 0, 0, 0, 0}},
      {{-5, 0.998, 0.999, 1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.601, 1.602, 5},
       {0, 0, 0, 0, 0.035, 0.12, 0.26, 0.55, 1.17, 2, 2, 2, 2}},
      {{-10, -1, -0.6, -0.3, -0.1, 0, 0.1, 0.3, 0.6, 0.8, 10},
       {0, 0, 0.08, 0.2, 0.55, 1, 1.4, 1.6, 1.7, 1.75, 1.75}},
      {{-10, -0.002, -0.001, 0, 0.00131, 0.00281, 0.00431, 0.00581, 0.00731, 0.00881, 0.0103, 0.0118, 0.0123,
        9.2, 9.201, 9.202, 20},
       {0, 0, 0, 0, 0.0108, 0.0257, 0.0435, 0.0652, 0.0915, 0.123, 0.161, 0.208, 0.227, 345, 345, 345, 345}},
  }};
  return kPoints;
}

const char* CeinmsCurveName(SubjectCurve curve) {
  return kCurveNames[curve];
}

const SubjectMuscle* Subject::Find(const std::string& muscle) const {
  const auto found =
      std::find_if(muscles.begin(), muscles.end(), [&](const SubjectMuscle& m) { return m.name == muscle; });
  return found != muscles.end() ? &*found : nullptr;
}

Result<CeinmsSubject> ReadCeinmsSubject(std::string_view text, const std::string& file_name) {
  SINEW_ASSIGN(const XmlDocument xml, XmlDocument::Parse(text, file_name));
  SINEW_ASSIGN(const Dialect dialect, DialectOf(xml));
  CeinmsSubject read;
  Subject& subject = read.subject;
  const pugi::xml_node root = xml.root();
  const pugi::xml_node defaults = root.child(dialect.defaults);
  if (!defaults) return xml.FailAt(root, "<subject> has no <{}>", dialect.defaults);
  SINEW_TRY(ReadCurves(xml, dialect, defaults, subject));
  SubjectMuscle usual;
  SINEW_TRY(ReadValues(xml, dialect, defaults, usual));

  std::set<std::string> known{"name"};
  for (const Entry& entry : kEntries) known.insert(dialect.NameOf(entry));
  std::set<std::string> said;
  for (const pugi::xml_node& element : Elements(root.child(dialect.muscles))) {
    if (std::string_view(element.name()) != dialect.muscle) continue;
    SubjectMuscle muscle = usual;
    muscle.name = ChildText(element, "name");
    if (muscle.name.empty()) return xml.FailAt(element, "<{}> has no name", dialect.muscle);
    if (subject.Find(muscle.name) != nullptr)
      return xml.FailAt(element, "the muscle '{}' is there twice", muscle.name);
    SINEW_TRY(ReadValues(xml, dialect, element, muscle));
    for (const Entry& entry : kEntries) {
      const char* name = dialect.NameOf(entry);
      if (entry.required && !element.child(name) && !defaults.child(name))
        return xml.FailAt(element, "the muscle '{}' has no <{}>", muscle.name, name);
    }
    NoteUnknown(xml, element, known, said, read.notes);
    subject.muscles.push_back(std::move(muscle));
  }
  if (subject.muscles.empty()) return xml.FailAt(root, "the subject has no muscle");
  known.insert(dialect.curve);
  NoteUnknown(xml, defaults, known, said, read.notes);
  SINEW_ASSIGN(subject.dofs,
               ReadGroups(xml, root.child(dialect.dofs), dialect.dof, dialect.members, subject));
  if (subject.dofs.empty())
    return xml.FailAt(root, "the subject has no joint coordinate (<{}><{}>)", dialect.dofs, dialect.dof);
  SINEW_ASSIGN(subject.channels,
               ReadGroups(xml, root.child("Channels"), "Channel", "muscleSequence", subject));
  subject.name = ChildText(root.child("calibrationInfo").child("uncalibrated"), "subjectID");
  return read;
}

std::string OriginalSubjectName(const std::string& name) {
  const auto dot = name.rfind('.');
  return dot == std::string::npos ? name + ".original" : name.substr(0, dot) + ".original" + name.substr(dot);
}

Result<std::string> WriteOriginalSubject(std::string_view original, const std::string& file_name,
                                         const Subject& imported, std::vector<SubjectMuscle> muscles) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  const std::string mark(original.substr(0, kMark.size()) == kMark ? kMark : "");
  original.remove_prefix(mark.size());
  SINEW_ASSIGN(const CeinmsSubject before, ReadCeinmsSubject(original, file_name));
  for (SubjectMuscle& muscle : muscles) {
    const SubjectMuscle* theirs = before.subject.Find(muscle.name);
    const SubjectMuscle* ours = imported.Find(muscle.name);
    if (theirs == nullptr || ours == nullptr || muscle.c1 != ours->c1 || muscle.c2 != ours->c2) continue;
    muscle.c1 = theirs->c1;
    muscle.c2 = theirs->c2;
  }
  SINEW_ASSIGN(const std::string written, WriteCeinmsSubject(original, file_name, muscles));
  return mark + written;
}

// The text itself is edited: comments, blanks and what we do not read stay as they are.
Result<std::string> WriteCeinmsSubject(std::string_view text, const std::string& file_name,
                                       const std::vector<SubjectMuscle>& muscles) {
  SINEW_ASSIGN(const CeinmsSubject before, ReadCeinmsSubject(text, file_name));
  SINEW_ASSIGN(const XmlDocument xml, XmlDocument::Parse(text, file_name));
  SINEW_ASSIGN(const Dialect dialect, DialectOf(xml));
  std::map<std::size_t, std::pair<std::size_t, std::string>> edits;  // place, length, replacement
  for (const SubjectMuscle& muscle : muscles) {
    const SubjectMuscle* old = before.subject.Find(muscle.name);
    if (old == nullptr) return Fail("{} has no muscle '{}'", file_name, muscle.name);
    for (const pugi::xml_node& element : xml.root().child(dialect.muscles).children(dialect.muscle)) {
      if (ChildText(element, "name") != muscle.name) continue;
      for (const Entry& entry : kEntries) {
        if (muscle.*entry.value == old->*entry.value) continue;
        const std::string number = fmt::format("{}", muscle.*entry.value / dialect.Factor(entry));
        const char* name = dialect.NameOf(entry);
        const pugi::xml_node words = element.child(name).first_child();
        if (!words) {
          const auto inside = static_cast<std::size_t>(element.child("name").first_child().offset_debug());
          const std::size_t after = text.find('>', inside) + 1;
          edits[after].second += fmt::format("<{0}>{1}</{0}>", name, number);
          continue;
        }
        if (words.type() != pugi::node_pcdata)
          return xml.FailAt(words, "{} is not plain text: it cannot be replaced", name);
        const auto at = static_cast<std::size_t>(words.offset_debug());
        edits[at] = {text.find('<', at) - at, number};
      }
    }
  }
  std::string written(text);
  for (auto edit = edits.rbegin(); edit != edits.rend(); ++edit)
    written.replace(edit->first, edit->second.first, edit->second.second);
  return written;
}

}  // namespace sinew
