#include "problems/nms/ceinms/project.h"

#include <algorithm>
#include <filesystem>

#include "base/text.h"
#include "base/value_limits.h"
#include "base/xml_document.h"
#include "datasets/io/storage_file.h"
#include "datasets/io/text_file.h"
#include "problems/nms/ceinms/calibration.h"
#include "problems/nms/ceinms/rt_project.h"
#include "problems/nms/ceinms/subject.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

std::string Beside(const std::string& file, const std::string& name) {
  const fs::path path(name);
  return path.is_absolute() ? name : (fs::path(file).parent_path() / path).lexically_normal().string();
}

// The file that a child element names. Errors: no such element.
Result<std::string> Named(const XmlDocument& xml, const char* child) {
  const std::string name = ChildText(xml.root(), child);
  if (name.empty()) return xml.FailAt(xml.root(), "<{}> has no <{}>", xml.root().name(), child);
  return Beside(xml.file_name(), name);
}

Result<XmlDocument> ReadXml(const std::string& file) {
  SINEW_ASSIGN(const std::string text, ReadTextFile(file));
  return XmlDocument::Parse(text, file);
}

// A muscle's excitation: weights of input signals.
struct Mapping {
  std::string muscle;
  std::vector<std::pair<std::string, double>> inputs;
};

Result<std::vector<Mapping>> ReadGenerator(const std::string& file) {
  SINEW_ASSIGN(const XmlDocument xml, ReadXml(file));
  if (std::string_view(xml.root().name()) != "excitationGenerator")
    return xml.FailAt(xml.root(), "the outermost element is <{}>, expected <excitationGenerator>",
                      xml.root().name());
  std::vector<Mapping> mappings;
  for (const pugi::xml_node& excitation : Elements(xml.root().child("mapping"))) {
    Mapping mapping;
    mapping.muscle = excitation.attribute("id").value();
    if (mapping.muscle.empty()) return xml.FailAt(excitation, "<excitation> has no id");
    for (const pugi::xml_node& input : Elements(excitation)) {
      const auto weight = input.attribute("weight");
      const auto number = weight ? ParseNumber(weight.value()) : std::optional<double>(1.0);
      if (!number) return xml.FailAt(input, "weight '{}' is not a number", weight.value());
      mapping.inputs.emplace_back(Trim(input.text().get()), *number);
    }
    mappings.push_back(std::move(mapping));
  }
  if (mappings.empty()) return xml.FailAt(xml.root(), "<mapping> is empty: no muscle gets an excitation");
  return mappings;
}

class TrialReader {
 public:
  TrialReader(const std::vector<Mapping>& mappings, const std::vector<std::string>& joints)
      : mappings_(mappings), joints_(joints) {}

  Result<Trial> Read(const std::string& file) const {
    SINEW_ASSIGN(const XmlDocument xml, ReadXml(file));
    if (std::string_view(xml.root().name()) != "inputData")
      return xml.FailAt(xml.root(), "the outermost element is <{}>, expected <inputData>", xml.root().name());
    Trial trial;
    SINEW_ASSIGN(const std::string lengths, Named(xml, "muscleTendonLengthFile"));
    SINEW_TRY(AddTable(lengths, "m", ChannelKind::kInput, trial.grids["lengths"]));
    SINEW_ASSIGN(const std::string excitations, Named(xml, "excitationsFile"));
    SINEW_TRY(AddExcitations(excitations, trial));
    for (const pugi::xml_node& arms : Elements(xml.root().child("momentArmsFiles"))) {
      const std::string joint = arms.attribute("dofName").value();
      if (joint.empty()) return xml.FailAt(arms, "<momentArmsFile> has no dofName");
      SINEW_TRY(AddTable(Beside(file, std::string(Trim(arms.text().get()))), "m", ChannelKind::kInput,
                         trial.grids["moment_arms." + joint]));
    }
    if (xml.root().child("externalTorquesFile")) {
      SINEW_ASSIGN(const std::string torques, Named(xml, "externalTorquesFile"));
      SINEW_TRY(AddTorques(torques, trial));
    }
    return trial;
  }

 private:
  static Status AddTable(const std::string& file, const std::string& unit, ChannelKind kind, Grid& grid) {
    SINEW_ASSIGN(const Storage table, ReadStorage(file));
    grid.time = table.time;
    for (std::size_t c = 0; c < table.names.size(); ++c)
      grid.channels[table.names[c]] = {unit, kind, {}, table.columns[c]};
    return {};
  }

  Status AddExcitations(const std::string& file, Trial& trial) const {
    SINEW_ASSIGN(const Storage table, ReadStorage(file));
    Grid& grid = trial.grids["excitations"];
    grid.time = table.time;
    if (mappings_.size() * table.time.size() > kMaxValues)
      return Fail("{}: the excitations of {} muscles would have more than {} values", file, mappings_.size(),
                  kMaxValues);
    for (const Mapping& mapping : mappings_) {
      if (mapping.inputs.empty()) continue;  // CEINMS finds it by optimisation
      std::vector<double> sum(table.time.size(), 0);
      for (const auto& [input, weight] : mapping.inputs) {
        const auto* column = table.Find(input);
        if (column == nullptr)
          return Fail("{}: there is no column '{}'{}", file, input, Suggestion(input, table.names));
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * (*column)[i];
      }
      grid.channels[mapping.muscle] = {"1", ChannelKind::kInput, {}, std::move(sum)};
    }
    return {};
  }

  // Columns are called JOINT_moment or JOINT; others are none of the subject's.
  Status AddTorques(const std::string& file, Trial& trial) const {
    SINEW_ASSIGN(const Storage table, ReadStorage(file));
    Grid& grid = trial.grids["moments"];
    grid.time = table.time;
    for (const std::string& joint : joints_) {
      const auto* column = table.Find(joint + "_moment");
      if (column == nullptr) column = table.Find(joint);
      if (column != nullptr) grid.channels[joint + "_moment"] = {"N*m", ChannelKind::kMeasured, {}, *column};
    }
    if (grid.channels.empty())
      return Fail("{}: no column is a moment of the subject's joints, expected {}_moment or {}", file,
                  joints_.front(), joints_.front());
    return {};
  }

  const std::vector<Mapping>& mappings_;
  const std::vector<std::string>& joints_;
};

}  // namespace

namespace {

// Its muscles and joints are the subject's.
Status CheckHybrid(const CeinmsCalibration& asked, const Subject& subject, const std::string& file) {
  if (!asked.hybrid) return {};
  std::vector<std::string> muscles;
  for (const SubjectMuscle& muscle : subject.muscles) muscles.push_back(muscle.name);
  std::vector<std::string> joints;
  for (const auto& [joint, movers] : subject.dofs) joints.push_back(joint);
  struct Names {
    const char* what;
    const std::vector<std::string>& names;
    const std::vector<std::string>& known;
  };
  for (const Names& list :
       {Names{"muscle", asked.hybrid->synthesise, muscles}, Names{"muscle", asked.hybrid->adjust, muscles},
        Names{"joint", asked.hybrid->joints, joints}}) {
    for (const std::string& name : list.names) {
      if (std::find(list.known.begin(), list.known.end(), name) != list.known.end()) continue;
      return FailAt(file, asked.hybrid->line, "<hybrid>: the subject has no {} '{}'{}", list.what, name,
                    Suggestion(name, list.known));
    }
  }
  return {};
}

}  // namespace

Result<CeinmsProject> ReadCeinmsProject(const std::string& setup, const std::vector<std::string>& validate,
                                        const std::string& execution) {
  SINEW_ASSIGN(const XmlDocument xml, ReadXml(setup));
  const std::string_view root = xml.root().name();
  if (root == "simulatedAnnealing") return ReadCeinmsRtProject(setup, execution, validate);
  const bool calibrates = root == "ceinmsCalibration";
  if (!calibrates && root != "ceinms")
    return xml.FailAt(xml.root(),
                      "the outermost element is <{}>, expected <ceinmsCalibration>, <ceinms>, or CEINMS-RT's "
                      "<simulatedAnnealing>",
                      root);
  if (!execution.empty())
    return xml.FailAt(xml.root(), "--execution goes with a calibration of CEINMS-RT, <simulatedAnnealing>");
  SINEW_ASSIGN(const std::string subject_file, Named(xml, "subjectFile"));
  SINEW_ASSIGN(const std::string subject_text, ReadTextFile(subject_file));
  SINEW_ASSIGN(const CeinmsSubject subject, ReadCeinmsSubject(subject_text, subject_file));
  SINEW_ASSIGN(const std::string generator, Named(xml, "excitationGeneratorFile"));
  SINEW_ASSIGN(const std::vector<Mapping> mappings, ReadGenerator(generator));
  SINEW_ASSIGN(const std::string asked, Named(xml, calibrates ? "calibrationFile" : "executionFile"));
  SINEW_ASSIGN(const std::string asked_text, ReadTextFile(asked));
  SINEW_ASSIGN(CeinmsCalibration calibration, ReadCeinmsCalibration(asked_text, asked));

  SINEW_TRY(CheckHybrid(calibration, subject.subject, asked));

  std::vector<std::pair<std::string, Role>> trials;
  // As CEINMS has it, trials are named relative to the setup.
  for (const std::string& trial : calibration.trials) trials.emplace_back(Beside(setup, trial), Role::kTrain);
  if (!calibrates) {
    SINEW_ASSIGN(const std::string trial, Named(xml, "inputDataFile"));
    trials.emplace_back(trial, Role::kTrain);
  }
  for (const std::string& trial : validate) trials.emplace_back(trial, Role::kValidate);

  std::vector<std::string> joints;
  for (const auto& [joint, muscles] : subject.subject.dofs) joints.push_back(joint);
  CeinmsProject project;
  const TrialReader reader(mappings, joints);
  for (const auto& [file, role] : trials) {
    SINEW_ASSIGN(Trial trial, reader.Read(file));
    trial.role = role;
    const std::string name = fs::path(file).stem().string();
    if (!project.data.trials.emplace(name, std::move(trial)).second)
      return Fail("{}: there is already a trial called '{}'", file, name);
  }
  project.data.title = "CEINMS project " + fs::path(setup).filename().string();
  project.data.subject = subject.subject.name;
  project.data.source = setup;
  project.data.files["subject.xml"] = subject_text;
  if (const std::string mark = ByteOrderMarkOf(subject_file); !mark.empty())
    project.data.files[OriginalSubjectName("subject.xml")] = mark + subject_text;
  project.data.files["nms.yaml"] = SettingsText(calibration);
  project.notes = std::move(calibration.notes);
  for (const Mapping& mapping : mappings) {
    if (mapping.inputs.empty()) {
      project.notes.push_back(fmt::format("{}: muscle '{}' has no input: its excitation is not known",
                                          generator, mapping.muscle));
    }
  }
  SINEW_TRY(project.data.Check());
  return project;
}

}  // namespace sinew
