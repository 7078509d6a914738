#include "problems/nms/ceinms/rt_project.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include "base/text.h"
#include "base/yaml_reader.h"
#include "datasets/cut.h"
#include "datasets/io/text_file.h"
#include "problems/nms/ceinms/rt_calibration.h"
#include "problems/nms/ceinms/rt_emg.h"
#include "problems/nms/ceinms/rt_execution.h"
#include "problems/nms/ceinms/rt_files.h"
#include "problems/nms/ceinms/rt_recording.h"
#include "problems/nms/ceinms/rt_trials.h"
#include "problems/nms/ceinms/subject.h"
#include "problems/nms/muscle/muscle_grids.h"
#include "problems/nms/settings.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTime_s = 1e-6;

class Project {
 public:
  Project(std::string file, CeinmsRtCalibration calibration)
      : file_(std::move(file)), calibration_(std::move(calibration)) {
    out_.notes = calibration_.notes;
  }

  Result<CeinmsProject> Read(const std::string& execution, const std::vector<std::string>& validate) {
    SINEW_TRY(ReadSubject());
    SINEW_TRY(WriteSettings(execution));
    SINEW_TRY(ReadModel());
    if (calibration_.raw_emg) SINEW_TRY(ReadEmgFilters());
    SINEW_ASSIGN(wanted_, ListCeinmsRtTrials(calibration_, file_, validate));
    for (const CeinmsRtWanted& wanted : wanted_) SINEW_TRY(ReadTrial(wanted));
    if (emg_filters_) Normalise();
    for (const CeinmsRtWanted& wanted : wanted_) SINEW_TRY(CutAndTrace(wanted));
    Say();
    out_.data.title = "CEINMS-RT project " + fs::path(file_).filename().string();
    out_.data.subject = subject_.name;
    out_.data.source = file_;
    SINEW_TRY(out_.data.Check());
    return std::move(out_);
  }

 private:
  [[nodiscard]] Result<std::string> Find(const CeinmsRtText& named, const std::string& element) const {
    return FindCeinmsRtFile({file_, named.line, element, named.text, 1});
  }

  // A name below the trials' directory.
  [[nodiscard]] std::string InDirectory(const std::string& name) const {
    const std::string& folder = calibration_.directory.text;
    return folder + (folder.back() == '/' || folder.back() == '\\' ? "" : "/") + name;
  }

  Status ReadSubject() {
    const auto found = FindCeinmsRtFile({file_, calibration_.subject.line, "<inputSubjectXMLName>",
                                         InDirectory(calibration_.subject.text), 1});
    if (!found && calibration_.prescaled)
      return Fail("{}; <preScaling> of CEINMS-RT writes it: run that first", found.error().message);
    if (!found) return tl::unexpected(found.error());
    SINEW_ASSIGN(const std::string text, ReadTextFile(*found));
    SINEW_ASSIGN(CeinmsSubject read, ReadCeinmsSubject(text, *found));
    subject_ = std::move(read.subject);
    std::vector<std::string> known;
    for (const auto& [joint, muscles] : subject_.dofs) known.push_back(joint);
    for (const std::string& joint : calibration_.joints) {
      if (std::find(known.begin(), known.end(), joint) == known.end())
        return FailAt(file_, calibration_.joints_line,
                      "<dofToCalibrate>: the subject {} has no joint coordinate '{}'{}", *found, joint,
                      Suggestion(joint, known));
    }
    std::vector<SubjectMuscle> muscles = subject_.muscles;
    for (SubjectMuscle& muscle : muscles) muscle.c1 = muscle.c2 = 0;
    SINEW_ASSIGN(out_.data.files["subject.xml"], WriteCeinmsSubject(text, *found, muscles));
    out_.data.files[OriginalSubjectName("subject.xml")] = ByteOrderMarkOf(*found) + text;
    for (const std::string& muscle : MusclesOf(subject_, calibration_.joints)) {
      if (!ExcitationSources(subject_, muscle).empty()) continue;
      out_.notes.push_back(fmt::format(
          "{}: no channel excites the muscle '{}': CEINMS-RT takes its excitation as 0, here it is "
          "not known, and `identify` will report it",
          *found, muscle));
    }
    return {};
  }

  Status WriteSettings(const std::string& execution) {
    CeinmsCalibration settings;
    std::string file = execution;
    if (file.empty()) {
      const fs::path beside = fs::path(file_).parent_path() / "executionRT.xml";
      std::error_code code;
      if (fs::exists(beside, code)) file = beside.string();
    }
    if (file.empty()) {
      out_.notes.push_back(
          fmt::format("{}: the execution file of CEINMS-RT (-e), which has the tendon model, is not given "
                      "(--execution): rigid",
                      file_));
    } else {
      SINEW_ASSIGN(const std::string text, ReadTextFile(file));
      SINEW_ASSIGN(CeinmsRtExecution read, ReadCeinmsRtExecution(text, file));
      settings.tendon = read.tendon;
      out_.notes.insert(out_.notes.end(), read.notes.begin(), read.notes.end());
    }
    settings.joints = calibration_.joints;
    settings.parameters = CeinmsRtParameters(calibration_.objective.text, subject_, calibration_.joints);
    settings.fibre_range = true;
    for (const auto& joints : calibration_.steps) {
      settings.steps.push_back({joints, {}});
      for (const CeinmsParameter& parameter : settings.parameters)
        settings.steps.back().parameters.push_back(parameter.name);
    }
    std::string& text = out_.data.files["nms.yaml"] = SettingsText(settings);
    // Names of a subject may be such that they mean something else in YAML.
    SINEW_ASSIGN(const YamlReader yaml, YamlReader::Parse(text, "nms.yaml"));
    SINEW_ASSIGN(const YamlReader nms, yaml.At("nms"));
    SINEW_TRY(ReadNmsSettings(nms, out_.data.files));
    return {};
  }

  Status ReadModel() {
    SINEW_ASSIGN(const std::string file, Find(calibration_.osim, "<osimFile>"));
    SINEW_ASSIGN(out_.data.files["model.osim"], ReadTextFile(file));
    SINEW_ASSIGN(
        MuscleGrids grids,
        MuscleGrids::Build(out_.data.files["model.osim"], file,
                           {MusclesOf(subject_, calibration_.joints), calibration_.joints, false,
                            fmt::format("{}:{}: <dofToCalibrate>", file_, calibration_.joints_line)}));
    grids_.emplace(std::move(grids));
    return {};
  }

  Status ReadEmgFilters() {
    if (calibration_.emg_processing.text.empty())
      return FailAt(file_, calibration_.directory.line,
                    "<filterEMG> is true, but there is no <EMGProccesing>");
    SINEW_ASSIGN(const std::string file, Find(calibration_.emg_processing, "<EMGProccesing>"));
    SINEW_ASSIGN(const std::string text, ReadTextFile(file));
    SINEW_ASSIGN(emg_filters_, ReadCeinmsRtEmg(text, file));
    std::vector<std::string> channels = Channels();
    std::sort(channels.begin(), channels.end());  // as CEINMS-RT goes through them
    if (emg_filters_->greatest.size() < channels.size())
      return Fail("{}: maxEMG has {} numbers, expected one for each of the subject's {} channels", file,
                  emg_filters_->greatest.size(), channels.size());
    for (std::size_t i = 0; i < channels.size(); ++i) greatest_[channels[i]] = emg_filters_->greatest[i];
    return {};
  }

  // The signals of the subject file.
  [[nodiscard]] std::vector<std::string> Channels() const {
    std::vector<std::string> names;
    for (const auto& [channel, muscles] : subject_.channels) names.push_back(channel);
    return names.empty() ? MusclesOf(subject_, calibration_.joints) : names;
  }

  // The whole recording.
  Status ReadTrial(const CeinmsRtWanted& wanted) {
    const auto find = [&](const char* file) {
      return FindCeinmsRtFile({file_, wanted.line, fmt::format("trial '{}'", wanted.folder),
                               InDirectory(wanted.folder + "/" + file), 2});
    };
    CeinmsRtFiles files;
    SINEW_ASSIGN(files.angles, find("ik.sto"));
    SINEW_ASSIGN(files.moments, find("id.sto"));
    SINEW_ASSIGN(files.emg, find(calibration_.raw_emg ? "emg.sto" : "emgFilt.sto"));
    const CeinmsRtReading reading{*grids_, calibration_.joints, Channels(),
                                  emg_filters_ ? &*emg_filters_ : nullptr, calibration_.emg_delay_s};
    SINEW_ASSIGN(Trial trial, ReadCeinmsRtRecording(files, reading, out_.notes));
    trial.role = wanted.role;
    recordings_[wanted.name] = std::move(trial);
    return {};
  }

  // By the greatest value of <maxEMG> and of all recordings that are fitted; held-out ones do not count.
  void Normalise() {
    for (const auto& [name, trial] : recordings_) {
      if (trial.role != Role::kTrain) continue;
      for (const auto& [channel, signal] : trial.grids.at("excitations").channels)
        greatest_[channel] =
            std::max(greatest_[channel], *std::max_element(signal.values.begin(), signal.values.end()));
    }
    for (auto& [name, trial] : recordings_) {
      for (auto& [channel, signal] : trial.grids["excitations"].channels) {
        const double greatest = greatest_[channel];
        for (double& value : signal.values) value = std::max(0.0, greatest > 0 ? value / greatest : value);
      }
    }
  }

  // Seconds of the recording. Errors: they are not all there.
  Result<TrialWindow> WindowOf(const CeinmsRtWanted& wanted, const Trial& recording) const {
    const double zero = recording.grids.at("moments").time.front();
    double end = std::numeric_limits<double>::infinity();
    for (const auto& [name, grid] : recording.grids) end = std::min(end, grid.time.back());
    const double emg_from = recording.grids.at("excitations").time.front() - calibration_.emg_delay_s;
    double begin = std::max(zero, emg_from);
    for (const auto& [name, grid] : recording.grids)
      if (name != "excitations") begin = std::max(begin, grid.time.front());
    TrialWindow window;
    window.start_s = std::isfinite(wanted.from_s) ? zero + wanted.from_s : begin;
    window.end_s = std::isfinite(wanted.to_s) ? zero + wanted.to_s : end;
    if (window.end_s > end + kSameTime_s)
      return FailAt(file_, wanted.line,
                    "trial '{}': its window ends {} s after the first moment, its recordings {} s after it",
                    wanted.folder, wanted.to_s, end - zero);
    if (emg_from > window.start_s + kSameTime_s)
      return FailAt(file_, wanted.line,
                    "trial '{}': its window begins {} s after the first moment, its EMG {} s after it",
                    wanted.folder, wanted.from_s, emg_from - zero);
    return window;
  }

  Status CutAndTrace(const CeinmsRtWanted& wanted) {
    Trial& recording = recordings_[wanted.name];
    SINEW_ASSIGN(TrialWindow window, WindowOf(wanted, recording));
    window.trial = "recording of " + wanted.name;
    window.name = wanted.name;
    Dataset cut;
    cut.trials[window.trial] = std::move(recording);
    const Status done = CutTrial(cut, window);
    if (!done) return FailAt(file_, wanted.line, "trial '{}': {}", wanted.folder, done.error().message);
    Trial& trial = out_.data.trials[wanted.name] = std::move(cut.trials[wanted.name]);
    const auto said = grids_->Add(trial.grids["coordinates"], trial);
    if (!said) return FailAt(file_, wanted.line, "trial '{}': {}", wanted.folder, said.error().message);
    // Its first line is what was asked for; the rest is what is odd.
    const auto lines = Split(*said, '\n');
    for (std::size_t i = 1; i < lines.size(); ++i) {
      if (!Trim(lines[i]).empty())
        out_.notes.push_back(fmt::format("trial '{}': {}", wanted.name, Trim(lines[i])));
    }
    return {};
  }

  void Say() {
    const auto say = [&](const std::string& words) { out_.notes.push_back(file_ + ": " + words); };
    if (calibration_.emg_delay_s > 0)
      say(fmt::format(
          "EMD: the times of the excitations are later by {} s; a `delay` that is fitted comes on top",
          calibration_.emg_delay_s));
    say("CEINMS-RT's activation has no filter: C1 and C2 are 0 in the data set's subject.xml; `sinew data "
        "subject` writes back those of the file, unless they are fitted");
    say("lengths and moment arms follow from the .osim at all recorded coordinates; CEINMS-RT interpolates "
        "them "
        "between nodes over the subject's joints and leaves other coordinates at their defaults");
    say("the objective is CEINMS-RT's, but its penalty for fibres beyond 0.5 to 1.5 optimal lengths is "
        "smooth "
        "here (fibre_range), and there is none for slack tendons; fibre velocities come from a spline "
        "through all fibre lengths, not through past "
        "ones; "
        "values of the subject that are outside of a range start at its end");
    if (emg_filters_ && wanted_.size() > 1)
      say("EMG is divided by its greatest value in all trials that are fitted; CEINMS-RT divides each trial "
          "by "
          "that of the trials up to it");
  }

  std::string file_;
  CeinmsRtCalibration calibration_;
  CeinmsProject out_;
  Subject subject_;
  std::optional<MuscleGrids> grids_;
  std::optional<CeinmsRtEmg> emg_filters_;
  std::map<std::string, double> greatest_;  // by channel
  std::vector<CeinmsRtWanted> wanted_;
  std::map<std::string, Trial> recordings_;
};

}  // namespace

Result<CeinmsProject> ReadCeinmsRtProject(const std::string& calibration, const std::string& execution,
                                          const std::vector<std::string>& validate) {
  SINEW_ASSIGN(const std::string text, ReadTextFile(calibration));
  SINEW_ASSIGN(CeinmsRtCalibration read, ReadCeinmsRtCalibration(text, calibration));
  return Project(calibration, std::move(read)).Read(execution, validate);
}

}  // namespace sinew
